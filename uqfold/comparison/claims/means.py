"""Claims on the means of the inputs (Example 4)."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from uqfold.comparison.claims.claim import PaperClaim, StudyResults
from uqfold.comparison.claims.curves import (
    NO_TAU,
    ROUNDING,
    advantage,
    contradictions,
    of_problem,
)
from uqfold.comparison.claims.scatter import beyond_scatter, scatter_of_gain
from uqfold.comparison.findings import Finding

if TYPE_CHECKING:
    import pandas as pd

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


def means_without_tau(results: StudyResults) -> list[Finding]:
    """Without synchronization the better condition is better at every T and m."""
    findings = []
    for name, (better, worse) in BETTER.items():
        gains = _gains(results, f"{name}-no-sync", better, worse)
        findings += [
            Finding(
                f"smallest gain of R, {name}",
                float(gains["gain"].min()),
                -ROUNDING,
                at_least=True,
                remark=f"largest {gains['gain'].max():.2g}",
            ),
            contradictions(name, _simulated(results, name, better, worse, synchronized=False)),
        ]
    return findings


def means_on_the_climb(results: StudyResults) -> list[Finding]:
    """With synchronization the same order holds while the curves climb."""
    findings = []
    for name, (better, worse) in BETTER.items():
        frame = results["example-4"][f"{name}-sync"]
        gains = _gains(results, f"{name}-sync", better, worse)
        climbing = gains[gains["threshold"] <= _end_of_climb(of_problem(frame, worse))]
        findings.append(
            Finding(
                f"smallest gain of R up to T = {climbing['threshold'].max():g} s, {name}",
                float(climbing["gain"].min()),
                -ROUNDING,
                at_least=True,
                remark=f"largest {climbing['gain'].max():.2g}",
            )
        )
        simulated = _simulated(results, name, better, worse, synchronized=True)
        early = simulated["threshold"] <= climbing["threshold"].max()
        findings.append(contradictions(f"climb, {name}", simulated[early]))
    return findings


def means_on_the_plateau(results: StudyResults) -> list[Finding]:
    """On the plateau V_q and k_d keep their order."""
    findings = []
    for name in ("V_q", "k_d"):
        better, worse = BETTER[name]
        last = _last(_gains(results, f"{name}-sync", better, worse))
        findings += [
            Finding(
                f"smallest gain of R over tau at T = {last['threshold'].max():g} s, {name}",
                float(last["gain"].min()),
                0.0,
                at_least=True,
            ),
            contradictions(
                f"largest simulated T, {name}",
                _last(_simulated(results, name, better, worse, synchronized=True)),
            ),
        ]
    return findings


def delta_on_the_plateau(results: StudyResults) -> list[Finding]:
    """On the plateau the smaller mean of delta is the more reliable one."""
    larger, smaller = BETTER["delta"]
    last = _last(_gains(results, "delta-sync", smaller, larger))
    findings = [
        Finding(
            f"smallest gain of R over tau at T = {last['threshold'].max():g} s",
            float(last["gain"].min()),
            0.0,
            at_least=True,
            remark=f"largest {last['gain'].max():.2g}",
        )
    ]
    for row in _gains(results, "delta-plateau", smaller, larger).to_dict("records"):
        findings.append(
            Finding(
                f"simulated gain of R at T = {row['threshold']:g} s, tau = {row['tau']:g} s",
                float(row["gain"]),
                0.0,
                at_least=True,
                uncertainty=2.0 * float(row["error"]),
            )
        )
    return findings


def clearance_on_the_plateau(results: StudyResults) -> list[Finding]:
    """On the plateau C_r keeps its order, as far as the scatter of the model lets us see."""
    better, worse = BETTER["C_r"]
    scatter = results["example-4"]["C_r-sync-scatter"]
    last = _last(_gains(results, "C_r-sync", better, worse))
    findings = []
    for row in last[last["tau"].isin(scatter["tau"].unique())].to_dict("records"):
        noise = scatter_of_gain(scatter, better, worse, row["threshold"], row["tau"])
        what = f"gain of R at T = {row['threshold']:g} s, tau = {row['tau']:g} s"
        findings.append(beyond_scatter(what, float(row["gain"]), noise))
    return findings


def _last(gains: pd.DataFrame) -> pd.DataFrame:
    return gains[gains["threshold"] == gains["threshold"].max()]


def _gains(results: StudyResults, table: str, better: str, worse: str) -> pd.DataFrame:
    frame = results["example-4"][table]
    return advantage(of_problem(frame, better), of_problem(frame, worse))


def _simulated(
    results: StudyResults, name: str, better: str, worse: str, *, synchronized: bool
) -> pd.DataFrame:
    gains = _gains(results, f"{name}-check", better, worse)
    if synchronized:
        chosen = (gains["tau"] != NO_TAU) & gains["missions"].str.startswith("binomial")
    else:
        chosen = (gains["tau"] == NO_TAU) & gains["missions"].str.isdecimal()
    return gains[chosen]


def _end_of_climb(frame: pd.DataFrame) -> float:
    """Give the last T at which the curve is below `CLIMB` of its plateau, for every tau."""
    ends = []
    for _, own in frame.groupby("tau"):
        curve = own.sort_values("threshold")
        below = curve["reliability"] < CLIMB * curve["reliability"].iloc[-1]
        ends.append(float(curve.loc[below, "threshold"].max()))
    return float(np.min(ends))


_SYNC = tuple(f"{name}-{part}" for name in BETTER for part in ("sync", "check"))

MEANS = PaperClaim(
    "means",
    "Without synchronization, reliability is higher for a smaller mean of V_q or b and for a "
    "larger mean of delta, k_d or C_r.",
    "Section 4.4, Table 8, Figs. 16(a), (c), (e), (g), (i)",
    "the gain of R is never negative at any T and m; no simulated point lies more than three "
    "standard errors on the other side",
    {"example-4": tuple(f"{name}-{part}" for name in BETTER for part in ("no-sync", "check"))},
    means_without_tau,
)
MEANS_CLIMB = PaperClaim(
    "means, climb",
    "With synchronization and a random number of missions, the same order holds while the curves "
    "climb.",
    "Section 4.4, Figs. 16(b), (d), (f), (h), (j)",
    "the gain of R is never negative up to the T at which the later curve has half its plateau",
    {"example-4": _SYNC},
    means_on_the_climb,
)
MEANS_PLATEAU = PaperClaim(
    "means, plateau",
    "On the plateau the means of V_q and k_d keep that order.",
    "Section 4.4, Figs. 16(b), (h)",
    "the gain of R at the largest T is positive for every tau; no simulated point lies more than "
    "three standard errors on the other side",
    {"example-4": tuple(f"{name}-{part}" for name in ("V_q", "k_d") for part in ("sync", "check"))},
    means_on_the_plateau,
)
DELTA_PLATEAU = PaperClaim(
    "means, plateau, delta",
    "On the plateau the smaller mean of delta is the more reliable one.",
    "Section 4.4, Fig. 16(d)",
    "the gain of R at the largest T is positive for every tau, and so is the simulated one, by "
    "more than two standard errors",
    {"example-4": ("delta-sync", "delta-plateau")},
    delta_on_the_plateau,
)
CLEARANCE_PLATEAU = PaperClaim(
    "means, plateau, C_r",
    "On the plateau the larger mean of C_r stays the more reliable one.",
    "Section 4.4, Fig. 16(j)",
    "the gain of R at the largest T exceeds twice the scatter of the model (same nodes, clearances "
    "nudged by up to 1e-2)",
    {"example-4": ("C_r-sync", "C_r-sync-scatter")},
    clearance_on_the_plateau,
)
