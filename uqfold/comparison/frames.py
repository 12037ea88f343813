"""From a pandas frame of a comparison back to its records."""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import replace
from typing import TYPE_CHECKING, Any

from uqfold.checks import instance
from uqfold.comparison.columns import COLUMNS, Row
from uqfold.comparison.csv_cells import text_of_cell
from uqfold.comparison.entries import MethodEntry
from uqfold.comparison.header import RunHeader
from uqfold.comparison.records import HEADER_ATTRIBUTE, Records
from uqfold.problems.criterion import Binomial, Criteria, Criterion

if TYPE_CHECKING:
    import pandas as pd


def records_from_frame(frame: pd.DataFrame) -> Records:
    """Give the records of a frame that `uqfold.compare` returned, or of a part of it.

    How the comparison was made travels in ``frame.attrs``. A frame without it (read from a CSV
    file, say) gives a header with what the rows alone tell: settings, equations, versions and
    date are then unknown.

    Parameters
    ----------
    frame
        Rows with the columns of `columns.COLUMNS`, of one problem.

    Raises
    ------
    ValueError
        If columns are missing, there is no row, or rows of several problems.
    """
    import pandas as pd

    instance("frame", frame, pd.DataFrame, "give one that uqfold.compare returned")
    missing = [name for name in COLUMNS if name not in frame.columns]
    if missing:
        raise ValueError(
            f"the frame has no column {missing[0]!r}: give one that uqfold.compare returned"
        )
    rows = tuple(_rows(frame, written=HEADER_ATTRIBUTE not in frame.attrs))
    problems = list(dict.fromkeys(row["problem"] for row in rows))
    if len(problems) != 1:
        named = ", ".join(problems) if problems else "none"
        raise ValueError(f"a report is about one problem, the frame holds {named}: select one")
    document = frame.attrs.get(HEADER_ATTRIBUTE)
    criteria = Criteria(_criteria(rows))
    header = _bare_header(rows, criteria) if document is None else _header(document, rows, criteria)
    return Records(header, rows)


def _rows(frame: pd.DataFrame, *, written: bool) -> Iterator[Row]:
    """Yield the rows; `written`: their texts are those of a CSV file."""
    columns = [_column(name, frame[name].tolist(), kind) for name, kind in COLUMNS.items()]
    for values in zip(*columns, strict=True):
        row = dict(zip(COLUMNS, values, strict=True))
        if written:
            row |= {name: text_of_cell(row[name]) for name, kind in COLUMNS.items() if kind is str}
        yield row


def _column(name: str, values: list[Any], kind: type) -> list[Any]:
    try:
        # an empty cell of a CSV file is read as NaN
        return [
            "" if kind is str and isinstance(value, float) and math.isnan(value) else kind(value)
            for value in values
        ]
    except (TypeError, ValueError, OverflowError) as error:
        raise ValueError(
            f"the column {name!r} of the frame holds no such numbers: {error}"
        ) from error


def _criteria(rows: Iterable[Row]) -> list[Criterion]:
    """Return the criteria that occur, each once."""
    stated = ("threshold", "tau", "missions", "missions_planned", "missions_p")
    # by their text, in which NaN equals NaN
    distinct = {tuple(repr(row[name]) for name in stated): row for row in reversed(list(rows))}
    return list(dict.fromkeys(map(_criterion, reversed(distinct.values()))))


def _criterion(row: Row) -> Criterion:
    binomial = not math.isnan(row["missions_planned"])
    return Criterion(
        row["threshold"],
        None if math.isnan(row["tau"]) else row["tau"],
        Binomial(row["missions_planned"], row["missions_p"])
        if binomial
        else _count(row["missions"]),
    )


def _count(missions: str) -> int:
    if not missions.isdecimal():
        raise ValueError(f"missions = {missions!r}: give a whole number, or missions_planned")
    return int(missions)


def _header(document: Mapping[str, Any], rows: tuple[Row, ...], criteria: Criteria) -> RunHeader:
    header = RunHeader.from_document(document)
    labels = {row["label"] for row in rows}
    methods = tuple(entry for entry in header.methods if entry.label in labels)
    known = {entry.label for entry in methods}
    if labels - known:
        # rows of another comparison were appended: nothing is known about how they were made
        return _bare_header(rows, criteria)
    return replace(header, criteria=criteria, methods=methods)


def _bare_header(rows: tuple[Row, ...], criteria: Criteria) -> RunHeader:
    methods = {row["label"]: row["method"] for row in rows}
    return RunHeader(
        problem=rows[0]["problem"],
        response="response",
        response_unit="",
        system=None,
        criteria=criteria,
        methods=tuple(MethodEntry(label, name, "", "") for label, name in methods.items()),
        seed=rows[0]["seed"],
        max_evals=None,
        failed_runs="",
        reference=None,
        command="",
        date="",
        machine="",
        versions={},
    )
