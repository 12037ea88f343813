"""Claims on the standard deviations of the inputs (Example 5)."""

from __future__ import annotations

from collections.abc import Hashable, Mapping
from typing import TYPE_CHECKING, Any

import numpy as np

from uqfold.comparison.claims.claim import PaperClaim, StudyResults
from uqfold.comparison.claims.curves import NO_TAU, STANDARD_ERRORS, advantage, of_problem
from uqfold.comparison.findings import Finding

if TYPE_CHECKING:
    import pandas as pd

SMALLER = {
    "V_q": ("condition-11", "condition-12"),
    "delta": ("condition-13", "condition-14"),
    "b": ("condition-15", "condition-16"),
    "k_d": ("condition-17", "condition-18"),
}
"""Input -> the condition with the smaller standard deviation, and the other one."""
CLEARANCE = ("condition-19", "condition-20")
SETTLED = 0.05
"""Share of the peak to which the difference has settled at the right boundary of T."""
COINCIDE = 0.01
"""Difference of reliability below which two curves nearly coincide."""
CLEAR = 0.01
"""Relative difference from which one condition is called better, however small R itself is: the
yardstick of what the text says by the letter, for lag, trough, peak and changes of sign alike."""
VISIBLE = 1e-3
"""Difference of R from which a figure of differences shows it: the yardstick of our stricter
reading, for trough and peak alike."""
RIGHT = (0.57, 0.585, 0.6)
"""Right boundary of T (s): the last mark that the text names, and on to the end of our range."""
EARLY, LATE = 0.54, 0.6
"""T (s) on the climb and on the plateau of curves with synchronization."""


def overtaking_without_tau(results: StudyResults) -> list[Finding]:
    """The smaller deviation starts lower and overtakes."""
    return _overtaking(results, "missions", synchronized=False)


def pattern_without_tau(results: StudyResults) -> list[Finding]:
    """The difference has a trough, then a peak, and settles."""
    findings = []
    for name, (smaller, larger) in SMALLER.items():
        shapes = _shapes(results["example-5"][f"{name}-no-sync"], smaller, larger, "missions")
        troughs = [shape["trough"] for shape in shapes]
        settled = max(abs(shape["last"]) / shape["peak"] for shape in shapes)
        findings += [
            Finding(
                f"relative depth of the trough, shallowest over m, {name}",
                max(shape["lowest_relative"] for shape in shapes),
                -CLEAR,
                remark=f"in R {max(troughs):.2g} to {min(troughs):.2g}",
            ),
            Finding(
                f"relative height of the peak, lowest over m, {name}",
                min(shape["highest_relative"] for shape in shapes),
                CLEAR,
                at_least=True,
                remark=f"in R from {min(shape['peak'] for shape in shapes):.2g}",
            ),
            Finding(
                f"smallest distance from trough to peak, {name}",
                min(shape["peak_at"] - shape["trough_at"] for shape in shapes),
                0.0,
                "s",
                at_least=True,
            ),
            Finding(f"largest final difference over its peak, {name}", settled, SETTLED),
        ]
    return findings


def visible_pattern(results: StudyResults) -> list[Finding]:
    """Trough and peak are large enough for a figure to show, without and with synchronization."""
    findings = []
    for part, column, over in (("no-sync", "missions", "m"), ("sync", "tau", "tau")):
        for name, (smaller, larger) in SMALLER.items():
            shapes = _shapes(results["example-5"][f"{name}-{part}"], smaller, larger, column)
            troughs = [shape["trough"] for shape in shapes]
            findings += [
                Finding(
                    f"shallowest trough over {over}, {name}, {part}",
                    max(troughs),
                    -VISIBLE,
                    remark=f"deepest {min(troughs):.2g}",
                ),
                Finding(
                    f"lowest peak over {over}, {name}, {part}",
                    min(shape["peak"] for shape in shapes),
                    VISIBLE,
                    at_least=True,
                ),
            ]
    return findings


def clearance_coincides(results: StudyResults) -> list[Finding]:
    """The curves of both standard deviations of C_r nearly coincide."""
    paired = _paired(results, "C_r-paired")
    worst = paired.loc[paired["difference"].abs().idxmax()]
    return [
        Finding(
            "largest difference of R in paired runs",
            float(abs(worst["difference"])),
            COINCIDE,
            uncertainty=2.0 * float(worst["std_error"]),
            remark=f"at T = {worst['threshold']:g} s, m = {worst['missions']}",
        )
    ]


