"""Claims on the standard deviations of the inputs (Example 5)."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
import pandas as pd

from uqfold.validation import Finding
from validation.paper.claims import (
    NO_TAU,
    STANDARD_ERRORS,
    Results,
    advantage,
    claim,
    positive,
    table_of,
)

STUDY = "example-5"
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


@claim(
    "deviations",
    "Without synchronization, the smaller standard deviation of V_q, delta, b or k_d starts with "
    "the lower reliability and overtakes as T rises.",
    "Section 4.5, Table 9, Figs. 17(a), (c), (e), (g)",
    f"by the letter, for every m: R lower by more than {CLEAR:.0%} of itself first, higher at the "
    "largest T, one change of sign between; no clear simulated difference of the other sign",
)
def overtaking(results: Results) -> Iterator[Finding]:
    """Yield how the smaller deviation starts lower and overtakes."""
    yield from _overtaking(results, "no-sync", "missions", "m")


@claim(
    "deviations, pattern",
    "The difference of reliability over T always shows a trough, then a peak, and then settles, at "
    "every number of missions.",
    "Section 4.5, Figs. 17(a), (c), (e), (g)",
    f"by the letter, for every m: a trough and a peak of more than {CLEAR:.0%} of R (or of pf, "
    f"where that is smaller), in this order; at the largest T at most {SETTLED:.0%} of the peak",
)
def pattern(results: Results) -> Iterator[Finding]:
    """Yield trough, peak and settling of the difference."""
    for name in SMALLER:
        shapes = _shapes(results, name, "no-sync", "missions")
        yield Finding(
            f"relative depth of the trough, shallowest over m, {name}",
            shapes["lowest_relative"].max(),
            -CLEAR,
            remark=f"in R {shapes['trough'].max():.2g} to {shapes['trough'].min():.2g}",
        )
        yield Finding(
            f"relative height of the peak, lowest over m, {name}",
            shapes["highest_relative"].min(),
            CLEAR,
            at_least=True,
            remark=f"in R from {shapes['peak'].min():.2g}",
        )
        distance = (shapes["peak_at"] - shapes["trough_at"]).min()
        yield positive(f"smallest distance from trough to peak, {name}", distance, unit="s")
        settled = (shapes["last"].abs() / shapes["peak"]).max()
        yield Finding(f"largest final difference over its peak, {name}", settled, SETTLED)


@claim(
    "deviation of C_r",
    "Without synchronization, the curves of both standard deviations of C_r nearly coincide.",
    "Section 4.5, conditions 19 and 20, Fig. 17(i)",
    f"R of runs with the same random numbers differs by at most {COINCIDE:g}",
)
def clearance(results: Results) -> Iterator[Finding]:
    """Yield the largest difference of the two curves of C_r."""
    paired = _paired(results, "C_r-paired")
    worst = paired.loc[paired["difference"].abs().idxmax()]
    yield Finding(
        "largest difference of R in paired runs",
        float(abs(worst["difference"])),
        COINCIDE,
        uncertainty=2.0 * float(worst["std_error"]),
        remark=f"at T = {worst['threshold']:g} s, m = {worst['missions']}",
    )


@claim(
    "deviation of C_r, end",
    "At the right boundary of T the smaller standard deviation of C_r is the more reliable one.",
    "Section 4.5, conditions 19 and 20, Fig. 17(i)",
    "its lead in runs with the same random numbers is positive by more than two standard errors, "
    f"for every m, at T = {', '.join(f'{T:g}' for T in RIGHT)} s",
)
def clearance_at_the_end(results: Results) -> Iterator[Finding]:
    """Yield the lead of the smaller deviation of C_r near the right boundary of T."""
    for threshold in RIGHT:
        yield from _paired_gains(results, "C_r-paired", threshold, "missions")


@claim(
    "deviations, tau",
    "With synchronization and a random number of missions, the smaller standard deviation of V_q, "
    "delta, b or k_d starts lower and overtakes, for every tau, and stays higher at the right "
    "boundary of T.",
    "Section 4.5, Figs. 17(b), (d), (f), (h)",
    f"by the letter, for every tau: R lower by more than {CLEAR:.0%} of itself first, higher at "
    "the largest T, one change of sign between; no clear simulated difference of the other sign",
)
def overtaking_with_tau(results: Results) -> Iterator[Finding]:
    """Yield the same with synchronization, for every tau."""
    yield from _overtaking(results, "sync", "tau", "tau")


@claim(
    "deviations, visible",
    "Trough and peak of that difference can be seen, without and with synchronization (a stricter "
    "reading, ours).",
    "Section 4.5, Figs. 17(a) to 17(h)",
    f"for every m and tau a trough deeper and a peak higher than {VISIBLE:g}, which a figure of "
    "differences can show",
)
def visible(results: Results) -> Iterator[Finding]:
    """Yield the shallowest trough and the lowest peak, without and with synchronization."""
    for part, column, over in (("no-sync", "missions", "m"), ("sync", "tau", "tau")):
        for name in SMALLER:
            shapes = _shapes(results, name, part, column)
            trough, peak = shapes["trough"], shapes["peak"]
            yield Finding(
                f"shallowest trough over {over}, {name}, {part}",
                trough.max(),
                -VISIBLE,
                remark=f"deepest {trough.min():.2g}",
            )
            what = f"lowest peak over {over}, {name}, {part}"
            yield Finding(what, peak.min(), VISIBLE, at_least=True)


@claim(
    "deviation of C_r, tau",
    "The same is said of the standard deviation of C_r with synchronization.",
    "Section 4.5, conditions 19 and 20, Fig. 17(j)",
    f"in runs with the same random numbers, for every tau, its lag at T = {EARLY:g} s and its lead "
    f"at T = {LATE:g} s are positive by more than two standard errors",
)
def clearance_with_tau(results: Results) -> Iterator[Finding]:
    """Yield lag and lead of the smaller deviation of C_r with synchronization."""
    for threshold, sign in ((EARLY, -1.0), (LATE, 1.0)):
        yield from _paired_gains(results, "C_r-sync-paired", threshold, "tau", sign)


def _paired(results: Results, table: str) -> pd.DataFrame:
    frame = table_of(results, STUDY, table)
    first, second = CLEARANCE
    own = frame[(frame["problem"] == first) & (frame["other"] == second)]
    if own.empty:
        raise ValueError(f"{table} does not compare {first} with {second}")
    return own.round({"threshold": 9})


def _paired_gains(
    results: Results, table: str, threshold: float, by: str, sign: float = 1.0
) -> Iterator[Finding]:
    """Yield differences of paired runs with the sign that the text gives them."""
    paired = _paired(results, table)
    for row in paired[paired["threshold"] == threshold].to_dict("records"):
        where = f"m = {row['missions']}" if by == "missions" else f"tau = {row['tau']:g} s"
        yield positive(
            f"{'lead' if sign > 0.0 else 'lag'} of the smaller deviation at T = {threshold:g} s, "
            f"{where}",
            sign * row["difference"],
            uncertainty=2.0 * float(row["std_error"]),
        )


def _overtaking(results: Results, part: str, column: str, over: str) -> Iterator[Finding]:
    for name in SMALLER:
        shapes = _shapes(results, name, part, column)
        yield Finding(
            f"lowest relative difference of R, largest over {over}, {name}",
            shapes["lowest_relative"].max(),
            -CLEAR,
            remark=f"in R {shapes['trough'].max():.2g} at least",
        )
        what = f"difference of R at the largest T, smallest over {over}, {name}"
        yield positive(what, shapes["last"].min())
        what = f"most changes of sign on the way, {name}"
        yield Finding(what, float(shapes["crossings"].max()), 1.0)
        yield _other_sign(results, name, part)


def _shapes(results: Results, name: str, part: str, column: str) -> pd.DataFrame:
    """Describe the difference over T, one row per curve: trough, peak, changes of sign, end."""
    rows = []
    for _, own in _gains(results, name, part).groupby(column):
        gain, T = own["gain"].to_numpy(), own["threshold"].to_numpy()
        relative = own["relative"].to_numpy()
        sign = np.sign(gain[np.abs(relative) > CLEAR])
        rows.append(
            {
                "trough": gain.min(),
                "trough_at": T[gain.argmin()],
                "peak": gain.max(),
                "peak_at": T[gain.argmax()],
                "crossings": (np.diff(sign) != 0.0).sum(),
                "lowest_relative": relative.min(),
                "highest_relative": relative.max(),
                "last": gain[-1],
            }
        )
    return pd.DataFrame(rows)


def _gains(results: Results, name: str, part: str) -> pd.DataFrame:
    return advantage(table_of(results, STUDY, f"{name}-{part}"), *SMALLER[name])


def _other_sign(results: Results, name: str, part: str) -> Finding:
    """Count simulated differences that clearly have another sign than that of the curves."""
    curves, marks = _gains(results, name, part), _gains(results, name, "check")
    keys = ["threshold", "tau", "missions"]
    both = marks[marks["error"] > 0.0].merge(
        curves.round({"threshold": 9}), on=keys, suffixes=("", "_curve")
    )
    both = both[(both["tau"] != NO_TAU) == (part == "sync")]
    clear = both[both["gain"].abs() > STANDARD_ERRORS * both["error"]]
    against = (np.sign(clear["gain"]) != np.sign(clear["gain_curve"])).sum()
    return Finding(
        f"simulated differences of the other sign, {name}",
        float(against),
        0.0,
        remark=f"{len(clear)} of {len(both)} clear (over {STANDARD_ERRORS:g} standard errors)",
    )
