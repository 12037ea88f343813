"""The committed tables of the studies, and statistics that suit any of them."""

from __future__ import annotations

import math
from collections.abc import Mapping
from functools import cache
from pathlib import Path
from typing import Any, TypeAlias

import numpy as np
import pandas as pd

from uqfold.typing import FloatArray
from uqfold.validation import Finding

STUDIES = Path(__file__).resolve().parents[2] / "studies"

Results: TypeAlias = Mapping[str, pd.DataFrame]
"""``study/table`` -> rows; tau is infinite where nothing has to be synchronized."""

NO_SYNC = {
    "example-1": ["example-1/no-sync"],
    "example-2": ["example-2/no-sync-open", "example-2/no-sync-crossed"],
    "example-3": ["example-3/no-sync"],
    "example-6": ["example-6/no-sync"],
}
"""Study -> tables of the paper's method without synchronization."""
SYNC = {
    study: [table.replace("no-sync", "sync") for table in tables]
    for study, tables in NO_SYNC.items()
}
"""The same with synchronization."""

IDENTITY = "an identity: every model keeps it, so it is no evidence"
"""Remark of a finding that follows from the algebra alone; a breach shows an error of ours."""
ROUNDING = 1e-9
"""Differences of reliabilities below it are none."""
STANDARD_ERRORS = 3.0
"""How far a simulation has to lie from an order to contradict it."""

_TEXTS = ("problem", "label", "missions", "status", "message")
_AXES = ("problem", "label", "threshold", "tau", "missions")
_CRITERION = ["threshold", "tau", "missions"]


@cache
def read_results() -> dict[str, pd.DataFrame]:
    """Read the tables of the paper's examples."""
    results = {}
    for path in sorted(STUDIES.glob("example-*/results/*.csv")):
        rows = pd.read_csv(path, dtype=dict.fromkeys(_TEXTS, str)).round({"threshold": 9})
        results[f"{path.parts[-3]}/{path.stem}"] = rows.fillna({"tau": math.inf})
    return results


def fixed_missions(rows: pd.DataFrame) -> pd.DataFrame:
    """Return the rows with a fixed number of missions, as whole numbers."""
    own = rows[rows["missions"].str.isdecimal()]
    return own.assign(missions=own["missions"].astype(int))


def at_largest_threshold(rows: pd.DataFrame) -> pd.DataFrame:
    """Return the rows of the largest T: the plateau."""
    return rows[rows["threshold"] == rows["threshold"].max()]


def wide(rows: pd.DataFrame, column: str, values: str = "pf") -> pd.DataFrame:
    """Return one row per criterion and problem, one column per value of `column`, ascending."""
    index = [name for name in _AXES if name != column]
    return rows.pivot(index=index, columns=column, values=values).sort_index(axis=1)


def steps(rows: pd.DataFrame, column: str, values: str = "pf") -> FloatArray:
    """Return how much pf rises from each value of a column to the next one."""
    return wide(rows, column, values).diff(axis=1).iloc[:, 1:].to_numpy()


def spread(rows: pd.DataFrame, column: str, by: str) -> pd.Series[float]:
    """Return the largest range of R over a column, by another one in ascending order."""
    table = wide(rows, column)
    return (table.max(axis=1) - table.min(axis=1)).groupby(by).max().sort_index()


def widening(what: str, rows: pd.DataFrame) -> Finding:
    """Return how the spread over missions at the largest T grows with tau: never, it is said."""
    gaps = spread(at_largest_threshold(rows), "missions", "tau")
    every = ", ".join(f"{gap:.3g} at tau = {tau:g} s" for tau, gap in gaps.items())
    what = f"largest widening of {what} as tau grows"
    return Finding(what, gaps.diff().max(), 0.0, remark=every)


def gains(rows: pd.DataFrame, better: str, worse: str) -> pd.DataFrame:
    """Set the reliability of one problem against that of another, criterion by criterion.

    Returns
    -------
    pandas.DataFrame
        Columns ``threshold``, ``tau``, ``missions``, ``gain`` (R of the better less R of the
        worse), ``relative`` (the same over the larger R, or over the larger pf where that is
        smaller) and ``error`` (joint standard error; NaN where none is stated), ordered by T.
    """
    one, other = (rows[rows["problem"] == name].set_index(_CRITERION) for name in (better, worse))
    # from the side on which nothing cancels
    gain = (other["pf"] - one["pf"]).where(
        one["pf"] <= 0.5, one["reliability"] - other["reliability"]
    )
    # gains of tiny reliabilities, and gains over tiny failure probabilities, count as well
    R, pf = (np.maximum(one[name], other[name]) for name in ("reliability", "pf"))
    columns = {
        "gain": gain,
        "relative": gain / np.minimum(R, pf),
        "error": np.hypot(_error(one), _error(other)),
    }
    return pd.DataFrame(columns).reset_index().sort_values(_CRITERION, ignore_index=True)


def _error(rows: pd.DataFrame) -> pd.Series[float]:
    """Return standard errors; of an estimate of 0 or 1 half the length of its interval."""
    return rows["std_error"].fillna(0.5 * (rows["ci_high"] - rows["ci_low"]))


def contradictions(what: str, gain: pd.Series[float], error: pd.Series[float]) -> Finding:
    """Count simulated gains that are negative by more than `STANDARD_ERRORS` of their errors."""
    scores = (gain / error)[error > 0.0]
    clear = f"{(scores > STANDARD_ERRORS).sum()} of {len(scores)} clearly for it"
    remark = f"{clear} (over {STANDARD_ERRORS:g} standard errors)"
    return Finding(what, (scores < -STANDARD_ERRORS).sum(), 0.0, remark=remark)


def identity(what: str, value: Any) -> Finding:
    """Return a number that no model can let exceed 0."""
    return Finding(what, value, ROUNDING, remark=IDENTITY)


def at_least(limit: float, what: str, value: Any, **more: Any) -> Finding:
    """Return a number with a lower limit."""
    return Finding(what, value, limit, at_least=True, **more)
