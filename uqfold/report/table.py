"""The comparison as a table on the terminal, or as plain text in a file or pipe.

Rows stand under their criterion. Columns are common to all criteria, and tighter where the terminal
is narrow; no cell is ever wrapped. What a method has to say about a row that did not converge
stands below the table, not in a cell.
"""

from __future__ import annotations

import math
import textwrap
from collections.abc import Container, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from uqfold.comparison.frames import checked_frame
from uqfold.plots.style import HEADER
from uqfold.plots.wording import (
    NO_VALUE,
    CriterionKey,
    Row,
    comparison_rows,
    count_text,
    criterion_key,
    criterion_text,
    percent,
    reference_resolution,
    scientific,
    seconds_text,
)
from uqfold.report.scores import method_scores
from uqfold.report.wording import UNCHECKED, remark, remarks

if TYPE_CHECKING:
    import pandas as pd
    from rich.console import Console, ConsoleOptions, RenderableType
    from rich.table import Table
    from rich.text import Text

STATUS_STYLES = {
    "converged": "green",
    "unchecked": "",
    "budget_exhausted": "yellow",
    "doubtful": "yellow",
    "unsupported": "bright_black",
    "failed": "bold red",
}
"""Status -> style on a terminal."""
_SHORT_STATUS = {"budget_exhausted": "budget"}
_LAYOUTS = (
    (True, 3, ()),
    (True, 2, ()),
    (False, 2, ()),
    (False, 1, ()),
    (False, 1, ("time",)),
    (False, 1, ("time", "interval")),
)
"""(full numbers and words, gap between columns, columns left out), from the most generous on."""
_OF_METHODS = ((True, 2, ()), (False, 2, ()), (False, 1, ("largest",)))
"""The same of the table of methods, of which the most generous one has titles too."""


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
        numbers = remarks(rows)
        yield Text(_title(header), "bold", overflow="fold")
        groups: dict[CriterionKey, list[Row]] = {}
        for row in rows:
            groups.setdefault(criterion_key(row), []).append(row)
        ordered = [row for group in groups.values() for row in group]
        answers = (_answers(ordered, numbers, *layout) for layout in _LAYOUTS)
        head, *lines = _fitting(answers, console, options)
        yield ""
        yield head
        for group in groups.values():
            yield ""
            yield from _group_head(group[0], header["response_unit"], options.max_width)
            yield from (lines.pop(0) for _ in group)
        yield ""
        methods = (_methods(header, self.frame, *layout) for layout in _OF_METHODS)
        yield from _fitting(methods, console, options)
        yield ""
        left_out = [name for name in ("time", "interval") if name not in head.plain]
        yield from _noted(_legend(header, rows, left_out), options.max_width, "dim")
        if numbers:
            yield ""
            said = {
                f"{f'[{number}]':>6} ": said if said.startswith(label) else f"{label}: {said}"
                for (label, said), number in numbers.items()
            }
            yield from _noted(said, options.max_width)


def _fitting(tables: Iterable[Table], console: Console, options: ConsoleOptions) -> list[Text]:
    """Return the lines of the first table that fits, or else of the last, which get folded."""
    from rich.text import Text

    for table in tables:
        width = console.measure(table, options=options.update(width=10_000)).maximum
        if width <= options.max_width:
            break
    lines = []
    for segments in console.render_lines(table, options.update(width=width), pad=False):
        line = Text.assemble(*((one.text, one.style or "") for one in segments), overflow="fold")
        line.rstrip()
        lines.append(line)
    return lines


def _noted(notes: Mapping[str, str], width: int, style: str = "") -> Iterator[Text]:
    """Return texts behind prefixes, wrapped with further lines flush with the first."""
    from rich.text import Text

    for prefix, text in notes.items():
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


def _table(
    columns: Mapping[str, Sequence[Text]], words: Container[str], gap: int, without: Container[str]
) -> Table:
    """Return a table from columns by name, of which some are words, the others numbers."""
    from rich.table import Table

    shown = {name: cells for name, cells in columns.items() if name.strip() not in without}
    table = Table(box=None, pad_edge=False, padding=(0, gap, 0, 0), header_style="dim")
    for name in shown:
        table.add_column(name, justify="left" if name in words else "right", no_wrap=True)
    for row in zip(*shown.values(), strict=True):
        table.add_row(*row)
    return table


