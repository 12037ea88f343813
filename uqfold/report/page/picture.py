"""Figures of matplotlib inside a page: SVG that follows the page's colours, type and switches."""

from __future__ import annotations

import re
import xml.etree.ElementTree as ET
from typing import TYPE_CHECKING

from uqfold.plots.saving import svg_text
from uqfold.plots.telling import Spot, told

if TYPE_CHECKING:
    from uqfold.plots.types import Figure

SVG = "http://www.w3.org/2000/svg"
_LINK = "{http://www.w3.org/1999/xlink}href"
_SIZE = re.compile(r"([\d.]+)px")
_COLOR = re.compile(r"#[0-9a-f]{6}")
_REFERENCE = re.compile(r"url\(#([^)]*)\)")
_ENLARGED = 1.45
"""Pixels of the page per point of a figure: its 9 points become the 13 pixels of small text."""
_NEAR = 1.0
"""Points within which a marker is that of a spot."""


def inline_svg(figure: Figure, prefix: str, description: str, colors: set[str]) -> str:
    """Return a figure as an ``svg`` element of a page.

    Its styles become attributes, which a content security policy lets through; colours become
    variables of the page, text its type. What belongs to a method or criterion has a
    ``data-gid``, and every marker its text.

    Parameters
    ----------
    figure
        The figure; it comes out as it was.
    prefix
        What its identifiers begin with, so that they are unique in the page.
    description
        What is read out in its place.
    colors
        Gains the colours that occur, in six hexadecimal digits.
    """
    artists = list(told(figure))
    owners = {f"artist-{i}": artist.get_gid() or "" for i, (artist, _) in enumerate(artists)}
    try:
        for name, (artist, _) in zip(owners, artists, strict=True):
            artist.set_gid(name)
        root = ET.fromstring(svg_text(figure))
    finally:
        for owner, (artist, _) in zip(owners.values(), artists, strict=True):
            artist.set_gid(owner)
    # where the points are is known now that the figure has been laid out
    spots = dict(zip(owners, (spots for _, spots in told(figure)), strict=True))
    for parent in list(root.iter()):
        for child in list(parent):
            if child.tag in (f"{{{SVG}}}metadata", f"{{{SVG}}}style"):
                parent.remove(child)
    for element in root.iter():
        name = element.get("id", "")
        _restyle(element, colors)
        _rename(element, prefix)
        if name in owners:
            element.set("data-gid", owners[name])
            _label_markers(element, spots[name])
    width, height = root.get("viewBox", "0 0 0 0").split()[2:]
    root.attrib = {
        "viewBox": f"0 0 {width} {height}", "width": f"{_ENLARGED * float(width):.0f}",
        "role": "img", "aria-label": description, "class": "chart",
    }  # fmt: skip
    return _serialised(root)


def describe(figure: Figure) -> str:
    """Say in words what a figure shows: its panels with their axes, and what is drawn."""
    said = []
    for axes in figure.axes:
        panel = " ".join((axes.get_title(loc="left") or axes.get_title()).split())
        names = [" ".join(name.split()) for name in (axes.get_ylabel(), axes.get_xlabel()) if name]
        words = ": ".join(part for part in (panel, " over ".join(names)) if part)
        if words:
            said.append(words)
    return "; ".join(dict.fromkeys(said))


def _restyle(element: ET.Element, colors: set[str]) -> None:
    """Turn a style attribute into presentation attributes, and colours into variables."""
    for part in element.attrib.pop("style", "").split(";"):
        name, _, value = (piece.strip() for piece in part.partition(":"))
        if name == "font":
            size = _SIZE.search(value)
            element.set("font-size", size[1] if size else "9")
            if "bold" in value or " 700 " in f" {value}":
                element.set("font-weight", "bold")
        elif name and name != "font-family":
            element.set(name, value.removesuffix("px") if name == "font-size" else value)
    for name in ("fill", "stroke", "stop-color"):
        value = element.get(name, "").lower()
        if _COLOR.fullmatch(value):
            colors.add(value)
            element.set(name, f"var(--c{value[1:]})")


def _rename(element: ET.Element, prefix: str) -> None:
    """Make identifiers that are referred to unique in the page, and drop the others."""
    name = element.attrib.pop("id", None)
    if name is not None and element.tag != f"{{{SVG}}}g":
        element.set("id", f"{prefix}-{name}")
    if _LINK in element.attrib:
        target = element.attrib.pop(_LINK)
        element.set("href", f"#{prefix}-{target[1:]}" if target.startswith("#") else target)
    for key, value in element.attrib.items():
        if "url(#" in value:
            element.set(key, _REFERENCE.sub(rf"url(#{prefix}-\1)", value))


def _label_markers(group: ET.Element, spots: list[Spot]) -> None:
    for use in group.iter(f"{{{SVG}}}use"):
        x, y = float(use.get("x", "nan")), float(use.get("y", "nan"))
        near = min(spots, key=lambda spot: abs(spot[0] - x) + abs(spot[1] - y), default=None)
        if near is not None and abs(near[0] - x) + abs(near[1] - y) < _NEAR:
            ET.SubElement(use, f"{{{SVG}}}title").text = near[2]


def _serialised(root: ET.Element) -> str:
    for element in root.iter():
        element.tag = element.tag.removeprefix(f"{{{SVG}}}")
        # matplotlib indents; only text counts
        element.tail = None
        if not (element.text or "").strip():
            element.text = None
        if "d" in element.attrib:
            element.set("d", " ".join(element.attrib["d"].split()))
    root.set("xmlns", SVG)
    return ET.tostring(root, encoding="unicode")
