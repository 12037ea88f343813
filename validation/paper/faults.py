"""Faults to plant in the tables of the studies: contradictions, and remedies for what fails."""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np
import pandas as pd

from validation.paper.deviations import SMALLER

Change = Callable[[pd.DataFrame], pd.DataFrame]


def upside_down(table: pd.DataFrame) -> pd.DataFrame:
    """Take reliability for the failure probability."""
    flipped = {name: 1.0 - table[name] for name in ("pf", "reference_pf") if name in table}
    return _consistent(table.assign(**flipped))


def reversed_in(column: str) -> Change:
    """Hand the values of a column out in reverse order."""

    def change(table: pd.DataFrame) -> pd.DataFrame:
        if column not in table:
            return table
        values = sorted(set(table[column]) - {math.inf})
        swapped = dict(zip(values, reversed(values), strict=True))
        return table.assign(**{column: table[column].map(lambda value: swapped.get(value, value))})

    return change


def off(table: pd.DataFrame) -> pd.DataFrame:
    """Let the methods' failure probabilities lie 0.03 further from the references."""
    if "reference_pf" not in table:
        return table
    known = table["reference_pf"].notna() & (table["pf"] < 0.9)
    pf = table["pf"].where(~known, np.maximum(table["pf"], table["reference_pf"]) + 0.03)
    return _consistent(table.assign(pf=pf, error=(pf / table["reference_pf"] - 1.0).abs()))


def one_run_more(table: pd.DataFrame) -> pd.DataFrame:
    """Count one evaluation more."""
    return table.assign(n_evals=table["n_evals"] + 1) if "n_evals" in table else table


def paired_the_other_way(table: pd.DataFrame) -> pd.DataFrame:
    """Let differences of paired systems have the other sign, a hundred times as large."""
    return table.assign(difference=-100.0 * table["difference"]) if "difference" in table else table


def with_troughs(table: pd.DataFrame) -> pd.DataFrame:
    """Let the larger deviation start 0.002 higher at every number of missions and tau."""
    if not {"problem", "pf", "missions", "tau", "threshold"} <= set(table):
        return table
    curve = ["missions", "tau"]
    first = table.groupby(["problem", *curve])["threshold"].transform("min")
    starts = table[table["threshold"] == first]
    pf = table["pf"].copy()
    for smaller, larger in SMALLER.values():
        own = starts[starts["problem"] == larger]
        other = starts[starts["problem"] == smaller].set_index(curve)["pf"].rename("smaller")
        # tables that compare both conditions in one row have no curve of their own to change
        pf.update(own.join(other, on=curve)["smaller"] - 0.002)
    return _consistent(table.assign(pf=pf))


def later(seconds: float) -> Change:
    """Let everything happen later."""
    return lambda table: (
        table.assign(threshold=table["threshold"] + seconds) if "threshold" in table else table
    )


def _consistent(table: pd.DataFrame) -> pd.DataFrame:
    """Let the reliability follow a changed failure probability."""
    return table.assign(reliability=1.0 - table["pf"]) if "reliability" in table else table


FAULTS: dict[str, Change] = {
    "upside down": upside_down,
    "conditions swapped": reversed_in("problem"),
    "tau swapped": reversed_in("tau"),
    "off": off,
    "one run more": one_run_more,
    "paired the other way": paired_the_other_way,
    "troughs": with_troughs,
    "later": later(0.085),
    "much later": later(0.2),
}
"""Name -> change of one table."""
