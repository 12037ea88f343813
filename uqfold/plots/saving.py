"""Writing figures to files, and as SVG into pages."""

from __future__ import annotations

import io
import os
import re
from collections.abc import Iterable
from typing import TYPE_CHECKING, Any

from uqfold.checks import choice, refused, several
from uqfold.checks import path as checked_path
from uqfold.plots.style import figure_settings
from uqfold.writing import replacing

if TYPE_CHECKING:
    from pathlib import Path

    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

FORMATS = ("png", "svg", "pdf")


def save(
    figure: Figure | Axes, path: str | os.PathLike[str], formats: Iterable[str] = ("png",)
) -> list[Path]:
    """Write a figure in each of some formats; each file appears whole or not at all.

    The same figure gives the same file: no date is written.

    Parameters
    ----------
    figure
        The figure, or any of its axes.
    path
        Where to, without a suffix; its folder is made if it is missing.
    formats
        Of ``png``, ``svg`` and ``pdf``.

    Returns
    -------
    list[pathlib.Path]
        The files written.

    Raises
    ------
    ValueError
        If a format is none of these.
    OSError
        If a file cannot be written.
    """
    drawn = figure_of(figure)
    stem = checked_path("path", path)
    listed = several("formats", formats, choice, FORMATS)
    stem.parent.mkdir(parents=True, exist_ok=True)
    written = []
    for one in listed:
        # with_suffix would take the end of "pf-0.5" for a suffix
        file = stem.with_name(f"{stem.name}.{one}")
        with replacing(file) as stream:
            if one == "svg":
                stream.write(svg_text(drawn).encode())
            else:
                write(drawn, stream, one)
        written.append(file)
    return written


def figure_of(figure: object) -> Any:
    """Return a figure of matplotlib, also that of given axes."""
    whole: Any = figure if hasattr(figure, "savefig") else getattr(figure, "figure", None)
    if not hasattr(whole, "savefig"):
        raise refused("figure", figure, "give a Figure or Axes of matplotlib", TypeError)
    return whole


def svg_text(figure: Figure) -> str:
    """Return a figure as the text of an SVG file."""
    stream = io.BytesIO()
    write(figure, stream, "svg")
    text = stream.getvalue().decode()
    # matplotlib names what is referred to by places that differ in their last digits
    names = dict.fromkeys(re.findall(r'id="([a-z][0-9a-f]{10})"', text))
    for number, name in enumerate(names):
        text = text.replace(name, f"{name[0]}{number}")
    return text


def write(figure: Figure, stream: Any, format: str) -> None:
    """Write a figure into a stream, without a date; a PNG has 256 colours."""
    dates = {"svg": {"Date": None}, "pdf": {"CreationDate": None}}
    with figure_settings():
        if format != "png":
            figure.savefig(stream, format=format, metadata=dates[format])
            return
        from PIL import Image

        whole = io.BytesIO()
        figure.savefig(whole, format="png")
        with Image.open(whole) as picture:
            # a quarter of the size; the median cut would turn the colour of a few small marks into
            # that of another method
            few = picture.convert("RGB").quantize(256, Image.Quantize.FASTOCTREE)
        few.save(stream, "png", optimize=True)
