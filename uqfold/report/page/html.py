"""A page as one HTML file that needs nothing else: no network, no fonts, no script to be read.

Style and script are inline, and a content security policy names both by their hash: nothing else
in the file can style, run or load anything, even if a text should find its way through the
escaping. Templates escape whatever they are given.
"""

from __future__ import annotations

import base64
import hashlib
from collections.abc import Iterator
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

from uqfold.report.page.blocks import Cell, Page, Part, Section, Words, parts, plain
from uqfold.report.page.chart import Key
from uqfold.report.page.colors import DARK_PAPER, LIGHT_PAPER, readable
from uqfold.report.page.environment import template
from uqfold.report.page.mathml import mathml
from uqfold.report.page.svg import draw_chart, draw_strip, draw_swatch, svg_text
from uqfold.report.page.text import split_powers, visible
from uqfold.report.page.values import values_table

if TYPE_CHECKING:
    from markupsafe import Markup


_SHORT = 26


def page_html(page: Page) -> str:
    """Write a page as HTML.

    Parameters
    ----------
    page
        The page.

    Returns
    -------
    str
        The whole document. The same page always gives the same text.
    """
    from markupsafe import Markup

    writer = _Writer()
    body = template("body.html.j2").render(page=page, **writer.names)
    style = template("page.css.j2").render(colors=writer.colors())
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


def _hash(text: str) -> str:
    digest = hashlib.sha256(text.encode("utf-8")).digest()
    return f"sha256-{base64.b64encode(digest).decode('ascii')}"


@dataclass
class _Writer:
    """What the templates call; remembers the colours that were used."""

    _classes: dict[str, str] = field(default_factory=dict)
    _drawn: int = 0

    @property
    def names(self) -> dict[str, Any]:
        return {
            "cell_classes": _cell_classes,
            "chart": self.chart,
            "strip": self.strip,
            "swatch": self.swatch,
            "mathml": _mathml,
            "parts": _kinded,
            "plain": plain,
            "pieces": split_powers,
            "sortable": _sortable,
            "subsections": _subsections,
            "values": values_table,
        }

    def colors(self) -> list[tuple[str, str, str]]:
        """Class, colour on light and colour on dark paper, in order of use."""
        return [
            (name, readable(color, LIGHT_PAPER), readable(color, DARK_PAPER))
            for color, name in self._classes.items()
        ]

    def color_class(self, color: str) -> str:
        if not color:
            return ""
        return self._classes.setdefault(color, f"k{len(self._classes)}")

    def chart(self, chart: Any, *, alone: bool) -> Markup:
        self._drawn += 1
        name = f"chart-{self._drawn}"
        return _markup(draw_chart(chart, name, self.color_class, alone=alone))

    def strip(self, cell: Cell) -> Markup:
        return _markup(draw_strip(cell.strip, plain(cell.words), self.color_class))  # type: ignore[arg-type]

    def swatch(self, key: Key) -> Markup | str:
        if not key.marker:
            return ""
        return _markup(draw_swatch(key.color, key.marker, self.color_class))


def _markup(element: Any) -> Markup:
    from markupsafe import Markup

    # serialised from a tree, so everything in it is escaped
    return Markup(visible(svg_text(element)))


def _mathml(latex: str) -> Markup | None:
    from markupsafe import Markup

    found = mathml(latex)
    return None if found is None else Markup(found)


def _kinded(words: Words) -> list[tuple[str, Part]]:
    """Give the parts of words, each with the name of its type."""
    return [
        ("str" if isinstance(part, str) else type(part).__name__.lower(), part)
        for part in parts(words)
    ]


def _sortable(cell: Cell) -> str | None:
    """Give what a numeric cell is sorted by; empty for none."""
    if cell.value is None:
        return None
    return "" if cell.value != cell.value else repr(float(cell.value))


def _cell_classes(cell: Cell, numeric: bool) -> str:
    """Give the classes of a cell; what is short stays on one line."""
    classes = ["number"] if numeric else []
    if len(plain(cell.words)) <= _SHORT:
        classes.append("short")
    if cell.tone:
        classes.append(f"tone {cell.tone}")
    return " ".join(classes)


def _subsections(section: Section) -> Iterator[Section]:
    for block in section.blocks:
        if isinstance(block, Section):
            yield block
