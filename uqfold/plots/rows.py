"""Choosing the rows that a figure draws, and what it calls the values in them."""

from __future__ import annotations

import math
import re
from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

from uqfold.checks import instance, refused
from uqfold.plots.style import HEADER

if TYPE_CHECKING:
    import pandas as pd

_BINOMIAL = re.compile(r"binomial\((\d+), (.+)\)")


def checked(name: str, frame: object, needs: Sequence[str]) -> pd.DataFrame:
    """Return a frame that has rows and the columns that a figure needs, or raise."""
    import pandas as pd

    table: pd.DataFrame = instance(name, frame, pd.DataFrame, "give a DataFrame")
    missing = [column for column in needs if column not in table.columns]
    if missing:
        raise refused(name, list(table.columns), f"it has no column {missing[0]!r}")
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


def response_of(frame: pd.DataFrame) -> tuple[str, str]:
    """Return response and unit as the header of the comparison has them."""
    header = frame.attrs.get(HEADER, {})
    return header.get("response", "response"), header.get("response_unit", "")


def threshold_label(frame: pd.DataFrame) -> str:
    """Return the label of an axis of thresholds."""
    response, unit = response_of(frame)
    return f"threshold $T$ on {response}{f' ({unit})' if unit else ''}"


def value_text(column: str, value: Any, unit: str) -> str:
    """Write one value of a column as figures call it, for instance ``τ = 0.04 s``."""
    if value is None:
        return "no $\\tau$" if column == "tau" else "none"
    if binomial := _BINOMIAL.fullmatch(str(value)):
        return f"$N_t$ = {binomial[1]}, $p_m$ = {binomial[2]}"
    written = f"{value:g}" if isinstance(value, float) else str(value)
    symbol = {"tau": "\\tau", "threshold": "T", "missions": "m", "units": "n"}.get(column)
    with_unit = f"{written} {unit}".strip() if column in ("tau", "threshold") else written
    return with_unit if symbol is None else f"${symbol}$ = {with_unit}"
