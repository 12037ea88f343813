"""The little markup of a page's texts: paragraphs, lists, code, stress and links.

Paragraphs are separated by empty lines; lines that begin with ``- `` or ``1. `` are a list. Within
a line ```code```, ``**strong**``, ``*stressed*`` and ``[text](target)`` are known, and a backslash
makes the character behind it an ordinary one. Everything else is text, and stays it: nothing can
become an element or a script of a page.
"""

from __future__ import annotations

import re
from dataclasses import dataclass
from typing import Literal, TypeAlias

from uqfold.checks import text as checked_text

Kind: TypeAlias = Literal["text", "code", "strong", "em", "link"]

_SPECIAL = re.compile(r"([\\`*\[\]])")
_SPANS = re.compile(
    r"(?P<escape>\\[^\w\s])"
    r"|(?P<ticks>`+)(?P<code>.+?)(?P=ticks)(?!`)"
    r"|\*\*(?P<strong>[^*\s](?:[^*]*[^*\s])?)\*\*"
    r"|\*(?P<em>[^*\s](?:[^*]*[^*\s])?)\*"
    r"|\[(?P<link>[^\[\]]+)\]\((?P<target>[^()\s]+)\)"
)
_ITEM = re.compile(r"(?:- |(?P<number>\d+)\. )\s*")
_SCHEME = re.compile(r"[a-zA-Z][a-zA-Z0-9+.\-]*:")


@dataclass(frozen=True)
class Span:
    """A piece of a line."""

    kind: Kind
    text: str
    target: str = ""


@dataclass(frozen=True)
class Piece:
    """A paragraph (``p``) of one line, or a list (``ul``, ``ol``) of several."""

    kind: Literal["p", "ul", "ol"]
    lines: tuple[tuple[Span, ...], ...]


def literal(text: str) -> str:
    r"""Return a text so that all of it stays text, whatever it holds.

    Examples
    --------
    >>> print(literal("2 * x [mm]"))
    2 \* x \[mm\]
    """
    given = checked_text("text", text, empty=True)
    return _SPECIAL.sub(r"\\\1", re.sub(r"\s+", " ", given))


def code(text: str) -> str:
    """Return a text as code, whatever it holds."""
    line = re.sub(r"\s+", " ", text)
    ticks = "`" * (max((len(run) for run in re.findall(r"`+", line)), default=0) + 1)
    space = " " if line.startswith("`") or line.endswith("`") else ""
    return f"{ticks}{space}{line}{space}{ticks}" if line.strip() else ""


def pieces(text: str) -> list[Piece]:
    """Take a text apart into paragraphs and lists."""
    found: list[Piece] = []
    for part in re.split(r"\n[ \t]*(?:\n[ \t]*)+", text.strip("\n")):
        runs: list[tuple[Literal["p", "ul", "ol"], list[str]]] = []
        for line in filter(None, map(str.strip, part.splitlines())):
            item = _ITEM.match(line)
            if item is None and runs:
                runs[-1][1][-1] += f" {line}"
                continue
            kind: Literal["p", "ul", "ol"] = "p"
            if item is not None:
                kind = "ol" if item["number"] else "ul"
            if not runs or runs[-1][0] != kind:
                runs.append((kind, []))
            runs[-1][1].append(line[item.end() if item else 0 :])
        found += [Piece(kind, tuple(map(spans, lines))) for kind, lines in runs]
    return found


def spans(line: str) -> tuple[Span, ...]:
    """Take a line apart.

    Examples
    --------
    >>> [(one.kind, one.text) for one in spans("from `pf` on")]
    [('text', 'from '), ('code', 'pf'), ('text', ' on')]
    """
    found: list[Span] = []

    def add(kind: Kind, text: str, target: str = "") -> None:
        if kind == "text" and found and found[-1].kind == "text":
            found[-1] = Span("text", found[-1].text + text)
        elif text:
            found.append(Span(kind, text, target))

    start = 0
    for match in _SPANS.finditer(line):
        add("text", line[start : match.start()])
        start = match.end()
        if match["escape"]:
            add("text", match["escape"][1:])
        elif match["ticks"]:
            inner = match["code"]
            padded = len(inner) > 2 and inner[0] == inner[-1] == " " and "`" in inner
            add("code", inner[1:-1] if padded else inner)
        elif match["link"] and not _safe(match["target"]):
            add("text", match[0])
        elif match["link"]:
            add("link", _unescaped(match["link"]), match["target"])
        else:
            kind: Kind = "strong" if match["strong"] else "em"
            add(kind, _unescaped(match["strong"] or match["em"]))
    add("text", line[start:])
    return tuple(found)


def plain(text: str) -> str:
    """Return a text without what sets its words apart, in one line."""
    return " ".join(
        "".join(span.text for span in line) for piece in pieces(text) for line in piece.lines
    )


def _safe(target: str) -> bool:
    """Whether a link leads to a place in the page, a file beside it, or a page of the web."""
    return target.startswith(("https://", "http://")) or not (
        _SCHEME.match(target) or target.startswith(("//", "\\"))
    )


def _unescaped(text: str) -> str:
    return re.sub(r"\\([^\w\s])", r"\1", text)
