"""The builder of pages: a report told step by step, written as Markdown or as one HTML file."""

from __future__ import annotations

import os
import re
from collections.abc import Iterator, Mapping, Sequence
from contextlib import AbstractContextManager, contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, ClassVar, Literal, TypeAlias, get_args

from uqfold.checks import choice, flag, function, instance, mapping, refused, several, text, whole
from uqfold.checks import path as checked_path
from uqfold.report.page.cells import Formatter, Grid, Tone, grid

if TYPE_CHECKING:
    import pandas as pd
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

Format: TypeAlias = Literal["html", "md"]


@dataclass(frozen=True)
class Text:
    """Paragraphs and lists, in the markup of `uqfold.report.page.markup`."""

    kind: ClassVar[str] = "text"
    source: str
    small: bool


@dataclass(frozen=True)
class Card:
    """One statement of a summary."""

    kind: ClassVar[str] = "card"
    title: str
    answer: str
    more: tuple[str, ...]
    tone: Tone


@dataclass(frozen=True)
class Facts:
    """Names and what they stand for."""

    kind: ClassVar[str] = "facts"
    facts: tuple[tuple[str, str], ...]


@dataclass(frozen=True)
class Table:
    """A table; `belongs` names what each row belongs to, as the artists of figures do."""

    kind: ClassVar[str] = "table"
    title: str
    caption: str
    name: str
    grid: Grid
    belongs: tuple[str, ...]


@dataclass(frozen=True)
class Picture:
    """A figure."""

    kind: ClassVar[str] = "picture"
    title: str
    caption: str
    name: str
    figure: Figure


@dataclass(frozen=True)
class Equation:
    """A displayed equation: lead-in, LaTeX, and where it comes from."""

    kind: ClassVar[str] = "equation"
    lead: str
    latex: str
    source: str


@dataclass(frozen=True)
class Listing:
    """Code or commands on lines of their own."""

    kind: ClassVar[str] = "listing"
    text: str


@dataclass(frozen=True)
class Heading:
    """A heading, with a word such as a verdict behind it."""

    kind: ClassVar[str] = "heading"
    title: str
    name: str
    level: int
    label: str
    tone: Tone


@dataclass(frozen=True)
class Details:
    """What readers may unfold; always open in print and in Markdown."""

    kind: ClassVar[str] = "details"
    title: str
    blocks: list[Block]


Block: TypeAlias = (
    Text | Card | Facts | Table | Picture | Equation | Listing | Heading | Details
)  # fmt: skip