def _answers(
    rows: Sequence[Row],
    numbers: Mapping[tuple[str, str], int],
    full: bool,
    gap: int,
    without: Container[str],
) -> Table:
    interval, evals = ("interval or error kind", "evaluations") if full else ("interval", "evals")
    names = ("  method", "pf", interval, "error", evals, "time", "status")
    cells = zip(*(_cells(row, numbers, full) for row in rows), strict=True)
    columns = dict(zip(names, cells, strict=True))
    return _table(columns, ("  method", interval, "status"), gap, without)


def _cells(row: Row, numbers: Mapping[tuple[str, str], int], full: bool) -> list[Text]:
    from rich.text import Text

    status = str(row["status"])
    shown = status if full else _SHORT_STATUS.get(status, status)
    number = numbers.get((row["label"], remark(row)))
    within = "~" if row["error"] <= reference_resolution(row) else ""
    # what a method refuses costs nothing
    evals = NO_VALUE if status == "unsupported" else count_text(row["n_evals_row"], short=not full)
    return [
        Text(f"  {row['label']}"),
        Text(scientific(row["pf"], 4 if full else 3), "bold"),
        Text(_interval(row, full)),
        Text(f"{within}{percent(row['error'])}"),
        Text(evals),
        Text(seconds_text(row["seconds"])),
        Text(shown if number is None else f"{shown} [{number}]", STATUS_STYLES.get(status, "")),
    ]


def _interval(row: Row, full: bool) -> str:
    """Return the interval, or else the standard error, or else the kind of error."""
    if math.isnan(row["pf"]):
        return NO_VALUE
    if not math.isnan(row["ci_low"] + row["ci_high"]):
        ends = (scientific(row[end], 3) for end in ("ci_low", "ci_high"))
        return (" .. " if full else "..").join(ends)
    if not math.isnan(row["std_error"]):
        return f"± {scientific(row['std_error'], 2)}"
    return str(row["error_kind"])


def _group_head(row: Row, unit: str, width: int) -> Iterator[Text]:
    from rich.text import Text

    criterion = criterion_text(criterion_key(row), unit)
    reference = "no reference"
    if not math.isnan(row["reference_pf"]):
        error = scientific(row["reference_std_error"], 2)
        reference = f"reference pf {scientific(row['reference_pf'], 4)} ± {error}"
    fits = len(criterion) + 3 + len(reference) <= width
    head = Text(criterion, "bold", overflow="fold")
    behind = Text(f"{'   ' if fits else '  '}{reference}", "not bold cyan", overflow="fold")
    yield from (head.append_text(behind),) if fits else (head, behind)


def _methods(
    header: Mapping[str, Any], frame: pd.DataFrame, titled: bool, gap: int, without: Container[str]
) -> Table:
    """Return one line per method: how much it answered, how well, and at what cost."""
    from rich.text import Text

    scores = method_scores(frame)
    answered = scores["answered"].astype(str) + " of " + scores["asked"].astype(str)
    texts = {
        "  whole run": "  " + scores.index,
        "answered": answered,
        "median error": scores["median_error"].map(percent),
        "largest": scores["largest_error"].map(percent),
        "evaluations": scores["n_evals"].map(count_text),
        "time": scores["seconds"].map(seconds_text),
    }
    if titled:
        titles = {entry["label"]: entry["title"] for entry in header["methods"]}
        texts[""] = [titles.get(label, "") for label in scores.index]
    columns = {name: [Text(one) for one in column] for name, column in texts.items()}
    return _table(columns, ("  whole run", ""), gap, without)


def _legend(
    header: Mapping[str, Any], rows: Sequence[Row], left_out: Sequence[str]
) -> dict[str, str]:
    said = {}
    if left_out:
        said["left out"] = f"{' and '.join(left_out)}, which a wider terminal shows"
    intervals = dict.fromkeys(row["ci_kind"] for row in rows if row["ci_kind"])
    if intervals and "interval" not in left_out:
        said["interval"] = ", ".join(intervals)
    if "interval" not in left_out and any(_interval(row, full=True) == "none" for row in rows):
        said["none"] = "the method gives no error of its own"
    if any(row["status"] == "unchecked" for row in rows):
        said["unchecked"] = UNCHECKED
    if any(not math.isnan(row["error"]) for row in rows):
        said["error"] = "|pf - reference| / reference, Eq. (49)"
    if any(row["error"] <= reference_resolution(row) for row in rows):
        said["~"] = "below two standard errors of the reference, which cannot judge it"
    if header["reference"] is not None and header["reference"]["how"]:
        said["reference"] = header["reference"]["how"]
    return {f"  {word:<11}": meaning for word, meaning in said.items()}
