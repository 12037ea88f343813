"""Frames of comparisons, whatever became of them since `uqfold.compare` returned them."""

from __future__ import annotations

import math
from collections.abc import Iterable
from typing import TYPE_CHECKING, Any

from uqfold.checks import instance
from uqfold.comparison.columns import COLUMNS, Row, rows_to_frame
from uqfold.comparison.csv_cells import text_of_cell
from uqfold.comparison.header import ATTRIBUTE, bare_header, checked_header, encoded_criterion
from uqfold.problems.criterion import Binomial, Criterion

if TYPE_CHECKING:
    import pandas as pd


def checked_frame(frame: pd.DataFrame) -> pd.DataFrame:
    """Return the rows of a comparison in their columns and types, with the header of these rows.

    How the comparison was made travels in ``frame.attrs``. The header returned has the criteria
    that occur in the rows, the methods that do, and those that had not finished. A frame without
    a header (read from a CSV file, say) gets one with what the rows alone tell: settings,
    equations, versions and date are then unknown.

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
    columns = {name: _column(name, frame[name].tolist(), kind) for name, kind in COLUMNS.items()}
    if ATTRIBUTE not in frame.attrs:
        # its texts are those of a CSV file
        columns |= {
            name: list(map(text_of_cell, columns[name]))
            for name, kind in COLUMNS.items()
            if kind is str
        }
    problems = list(dict.fromkeys(columns["problem"]))
    if len(problems) != 1:
        named = ", ".join(problems) if problems else "none"
        raise ValueError(f"a report is about one problem, the frame holds {named}: select one")
    rows = [
        dict(zip(columns, values, strict=True)) for values in zip(*columns.values(), strict=True)
    ]
    checked = rows_to_frame(rows)
    checked.attrs[ATTRIBUTE] = _header(frame.attrs.get(ATTRIBUTE), rows)
    return checked


def comparison_header(frame: pd.DataFrame) -> dict[str, Any]:
    """Return how the comparison in a frame was made; see `checked_frame`, and ``docs/records.md``.

    Raises
    ------
    ValueError
        If the frame is not one of a comparison.
    """
    header: dict[str, Any] = checked_frame(frame).attrs[ATTRIBUTE]
    return header


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


def _header(document: Any, rows: list[dict[str, Any]]) -> dict[str, Any]:
    occurring = [encoded_criterion(one) for one in _criteria(rows)]
    labels = {row["label"]: row["method"] for row in rows}
    if document is not None:
        header = checked_header(document)
        if set(labels) <= {one["label"] for one in header["methods"]}:
            left_out = set(header["finished"]) - set(labels)
            methods = [one for one in header["methods"] if one["label"] not in left_out]
            return {
                **header, "criteria": occurring, "methods": methods, "finished": list(labels)
            }  # fmt: skip
    # where rows of another comparison were appended, nothing is known about how they were made
    bare = bare_header(rows[0]["problem"], labels, rows[0]["seed"])
    return {**bare, "criteria": occurring}


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