def clearance_at_the_end(results: StudyResults) -> list[Finding]:
    """Near the right boundary of T the smaller deviation of C_r is the more reliable one."""
    paired = _paired(results, "C_r-paired")
    return [
        _paired_gain(row, f"m = {row['missions']}")
        for threshold in RIGHT
        for row in paired[paired["threshold"] == threshold].to_dict("records")
    ]


def overtaking_with_tau(results: StudyResults) -> list[Finding]:
    """With synchronization the smaller deviation starts lower and overtakes, for every tau."""
    return _overtaking(results, "tau", synchronized=True)


def clearance_with_tau(results: StudyResults) -> list[Finding]:
    """The same for the clearance, in paired runs."""
    paired = _paired(results, "C_r-sync-paired")
    return [
        _paired_gain(row, f"tau = {row['tau']:g} s", sign)
        for threshold, sign in ((EARLY, -1.0), (LATE, 1.0))
        for row in paired[paired["threshold"] == threshold].to_dict("records")
    ]


def _paired(results: StudyResults, table: str) -> pd.DataFrame:
    frame = results["example-5"][table]
    first, second = CLEARANCE
    own = frame[(frame["problem"] == first) & (frame["other"] == second)]
    if own.empty:
        raise ValueError(f"{table} does not compare {first} with {second}")
    return own.round({"threshold": 9})


def _paired_gain(row: Mapping[Hashable, Any], where: str, sign: float = 1.0) -> Finding:
    """Find whether a difference of paired runs has the sign that the text gives it."""
    words = "lead" if sign > 0.0 else "lag"
    return Finding(
        f"{words} of the smaller deviation at T = {row['threshold']:g} s, {where}",
        sign * float(row["difference"]),
        0.0,
        at_least=True,
        uncertainty=2.0 * float(row["std_error"]),
    )


def _overtaking(results: StudyResults, column: str, *, synchronized: bool) -> list[Finding]:
    part, over = ("sync", "tau") if synchronized else ("no-sync", "m")
    findings = []
    for name, (smaller, larger) in SMALLER.items():
        shapes = _shapes(results["example-5"][f"{name}-{part}"], smaller, larger, column)
        findings += [
            Finding(
                f"lowest relative difference of R, largest over {over}, {name}",
                max(shape["lowest_relative"] for shape in shapes),
                -CLEAR,
                remark=f"in R {max(shape['trough'] for shape in shapes):.2g} at least",
            ),
            Finding(
                f"difference of R at the largest T, smallest over {over}, {name}",
                min(shape["last"] for shape in shapes),
                0.0,
                at_least=True,
            ),
            Finding(
                f"most changes of sign on the way, {name}",
                max(shape["crossings"] for shape in shapes),
                1.0,
            ),
            _simulated(results, name, smaller, larger, synchronized=synchronized),
        ]
    return findings


def _shapes(frame: pd.DataFrame, smaller: str, larger: str, column: str) -> list[dict[str, float]]:
    """Describe the difference over T of every curve: trough, peak, changes of sign, last value."""
    shapes = []
    for _, own in _gains(frame, smaller, larger).groupby(column):
        gain, T = own["gain"].to_numpy(), own["threshold"].to_numpy()
        relative = own["relative"].to_numpy()
        sign = np.sign(gain[np.abs(relative) > CLEAR])
        shapes.append(
            {
                "trough": float(gain.min()),
                "trough_at": float(T[gain.argmin()]),
                "peak": float(gain.max()),
                "peak_at": float(T[gain.argmax()]),
                "crossings": float((np.diff(sign) != 0.0).sum()),
                "lowest_relative": float(relative.min()),
                "highest_relative": float(relative.max()),
                "last": float(gain[-1]),
            }
        )
    return shapes


def _gains(frame: pd.DataFrame, smaller: str, larger: str) -> pd.DataFrame:
    return advantage(of_problem(frame, smaller), of_problem(frame, larger))


