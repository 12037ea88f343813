"""A page as one HTML file that needs nothing else: no network, no fonts, no script to be read.

Style and script are inline, and a content security policy names both by their hash: nothing else
in the file can style, run or load anything, even if a text should find its way through the
escaping. Templates escape whatever they are given.
"""

from __future__ import annotations

import base64
import hashlib
import re
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from functools import cache
from itertools import count
from typing import TYPE_CHECKING, Any

from uqfold.report.page import markup
from uqfold.report.page.cells import Cell
from uqfold.report.page.colors import by_day, by_night
from uqfold.report.page.mathml import mathml
from uqfold.report.page.picture import describe, inline_svg

if TYPE_CHECKING:
    from jinja2 import Environment

_SHORT = 26
"""Cells up to this length stay on one line."""
_INVISIBLE = re.compile("[\x00-\x08\x0b\x0c\x0e-\x1f\x7f-\x9f\ud800-\udfff\ufffe\uffff]")


@dataclass
class Block:
    """A piece of a page.

    Attributes
    ----------
    kind
        What it is, as the macro that makes HTML of it is called.
    markdown
        The piece as Markdown.
    data
        What that macro needs, by name.
    """

    kind: str
    markdown: str
    data: Mapping[str, Any]


@dataclass
class Section:
    """A heading (data of its block), the blocks below it, and the sections within it."""

    heading: Mapping[str, Any]
    blocks: list[Block] = field(default_factory=list)
    sections: list[Section] = field(default_factory=list)


def html(blocks: Iterable[Block], **about: str) -> str:
    """Return an HTML document; the same blocks always give the same text.

    Parameters
    ----------
    blocks
        What it shows, from top to bottom.
    about
        Its ``title``, ``lead``, ``kind`` and ``imprint``.
    """
    from markupsafe import Markup

    colors: set[str] = set()
    numbers = count(1)

    def picture(data: Mapping[str, Any]) -> Markup:
        said = ". ".join(part for part in (data["title"], describe(data["figure"])) if part)
        # serialised from a tree, so everything in it is escaped
        return Markup(inline_svg(data["figure"], f"p{next(numbers)}", f"{said}.", colors))

    templates = _templates()
    body = templates.get_template("body.html.j2").render(
        page=about, whole=_tree(blocks), picture=picture
    )
    shades = [(one[1:], by_day(one), by_night(one)) for one in sorted(colors)]
    style = templates.get_template("page.css.j2").render(colors=shades)
    script = templates.get_template("page.js").render()
    return templates.get_template("page.html.j2").render(
        page=about,
        # all three are our own: the body comes out of an escaping template
        body=Markup(visible(body)),
        style=Markup(style),
        script=Markup(script),
        style_hash=_hash(style),
        script_hash=_hash(script),
    )


def visible(text: str) -> str:
    """Replace what no document may hold (control characters, halves of surrogate pairs)."""
    return _INVISIBLE.sub("\N{REPLACEMENT CHARACTER}", text)


@cache
def _templates() -> Environment:
    from jinja2 import Environment, PackageLoader, StrictUndefined
    from markupsafe import Markup

    templates = Environment(
        loader=PackageLoader("uqfold.report.page", "templates"),
        autoescape=True,
        undefined=StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
    )
    templates.filters |= {
        "markdown": lambda text: Markup(markup.html(text)),
        "inline": lambda text: Markup(markup.inline_html(text)),
        "mathml": lambda latex: Markup(mathml(latex) or ""),
        "sortable": _sortable,
        "classes": _classes,
        "values": _values,
    }
    return templates


def _tree(blocks: Iterable[Block]) -> Section:
    """Put blocks below their headings, and headings below those of lower level."""
    path = [Section({"level": 0})]
    for block in blocks:
        if block.kind == "heading":
            section = Section(block.data)
            while path[-1].heading["level"] >= block.data["level"]:
                path.pop()
            path[-1].sections.append(section)
            path.append(section)
        else:
            path[-1].blocks.append(block)
    return path[0]


def _values(figure: Any) -> list[tuple[str, list[str]]]:
    """Return whose points are marked in a figure, with their texts in one line each."""
    from uqfold.plots.telling import values

    return [
        (
            ", ".join(part.partition("=")[2] for part in name.split(";")),
            [text.replace("\n", ", ") for text in texts],
        )
        for name, texts in values(figure).items()
    ]


def _sortable(cell: Cell) -> str | None:
    """Return what a numeric cell is sorted by, empty for NaN; None for text."""
    if cell.value is None:
        return None
    return "" if cell.value != cell.value else repr(cell.value)


def _classes(cell: Cell, numeric: bool) -> str:
    named = {
        "number": numeric, "short": len(cell.text) <= _SHORT, f"tone {cell.tone}": cell.tone
    }  # fmt: skip
    return " ".join(name for name, applies in named.items() if applies)


def _hash(text: str) -> str:
    digest = hashlib.sha256(text.encode("utf-8")).digest()
    return f"sha256-{base64.b64encode(digest).decode('ascii')}"
