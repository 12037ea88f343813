"""Means of the inputs (Example 4)."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
import pandas as pd

from uqfold.validation import Finding
from validation.paper.results import (
    ROUNDING,
    Results,
    at_largest_threshold,
    at_least,
    contradictions,
    gains,
    wide,
)

BETTER = {
    "V_q": ("condition-1", "condition-2"),
    "delta": ("condition-3", "condition-4"),
    "b": ("condition-5", "condition-6"),
    "k_d": ("condition-7", "condition-8"),
    "C_r": ("condition-9", "condition-10"),
}
"""Input -> the condition that the text calls more reliable without synchronization, the other."""


def without_tau(results: Results) -> Iterator[Finding]:
    """Yield the smallest gain of the better condition over all T and m."""
    for name in BETTER:
        yield _smallest_gain(f"smallest gain of R, {name}", _gains(results, name, "no-sync"))
        yield _against(name, _simulated(results, name, synchronized=False))


def on_the_climb(results: Results, climb: float) -> Iterator[Finding]:
    """Yield the smallest gain up to the T at which the later curve has a share of its plateau."""
    for name, (_, worse) in BETTER.items():
        rows = results[f"example-4/{name}-sync"]
        later = wide(rows[rows["problem"] == worse], "threshold", "reliability")
        below = later.lt(climb * later.iloc[:, -1], axis=0)
        end = below.iloc[:, ::-1].idxmax(axis=1).min()
        gain = _gains(results, name, "sync").query("threshold <= @end")
        yield _smallest_gain(f"smallest gain of R up to T = {end:g} s, {name}", gain)
        simulated = _simulated(results, name, synchronized=True).query("threshold <= @end")
        yield _against(f"climb, {name}", simulated)


def on_the_plateau(results: Results) -> Iterator[Finding]:
    """Yield gains of V_q and k_d at the largest T."""
    for name in ("V_q", "k_d"):
        last = at_largest_threshold(_gains(results, name, "sync"))
        T = last["threshold"].max()
        what = f"smallest gain of R over tau at T = {T:g} s, {name}"
        yield at_least(0.0, what, last["gain"].min())
        simulated = at_largest_threshold(_simulated(results, name, synchronized=True))
        yield _against(f"largest simulated T, {name}", simulated)


def delta_on_the_plateau(results: Results) -> Iterator[Finding]:
    """Yield gains of the smaller mean of delta at the largest T."""
    larger, smaller = BETTER["delta"]
    last = at_largest_threshold(gains(results["example-4/delta-sync"], smaller, larger))
    T = last["threshold"].max()
    yield _smallest_gain(f"smallest gain of R over tau at T = {T:g} s", last, 0.0)
    for row in gains(results["example-4/delta-plateau"], smaller, larger).itertuples():
        what = f"simulated gain of R at T = {row.threshold:g} s, tau = {row.tau:g} s"
        yield at_least(0.0, what, row.gain, uncertainty=2.0 * row.error)


def clearance_on_the_plateau(results: Results) -> Iterator[Finding]:
    """Yield gains of C_r at the largest T, as far as the scatter of the model lets us see."""
    scatter = results["example-4/C_r-sync-scatter"]
    # that of the two conditions is independent; the largest over the nudges counts
    one, other = (
        scatter[scatter["problem"] == problem].set_index(["threshold", "tau", "relative"])["pf_std"]
        for problem in BETTER["C_r"]
    )
    noise = np.hypot(one, other).groupby(["threshold", "tau"]).max().rename("noise")
    last = at_largest_threshold(_gains(results, "C_r", "sync"))
    for row in last.merge(noise, on=["threshold", "tau"]).itertuples():
        what = f"gain of R at T = {row.threshold:g} s, tau = {row.tau:g} s"
        remark = f"scatter of the model {row.noise:.1g} (one standard deviation)"
        yield at_least(0.0, what, row.gain, uncertainty=2.0 * row.noise, remark=remark)


def _gains(results: Results, name: str, part: str) -> pd.DataFrame:
    return gains(results[f"example-4/{name}-{part}"], *BETTER[name])


def _simulated(results: Results, name: str, *, synchronized: bool) -> pd.DataFrame:
    """Return simulated gains: of fixed missions, or of random ones with synchronization."""
    gain = _gains(results, name, "check")
    random = gain["missions"].str.startswith("binomial")
    return gain[(random == synchronized) & (np.isfinite(gain["tau"]) == synchronized)]


def _smallest_gain(what: str, found: pd.DataFrame, limit: float = -ROUNDING) -> Finding:
    gain = found["gain"]
    return at_least(limit, what, gain.min(), remark=f"largest {gain.max():.2g}")


def _against(what: str, found: pd.DataFrame) -> Finding:
    return contradictions(f"simulated points against it, {what}", found["gain"], found["error"])
