"""Faults to plant in the tables of the studies: contradictions, and remedies for what fails."""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np
import pandas as pd

from validation.paper.deviations import SMALLER

Change = Callable[[pd.DataFrame], pd.DataFrame]


def plant(fault: str, table: pd.DataFrame) -> pd.DataFrame:
    """Return the table with a fault in it, or as it is where it lacks the columns for that."""
    columns, change = FAULTS[fault]
    return change(table) if columns <= set(table) else table


def upside_down(table: pd.DataFrame) -> pd.DataFrame:
    """Take reliability for the failure probability."""
    names = {"pf", "reference_pf"} & set(table)
    return table.assign(reliability=table["pf"], **{name: 1.0 - table[name] for name in names})


def reversed_in(column: str) -> Change:
    """Hand the values of a column out in reverse order."""

    def change(table: pd.DataFrame) -> pd.DataFrame:
        values = sorted(set(table[column]) - {math.inf})
        swapped = dict(zip(values, reversed(values), strict=True))
        return table.assign(**{column: table[column].map(lambda value: swapped.get(value, value))})

    return change


def off(table: pd.DataFrame) -> pd.DataFrame:
    """Let the methods' failure probabilities lie 0.03 further from the references."""
    known = table["reference_pf"].notna() & (table["pf"] < 0.9)
    pf = table["pf"].where(~known, np.maximum(table["pf"], table["reference_pf"]) + 0.03)
    error = (pf / table["reference_pf"] - 1.0).abs()
    return table.assign(pf=pf, reliability=1.0 - pf, error=error)


def with_troughs(table: pd.DataFrame) -> pd.DataFrame:
    """Let the larger deviation start 0.002 higher at every number of missions and tau."""
    curve = ["missions", "tau"]
    first = table.groupby(["problem", *curve])["threshold"].transform("min")
    starts = table[table["threshold"] == first]
    pf = table["pf"].copy()
    for smaller, larger in SMALLER.values():
        own = starts[starts["problem"] == larger]
        other = starts[starts["problem"] == smaller].set_index(curve)["pf"].rename("smaller")
        # tables that compare both conditions in one row have no curve of their own to change
        pf.update(own.join(other, on=curve)["smaller"] - 0.002)
    return table.assign(pf=pf, reliability=1.0 - pf)


def shifted(column: str, change: Callable[[pd.Series], pd.Series]) -> Change:
    """Change the values of one column."""
    return lambda table: table.assign(**{column: change(table[column])})


FAULTS: dict[str, tuple[set[str], Change]] = {
    "upside down": ({"pf"}, upside_down),
    "conditions swapped": ({"problem"}, reversed_in("problem")),
    "tau swapped": ({"tau"}, reversed_in("tau")),
    "off": ({"pf", "reference_pf"}, off),
    "one run more": ({"n_evals"}, shifted("n_evals", lambda count: count + 1)),
    "paired the other way": ({"difference"}, shifted("difference", lambda gap: -100.0 * gap)),
    "troughs": ({"problem", "pf", "missions", "tau", "threshold"}, with_troughs),
    "later": ({"threshold"}, shifted("threshold", lambda T: T + 0.085)),
    "much later": ({"threshold"}, shifted("threshold", lambda T: T + 0.2)),
}
"""Name -> columns that a table needs for it, and the change."""
