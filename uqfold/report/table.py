"""The comparison as a table on the terminal, or as plain text in a file or pipe.

Rows stand under their criterion. Columns are common to all criteria, and closer where the terminal
is narrow; no cell is ever wrapped. What a method has to say about a row that did not converge
stands below the table, not in a cell.
"""

from __future__ import annotations

import math
import textwrap
from collections.abc import Collection, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any

from uqfold.comparison.frames import checked_frame
from uqfold.plots.style import HEADER
from uqfold.plots.wording import (
    CriterionKey,
    Row,
    comparison_rows,
    criterion_key,
    criterion_text,
    probability,
    reference_resolution,
    scientific,
)
from uqfold.report.answers import (
    ERROR,
    NOT_JUDGED,
    UNCHECKED,
    answers_table,
    methods_table,
    remarks,
)
from uqfold.report.page.cells import Cell

if TYPE_CHECKING:
    import pandas as pd
    from rich.console import Console, ConsoleOptions, RenderableType
    from rich.text import Text

_STYLES = {"good": "green", "warn": "yellow", "bad": "bold red", "quiet": "bright_black"}
"""Tone -> style on a terminal."""
_WORDS = ("method", "whole run", "interval", "status", "title")
"""Columns that begin at the left."""
_OF_ANSWERS = ("method", "pf", "interval", "error", "evaluations", "status")
_OF_METHODS = (
    "whole run", "answered", "median error", "largest", "evaluations", "time", "title",
)  # fmt: skip
_LEFT_OUT = {_OF_ANSWERS: ("evaluations", "interval"), _OF_METHODS: ("title", "largest")}
"""What is left out where there is no room, one after the other."""


@dataclass(frozen=True)
class ComparisonTable:
    """A comparison, ready for ``rich.console.Console.print``.

    Attributes
    ----------
    frame
        What `uqfold.compare` returned, or a part of it.
    """

    frame: pd.DataFrame

    def __post_init__(self) -> None:
        object.__setattr__(self, "frame", checked_frame(self.frame))

    def __rich_console__(
        self, console: Console, options: ConsoleOptions
    ) -> Iterator[RenderableType]:
        """Render the table in the width of the console."""
        from rich.text import Text

        header, rows = self.frame.attrs[HEADER], comparison_rows(self.frame)
        groups: dict[CriterionKey, list[int]] = {}
        for i, row in enumerate(rows):
            groups.setdefault(criterion_key(row), []).append(i)
        answers = answers_table(self.frame)
        if "remark" in answers.columns:
            told = zip(answers["status"], answers["remark"], strict=True)
            answers["status"] = [replace(one, text=f"{one.text} {n}".rstrip()) for one, n in told]
        head, *lines = _fitting(answers, _OF_ANSWERS, console, options)
        yield Text(_title(header), "bold", overflow="fold")
        yield ""
        yield head
        for key, members in groups.items():
            yield ""
            yield from _group_head(key, rows[members[0]], header, options.max_width)
            yield from (lines[i] for i in members)
        titles = {entry["label"]: entry["title"] for entry in header["methods"]}
        methods = methods_table(self.frame).rename(columns={"method": "whole run"})
        methods["title"] = methods["whole run"].map(titles)
        yield ""
        yield from _fitting(methods, _OF_METHODS, console, options)
        yield ""
        left_out = [name for name in _LEFT_OUT[_OF_ANSWERS] if name not in head.plain]
        for word, meaning in _legend(header, rows, left_out).items():
            yield from _noted(f"  {word:<11}", meaning, options.max_width, "dim")
        for i, ((label, said), number) in enumerate(remarks(rows).items()):
            if not i:
                yield ""
            words = said if said.startswith(label) else f"{label}: {said}"
            yield from _noted(f"{f'[{number}]':>6} ", words, options.max_width)


