"""What a page is made of.

Every text is plain text, and stays it: the writers escape it. Where a part of a sentence is
code, stands out or leads elsewhere in the page, the sentence is a sequence of parts.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import ClassVar, Literal, TypeAlias

from uqfold.report.page.chart import Chart, Key, Strip

Tone: TypeAlias = Literal["", "good", "warn", "bad", "quiet"]
"""How a word is coloured; never the only bearer of its meaning."""


@dataclass(frozen=True)
class Code:
    """A name, command or other code in a sentence."""

    text: str


@dataclass(frozen=True)
class Strong:
    """Words that stand out in a sentence, with a tone."""

    text: str
    tone: Tone = ""


@dataclass(frozen=True)
class Link:
    """Words that lead to another place in the page, named by its anchor."""

    text: str
    anchor: str


@dataclass(frozen=True)
class Number:
    """A number as text; a power of ten in it is typeset as one."""

    text: str


Part: TypeAlias = str | Code | Strong | Link | Number
Words: TypeAlias = str | Sequence[Part]


@dataclass(frozen=True)
class Paragraph:
    """One paragraph; `small` for remarks and legends."""

    kind: ClassVar[str] = "paragraph"

    words: Words
    small: bool = False


@dataclass(frozen=True)
class Items:
    """A list of sentences, numbered or not."""

    kind: ClassVar[str] = "items"

    items: tuple[Words, ...]
    numbered: bool = False


@dataclass(frozen=True)
class Card:
    """One statement of a summary: a question, its short answer, and what else to say."""

    title: str
    answer: Words
    more: tuple[Words, ...] = ()
    tone: Tone = ""


@dataclass(frozen=True)
class Cards:
    """The statements of a summary, side by side where there is room."""

    kind: ClassVar[str] = "cards"

    cards: tuple[Card, ...]


@dataclass(frozen=True)
class Column:
    """A column of a table.

    Attributes
    ----------
    head
        Its heading.
    numeric
        Whether it is set flush right and sorted as numbers.
    choices
        Whether readers may select rows by its values.
    """

    head: str
    numeric: bool = False
    choices: bool = False


@dataclass(frozen=True)
class Cell:
    """A cell of a table.

    Attributes
    ----------
    words
        What it shows.
    value
        The number to sort by, where it is one; NaN sorts last.
    tone
        Its colour.
    key
        Whose colour and marker stand before it.
    strip
        A small picture of numbers instead of words; the words are its text alternative.
    """

    words: Words
    value: float | None = None
    tone: Tone = ""
    key: Key | None = None
    strip: Strip | None = None


@dataclass(frozen=True)
class Row:
    """A row of a table; it is hidden together with any of its keys."""

    cells: tuple[Cell, ...]
    keys: tuple[str, ...] = ()


@dataclass(frozen=True)
class Table:
    """A table whose first column names the rows.

    Attributes
    ----------
    caption
        What it shows.
    columns, rows
        Each row has one cell per column.
    tools
        Whether readers may sort and filter it.
    show_caption
        Whether the caption is seen, or only read out.
    """

    kind: ClassVar[str] = "table"

    caption: str
    columns: tuple[Column, ...]
    rows: tuple[Row, ...]
    tools: bool = True
    show_caption: bool = True

    def __post_init__(self) -> None:
        for row in self.rows:
            if len(row.cells) != len(self.columns):
                raise ValueError(
                    f"table {self.caption!r}: {len(row.cells)} cells for "
                    f"{len(self.columns)} columns"
                )


@dataclass(frozen=True)
class Facts:
    """Names and what they stand for, in two columns."""

    kind: ClassVar[str] = "facts"

    facts: tuple[tuple[str, Words], ...]


@dataclass(frozen=True)
class View:
    """One of several ways to draw the same numbers: its name, and its panels."""

    name: str
    charts: tuple[Chart, ...]


@dataclass(frozen=True)
class Figure:
    """Charts with a common caption and legend.

    Attributes
    ----------
    caption
        What is to be seen, in one or two sentences.
    views
        Readers with JavaScript switch between them; others see all.
    legend
        What may be switched off.
    notes
        Legend of what belongs to no key: bands, lines, arrows; sign and meaning.
    values_at
        Anchor of the table that holds the numbers; without one the figure brings its own.
    """

    kind: ClassVar[str] = "figure"

    caption: str
    views: tuple[View, ...]
    legend: tuple[Key, ...] = ()
    notes: tuple[tuple[str, str], ...] = ()
    values_at: str = ""


@dataclass(frozen=True)
class Controls:
    """Switches for what the whole page shows; without JavaScript a legend.

    Attributes
    ----------
    groups
        Title and keys of each group.
    """

    kind: ClassVar[str] = "controls"

    groups: tuple[tuple[str, tuple[Key, ...]], ...]


@dataclass(frozen=True)
class Formula:
    """A displayed equation: lead-in, LaTeX, and where it comes from."""

    kind: ClassVar[str] = "formula"

    lead: str
    latex: str
    source: str = ""


@dataclass(frozen=True)
class Listing:
    """Code or commands on lines of their own."""

    kind: ClassVar[str] = "listing"

    text: str


@dataclass(frozen=True)
class Details:
    """Blocks that readers may unfold; always open in print and in Markdown."""

    kind: ClassVar[str] = "details"

    title: str
    blocks: tuple[Block, ...]


@dataclass(frozen=True)
class Section:
    """A heading with what belongs below it.

    Attributes
    ----------
    anchor
        Its name in links.
    title
        The heading.
    blocks
        What stands below it, further sections included.
    label, tone
        A word behind the heading, such as a verdict.
    """

    kind: ClassVar[str] = "section"

    anchor: str
    title: str
    blocks: tuple[Block, ...]
    label: str = ""
    tone: Tone = ""


Block: TypeAlias = (
    Paragraph
    | Items
    | Cards
    | Table
    | Facts
    | Figure
    | Controls
    | Formula
    | Listing
    | Details
    | Section
)


@dataclass(frozen=True)
class Page:
    """A whole report.

    Attributes
    ----------
    title
        Its title.
    kicker
        What sort of report it is, above the title.
    lead
        One paragraph below the title.
    summary
        What fits on the first screen, and says it all.
    sections
        The rest.
    imprint
        The last line: what made the report, and from what.
    """

    title: str
    kicker: str
    lead: Words
    summary: tuple[Block, ...]
    sections: tuple[Section, ...]
    imprint: Words = ""


def parts(words: Words) -> tuple[Part, ...]:
    """Give words as a sequence of parts."""
    return (words,) if isinstance(words, str) else tuple(words)


def plain(words: Words) -> str:
    """Give words without anything that sets them apart."""
    return "".join(part if isinstance(part, str) else part.text for part in parts(words))
