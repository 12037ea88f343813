"""Missions, the synchronization threshold tau, independent wings, and the range of T."""

from __future__ import annotations

from collections.abc import Iterator
from itertools import chain

import numpy as np
import pandas as pd

from uqfold.validation import Finding
from validation.paper.results import (
    IDENTITY,
    NO_SYNC,
    ROUNDING,
    STANDARD_ERRORS,
    SYNC,
    Results,
    at_largest_threshold,
    at_least,
    fixed_missions,
    identity,
    spread,
    steps,
    wide,
    widening,
)

EXAMPLE_3 = 0.57
"""T (s) from which tau governs in Example 3, as the text says."""


def missions(results: Results) -> Iterator[Finding]:
    """Yield rises of R with m, without and with synchronization, and of the references."""
    for name in chain(*NO_SYNC.values(), *SYNC.values()):
        rows = fixed_missions(results[name])
        fall = steps(rows, "missions")
        yield identity(f"largest rise of R as m grows, {name}", -np.nanmin(fall))
        known = rows[rows["reference_pf"].notna()]
        if known.empty:
            continue
        fall = steps(known, "missions", "reference_pf")
        error = wide(known, "missions", "reference_std_error").to_numpy()
        joint = np.hypot(error[:, :-1], error[:, 1:])
        against = (fall < -STANDARD_ERRORS * joint - ROUNDING).sum()
        remark = f"{IDENTITY}; {np.isfinite(fall).sum()} steps"
        yield Finding(f"references against it, {name}", against, 0.0, remark=remark)


def random_missions(results: Results) -> Iterator[Finding]:
    """Yield rises of R with N_t and p_m, and how the curves close up as tau grows."""
    for what, table, column in (
        ("N_t", "planned", "missions_planned"),
        ("p_m", "flown", "missions_p"),
    ):
        rows = results[f"example-3/{table}"]
        # what tells the profiles apart takes the place of their text
        rows = rows.assign(missions=rows[column])
        rise = -np.nanmin(steps(rows, "missions"))
        yield identity(f"largest rise of R as {what} grows", rise)
        yield widening(f"the spread over {what} at the largest T", rows)


def larger_tau(results: Results, late: float) -> Iterator[Finding]:
    """Yield falls of R with tau, and what the plateau of R(T) looks like."""
    for name in chain(*SYNC.values()):
        rows = results[name]
        fall = np.nanmax(steps(rows, "tau"))
        yield identity(f"largest fall of R as tau grows, {name}", fall)
        T = rows["threshold"]
        last_tenth = rows[T.max() - 0.1 * (T.max() - T.min()) <= T]
        change = spread(last_tenth, "threshold", "tau").max()
        yield Finding(f"largest change of R over the last tenth of T, {name}", change, late)
        plateau = at_largest_threshold(rows)["pf"].min()
        yield at_least(1e-6, f"smallest pf on the plateau, {name}", plateau)


def gain_of_tau(results: Results) -> Iterator[Finding]:
    """Yield how the gain per step of tau grows, at every condition of Example 4."""

    def growth(table: str) -> float:
        rows = at_largest_threshold(results[table])
        return float(np.diff(-steps(rows, "tau"), axis=1).max())

    for name in ("V_q", "delta", "b", "k_d", "C_r"):
        what = f"largest growth of the gain per step of tau, changed {name}"
        yield Finding(what, growth(f"example-4/{name}-sync"), 0.0)
    yield Finding(
        "the same where b or k_d scatters three times as much (conditions 16, 18)",
        max(growth(f"example-5/{name}-sync") for name in ("b", "k_d")),
        remark="beyond what the text says: far below the plateau of R = 1 gains still grow",
    )


def which_governs(results: Results, low: float, high: float) -> Iterator[Finding]:
    """Yield the range of R over tau by that over T, early and late."""
    rows = fixed_missions(results["example-3/sync"])

    def ratios(part: pd.DataFrame, at: float) -> pd.Series[float]:
        over_tau = spread(part[part["threshold"] == at], "tau", "missions")
        return over_tau / spread(part, "threshold", "missions")

    early, late = rows[rows["threshold"] <= low], rows[rows["threshold"] >= high]
    what = "range of R over tau by range over T"
    largest = ratios(early, early["threshold"].max()).max()
    yield Finding(f"{what}, up to T = {low:g} s, largest over m", largest, 1.0)
    smallest = ratios(late, late["threshold"].min()).min()
    yield at_least(1.0, f"{what}, from T = {high:g} s, smallest over m", smallest)
    yield widening("the spread over m at the largest T", rows)


