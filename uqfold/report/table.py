"""The comparison as a table on the terminal, or as plain text in a file or pipe.

Rows stand under their criterion. Columns are as wide for all criteria, and no cell is ever wrapped:
what has no room in a narrow terminal is left out, and said. What a method has to say about a row
that did not converge stands below the table, not in a cell.
"""

from __future__ import annotations

import math
import textwrap
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from uqfold.comparison.columns import ATTRIBUTE
from uqfold.comparison.frames import checked_frame
from uqfold.plots.wording import (
    Row,
    criterion_text,
    percent,
    probability,
    reference_resolution,
    response_text,
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
from uqfold.report.page.cells import TONES, Cell, is_numeric

if TYPE_CHECKING:
    import pandas as pd
    from rich.console import Console, ConsoleOptions, RenderableType
    from rich.text import Text

STYLES = {"good": "green", "warn": "yellow", "bad": "bold red", "quiet": "bright_black"}
"""Tone -> style on a terminal."""
_OF_ANSWERS = ("method", "pf", "interval", "error", "evaluations", "status")
_OF_METHODS = (
    "whole run", "answered", "median error", "largest", "evaluations", "time", "",
)  # fmt: skip
_MAY_GO = ("evaluations", "interval")
"""Columns of answers that are left out where there is no room, one after the other."""
_GAP = 2


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

        header, rows = self.frame.attrs[ATTRIBUTE], self.frame.to_dict("records")
        unit, width = header["response_unit"], options.max_width
        answers = answers_table(self.frame)
        if "remark" in answers.columns:
            pairs = zip(answers["status"], answers["remark"], strict=True)
            answers["status"] = [
                Cell(f"{status} {number}".rstrip(), tone=TONES.get(status, ""))
                for status, number in pairs
            ]
        columns = text_columns(answers, _OF_ANSWERS, width, _MAY_GO)
        head, *lines = joined(columns)
        budget = "no budget"
        if header["max_evals"] is not None:
            budget = f"at most {header['max_evals']:,} evaluations per method"
        of = ", ".join(filter(None, [response_text(self.frame), f"seed {header['seed']}", budget]))
        yield Text(f"{header['problem']}: {of}", "bold", overflow="fold")
        yield ""
        yield head
        criteria = [criterion_text(row, unit) for row in rows]
        for criterion in dict.fromkeys(criteria):
            members = [i for i, one in enumerate(criteria) if one == criterion]
            yield ""
            yield _group_head(criterion, rows[members[0]])
            yield from (lines[i] for i in members)
        titles = {entry["label"]: entry["title"] for entry in header["methods"]}
        methods = methods_table(self.frame).rename(columns={"method": "whole run"})
        methods[""] = methods["whole run"].map(titles)
        yield ""
        yield from joined(text_columns(methods, _OF_METHODS, width, ("", "largest")))
        yield ""
        left_out = [one for one in _MAY_GO if one not in columns]
        for word, meaning in _legend(header, rows, left_out).items():
            yield _noted(f"  {word:<11}", meaning, width, "dim")
        parts = header.get("error_parts", {})
        if parts:
            each = "; ".join(
                f"{label} {', '.join(f'{part} {percent(one)}' for part, one in own.items())}"
                for label, own in parts.items()
            )
            yield _noted("  errors     ", f"stated ones of pf come from: {each}", width, "dim")
        for i, ((label, said), number) in enumerate(remarks(rows).items()):
            if not i:
                yield ""
            words = said if said.startswith(label) else f"{label}: {said}"
            yield _noted(f"{f'[{number}]':>6} ", words, width)


def text_columns(
    frame: pd.DataFrame,
    names: Sequence[str] = (),
    width: float = math.inf,
    may_go: Sequence[str] = (),
) -> dict[str, list[Text]]:
    """Return columns of cells as texts of one width each, with their heads; numbers at the right.

    Parameters
    ----------
    frame
        The cells, or what stands for them.
    names
        The columns, where the frame has them; by default all.
    width, may_go
        Columns that are left out one after the other as long as there is no room for all.
    """
    from rich.text import Text

    columns = {}
    for name in [one for one in names if one in frame.columns] or frame.columns:
        cells = [
            one if isinstance(one, Cell) else Cell(str(one), tone=TONES.get(str(one), ""))
            for one in frame[name]
        ]
        texts = [Text(cell.text, "bold" if name == "pf" else STYLES.get(cell.tone, ""))
                 for cell in cells]  # fmt: skip
        columns[name] = [Text(name, "dim"), *texts]
        widest = max(text.cell_len for text in columns[name])
        for text in columns[name]:
            text.align("right" if is_numeric(cells) else "left", widest)
    for name in may_go:
        if sum(column[0].cell_len + _GAP for column in columns.values()) > width:
            columns.pop(name, None)
    return columns


def joined(columns: Mapping[str, Sequence[Text]]) -> list[Text]:
    """Return columns of texts as lines, the heads first."""
    from rich.text import Text

    lines = [Text(" " * _GAP).join([Text(), *row]) for row in zip(*columns.values(), strict=True)]
    for line in lines:
        line.rstrip()
        line.overflow = "fold"
    return lines


def _noted(prefix: str, text: str, width: int, style: str = "") -> Text:
    """Return a text behind a prefix, wrapped with further lines flush with the first."""
    from rich.text import Text

    lines = textwrap.wrap(text, max(width - len(prefix), 20), break_on_hyphens=False)
    between = "\n" + " " * len(prefix)
    return Text(f"{prefix}{between.join(lines)}", style, overflow="fold")


def _group_head(criterion: str, row: Row) -> Text:
    from rich.text import Text

    reference = "no reference"
    if not math.isnan(row["reference_pf"]):
        pf, error = row["reference_pf"], row["reference_std_error"]
        reference = f"reference pf {probability(pf, 4)} ± {scientific(error, 2)}"
    return Text.assemble((criterion, "bold"), "   ", (reference, "cyan"), overflow="fold")


def _legend(
    header: Mapping[str, Any], rows: Sequence[Row], left_out: Sequence[str]
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
