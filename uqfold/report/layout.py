"""Aligned columns of text for terminals: fixed widths, no boxes, nothing wrapped inside a cell."""

from __future__ import annotations

import textwrap
from collections.abc import Collection, Iterator, Sequence
from dataclasses import dataclass

from rich.text import Text


@dataclass(frozen=True)
class Cell:
    """Text of one cell and its style on a terminal."""

    text: str
    style: str = ""


@dataclass(frozen=True)
class Grid:
    """Columns as wide as their widest cell.

    Attributes
    ----------
    head
        Column headings.
    rows
        All rows that are to align.
    numeric
        Indices of the columns that are set flush right.
    gap
        Spaces between columns.
    """

    head: Sequence[str]
    rows: Sequence[Sequence[Cell]]
    numeric: Collection[int]
    gap: int

    @property
    def widths(self) -> list[int]:
        """Width of each column."""
        return [
            max(len(head), *(len(row[i].text) for row in self.rows))
            for i, head in enumerate(self.head)
        ]

    @property
    def width(self) -> int:
        """Width of a line."""
        return sum(self.widths) + self.gap * (len(self.head) - 1)

    def head_line(self) -> Text:
        """Give the headings as one line."""
        return self._joined([Cell(head, "dim") for head in self.head])

    def lines(self) -> Iterator[Text]:
        """Give every row as one line."""
        yield from map(self._joined, self.rows)

    def _joined(self, cells: Sequence[Cell]) -> Text:
        text = line("")
        for i, (cell, width) in enumerate(zip(cells, self.widths, strict=True)):
            padded = cell.text.rjust(width) if i in self.numeric else cell.text.ljust(width)
            text.append(" " * self.gap if i else "")
            text.append(padded, cell.style)
        text.rstrip()
        return text


def line(text: str, style: str = "") -> Text:
    """Give one line; only a console narrower than it folds it, and nothing is cut off."""
    return Text(text, style=style, overflow="fold")


def hanging(prefix: str, text: str, width: int, style: str = "") -> Iterator[Text]:
    """Wrap a text behind a prefix, further lines flush with the first."""
    wrapped = textwrap.wrap(
        text,
        max(width, len(prefix) + 20),
        initial_indent=prefix,
        subsequent_indent=" " * len(prefix),
        break_long_words=False,
        break_on_hyphens=False,
    )
    for one in wrapped or [prefix.rstrip()]:
        yield line(one, style)
