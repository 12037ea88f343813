"""Choosing the rows that a figure draws, and what it calls the values in them."""

from __future__ import annotations

import math
import re
from collections.abc import Sequence
from typing import TYPE_CHECKING, Any, TypeAlias

from uqfold.checks import instance, listed, refused
from uqfold.plots.style import HEADER

if TYPE_CHECKING:
    import pandas as pd

    Frames: TypeAlias = pd.DataFrame | Sequence[pd.DataFrame]

_BINOMIAL = re.compile(r"binomial\((\d+), (.+)\)")


def joined(frames: Frames, needs: Sequence[str], name: str = "frame") -> pd.DataFrame:
    """Return the rows of one or several frames, one after the other, with the first one's attrs.

    Raises
    ------
    TypeError, ValueError
        If there is no row, or a frame lacks a column that the figure needs.
    """
    import pandas as pd

    given: list[pd.DataFrame] = (
        [frames]
        if isinstance(frames, pd.DataFrame)
        else list(listed(name, frames, what="DataFrame, or a list of them"))
    )
    for frame in given:
        instance(name, frame, pd.DataFrame, "give a DataFrame, or a list of them")
        missing = [column for column in needs if column not in frame.columns]
        if missing:
            raise refused(name, list(frame.columns), f"it has no column {missing[0]!r}")
    if not any(len(frame) for frame in given):
        raise refused(name, frames, "it has no row to draw")
    whole = given[0] if len(given) == 1 else pd.concat(given, ignore_index=True)
    whole.attrs = given[0].attrs
    return whole


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
    if column == "missions":
        match = _BINOMIAL.fullmatch(str(value))
        return f"$N_t$ = {match[1]}, $p_m$ = {match[2]}" if match else f"$m$ = {value}"
    if value is None:
        return "no $\\tau$" if column == "tau" else "none"
    symbol = {"tau": "$\\tau$", "threshold": "$T$"}.get(column)
    if symbol is not None:
        return f"{symbol} = {value:g} {unit}".strip()
    if column == "units":
        return f"$n$ = {value}"
    return f"{value:g}" if isinstance(value, float) else str(value)
