"""Claims on Example 6 that are its own: the closing gap between missions, and the range of T."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from uqfold.comparison.claims.claim import PaperClaim, StudyResults
from uqfold.comparison.claims.curves import at_largest_threshold, fixed_missions, spread, wide
from uqfold.comparison.findings import Finding

if TYPE_CHECKING:
    import pandas as pd

STABLE_FROM = 0.47
"""T (s) from which the text calls the curves stable."""
EXAMPLE_3 = 0.57
"""T (s) from which tau governs in Example 3, as the text says."""
STABLE = 0.001
"""Distance of R from its plateau below which a curve is stable."""
CLOSE = 0.02
"""Distance of T (s) that still counts as the one in the text."""


def missions_close_up(results: StudyResults) -> list[Finding]:
    """The final difference between two numbers of missions shrinks as tau grows."""
    frame = fixed_missions(results["example-6"]["sync"])
    gaps = spread(at_largest_threshold(frame), "missions").groupby("tau").max().sort_index()
    return [
        Finding(
            "largest widening of the final difference between m = 2 and m = 5 as tau grows",
            float(gaps.diff().max()),
            0.0,
            remark=", ".join(f"{gap:.3g} at tau = {tau:g} s" for tau, gap in gaps.items()),
        )
    ]


def stable_beyond(results: StudyResults) -> list[Finding]:
    """Whether the curves are stable beyond the T of the text: what it says by the letter."""
    found = _stable_from(results)
    return [Finding("T from which the curves are stable", round(found, 6), STABLE_FROM, "s")]


def _stable_from(results: StudyResults) -> float:
    """Give the T from which on R stays near its plateau."""
    curves = 1.0 - wide(fixed_missions(results["example-6"]["sync"]), "threshold")
    away = (curves.sub(curves.iloc[:, -1], axis=0)).abs().max()
    last_away = away.index[away > STABLE].max()
    later = [T for T in away.index if last_away < T]
    return float(min(later)) if later else float("inf")


def stable_from(results: StudyResults) -> list[Finding]:
    """Where the curves become stable, against the T that the text names."""
    found = _stable_from(results)
    ratios = _ratios(results["example-6"]["lock-scan"])
    return [
        Finding(
            f"distance from T = {STABLE_FROM:g} s of the T at which the curves become stable",
            abs(found - STABLE_FROM),
            CLOSE,
            "s",
            remark=f"here they are stable from T = {found:g} s",
        ),
        Finding(
            "largest ratio of the deployment times at the means of Tables 10 and 6",
            float(ratios.max()),
            remark=f"over {len(ratios)} initial poses and lock positions, which the text leaves "
            f"open; smallest {ratios.min():.3g}; the text's marks, {STABLE_FROM:g} s against "
            f"{EXAMPLE_3:g} s in Example 3, have the ratio {STABLE_FROM / EXAMPLE_3:.2g}",
        ),
    ]


def _ratios(frame: pd.DataFrame) -> pd.Series[float]:
    """Give the time of Example 6 over that of Example 3, where both wings get to their lock."""
    times = frame.pivot(index=["theta_1_initial", "x_lock"], columns="problem", values="time")
    finite = times[np.isfinite(times).all(axis=1)]
    return finite["wing"] / finite["example-3"]


CLOSING = PaperClaim(
    "closing gap",
    "In Example 6 the final difference between two numbers of missions shrinks as tau grows.",
    "Section 4.6, Fig. 18(b)",
    "at the largest T the difference of R between m = 2 and m = 5 never grows with tau",
    {"example-6": ("sync",)},
    missions_close_up,
)
WINDOW = PaperClaim(
    "range of T",
    "In Example 6 the curves stay stable when T is greater than 0.47 s.",
    "Section 4.6, Fig. 18(b)",
    f"by the letter: R stays within {STABLE:g} of its plateau from {STABLE_FROM:g} s or earlier on",
    {"example-6": ("sync",)},
    stable_beyond,
)
ONSET = PaperClaim(
    "range of T, onset",
    "In Example 6 it is about T = 0.47 s that the curves become stable (a stricter reading, ours).",
    "Section 4.6, Fig. 18(b)",
    f"R stays within {STABLE:g} of its plateau from a T within {CLOSE:g} s of {STABLE_FROM:g} s",
    {"example-6": ("sync", "lock-scan")},
    stable_from,
)
