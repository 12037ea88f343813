"""Choosing rows of a study's tables, and what figures call the values in them."""

from __future__ import annotations

import math
import re
from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any

from uqfold.report.wording import quantity

if TYPE_CHECKING:
    import pandas as pd

_BINOMIAL = re.compile(r"binomial\((\d+), (.+)\)")


class SelectionError(ValueError):
    """A figure or table chooses no row."""


def selected(frame: pd.DataFrame, where: Mapping[str, Any]) -> pd.DataFrame:
    """Give the rows that hold the wanted values.

    Parameters
    ----------
    frame
        A table of the study.
    where
        Column -> value or list of values; the text ``none`` stands for a missing number.

    Raises
    ------
    SelectionError
        If no row does.
    """
    rows = frame
    for column, wanted in where.items():
        values = wanted if isinstance(wanted, list) else [wanted]
        mask = rows[column].isin([value for value in values if value != "none"])
        if "none" in values:
            mask |= rows[column].isna()
        rows = rows[mask]
    if rows.empty:
        raise SelectionError(f"no row has {dict(where)}")
    return rows


def joined(tables: Mapping[str, pd.DataFrame], names: Sequence[str]) -> pd.DataFrame:
    """Give the rows of several tables with the same columns, one after the other."""
    import pandas as pd

    return pd.concat([tables[name] for name in names], ignore_index=True)


def distinct(frame: pd.DataFrame, column: str | None) -> list[Any]:
    """Give the values in a column in the order in which they occur, NaN as None."""
    if column is None:
        return [None]
    values = frame[column].drop_duplicates().tolist()
    return [None if _missing(value) else value for value in values]


def having(frame: pd.DataFrame, column: str | None, value: Any) -> pd.DataFrame:
    """Give the rows with that value in a column, None being a missing one; all without a column."""
    if column is None:
        return frame
    return frame[frame[column].isna() if value is None else frame[column] == value]


def value_text(column: str, value: Any, unit: str) -> str:
    """Write one value of a column as figures call it, for instance ``τ = 0.04 s``."""
    if column == "missions":
        match = _BINOMIAL.fullmatch(value)
        if match is None:
            return f"$m$ = {value}"
        return f"$N_t$ = {match[1]}, $p_m$ = {match[2]}"
    if column == "tau":
        return "no $\\tau$" if value is None else f"$\\tau$ = {quantity(value, unit)}"
    if column == "units":
        return f"$n$ = {value}"
    if column == "threshold":
        return f"$T$ = {quantity(value, unit)}"
    if isinstance(value, float) and column == "max_evals":
        return f"{value:,.0f} evaluations"
    return "none" if value is None else f"{value:g}" if isinstance(value, float) else str(value)


def response_axis(tables: Mapping[str, pd.DataFrame], problem: str) -> tuple[str, str]:
    """Give response and unit of a problem of the study."""
    row = tables["problems"].set_index("problem").loc[problem]
    return str(row["response"]), str(row["response_unit"])


def _missing(value: Any) -> bool:
    return isinstance(value, float) and math.isnan(value)
