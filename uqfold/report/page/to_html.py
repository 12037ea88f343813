"""A page as one HTML file that needs nothing else: no network, no fonts, no script to be read.

Style and script are inline, and a content security policy names both by their hash: nothing else
in the file can style, run or load anything, even if a text should find its way through the
escaping. Templates escape whatever they are given.
"""

from __future__ import annotations

import base64
import hashlib
from collections.abc import Iterable
from dataclasses import dataclass, field
from itertools import groupby
from typing import TYPE_CHECKING, Any

from uqfold.report.page.builder import Block, Card, Heading, Picture
from uqfold.report.page.cells import Cell
from uqfold.report.page.colors import by_day, by_night
from uqfold.report.page.environment import template
from uqfold.report.page.markup import pieces, spans
from uqfold.report.page.mathml import mathml
from uqfold.report.page.picture import describe, inline_svg
from uqfold.report.page.text import visible

if TYPE_CHECKING:
    from markupsafe import Markup

    from uqfold.report.page.builder import Page

_SHORT = 26
"""Cells up to this length stay on one line."""


@dataclass
class Part:
    """A heading, the blocks below it, and the parts within it."""

    heading: Heading
    blocks: list[Block] = field(default_factory=list)
    parts: list[Part] = field(default_factory=list)


def html(page: Page) -> str:
    """Return a page as an HTML document; the same page always gives the same text."""
    from markupsafe import Markup

    colors: set[str] = set()
    whole = _tree(page.blocks)
    body = template("body.html.j2").render(
        page=page,
        summary=whole.blocks,
        sections=whole.parts,
        grouped=_grouped,
        pieces=pieces,
        spans=spans,
        cell_classes=_cell_classes,
        sortable=_sortable,
        mathml=_mathml,
        picture=_Pictures(colors),
        values=_values,
    )
    shades = [(one[1:], by_day(one), by_night(one)) for one in sorted(colors)]
    style = template("page.css.j2").render(colors=shades)
    script = template("page.js").render()
    return template("page.html.j2").render(
        page=page,
        # all three are our own: the body comes out of an escaping template
        body=Markup(body),
        style=Markup(style),
        script=Markup(script),
        style_hash=_hash(style),
        script_hash=_hash(script),
    )


def _tree(blocks: Iterable[Block]) -> Part:
    """Put blocks below their headings, and headings below those of lower level."""
    path = [Part(Heading("", "", 0, "", ""))]
    for block in blocks:
        if isinstance(block, Heading):
            part = Part(block)
            while path[-1].heading.level >= block.level:
                path.pop()
            path[-1].parts.append(part)
            path.append(part)
        else:
            path[-1].blocks.append(block)
    return path[0]


def _grouped(blocks: Iterable[Block]) -> list[tuple[str, list[Block]]]:
    """Return runs of cards as one, other blocks one by one, each with its kind."""
    found: list[tuple[str, list[Block]]] = []
    for cards, group in groupby(blocks, lambda block: isinstance(block, Card)):
        run = list(group)
        found += [("cards", run)] if cards else [(block.kind, [block]) for block in run]
    return found


@dataclass
class _Pictures:
    """Draws figures, numbers them and remembers their colours."""

    colors: set[str]
    drawn: int = 0

    def __call__(self, block: Picture) -> Markup:
        from markupsafe import Markup

        self.drawn += 1
        said = ". ".join(part for part in (block.title, describe(block.figure)) if part)
        # serialised from a tree, so everything in it is escaped
        return Markup(visible(inline_svg(block.figure, f"p{self.drawn}", f"{said}.", self.colors)))


def _values(block: Picture) -> list[tuple[str, list[str]]]:
    """Return whose points are marked in a figure, with their texts in one line each."""
    from uqfold.plots.telling import values

    return [
        (
            ", ".join(part.partition("=")[2] for part in name.split(";")),
            [text.replace("\n", ", ") for text in texts],
        )
        for name, texts in values(block.figure).items()
    ]


def _mathml(latex: str) -> Markup | None:
    from markupsafe import Markup

    found = mathml(latex)
    return None if found is None else Markup(found)


def _sortable(cell: Cell) -> str | None:
    """Return what a numeric cell is sorted by; empty for none."""
    if cell.value is None:
        return None
    return "" if cell.value != cell.value else repr(cell.value)


def _cell_classes(cell: Cell, numeric: bool) -> str:
    classes = ["number"] if numeric else []
    if len(cell.text) <= _SHORT:
        classes.append("short")
    if cell.tone:
        classes.append(f"tone {cell.tone}")
    return " ".join(classes)


def _hash(text: str) -> Any:
    digest = hashlib.sha256(text.encode("utf-8")).digest()
    return f"sha256-{base64.b64encode(digest).decode('ascii')}"
