"""Choosing the rows that a figure draws."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

from uqfold.checks import instance, refused

if TYPE_CHECKING:
    import pandas as pd


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
