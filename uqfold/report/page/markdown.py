"""A page as Markdown, as GitHub and most other readers know it, charts as SVG files beside it."""

from __future__ import annotations

import re
import xml.etree.ElementTree as ET
from collections.abc import Iterator
from dataclasses import dataclass, field

from uqfold.report.page.blocks import (
    Block,
    Cards,
    Code,
    Controls,
    Details,
    Facts,
    Figure,
    Formula,
    Items,
    Link,
    Listing,
    Page,
    Paragraph,
    Section,
    Strong,
    Table,
    Words,
    parts,
)
from uqfold.report.page.chart import Chart
from uqfold.report.page.colors import DARK_PAPER, LIGHT_PAPER, readable
from uqfold.report.page.environment import template
from uqfold.report.page.svg import draw_chart, svg_text
from uqfold.report.page.text import visible

_SPECIAL = re.compile(r"([\\`*_\[\]~|$#])")
_AT_START = re.compile(r"^(\s*)([-+]|\d+[.)])(?=\s)")
_ADDRESS = re.compile(r"(?i)\b(https?|ftp|www)(?=[:.])|@")
_LIGHT = {"soft": "#5a6169", "ink": "#1d2126", "faint": "#e4e6e9", "paper": LIGHT_PAPER}
_DARK = {"soft": "#a9adb2", "ink": "#e6e4df", "faint": "#343a41", "paper": DARK_PAPER}


def page_markdown(page: Page, stem: str) -> dict[str, str]:
    """Write a page as Markdown.

    Parameters
    ----------
    page
        The page.
    stem
        Name of the file without its suffix; the folder of the pictures is called after it.

    Returns
    -------
    dict[str, str]
        The text under the empty name, and the pictures under the paths of their files.
    """
    writer = _Writer(stem)
    lines = [f"# {_words(page.title)}", "", _words(page.lead), ""]
    for block in (*page.summary, *page.sections):
        lines += [*writer.lines(block, 2), ""]
    if page.imprint:
        lines += ["---", "", _words(page.imprint)]
    text = re.sub(r"\n{3,}", "\n\n", "\n".join(lines)).strip() + "\n"
    return {"": visible(text), **writer.pictures}


@dataclass
class _Writer:
    """Turns blocks into lines, and keeps the pictures that were drawn on the way."""

    stem: str
    pictures: dict[str, str] = field(default_factory=dict)

    def lines(self, block: Block, level: int) -> Iterator[str]:
        match block:
            case Paragraph():
                yield _words(block.words)
            case Items():
                for number, item in enumerate(block.items, start=1):
                    yield f"{f'{number}.' if block.numbered else '-'} {_words(item)}"
            case Cards():
                for card in block.cards:
                    yield f"- {_words(card.title)} **{_words(card.answer)}**"
                    yield from (f"  - {_words(words)}" for words in card.more)
            case Table():
                yield from _table(block)
            case Facts():
                yield from ("| | |", "| --- | --- |")
                yield from (f"| {_words(name)} | {_words(words)} |" for name, words in block.facts)
            case Figure():
                yield from self._figure(block)
            case Formula():
                lead = _words(block.lead) + (f" ({_words(block.source)}):" if block.source else ":")
                yield from (lead, "", *_latex(block.latex))
            case Listing():
                yield from _fenced(block.text)
            case Details():
                yield from (f"**{_words(block.title)}**", "")
                yield from self._blocks(block.blocks, level)
            case Section():
                label = f" ({_words(block.label)})" if block.label else ""
                yield from (f"{'#' * min(level, 6)} {_words(block.title)}{label}", "")
                yield from self._blocks(block.blocks, level + 1)
            case Controls():
                pass

    def _blocks(self, blocks: tuple[Block, ...], level: int) -> Iterator[str]:
        for block in blocks:
            yield from self.lines(block, level)
            yield ""

    def _figure(self, figure: Figure) -> Iterator[str]:
        for view in figure.views:
            for chart in view.charts:
                name = f"{self.stem}-figures/{len(self.pictures) + 1:02d}.svg"
                self.pictures[name] = standalone_svg(chart)
                title = f"{chart.title}: {view.name}" if len(figure.views) > 1 else chart.title
                yield from (f"![{_words(title)}]({name})", "")
        if figure.caption:
            yield f"*{_words(figure.caption)}*"
        if figure.legend:
            yield from ("", "Legend: " + ", ".join(_legend(figure)) + ".")


