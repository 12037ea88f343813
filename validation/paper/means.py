"""Claims on the means of the inputs (Example 4)."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
import pandas as pd

from uqfold.validation import Finding
from validation.paper.claims import (
    NO_TAU,
    ROUNDING,
    Results,
    advantage,
    at_largest_threshold,
    claim,
    contradictions,
    of_problem,
    positive,
    table_of,
)

STUDY = "example-4"
BETTER = {
    "V_q": ("condition-1", "condition-2"),
    "delta": ("condition-3", "condition-4"),
    "b": ("condition-5", "condition-6"),
    "k_d": ("condition-7", "condition-8"),
    "C_r": ("condition-9", "condition-10"),
}
"""Input -> the condition that the text calls more reliable, and the other one."""
CLIMB = 0.5
"""Share of the plateau that the later of two curves has to reach for the climb to be over."""


@claim(
    "means",
    "Without synchronization, reliability is higher for a smaller mean of V_q or b and for a "
    "larger mean of delta, k_d or C_r.",
    "Section 4.4, Table 8, Figs. 16(a), (c), (e), (g), (i)",
    "the gain of R is never negative at any T and m; no simulated point lies more than three "
    "standard errors on the other side",
)
def without_tau(results: Results) -> Iterator[Finding]:
    """Yield the smallest gain of the better condition over all T and m."""
    for name in BETTER:
        yield _smallest_gain(f"smallest gain of R, {name}", _gains(results, name, "no-sync"))
        simulated = _gains(results, name, "check")
        chosen = (simulated["tau"] == NO_TAU) & simulated["missions"].str.isdecimal()
        yield contradictions(name, simulated[chosen])


@claim(
    "means, climb",
    "With synchronization and a random number of missions, the same order holds while the curves "
    "climb.",
    "Section 4.4, Figs. 16(b), (d), (f), (h), (j)",
    "the gain of R is never negative up to the T at which the later curve has half its plateau",
)
def on_the_climb(results: Results) -> Iterator[Finding]:
    """Yield the smallest gain while the curves climb."""
    for name, (_, worse) in BETTER.items():
        gains = _gains(results, name, "sync")
        end = _end_of_climb(of_problem(table_of(results, STUDY, f"{name}-sync"), worse))
        climbing = gains[gains["threshold"] <= end]
        last = climbing["threshold"].max()
        yield _smallest_gain(f"smallest gain of R up to T = {last:g} s, {name}", climbing)
        simulated = _simulated_with_tau(results, name)
        yield contradictions(f"climb, {name}", simulated[simulated["threshold"] <= last])


@claim(
    "means, plateau",
    "On the plateau the means of V_q and k_d keep that order.",
    "Section 4.4, Figs. 16(b), (h)",
    "the gain of R at the largest T is positive for every tau; no simulated point lies more than "
    "three standard errors on the other side",
)
def on_the_plateau(results: Results) -> Iterator[Finding]:
    """Yield gains of V_q and k_d on the plateau."""
    for name in ("V_q", "k_d"):
        last = at_largest_threshold(_gains(results, name, "sync"))
        T = last["threshold"].max()
        what = f"smallest gain of R over tau at T = {T:g} s, {name}"
        yield positive(what, last["gain"].min())
        simulated = at_largest_threshold(_simulated_with_tau(results, name))
        yield contradictions(f"largest simulated T, {name}", simulated)


@claim(
    "means, plateau, delta",
    "On the plateau the smaller mean of delta is the more reliable one.",
    "Section 4.4, Fig. 16(d)",
    "the gain of R at the largest T is positive for every tau, and so is the simulated one, by "
    "more than two standard errors",
)
def delta_on_the_plateau(results: Results) -> Iterator[Finding]:
    """Yield gains of the smaller mean of delta on the plateau."""
    last = at_largest_threshold(_gains(results, "delta", "sync", swapped=True))
    yield positive(
        f"smallest gain of R over tau at T = {last['threshold'].max():g} s",
        last["gain"].min(),
        remark=f"largest {last['gain'].max():.2g}",
    )
    for row in _gains(results, "delta", "plateau", swapped=True).to_dict("records"):
        yield positive(
            f"simulated gain of R at T = {row['threshold']:g} s, tau = {row['tau']:g} s",
            row["gain"],
            uncertainty=2.0 * float(row["error"]),
        )


@claim(
    "means, plateau, C_r",
    "On the plateau the larger mean of C_r stays the more reliable one.",
    "Section 4.4, Fig. 16(j)",
    "the gain of R at the largest T exceeds twice the scatter of the model (same nodes, clearances "
    "nudged by up to 1e-2)",
)
def clearance_on_the_plateau(results: Results) -> Iterator[Finding]:
    """Yield gains of C_r on the plateau, as far as the scatter of the model lets us see."""
    scatter = table_of(results, STUDY, "C_r-sync-scatter")
    last = at_largest_threshold(_gains(results, "C_r", "sync"))
    for row in last[last["tau"].isin(scatter["tau"].unique())].to_dict("records"):
        noise = _scatter_of_gain(scatter, row["threshold"], row["tau"])
        yield positive(
            f"gain of R at T = {row['threshold']:g} s, tau = {row['tau']:g} s",
            row["gain"],
            uncertainty=2.0 * noise,
            remark=f"scatter of the model {noise:.1g} (one standard deviation)",
        )


def _gains(results: Results, name: str, part: str, *, swapped: bool = False) -> pd.DataFrame:
    better, worse = BETTER[name][::-1] if swapped else BETTER[name]
    return advantage(table_of(results, STUDY, f"{name}-{part}"), better, worse)


def _simulated_with_tau(results: Results, name: str) -> pd.DataFrame:
    gains = _gains(results, name, "check")
    return gains[(gains["tau"] != NO_TAU) & gains["missions"].str.startswith("binomial")]


def _smallest_gain(what: str, gains: pd.DataFrame) -> Finding:
    largest = f"largest {gains['gain'].max():.2g}"
    return Finding(what, float(gains["gain"].min()), -ROUNDING, at_least=True, remark=largest)


def _end_of_climb(frame: pd.DataFrame) -> float:
    """Return the last T at which the curve is below `CLIMB` of its plateau, for every tau."""
    ends = []
    for _, own in frame.groupby("tau"):
        curve = own.sort_values("threshold")
        below = curve["reliability"] < CLIMB * curve["reliability"].iloc[-1]
        ends.append(float(curve.loc[below, "threshold"].max()))
    return min(ends)


def _scatter_of_gain(frame: pd.DataFrame, threshold: float, tau: float) -> float:
    """Return the standard deviation of a gain of R that comes from the model's own scatter.

    The scatter of the two conditions is independent; the largest over nudges and missions counts.
    """
    own = frame[(frame["tau"] == tau) & (frame["threshold"] == threshold)]
    one, other = (
        own[own["problem"] == problem].set_index(["relative", "missions"])["pf_std"]
        for problem in BETTER["C_r"]
    )
    return float(np.hypot(one, other[one.index]).max())
