"""Reliability curves in the tables of runs: steps between curves, orders, and their breaches."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from uqfold.comparison.claims.claim import IDENTITY
from uqfold.comparison.findings import Finding
from uqfold.typing import FloatArray

if TYPE_CHECKING:
    import pandas as pd

ROUNDING = 1e-9
"""Differences of reliabilities below it are none."""
STANDARD_ERRORS = 3.0
"""How far a simulation has to lie from an order to contradict it."""
NO_TAU = -1.0
NO_SYNC = {
    "example-1": ("no-sync",),
    "example-2": ("no-sync-open", "no-sync-crossed"),
    "example-3": ("no-sync",),
    "example-6": ("no-sync",),
}
"""Study -> tables of the paper's method without synchronization."""
SYNC = {
    "example-1": ("sync",),
    "example-2": ("sync-open", "sync-crossed"),
    "example-3": ("sync",),
    "example-6": ("sync",),
}
"""The same with synchronization."""
BOTH = {study: NO_SYNC[study] + SYNC[study] for study in SYNC}
_AXES = ("problem", "label", "threshold", "tau", "missions")


def fixed_missions(frame: pd.DataFrame) -> pd.DataFrame:
    """Give the rows with a fixed number of missions, as whole numbers."""
    own = frame[frame["missions"].str.isdecimal()]
    return own.assign(missions=own["missions"].astype(int))


def wide(frame: pd.DataFrame, column: str, values: str = "pf") -> pd.DataFrame:
    """Give one row per criterion and problem, one column per value of `column`, ascending."""
    rows = frame.assign(tau=frame["tau"].fillna(NO_TAU))
    index = [name for name in _AXES if name != column]
    return rows.pivot(index=index, columns=column, values=values).sort_index(axis=1)


def rises(frame: pd.DataFrame, column: str) -> FloatArray:
    """Give the changes of reliability from each value of `column` to the next one, all of them."""
    steps = -wide(frame, column).diff(axis=1).iloc[:, 1:].to_numpy()
    return np.asarray(steps[np.isfinite(steps)])


def never_rises(what: str, frame: pd.DataFrame, column: str) -> Finding:
    """Find the largest rise of reliability along a column, where no model can rise."""
    rise = float(rises(frame, column).max())
    return Finding(f"largest rise of R {what}", rise, ROUNDING, remark=IDENTITY)


def never_falls(what: str, frame: pd.DataFrame, column: str) -> Finding:
    """Find the largest fall of reliability along a column, where no model can fall."""
    fall = float(-rises(frame, column).min())
    return Finding(f"largest fall of R {what}", fall, ROUNDING, remark=IDENTITY)


def at_largest_threshold(frame: pd.DataFrame) -> pd.DataFrame:
    """Give the rows of the largest T: the plateau."""
    return frame[frame["threshold"] == frame["threshold"].max()]


def spread(frame: pd.DataFrame, column: str) -> pd.Series[float]:
    """Give the range of reliability over a column, by what is left of tau and threshold."""
    table = wide(frame, column)
    return table.max(axis=1) - table.min(axis=1)


def advantage(first: pd.DataFrame, second: pd.DataFrame) -> pd.DataFrame:
    """Set the reliability of one problem against that of another, criterion by criterion.

    Returns
    -------
    pandas.DataFrame
        Columns ``threshold``, ``tau``, ``missions``, ``gain`` (R of the first less R of the
        second), ``relative`` (the same over the larger R, or over the larger pf where that is
        smaller) and ``error`` (joint standard error; NaN where none is stated), ordered by T.
    """
    keys = ["threshold", "tau", "missions"]
    both = first.fillna({"tau": NO_TAU}).merge(
        second.fillna({"tau": NO_TAU}), on=keys, suffixes=("", "_other"), validate="one_to_one"
    )
    # from the side on which nothing cancels
    gain = np.where(
        both["pf"] > 0.5,
        both["reliability"] - both["reliability_other"],
        both["pf_other"] - both["pf"],
    )
    error = np.hypot(_error(both, ""), _error(both, "_other"))
    # gains of tiny reliabilities, and gains over tiny failure probabilities, count as well
    scale = np.minimum(
        both[["reliability", "reliability_other"]].max(axis=1),
        both[["pf", "pf_other"]].max(axis=1),
    )
    return (
        both[keys]
        .assign(gain=gain, relative=gain / scale, error=error)
        .sort_values(keys, ignore_index=True)
    )


def _error(frame: pd.DataFrame, suffix: str) -> FloatArray:
    """Give standard errors; of an estimate of 0 or 1 half the length of its interval."""
    half = 0.5 * (frame[f"ci_high{suffix}"] - frame[f"ci_low{suffix}"])
    return np.asarray(frame[f"std_error{suffix}"].fillna(half), dtype=np.float64)


def of_problem(frame: pd.DataFrame, problem: str) -> pd.DataFrame:
    """Give the rows of one problem.

    Raises
    ------
    ValueError
        If there are none.
    """
    rows = frame[frame["problem"] == problem]
    if rows.empty:
        raise ValueError(f"the table has no problem {problem!r}")
    return rows


def contradictions(what: str, gains: pd.DataFrame) -> Finding:
    """Count simulated gains that are negative by more than `STANDARD_ERRORS` of their errors."""
    known = gains[gains["error"] > 0.0]
    scores = known["gain"] / known["error"]
    clear = int((scores > STANDARD_ERRORS).sum())
    return Finding(
        f"simulated points against it, {what}",
        float((scores < -STANDARD_ERRORS).sum()),
        0.0,
        remark=f"{clear} of {len(known)} clearly for it (over {STANDARD_ERRORS:g} standard errors)",
    )


def named(rows: Sequence[Any]) -> str:
    """Write a short list of values."""
    return ", ".join(f"{value:g}" if isinstance(value, float) else str(value) for value in rows)
