"""Standard deviations of the inputs (Example 5)."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import numpy as np
import pandas as pd

from uqfold.validation import Finding
from validation.paper.results import Results, at_least, contradictions, gains

SMALLER = {
    "V_q": ("condition-11", "condition-12"),
    "delta": ("condition-13", "condition-14"),
    "b": ("condition-15", "condition-16"),
    "k_d": ("condition-17", "condition-18"),
}
"""Input -> the condition with the smaller standard deviation, and the other one."""
OVER = {"no-sync": "m", "sync": "tau"}
"""Without and with synchronization: what tells the curves apart."""


def overtaking(results: Results, part: str, clear: float) -> Iterator[Finding]:
    """Yield how the smaller deviation starts lower and overtakes."""
    for name, pair in SMALLER.items():
        gain, relative = _curves(results, name, part)
        what = f"lowest relative difference of R, largest over {OVER[part]}, {name}"
        yield _trough(what, relative, clear, f"in R {gain.min(axis=1).max():.2g} at least")
        what = f"difference of R at the largest T, smallest over {OVER[part]}, {name}"
        yield at_least(0.0, what, gain.iloc[:, -1].min())
        signs = np.sign(gain).where(relative.abs() > clear).ffill(axis=1)
        crossings = (signs.diff(axis=1).fillna(0.0) != 0.0).sum(axis=1)
        yield Finding(f"most changes of sign on the way, {name}", crossings.max(), 1.0)
        simulated = gains(results[f"example-5/{name}-check"], *pair)
        curves = gains(results[f"example-5/{name}-{part}"], *pair)
        both = simulated.merge(
            curves, on=["threshold", "tau", "missions"], suffixes=("", "_of_curve")
        )
        signed = both["gain"] * np.sign(both["gain_of_curve"])
        what = f"simulated differences of the other sign, {name}"
        yield contradictions(what, signed, both["error"])


def pattern(results: Results, clear: float, settled: float) -> Iterator[Finding]:
    """Yield trough, peak and settling of the difference."""
    for name in SMALLER:
        gain, relative = _curves(results, name, "no-sync")
        trough, peak = gain.min(axis=1), gain.max(axis=1)
        what = f"relative depth of the trough, shallowest over m, {name}"
        yield _trough(what, relative, clear, f"in R {trough.max():.2g} to {trough.min():.2g}")
        what = f"relative height of the peak, lowest over m, {name}"
        yield _peak(what, relative, clear, f"in R from {peak.min():.2g}")
        distance = (gain.idxmax(axis=1) - gain.idxmin(axis=1)).min()
        yield at_least(0.0, f"smallest distance from trough to peak, {name}", distance, unit="s")
        final = (gain.iloc[:, -1].abs() / peak).max()
        yield Finding(f"largest final difference over its peak, {name}", final, settled)


def visible(results: Results, visible: float) -> Iterator[Finding]:
    """Yield the shallowest trough and the lowest peak, without and with synchronization."""
    for part, over in OVER.items():
        for name in SMALLER:
            gain, _ = _curves(results, name, part)
            deepest = f"deepest {gain.min(axis=None):.2g}"
            yield _trough(f"shallowest trough over {over}, {name}, {part}", gain, visible, deepest)
            yield _peak(f"lowest peak over {over}, {name}, {part}", gain, visible)


def _trough(what: str, curves: pd.DataFrame, depth: float, remark: str) -> Finding:
    """Return the shallowest trough of all curves, which has to have a depth."""
    return Finding(what, curves.min(axis=1).max(), -depth, remark=remark)


def _peak(what: str, curves: pd.DataFrame, height: float, remark: str = "") -> Finding:
    """Return the lowest peak of all curves, which has to have a height."""
    return at_least(height, what, curves.max(axis=1).min(), remark=remark)


def clearance(results: Results, coincide: float) -> Iterator[Finding]:
    """Yield the largest difference of the two curves of C_r, in runs with the same numbers."""
    paired = results["example-5/C_r-paired"]
    worst = paired.loc[paired["difference"].abs().idxmax()]
    where = f"at T = {worst['threshold']:g} s, m = {worst['missions']}"
    size, uncertainty = abs(worst["difference"]), 2.0 * worst["std_error"]
    what = "largest difference of R in paired runs"
    yield Finding(what, size, coincide, uncertainty=uncertainty, remark=where)


def clearance_at(
    results: Results, table: str, lags: Sequence[float], leads: Sequence[float]
) -> Iterator[Finding]:
    """Yield differences of paired runs with the sign that the text gives them.

    Parameters
    ----------
    results
        Tables of the studies.
    table
        That of the paired runs, in which the smaller deviation comes first.
    lags, leads
        T (s) at which the smaller deviation is the less and the more reliable one.
    """
    paired = results[f"example-5/{table}"]
    for what, sign, thresholds in (("lag", -1.0, lags), ("lead", 1.0, leads)):
        for row in paired[paired["threshold"].isin(thresholds)].itertuples():
            where = f"m = {row.missions}" if np.isinf(row.tau) else f"tau = {row.tau:g} s"
            text = f"{what} of the smaller deviation at T = {row.threshold:g} s, {where}"
            yield at_least(0.0, text, sign * row.difference, uncertainty=2.0 * row.std_error)


def _curves(results: Results, name: str, part: str) -> tuple[pd.DataFrame, pd.DataFrame]:
    """Return the difference of R over T and the relative one, one row per curve."""
    found = gains(results[f"example-5/{name}-{part}"], *SMALLER[name])
    gain, relative = (
        found.pivot(index=["missions", "tau"], columns="threshold", values=values)
        for values in ("gain", "relative")
    )
    return gain, relative