def _fitting(
    frame: pd.DataFrame, names: tuple[str, ...], console: Console, options: ConsoleOptions
) -> list[Text]:
    """Return the lines of a frame of cells, its heading first, as wide as there is room."""
    from rich.text import Text

    columns = [name for name in names if name in frame.columns]
    for gap, n_left_out in ((3, 0), (2, 0), (1, 0), (1, 1), (1, 2)):
        without = _LEFT_OUT[names][:n_left_out]
        table = _table(frame, [name for name in columns if name not in without], gap)
        width = console.measure(table, options=options.update(width=10_000)).maximum
        if width <= options.max_width:
            break
    lines = []
    for segments in console.render_lines(table, options.update(width=width), pad=False):
        line = Text.assemble(*((one.text, one.style or "") for one in segments), overflow="fold")
        line.rstrip()
        lines.append(line)
    return lines


def _table(frame: pd.DataFrame, names: Sequence[str], gap: int) -> Any:
    from rich.table import Table
    from rich.text import Text

    table = Table(box=None, pad_edge=False, padding=(0, gap, 0, 0), header_style="dim")
    for i, name in enumerate(names):
        justify: Any = "left" if name in _WORDS else "right"
        head = f"  {name}" if i == 0 else name.replace("title", "")
        table.add_column(head, justify=justify, no_wrap=True)
    for row in frame[list(names)].itertuples(index=False):
        first, *others = (
            Text(one.text, "bold" if name == "pf" else _STYLES.get(one.tone, ""))
            if isinstance(one, Cell)
            else Text(str(one))
            for name, one in zip(names, row, strict=True)
        )
        table.add_row(Text("  ").append_text(first), *others)
    return table


def _noted(prefix: str, text: str, width: int, style: str = "") -> Iterator[Text]:
    """Return a text behind a prefix, wrapped with further lines flush with the first."""
    from rich.text import Text

    lines = textwrap.wrap(text, max(width - len(prefix), 20), break_on_hyphens=False) or [""]
    for i, line in enumerate(lines):
        before = " " * len(prefix) if i else prefix
        yield Text(f"{before}{line}".rstrip(), style, overflow="fold")


def _title(header: Mapping[str, Any]) -> str:
    unit = f" ({header['response_unit']})" if header["response_unit"] else ""
    budget = "no budget"
    if header["max_evals"] is not None:
        budget = f"at most {header['max_evals']:,} evaluations per method"
    asked = f"{header['problem']}: {header['response']}{unit}"
    return f"{asked}, seed {header['seed']}, {budget}"


def _group_head(
    key: CriterionKey, row: Row, header: Mapping[str, Any], width: int
) -> Iterator[Text]:
    from rich.text import Text

    criterion = criterion_text(key, header["response_unit"])
    reference = "no reference"
    if not math.isnan(row["reference_pf"]):
        pf, error = row["reference_pf"], row["reference_std_error"]
        reference = f"reference pf {probability(pf, 4)} ± {scientific(error, 2)}"
    fits = len(criterion) + 3 + len(reference) <= width
    head = Text(criterion, "bold", overflow="fold")
    behind = Text(f"{'   ' if fits else '  '}{reference}", "not bold cyan", overflow="fold")
    yield from (head.append_text(behind),) if fits else (head, behind)


def _legend(
    header: Mapping[str, Any], rows: Sequence[Row], left_out: Collection[str]
) -> dict[str, str]:
    """Return word -> meaning, of the words that occur."""
    said = {}
    if left_out:
        said["left out"] = f"{' and '.join(left_out)}, which a wider terminal shows"
    intervals = dict.fromkeys(row["ci_kind"] for row in rows if row["ci_kind"])
    if intervals and "interval" not in left_out:
        said["interval"] = ", ".join(intervals)
    if any(row["status"] == "unchecked" for row in rows):
        said["unchecked"] = UNCHECKED
    if any(not math.isnan(row["error"]) for row in rows):
        said["error"] = ERROR
    if any(row["error"] <= reference_resolution(row) for row in rows):
        said["~"] = NOT_JUDGED
    if header["reference"] is not None and header["reference"]["how"]:
        said["reference"] = header["reference"]["how"]
    return said