def _legend(figure: Figure) -> Iterator[str]:
    signs = {"o": "●", "s": "■", "D": "◆", "^": "▲", "v": "▼", "<": "◀", ">": "▶", "P": "✚"}
    signs |= {"X": "✖", "p": "⬟", "h": "⬢", "H": "⬣", "8": "⯃", "d": "⬧", "*": "★", "--": "- -"}
    for key in figure.legend:
        yield f"{signs.get(key.marker, '●')} {_words(key.label)}"


def standalone_svg(chart: Chart) -> str:
    """Draw a chart as a file of its own, which follows the reader's light or dark scheme."""
    classes: dict[str, str] = {}

    def color_class(color: str) -> str:
        return classes.setdefault(color, f"k{len(classes)}") if color else ""

    svg = draw_chart(chart, "chart", color_class)
    sheet = template("chart.css.j2")
    light = sheet.render(**_LIGHT, colors=_colors(classes, LIGHT_PAPER))
    dark = sheet.render(**_DARK, colors=_colors(classes, DARK_PAPER))
    style = ET.Element("style")
    style.text = f"{light}@media (prefers-color-scheme: dark) {{ {dark} }}"
    paper = ET.Element("rect", {"class": "paper", "width": "100%", "height": "100%"})
    svg.insert(0, style)
    svg.insert(1, paper)
    title = ET.Element("title")
    title.text = chart.title
    svg.insert(0, title)
    return visible(svg_text(svg)) + "\n"


def _colors(classes: dict[str, str], paper: str) -> list[tuple[str, str]]:
    return [(name, readable(color, paper)) for color, name in classes.items()]


def _words(words: Words) -> str:
    """Give words in one line, everything in them escaped."""
    written = []
    for part in parts(words):
        match part:
            case Code():
                written.append(_code(part.text))
            case Strong():
                written.append(f"**{_escaped(part.text)}**")
            case Link():
                written.append(_escaped(part.text))
            case str():
                written.append(_escaped(part))
            case _:
                written.append(_escaped(part.text))
    return _AT_START.sub(r"\1\\\2", "".join(written))


def _escaped(text: str) -> str:
    line = re.sub(r"\s*[\r\n\v\f\x1c-\x1e\x85\u2028\u2029]+\s*", " ", text)
    line = line.replace("&", "&amp;").replace("<", "&lt;").replace(">", "&gt;")
    line = _SPECIAL.sub(r"\\\1", line)
    # an address in a record is text, no link
    return _ADDRESS.sub(lambda match: f"{match[0]}<!-- -->", line)


def _code(text: str) -> str:
    line = re.sub(r"\s+", " ", text)
    # a bar ends the cell of a table even within code
    line = line.replace("|", "\N{BROKEN BAR}")
    ticks = "`" * (max((len(run) for run in re.findall(r"`+", line)), default=0) + 1)
    space = " " if line.startswith("`") or line.endswith("`") else ""
    return f"{ticks}{space}{line}{space}{ticks}" if line.strip() else ""


def _fenced(text: str) -> list[str]:
    longest = max((len(run) for run in re.findall(r"`+", text)), default=0)
    fence = "`" * max(3, longest + 1)
    return [fence, text, fence]


def _latex(latex: str) -> list[str]:
    """Give a displayed equation, or its source as code where it could end the display."""
    if "$" in latex or "\n" in latex or "```" in latex:
        return _fenced(latex)
    return ["```math", latex, "```"]


def _table(table: Table) -> Iterator[str]:
    if table.show_caption:
        yield from (f"*{_words(table.caption)}*", "")
    yield "| " + " | ".join(_words(column.head) for column in table.columns) + " |"
    yield "| " + " | ".join("---:" if c.numeric else "---" for c in table.columns) + " |"
    for row in table.rows:
        yield "| " + " | ".join(_words(cell.words) for cell in row.cells) + " |"
