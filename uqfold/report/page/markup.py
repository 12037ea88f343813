"""The texts of a page are Markdown; text from elsewhere is escaped on its way into it."""

from __future__ import annotations

import re
from functools import cache
from typing import TYPE_CHECKING

from uqfold.checks import text as checked_text

if TYPE_CHECKING:
    from markdown_it import MarkdownIt

_SPECIAL = re.compile(r"([\\`*_\[\]~|$#])")
_AT_START = re.compile(r"^(\d*)([-+=.)])(?=[\s=-]|$)")
_CODE_OR_ELEMENT = re.compile(r"(?s)\\.|(`+).*?(?<!`)\1(?!`)|<(?=[a-zA-Z/!?])")
_BAR = r"\\|"
_OPEN_BAR = re.compile(r"(?<!\\)\|")
_ADDRESS = re.compile(r"(?i)\b(https?|ftp|www)([:.])")
_SCHEME = re.compile(r"[a-zA-Z][a-zA-Z0-9+.\-]*:")


def literal(text: str) -> str:
    r"""Return a text as one line of Markdown in which all of it stays text, whatever it holds.

    Examples
    --------
    >>> print(literal("2 * x [mm]"))
    2 \* x \[mm\]
    """
    return _AT_START.sub(r"\1\\\2", escaped(checked_text("text", text, empty=True)))


def escaped(text: str) -> str:
    """Return a text as `literal` does, to stand behind something else in its line."""
    line = _SPECIAL.sub(r"\\\1", re.sub(r"\s+", " ", text))
    line = line.replace("&", "&amp;").replace("<", "&lt;").replace(">", "&gt;")
    # an address in a text is text, no link
    return _ADDRESS.sub(r"\1\\\2", line)


def fenced(text: str, language: str = "") -> str:
    """Return a text as code on lines of its own, whatever it holds."""
    longest = max((len(run) for run in re.findall(r"`+", text)), default=0)
    fence = "`" * max(3, longest + 1)
    return f"{fence}{language}\n{text}\n{fence}"


def without_elements(markdown: str) -> str:
    """Return Markdown whose elements of HTML, but for those within code, are text."""
    return _CODE_OR_ELEMENT.sub(lambda match: "&lt;" if match[0] == "<" else match[0], markdown)


def unbarred(cell: str) -> str:
    """Return the text of a cell in a table of Markdown: a bar ends none, not even within code."""
    return _OPEN_BAR.sub(_BAR, cell)


def html(markdown: str) -> str:
    """Return Markdown as HTML; elements of HTML in it are text."""
    return str(_parser().render(markdown))


def inline_html(markdown: str) -> str:
    """Return one line of Markdown as HTML, without a paragraph around it."""
    return str(_parser().renderInline(markdown))


@cache
def _parser() -> MarkdownIt:
    from markdown_it import MarkdownIt

    parser = MarkdownIt("commonmark", {"html": False}).disable(["image", "autolink"])
    parser.validateLink = _leads_where_nothing_runs  # type: ignore[assignment, method-assign]
    return parser


def _leads_where_nothing_runs(target: str) -> bool:
    """Whether a link leads to a place in the page, a file beside it, or a page of the web."""
    return target.startswith(("https://", "http://")) or not (
        _SCHEME.match(target) or target.startswith(("//", "\\"))
    )