class Page:
    """A report, told from top to bottom: what comes before the first section is its summary.

    Texts know a little markup: paragraphs, ``- `` lists, `` `code` ``, ``**strong**``,
    ``*stressed*`` and ``[links](target)``. Cells of tables, titles and code are plain text. Text
    from elsewhere goes through `uqfold.report.literal` first.

    Parameters
    ----------
    title
        Its title.
    lead
        One paragraph below the title.
    kind
        What sort of report it is, for instance ``Study``.
    imprint
        The last line: what made the report, and from what.

    Examples
    --------
    >>> import pandas as pd
    >>> page = Page("Two bars", "Which of them breaks?", kind="Study")
    >>> page.section("Answers")
    >>> page.text("Both, says `form`.")
    >>> page.table(pd.DataFrame({"bar": ["a", "b"], "pf": [1.2e-5, 0.25]}), "Answers of FORM")
    >>> print(page.markdown().partition("## ")[2])
    Answers
    <BLANKLINE>
    Both, says `form`.
    <BLANKLINE>
    *Answers of FORM*
    <BLANKLINE>
    | bar | pf |
    | --- | ---: |
    | a | 1.2 × 10⁻⁵ |
    | b | 0.25 |
    <BLANKLINE>
    """

    def __init__(self, title: str, lead: str = "", *, kind: str = "Report", imprint: str = ""):
        self.title = text("title", title)
        self.lead = text("lead", lead, empty=True)
        self.kind = text("kind", kind, empty=True)
        self.imprint = text("imprint", imprint, empty=True)
        self.blocks: list[Block] = []
        self._open = self.blocks
        self._names = {"main", "summary"}

    def section(
        self, title: str, *, level: int = 1, label: str = "", tone: Tone = "", name: str = ""
    ) -> None:
        """Begin a section, or at a higher level one within it; `label` stands behind its title."""
        if self._open is not self.blocks:
            raise ValueError(f"section {title!r} cannot begin within details")
        self._add(
            Heading(
                text("title", title),
                self._unique(title, name),
                whole("level", level, at_least=1, at_most=5),
                text("label", label, empty=True),
                choice("tone", tone, get_args(Tone)),
            )
        )

    def text(self, source: str, *, small: bool = False) -> None:
        """Add paragraphs and lists; `small` for remarks and legends."""
        self._add(Text(text("source", source, empty=True), flag("small", small)))

    def card(self, title: str, answer: str, *more: str, tone: Tone = "") -> None:
        """Add a statement to a row of them: a question, its short answer, and what else to say."""
        said = several("more", more, text)
        tone = choice("tone", tone, get_args(Tone))
        self._add(Card(text("title", title), text("answer", answer), said, tone))

    def facts(self, facts: Mapping[str, str]) -> None:
        """Add names and what they stand for, in two columns."""
        self._add(Facts(tuple(mapping("facts", facts, text, empty=True).items())))

    def table(
        self,
        frame: pd.DataFrame,
        title: str,
        caption: str = "",
        *,
        name: str = "",
        formats: Mapping[str, Formatter] = {},
        tones: Mapping[str, Tone] = {},
        belongs: Sequence[str] = (),
    ) -> None:
        """Add a table.

        Parameters
        ----------
        frame
            Its columns with units in their headings; a named index comes first. Numbers are
            written with four digits, NaN and None as nothing.
        title, caption
            What it shows; `caption` adds what is to be known, in the markup of texts.
        name
            Its anchor in links; made from the title if empty.
        formats
            Column -> function that writes its values.
        tones
            Text of a cell -> ``good``, ``warn``, ``bad`` or ``quiet``.
        belongs
            For each row what it belongs to, as `uqfold.plots` names the artists of figures: rows
            are switched on and off together with these.

        Raises
        ------
        TypeError, ValueError
            If `frame` is no frame, or `belongs` has not one name per row.
        """
        import pandas as pd

        instance("frame", frame, pd.DataFrame, "give a pandas DataFrame")
        owners = several("belongs", belongs, text, empty=True)
        if owners and len(owners) != len(frame):
            raise refused("belongs", belongs, f"give one name for each of {len(frame)} rows")
        cells = grid(
            frame,
            mapping("formats", formats, function),
            mapping("tones", tones, choice, get_args(Tone)),
        )
        said = text("caption", caption, empty=True)
        self._add(Table(text("title", title), said, self._unique(title, name), cells, owners))

    def figure(
        self, figure: Figure | Axes, title: str, caption: str = "", *, name: str = ""
    ) -> None:
        """Add a figure of matplotlib.

        Parameters
        ----------
        figure
            The figure, or any of its axes.
        title, caption
            What is to be seen; both are read out where the figure cannot be seen.
        name
            Its anchor, and the name of its file beside Markdown; made from the title if empty.
        """
        from uqfold.plots.saving import figure_of

        said = text("caption", caption, empty=True)
        self._add(Picture(text("title", title), said, self._unique(title, name), figure_of(figure)))

    def equation(self, latex: str, lead: str = "", source: str = "") -> None:
        """Add a displayed equation in LaTeX, what leads to it, and where it comes from."""
        lead, source = (
            text(name, value, empty=True) for name, value in (("lead", lead), ("source", source))
        )
        self._add(Equation(lead, text("latex", latex), source))

    def code(self, source: str) -> None:
        """Add code or commands on lines of their own."""
        self._add(Listing(text("source", source, empty=True)))

    def details(self, title: str) -> AbstractContextManager[None]:
        """Fold away what is added within the ``with``; open in print and in Markdown."""
        return self._folded(Details(text("title", title), []))

    @contextmanager
    def _folded(self, inner: Details) -> Iterator[None]:
        outer = self._open
        self._add(inner)
        self._open = inner.blocks
        try:
            yield
        finally:
            self._open = outer

    def write(self, path: str | os.PathLike[str], *, format: str | None = None) -> list[Path]:
        """Write the page: Markdown with its pictures beside it, or one HTML file.

        Each file appears whole or not at all.

        Parameters
        ----------
        path
            Where to; its folder is made if it is missing.
        format
            ``html`` or ``md``; None: as the suffix of the path says.

        Returns
        -------
        list[pathlib.Path]
            The page, and behind it the pictures that Markdown needs: ``figures/<name>.png``.
        """
        from uqfold.plots.saving import save
        from uqfold.writing import write_text

        file = checked_path("path", path)
        asked = page_format(file, format)
        file.parent.mkdir(parents=True, exist_ok=True)
        write_text(file, self.html() if asked == "html" else self.markdown())
        written = [file]
        if asked == "md":
            for picture in self.pictures():
                written += save(picture.figure, file.parent / "figures" / picture.name)
        return written

    def markdown(self) -> str:
        """Return the page as Markdown, which refers to its pictures as ``figures/<name>.png``."""
        from uqfold.report.page.to_markdown import markdown

        return markdown(self)

    def html(self) -> str:
        """Return the page as one HTML document that needs nothing else."""
        from uqfold.report.page.to_html import html

        return html(self)

    def pictures(self) -> list[Picture]:
        """Return the figures of the page with their names."""
        return [block for block in _all(self.blocks) if isinstance(block, Picture)]

    def _add(self, block: Block) -> None:
        self._open.append(block)

    def _unique(self, title: str, name: str) -> str:
        asked = text("name", name, empty=True) or text("title", title)
        stem = re.sub(r"[^a-z0-9.]+", "-", asked.lower()).strip("-.") or "part"
        name, number = stem, 1
        while name in self._names:
            number += 1
            name = f"{stem}-{number}"
        self._names.add(name)
        return name


def page_format(path: Path, format: str | None = None) -> Format:
    """Return the format of a page: the one asked for, or that of the file's suffix."""
    asked = path.suffix.lower().lstrip(".") if format is None else format
    name = "suffix of path" if format is None else "format"
    return choice(name, asked, get_args(Format))


def _all(blocks: Sequence[Block]) -> Iterator[Block]:
    for block in blocks:
        yield block
        if isinstance(block, Details):
            yield from _all(block.blocks)
