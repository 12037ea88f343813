"""Claims on the synchronization threshold tau, and on which of T and tau governs."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING

import numpy as np

from uqfold.comparison.claims.claim import PaperClaim, StudyResults
from uqfold.comparison.claims.curves import (
    SYNC,
    at_largest_threshold,
    fixed_missions,
    never_falls,
    spread,
    wide,
)
from uqfold.comparison.findings import Finding

if TYPE_CHECKING:
    import pandas as pd

INPUTS = ("V_q", "delta", "b", "k_d", "C_r")
LATE = 0.01
"""Change of R over the last tenth of T up to which a curve is called stable."""
T_LOW, T_HIGH = 0.545, 0.57
"""Marks of Example 3 (s)."""


def larger_tau_more_reliability(results: StudyResults) -> list[Finding]:
    """R rises with tau, and R(T) climbs to a plateau below 1."""
    findings = []
    for name, frame in _tables(results):
        findings.append(never_falls(f"as tau grows, {name}", frame, "tau"))
        curves = wide(frame, "threshold")
        T = curves.columns.to_numpy(dtype=float)
        late = curves.loc[:, T[-1] - 0.1 * (T[-1] - T[0]) <= T]
        findings.append(
            Finding(
                f"largest change of R over the last tenth of T, {name}",
                float((late.max(axis=1) - late.min(axis=1)).max()),
                LATE,
            )
        )
        findings.append(
            Finding(
                f"smallest pf on the plateau, {name}",
                float(curves.iloc[:, -1].min()),
                1e-6,
                at_least=True,
            )
        )
    return findings


def _tables(results: StudyResults) -> Iterator[tuple[str, pd.DataFrame]]:
    for study, tables in SYNC.items():
        for table in tables:
            yield f"{study}/{table}", results[study][table]


def gain_per_step_shrinks(results: StudyResults) -> list[Finding]:
    """Equal steps of tau gain less and less reliability, at every condition of Example 4."""
    findings = []
    for name in INPUTS:
        growth = _growth_of_gain(results["example-4"][f"{name}-sync"])
        findings.append(
            Finding(f"largest growth of the gain per step of tau, changed {name}", growth, 0.0)
        )
    wider = {name: _growth_of_gain(results["example-5"][f"{name}-sync"]) for name in ("b", "k_d")}
    findings.append(
        Finding(
            "the same where b or k_d scatters three times as much (conditions 16, 18)",
            max(wider.values()),
            remark="beyond what the text says: far below the plateau of R = 1 gains still grow",
        )
    )
    return findings


def _growth_of_gain(frame: pd.DataFrame) -> float:
    table = -wide(at_largest_threshold(frame), "tau").to_numpy()
    return float(np.diff(table, n=2, axis=1).max())


def which_threshold_governs(results: StudyResults) -> list[Finding]:
    """Example 3: T governs below 0.545 s, tau above 0.57 s; curves of m close up with tau."""
    frame = fixed_missions(results["example-3"]["sync"])
    early, late = frame[frame["threshold"] <= T_LOW], frame[frame["threshold"] >= T_HIGH]
    findings = []
    for words, part, at, at_least in (
        (f"up to T = {T_LOW:g} s", early, early["threshold"].max(), False),
        (f"from T = {T_HIGH:g} s", late, late["threshold"].min(), True),
    ):
        by_tau = spread(part[part["threshold"] == at], "tau").groupby("missions").max()
        by_T = spread(part, "threshold").groupby("missions").max()
        ratios = by_tau / by_T
        findings.append(
            Finding(
                f"range of R over tau by range over T, {words}, "
                f"{'smallest' if at_least else 'largest'} over m",
                float(ratios.min() if at_least else ratios.max()),
                1.0,
                at_least=at_least,
            )
        )
    gaps = spread(at_largest_threshold(frame), "missions").groupby("tau").max().sort_index()
    findings.append(
        Finding(
            "largest widening of the spread over m at the largest T as tau grows",
            float(gaps.diff().max()),
            0.0,
            remark=f"spread {gaps.iloc[0]:.3g} at tau = {gaps.index[0]:g} s, "
            f"{gaps.iloc[-1]:.3g} at {gaps.index[-1]:g} s",
        )
    )
    return findings


LARGER_TAU = PaperClaim(
    "tau",
    "With synchronization, reliability rises with tau, and over T it climbs to a plateau below 1.",
    "Sections 4.1 to 4.3 and 4.6; Figs. 12(c), 14(c), 15(b), 18(b)",
    f"R never falls with tau, which is an identity; it changes by at most {LATE:g} over the last "
    "tenth of T, and pf stays above 1e-6 there, which is evidence",
    SYNC,
    larger_tau_more_reliability,
)
GAIN_SHRINKS = PaperClaim(
    "gain of tau",
    "As tau grows in equal steps, reliability gains less and less, at every condition.",
    "Section 4.4, Figs. 16(b), (d), (f), (h), (j)",
    "on the plateau (largest T) the second difference of R over tau is never positive",
    {
        "example-4": tuple(f"{name}-sync" for name in INPUTS),
        "example-5": ("b-sync", "k_d-sync"),
    },
    gain_per_step_shrinks,
)
WHICH_GOVERNS = PaperClaim(
    "T or tau",
    "In Example 3 the response threshold governs below 0.545 s and the synchronization threshold "
    "above 0.57 s; there the curves of different m lie closer for larger tau.",
    "Section 4.3, Figs. 15(b) and 15(c)",
    "R ranges less over tau (0.03 to 0.05 s) than over T below the first mark, more above the "
    "second; at the largest T the spread over m never widens with tau",
    {"example-3": ("sync",)},
    which_threshold_governs,
)
