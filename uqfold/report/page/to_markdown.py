"""A page as Markdown, as GitHub and most other readers know it."""

from __future__ import annotations

import re
from collections.abc import Iterator
from typing import TYPE_CHECKING
from urllib.parse import quote

from uqfold.report.page.builder import (
    Block,
    Card,
    Details,
    Equation,
    Facts,
    Heading,
    Listing,
    Picture,
    Table,
    Text,
)
from uqfold.report.page.markup import Span, code, pieces, spans
from uqfold.report.page.text import visible

if TYPE_CHECKING:
    from uqfold.report.page.builder import Page

_SPECIAL = re.compile(r"([\\`*_\[\]~|$#])")
_AT_START = re.compile(r"^(\s*)([-+]|\d+[.)])(?=\s)")
_ADDRESS = re.compile(r"(?i)\b(https?|ftp|www)(?=[:.])|@")


def markdown(page: Page) -> str:
    """Return a page as Markdown."""
    lines = [f"# {_plain(page.title)}", "", *_text(page.lead)]
    parts = [list(_lines(block)) for block in page.blocks]
    told = "\n".join(line for part in parts for line in part)
    for block, part in zip(page.blocks, parts, strict=True):
        if isinstance(block, Heading) and f"](#{block.name})" in told:
            lines += [f'<a id="{block.name}"></a>', ""]
        lines += [*part, ""]
    if page.imprint:
        lines += ["---", "", *_text(page.imprint)]
    joined = re.sub(r"\n{3,}", "\n\n", "\n".join(lines))
    # statements side by side are one list
    joined = re.sub(r"(?m)(^ *- .*\n)\n(?=- )", r"\1", joined)
    return visible(joined.strip() + "\n")


def _lines(block: Block) -> Iterator[str]:
    match block:
        case Text():
            yield from _text(block.source)
        case Card():
            yield f"- {_line(block.title)} **{_line(block.answer)}**"
            yield from (f"  - {_line(one)}" for one in block.more)
        case Facts():
            yield from ("| | |", "| --- | --- |")
            yield from (f"| {_plain(name)} | {_line(said)} |" for name, said in block.facts)
        case Table():
            yield from _table(block)
        case Picture():
            yield from (f"![{_plain(block.title)}](figures/{quote(block.name)}.png)", "")
            yield f"*{_plain(block.title)}*{_behind(block.caption)}"
        case Equation():
            yield from _equation(block)
        case Listing():
            yield from _fenced(block.text)
        case Details():
            yield from (f"**{_plain(block.title)}**", "")
            for inner in block.blocks:
                yield from (*_lines(inner), "")
        case Heading():
            label = f" ({_plain(block.label)})" if block.label else ""
            yield f"{'#' * min(block.level + 1, 6)} {_plain(block.title)}{label}"


def _text(source: str) -> Iterator[str]:
    for piece in pieces(source):
        marks = {"p": "", "ul": "- "}
        for number, line in enumerate(piece.lines, start=1):
            said = "".join(map(_span, line))
            mark = marks.get(piece.kind, f"{number}. ")
            yield mark + (said if mark else _AT_START.sub(r"\1\\\2", said))
        yield ""


def _line(source: str) -> str:
    return "".join(map(_span, spans(source)))


def _behind(caption: str) -> str:
    return f" {_line(caption)}" if caption else ""


def _span(span: Span) -> str:
    match span.kind:
        case "code":
            # a bar ends the cell of a table even within code
            return code(span.text.replace("|", "\N{BROKEN BAR}"))
        case "strong":
            return f"**{_escaped(span.text)}**"
        case "em":
            return f"*{_escaped(span.text)}*"
        case "link":
            return f"[{_escaped(span.text)}]({quote(span.target, safe='/:#?&=%.,+~-_')})"
        case _:
            return _escaped(span.text)


def _plain(text: str) -> str:
    return _AT_START.sub(r"\1\\\2", _escaped(text))


def _escaped(text: str) -> str:
    line = re.sub(r"\s*[\r\n\v\f\x1c-\x1e\x85\u2028\u2029]+\s*", " ", text)
    line = line.replace("&", "&amp;").replace("<", "&lt;").replace(">", "&gt;")
    line = _SPECIAL.sub(r"\\\1", line)
    # an address in a text is text, no link
    return _ADDRESS.sub(lambda match: f"{match[0]}<!-- -->", line)


def _table(table: Table) -> Iterator[str]:
    yield from (f"*{_plain(table.title)}*{_behind(table.caption)}", "")
    yield "| " + " | ".join(map(_plain, table.grid.head)) + " |"
    yield "| " + " | ".join("---:" if one else "---" for one in table.grid.numeric) + " |"
    for row in table.grid.rows:
        yield "| " + " | ".join(_plain(cell.text) for cell in row) + " |"


def _equation(block: Equation) -> Iterator[str]:
    source = f" ({_plain(block.source)})" if block.source else ""
    if block.lead or source:
        yield from (f"{_line(block.lead)}{source}:".strip(), "")
    # what could end the display is shown as code
    if "$" in block.latex or "\n" in block.latex or "```" in block.latex:
        yield from _fenced(block.latex)
    else:
        yield from ("```math", block.latex, "```")


def _fenced(text: str) -> list[str]:
    longest = max((len(run) for run in re.findall(r"`+", text)), default=0)
    fence = "`" * max(3, longest + 1)
    return [fence, text, fence]
