"""The builder of pages: a report told step by step, written as Markdown or as one HTML file."""

from __future__ import annotations

import os
import re
from collections.abc import Iterator, Mapping, Sequence
from contextlib import AbstractContextManager, contextmanager
from itertools import count
from pathlib import Path
from typing import TYPE_CHECKING, Any, get_args

from uqfold.checks import choice, flag, instance, mapping, refused, several, text, whole
from uqfold.checks import path as checked_path
from uqfold.report.page.cells import Tone, cell_of, is_numeric
from uqfold.report.page.markup import without_elements
from uqfold.report.page.rendering import html, markdown

if TYPE_CHECKING:
    import pandas as pd

    from uqfold.plots.types import Axes, Figure


class Page:
    """A report, told from top to bottom: what comes before the first section is its summary.

    Texts are Markdown, in which elements of HTML are text. Cells of tables, titles and code are
    plain text. Text from elsewhere goes through `uqfold.report.literal` first.

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

    Attributes
    ----------
    blocks
        What it shows, from top to bottom: dicts of ``kind``, and what the templates need of it.
    pictures
        Its figures, by name.

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
        self.lead = _markdown("lead", lead)
        self.kind = text("kind", kind, empty=True)
        self.imprint = _markdown("imprint", imprint)
        self.blocks: list[dict[str, Any]] = []
        self.pictures: dict[str, Figure] = {}
        self._names = {"main", "summary"}
        self._folding = False

    def section(
        self, title: str, *, level: int = 1, label: str = "", tone: Tone = "", name: str = ""
    ) -> None:
        """Begin a section, or at a higher level one within it; `label` stands behind its title."""
        if self._folding:
            raise ValueError(f"section {title!r} cannot begin within details")
        self._add(
            "heading",
            name=self._unique(text("title", title), name),
            title=title,
            level=whole("level", level, at_least=1, at_most=5),
            label=text("label", label, empty=True),
            tone=choice("tone", tone, get_args(Tone)),
        )

    def text(self, source: str, *, small: bool = False) -> None:
        """Add paragraphs and lists; `small` for remarks and legends."""
        self._add("text", source=_markdown("source", source), small=flag("small", small))

    def card(self, title: str, answer: str, *more: str, tone: Tone = "") -> None:
        """Add a statement to a row of them: a question, its short answer, and what else to say."""
        card = {
            "title": text("title", title),
            "answer": _markdown("answer", answer, empty=False),
            "more": [without_elements(one) for one in several("more", more, text)],
            "tone": choice("tone", tone, get_args(Tone)),
        }
        if not self.blocks or self.blocks[-1]["kind"] != "cards":
            self._add("cards", cards=[])
        self.blocks[-1]["cards"].append(card)

    def facts(self, facts: Mapping[str, str]) -> None:
        """Add names and what they stand for, in two columns."""
        checked = mapping("facts", facts, text, empty=True)
        self._add("facts", facts={name: without_elements(one) for name, one in checked.items()})

    def table(
        self,
        frame: pd.DataFrame,
        title: str,
        caption: str = "",
        *,
        name: str = "",
        belongs: Sequence[str] = (),
    ) -> None:
        """Add a table.

        Parameters
        ----------
        frame
            Its columns with units in their headings; a named index comes first. Numbers are
            written with four digits, NaN and None as nothing.
        title, caption
            What it shows; `caption` adds what is to be known, in Markdown.
        name
            Its anchor in links; made from the title if empty.
        belongs
            For each row what it belongs to, as `uqfold.plots` names the artists of figures: rows
            are switched on and off together with these.

        Raises
        ------
        TypeError, ValueError
            If `frame` is not a frame, or `belongs` has not one name per row.
        """
        import pandas as pd

        instance("frame", frame, pd.DataFrame, "give a pandas DataFrame")
        owners = several("belongs", belongs, text, empty=True)
        if owners and len(owners) != len(frame):
            raise refused("belongs", belongs, f"give one name for each of {len(frame)} rows")
        if any(one is not None for one in frame.index.names):
            frame = frame.reset_index()
        rows = [[cell_of(value) for value in row] for row in frame.itertuples(index=False)]
        heads = [one if isinstance(one, tuple) else (one,) for one in frame.columns]
        self._add(
            "table",
            name=self._unique(text("title", title), name),
            title=title,
            caption=_markdown("caption", caption),
            heads=[" ".join(map(str, one)) for one in heads],
            numeric=[is_numeric([row[i] for row in rows]) for i in range(len(heads))],
            rows=rows,
            belongs=owners,
        )

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

        drawn = figure_of(figure)
        name = self._unique(text("title", title), name)
        self.pictures[name] = drawn
        said = _markdown("caption", caption)
        self._add("figure", name=name, title=title, caption=said, figure=drawn)

    def equation(self, latex: str, lead: str = "", source: str = "") -> None:
        """Add a displayed equation in LaTeX, what leads to it, and where it comes from."""
        self._add(
            "equation",
            latex=text("latex", latex),
            lead=_markdown("lead", lead),
            source=text("source", source, empty=True),
        )

    def code(self, source: str) -> None:
        """Add code or commands on lines of their own."""
        self._add("listing", text=text("source", source, empty=True))

    def details(self, title: str) -> AbstractContextManager[None]:
        """Fold away what is added within the ``with``; open in print and in Markdown."""
        return self._folded(text("title", title))

    @contextmanager
    def _folded(self, title: str) -> Iterator[None]:
        outer, self.blocks = self.blocks, []
        was_folding, self._folding = self._folding, True
        try:
            yield
        finally:
            inner, self.blocks, self._folding = self.blocks, outer, was_folding
        self._add("details", title=title, blocks=inner)

    def write(self, path: str | os.PathLike[str]) -> list[Path]:
        """Write the page: Markdown with its pictures beside it, or one HTML file.

        Each file appears whole or not at all.

        Parameters
        ----------
        path
            Where to, a file that ends in ``.html`` or ``.md``; its folder is made if it is missing.

        Returns
        -------
        list[pathlib.Path]
            The page, and behind it the pictures that Markdown needs: ``figures/<name>.png``.
        """
        from uqfold.plots.saving import save
        from uqfold.writing import write_text

        file = page_path("path", path)
        file.parent.mkdir(parents=True, exist_ok=True)
        if file.suffix.lower() == ".html":
            write_text(file, self.html())
            return [file]
        write_text(file, self.markdown())
        written = [file]
        for name, figure in self.pictures.items():
            written += save(figure, file.parent / "figures" / name)
        return written

    def markdown(self) -> str:
        """Return the page as Markdown, which refers to its pictures as ``figures/<name>.png``."""
        return markdown(self.blocks, vars(self))

    def html(self) -> str:
        """Return the page as one HTML document that needs nothing else."""
        return html(self.blocks, vars(self))

    def _add(self, kind: str, **data: Any) -> None:
        self.blocks.append({"kind": kind, **data})

    def _unique(self, title: str, name: str) -> str:
        """Return an anchor of the page that no other part has."""
        asked = text("name", name, empty=True) or title
        stem = re.sub(r"[^a-z0-9.]+", "-", asked.lower()).strip("-.") or "part"
        names = (stem if i == 1 else f"{stem}-{i}" for i in count(1))
        free = next(one for one in names if one not in self._names)
        self._names.add(free)
        return free


def page_path(name: str, path: str | os.PathLike[str]) -> Path:
    """Return the path of a page, whose suffix says what it is."""
    file = checked_path(name, path)
    choice(f"suffix of {name}", file.suffix.lower(), (".html", ".md"))
    return file


def _markdown(name: str, given: str, *, empty: bool = True) -> str:
    return without_elements(text(name, given, empty=empty)).strip()
