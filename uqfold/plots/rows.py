"""Choosing the rows that a figure draws."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping, Sequence
from typing import TYPE_CHECKING, Any, TypeAlias

from uqfold.checks import instance, mapping, refused, several
from uqfold.comparison.columns import comparison_row, rows_to_frame
from uqfold.methods.result import ReliabilityResult

if TYPE_CHECKING:
    import pandas as pd


Comparable: TypeAlias = (
    "pd.DataFrame | ReliabilityResult | Iterable[ReliabilityResult] | "
    "Mapping[str, ReliabilityResult]"
)
"""A frame of `uqfold.compare`, a result of a method, several, or label -> result."""


def answers_frame(frame: Comparable, needs: Sequence[str]) -> pd.DataFrame:
    """Return the frame of a comparison, checked; results of methods become one without problem.

    Results that have no labels are called by their methods, further ones of a method by a number
    behind it.
    """
    if hasattr(frame, "columns"):
        return checked("frame", frame, needs)
    given = [frame] if isinstance(frame, ReliabilityResult) else frame
    remedy = "give a DataFrame of uqfold.compare, or results of methods"
    if isinstance(given, Mapping):
        labelled = mapping("frame", given, instance, ReliabilityResult, remedy)
    else:
        results = several("frame", given, instance, ReliabilityResult, remedy)
        names = [result.method for result in results]
        before = [names[:i].count(name) for i, name in enumerate(names)]
        labels = [f"{name} {k + 1}" if k else name for name, k in zip(names, before, strict=True)]
        labelled = dict(zip(labels, results, strict=True))
    rows = (
        comparison_row("", label, row, None) for label, result in labelled.items() for row in result
    )
    return checked("frame", rows_to_frame(rows), needs)


def checked(name: str, frame: object, needs: Sequence[str]) -> pd.DataFrame:
    """Return a frame that has rows and the columns that a figure needs, or raise."""
    import pandas as pd

    table: pd.DataFrame = instance(name, frame, pd.DataFrame, "give a DataFrame")
    missing = [column for column in needs if column not in table.columns]
    if missing:
        raise ValueError(
            f"{name} has no column {missing[0]!r}: it has {', '.join(map(str, table))}"
        )
    if table.empty:
        raise refused(name, table, "it has no row to draw")
    return table


def distinct(frame: pd.DataFrame, column: str | None) -> list[Any]:
    """Return the values of a column in the order in which they occur, NaN as None."""
    if column is None:
        return [None]
    values = frame[column].drop_duplicates().tolist()
    return [None if isinstance(one, float) and math.isnan(one) else one for one in values]


def having(frame: pd.DataFrame, column: str | None, value: Any) -> pd.DataFrame:
    """Return the rows with that value in a column, None being NaN; all without a column."""
    if column is None:
        return frame
    return frame[frame[column].isna() if value is None else frame[column] == value]