def closing_gap(results: Results) -> Iterator[Finding]:
    """Yield how the final difference between two numbers of missions changes with tau."""
    rows = fixed_missions(results["example-6/sync"])
    yield widening("the final difference between m = 2 and m = 5", rows)


def independence(results: Results, upper: float) -> Iterator[Finding]:
    """Yield the sign of the gap, and how it changes with T and n."""
    for study in ("example-3", "example-6"):
        gap = _over_units(results, study, "difference")
        what = f"smallest R less R of independent wings, {study}"
        yield at_least(-ROUNDING, what, gap.min(axis=None), remark=IDENTITY)
        largest_system = _over_units(results, study, "pf").iloc[:, -1]
        reliable = gap[1.0 - largest_system >= upper]
        peaks = gap.idxmax()
        what = f"largest growth of the gap from one T to the next where R >= {upper:g}, {study}"
        ours = "the limit on R is ours: below it the gap grows with T, up to T = "
        ours += f"{peaks.min():g} to {peaks.max():g} s"
        yield Finding(what, reliable.diff().max(axis=None), ROUNDING, remark=ours)
        by_letter = "what the text says, read by the letter: not so"
        growth = gap.diff().max(axis=None)
        yield Finding(f"the same over all T, {study}", growth, remark=by_letter)
        maxima = ", ".join(f"{round(value, 4):g} (n = {n})" for n, value in gap.max().items())
        what = f"largest shrinking of the gap from one n to the next, same range, {study}"
        shrinking = -reliable.diff(axis=1).min(axis=None)
        yield Finding(what, shrinking, ROUNDING, remark=f"largest gap {maxima}")


def dispersion(results: Results) -> Iterator[Finding]:
    """Yield the gaps of Example 6, whose shared inputs scatter more, over those of Example 3."""
    small, large = (
        _over_units(results, study, "difference").max() for study in ("example-3", "example-6")
    )
    for n, ratio in (large / small).dropna().items():
        what = f"largest gap of Example 6 over that of Example 3, n = {n}"
        yield at_least(1.0, what, ratio)


def _over_units(results: Results, study: str, values: str) -> pd.DataFrame:
    """Return R less R of independent wings, or pf, without synchronization: T by n."""
    rows = results[f"{study}/independence"]
    table = rows.pivot(index="threshold", columns="units", values=values)
    return table.sort_index(axis=1)


def stable_beyond(results: Results, mark: float, stable: float) -> Iterator[Finding]:
    """Yield the T from which the curves are stable: what the text says by the letter."""
    found = _stable_from(results, stable)
    yield Finding("T from which the curves are stable", found, mark, "s")


def onset(results: Results, mark: float, stable: float, close: float) -> Iterator[Finding]:
    """Yield where the curves become stable, and what was tried to mend it."""
    found = _stable_from(results, stable)
    what = f"distance from T = {mark:g} s of the T at which the curves become stable"
    here = f"here they are stable from T = {found:g} s"
    yield Finding(what, abs(found - mark), close, "s", remark=here)
    times = results["example-6/lock-scan"].pivot(
        index=["theta_1_initial", "x_lock"], columns="problem", values="time"
    )
    finite = times[np.isfinite(times).all(axis=1)]
    ratios = finite["wing"] / finite["example-3"]
    yield Finding(
        "largest ratio of the deployment times at the means of Tables 10 and 6",
        ratios.max(),
        remark=f"over {len(ratios)} initial poses and lock positions, which the text leaves "
        f"open; smallest {ratios.min():.3g}; the text's marks, {mark:g} s against "
        f"{EXAMPLE_3:g} s in Example 3, have the ratio {mark / EXAMPLE_3:.2g}",
    )


def _stable_from(results: Results, stable: float) -> float:
    """Return the T from which on R stays near its plateau."""
    curves = wide(fixed_missions(results["example-6/sync"]), "threshold")
    away = curves.sub(curves.iloc[:, -1], axis=0).abs().max() > stable
    later = away.index[away.index > away.index[away].max()]
    return round(float(later.min()), 6)
