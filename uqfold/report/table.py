"""The comparison as a table on the terminal, or as plain text in a file or pipe.

Rows stand under their criterion. Column widths are common to all criteria, and the layout becomes
tighter where the terminal is narrow; no cell is ever wrapped. What a method has to say about a row
that did not converge stands below the table, not in a cell.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from statistics import median
from typing import TYPE_CHECKING

from uqfold.checks import instance, keep
from uqfold.comparison.columns import Row
from uqfold.comparison.records import Records
from uqfold.report.style import STATUS_STYLES
from uqfold.report.wording import (
    NO_VALUE,
    UNCHECKED,
    count_text,
    criterion_key,
    criterion_text,
    finite,
    percent,
    reference_resolution,
    remark,
    remarks,
    scientific,
    seconds_text,
)

if TYPE_CHECKING:
    from rich.console import Console, ConsoleOptions
    from rich.text import Text

    from uqfold.report.layout import Cell, Grid

_SHORT_STATUS = {"budget_exhausted": "budget"}
_NUMERIC = (1, 3, 4, 5)
_LAYOUTS = ((True, 3), (True, 2), (False, 2), (False, 1))
"""(full numbers and words, gap between columns), from the most generous on."""


@dataclass(frozen=True)
class ComparisonTable:
    """A comparison, ready for ``rich.console.Console.print``.

    Attributes
    ----------
    records
        The comparison.
    """

    records: Records

    def __post_init__(self) -> None:
        keep(self, "records", instance, Records, "give Records")

    def __rich_console__(self, console: Console, options: ConsoleOptions) -> Iterator[Text]:
        """Render the table in the width of the console."""
        from uqfold.report.layout import line

        width = options.max_width
        notes = remarks(self.records.rows)
        yield line(_title(self.records), "bold")
        yield line("")
        yield from _criteria_lines(self.records, notes, width)
        yield line("")
        yield from _summary_lines(self.records, width)
        yield line("")
        yield from _legend_lines(self.records, notes, width)


def _title(records: Records) -> str:
    header = records.header
    unit = f" ({header.response_unit})" if header.response_unit else ""
    budget = "no budget"
    if header.max_evals is not None:
        budget = f"at most {header.max_evals:,} evaluations per method"
    return f"{header.problem}: {header.response}{unit}, seed {header.seed}, {budget}"


def _criteria_lines(
    records: Records, notes: Mapping[tuple[str, str], int], width: int
) -> Iterator[Text]:
    """Give the rows, one group per criterion."""
    from uqfold.report.layout import line

    groups: dict[object, list[Row]] = {}
    for row in records.rows:
        groups.setdefault(criterion_key(row), []).append(row)
    ordered = [row for group in groups.values() for row in group]
    grid = _fitting(ordered, notes, width)
    lines = grid.lines()
    yield grid.head_line()
    for group in groups.values():
        yield line("")
        yield from _group_head(group[0], records.header.response_unit, width)
        for _ in group:
            yield next(lines)


def _fitting(rows: Sequence[Row], notes: Mapping[tuple[str, str], int], width: int) -> Grid:
    """Give the most generous grid that fits, or the tightest."""
    from uqfold.report.layout import Grid

    grids = []
    for full, gap in _LAYOUTS:
        interval, evals = (
            ("interval or error kind", "evaluations") if full else ("interval", "evals")
        )
        head = ["  method", "pf", interval, "error", evals, "time", "status"]
        grids.append(Grid(head, [_cells(row, notes, full) for row in rows], _NUMERIC, gap))
    return next((grid for grid in grids if grid.width <= width), grids[-1])


def _group_head(row: Row, unit: str, width: int) -> Iterator[Text]:
    from uqfold.report.layout import line

    criterion = criterion_text(criterion_key(row), unit)
    reference = "no reference"
    if not math.isnan(row["reference_pf"]):
        error = scientific(row["reference_std_error"], 2)
        reference = f"reference pf {scientific(row['reference_pf'], 4)} ± {error}"
    text = line(criterion, "bold")
    if len(criterion) + 3 + len(reference) > width:
        yield text
        yield line(f"  {reference}", "cyan")
    else:
        text.append(f"   {reference}", "not bold cyan")
        yield text


def _cells(row: Row, notes: Mapping[tuple[str, str], int], full: bool) -> list[Cell]:
    from uqfold.report.layout import Cell

    status = str(row["status"])
    shown = status if full else _SHORT_STATUS.get(status, status)
    number = notes.get((row["label"], remark(row)))
    within = row["error"] <= reference_resolution(row)
    return [
        Cell(f"  {row['label']}"),
        Cell(scientific(row["pf"], 4 if full else 3), "bold"),
        Cell(_interval(row, full)),
        Cell(f"{'~' if within else ''}{percent(row['error'])}"),
        # what a method refuses costs nothing
        Cell(
            NO_VALUE if status == "unsupported" else count_text(row["n_evals_row"], short=not full)
        ),
        Cell(seconds_text(row["seconds"])),
        Cell(
            shown if number is None else f"{shown} [{number}]",
            STATUS_STYLES.get(status, ""),
        ),
    ]


def _interval(row: Row, full: bool) -> str:
    """Give the interval, or else the standard error, or else the kind of error."""
    if math.isnan(row["pf"]):
        return NO_VALUE
    if not (math.isnan(row["ci_low"]) or math.isnan(row["ci_high"])):
        return (" .. " if full else "..").join(
            scientific(row[end], 3) for end in ("ci_low", "ci_high")
        )
    if not math.isnan(row["std_error"]):
        return f"± {scientific(row['std_error'], 2)}"
    return str(row["error_kind"])


def _summary_lines(records: Records, width: int) -> Iterator[Text]:
    """Give one line per method: how much it answered, how well, and at what cost."""
    from uqfold.report.layout import Cell, Grid

    titles = {entry.label: entry.title for entry in records.header.methods}
    rows = []
    for label in records.finished:
        own = [row for row in records.rows if row["label"] == label]
        errors = finite(row["error"] for row in own)
        answered = sum(not math.isnan(row["pf"]) for row in own)
        cells = [
            f"  {label}",
            f"{answered} of {len(own)}",
            percent(median(errors)) if errors else NO_VALUE,
            percent(max(errors)) if errors else NO_VALUE,
            count_text(own[0]["n_evals"]),
            seconds_text(own[0]["seconds"]),
            titles.get(label, ""),
        ]
        rows.append([Cell(cell) for cell in cells])
    head = ["  whole run", "answered", "median error", "largest", "evaluations", "time", ""]
    grid = Grid(head, rows, (1, 2, 3, 4, 5), gap=2)
    if grid.width > width:
        grid = Grid(head[:-1], [row[:-1] for row in rows], grid.numeric, grid.gap)
    yield grid.head_line()
    yield from grid.lines()


def _legend_lines(
    records: Records, notes: Mapping[tuple[str, str], int], width: int
) -> Iterator[Text]:
    from uqfold.report.layout import hanging, line

    rows, reference = records.rows, records.header.reference
    legend = []
    intervals = dict.fromkeys(row["ci_kind"] for row in rows if row["ci_kind"])
    if intervals:
        legend.append(("interval", ", ".join(intervals)))
    if any(_interval(row, full=True) == "none" for row in rows):
        legend.append(("none", "the method gives no error of its own"))
    if any(row["status"] == "unchecked" for row in rows):
        legend.append(("unchecked", UNCHECKED))
    if any(not math.isnan(row["error"]) for row in rows):
        legend.append(("error", "|pf - reference| / reference, Eq. (49)"))
    if any(row["error"] <= reference_resolution(row) for row in rows):
        legend.append(("~", "below two standard errors of the reference, which cannot judge it"))
    if reference is not None and reference.how:
        legend.append(("reference", reference.how))
    for word, meaning in legend:
        yield from hanging(f"  {word:<11}", meaning, width, "dim")
    if notes:
        yield line("")
    for (label, message), number in notes.items():
        said = message if message.startswith(label) else f"{label}: {message}"
        yield from hanging(f"{f'[{number}]':>6} ", said, width)