def _simulated(
    results: StudyResults, name: str, smaller: str, larger: str, *, synchronized: bool
) -> Finding:
    """Count simulated differences that clearly have another sign than that of the curves."""
    part = "sync" if synchronized else "no-sync"
    curves = _gains(results["example-5"][f"{name}-{part}"], smaller, larger)
    marks = _gains(results["example-5"][f"{name}-check"], smaller, larger)
    keys = ["threshold", "tau", "missions"]
    both = marks[marks["error"] > 0.0].merge(
        curves.round({"threshold": 9}), on=keys, suffixes=("", "_curve")
    )
    both = both[(both["tau"] != NO_TAU) == synchronized]
    clear = both[both["gain"].abs() > STANDARD_ERRORS * both["error"]]
    against = int((np.sign(clear["gain"]) != np.sign(clear["gain_curve"])).sum())
    return Finding(
        f"simulated differences of the other sign, {name}",
        float(against),
        0.0,
        remark=f"{len(clear)} of {len(both)} clear (over {STANDARD_ERRORS:g} standard errors)",
    )


_NAMES = tuple(SMALLER)

DEVIATIONS = PaperClaim(
    "deviations",
    "Without synchronization, the smaller standard deviation of V_q, delta, b or k_d starts with "
    "the lower reliability and overtakes as T rises.",
    "Section 4.5, Table 9, Figs. 17(a), (c), (e), (g)",
    f"by the letter, for every m: R lower by more than {CLEAR:.0%} of itself first, higher at the "
    "largest T, one change of sign between; no clear simulated difference of the other sign",
    {"example-5": tuple(f"{name}-{part}" for name in _NAMES for part in ("no-sync", "check"))},
    overtaking_without_tau,
)
DEVIATION_PATTERN = PaperClaim(
    "deviations, pattern",
    "The difference of reliability over T always shows a trough, then a peak, and then settles, at "
    "every number of missions.",
    "Section 4.5, Figs. 17(a), (c), (e), (g)",
    f"by the letter, for every m: a trough and a peak of more than {CLEAR:.0%} of R (or of pf, "
    f"where that is smaller), in this order; at the largest T at most {SETTLED:.0%} of the peak",
    {"example-5": tuple(f"{name}-no-sync" for name in _NAMES)},
    pattern_without_tau,
)
CLEARANCE_COINCIDES = PaperClaim(
    "deviation of C_r",
    "Without synchronization, the curves of both standard deviations of C_r nearly coincide.",
    "Section 4.5, conditions 19 and 20, Fig. 17(i)",
    f"R of runs with the same random numbers differs by at most {COINCIDE:g}",
    {"example-5": ("C_r-paired",)},
    clearance_coincides,
)
CLEARANCE_AT_THE_END = PaperClaim(
    "deviation of C_r, end",
    "At the right boundary of T the smaller standard deviation of C_r is the more reliable one.",
    "Section 4.5, conditions 19 and 20, Fig. 17(i)",
    "its lead in runs with the same random numbers is positive by more than two standard errors, "
    f"for every m, at T = {', '.join(f'{T:g}' for T in RIGHT)} s",
    {"example-5": ("C_r-paired",)},
    clearance_at_the_end,
)
DEVIATIONS_TAU = PaperClaim(
    "deviations, tau",
    "With synchronization and a random number of missions, the smaller standard deviation of V_q, "
    "delta, b or k_d starts lower and overtakes, for every tau, and stays higher at the right "
    "boundary of T.",
    "Section 4.5, Figs. 17(b), (d), (f), (h)",
    f"by the letter, for every tau: R lower by more than {CLEAR:.0%} of itself first, higher at "
    "the largest T, one change of sign between; no clear simulated difference of the other sign",
    {"example-5": tuple(f"{name}-{part}" for name in _NAMES for part in ("sync", "check"))},
    overtaking_with_tau,
)
DEVIATIONS_VISIBLE = PaperClaim(
    "deviations, visible",
    "Trough and peak of that difference can be seen, without and with synchronization (a stricter "
    "reading, ours).",
    "Section 4.5, Figs. 17(a) to 17(h)",
    f"for every m and tau a trough deeper and a peak higher than {VISIBLE:g}, which a figure of "
    "differences can show",
    {"example-5": tuple(f"{name}-{part}" for name in _NAMES for part in ("no-sync", "sync"))},
    visible_pattern,
)
CLEARANCE_TAU = PaperClaim(
    "deviation of C_r, tau",
    "The same is said of the standard deviation of C_r with synchronization.",
    "Section 4.5, conditions 19 and 20, Fig. 17(j)",
    f"in runs with the same random numbers, for every tau, its lag at T = {EARLY:g} s and its lead "
    f"at T = {LATE:g} s are positive by more than two standard errors",
    {"example-5": ("C_r-sync-paired",)},
    clearance_with_tau,
)
