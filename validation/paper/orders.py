"""Claims on missions, on the synchronization threshold tau, and on independent wings."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
import pandas as pd

from uqfold.validation import Finding
from validation.paper.claims import (
    BOTH,
    IDENTITY,
    ROUNDING,
    STANDARD_ERRORS,
    SYNC,
    Results,
    at_largest_threshold,
    claim,
    fixed_missions,
    largest_fall,
    largest_rise,
    spread,
    table_of,
    tables_of,
    wide,
    widening,
)

INPUTS = ("V_q", "delta", "b", "k_d", "C_r")
LATE = 0.01
"""Change of R over the last tenth of T up to which a curve is called stable."""
T_LOW, T_HIGH = 0.545, 0.57
"""Marks of Example 3 (s)."""
UPPER = 0.9
"""Reliability of the largest system from which a curve is on its upper part: our restriction, the
text says it of all T."""


@claim(
    "missions",
    "The more missions, the lower the reliability, with and without synchronization.",
    "Sections 4.1 to 4.3 and 4.6; Figs. 12(b), 12(c), 14(b), 14(c), 15(a) to 15(c), 18(a), 18(b)",
    "R never rises with m at given T and tau, for the methods and for the references; an identity, "
    "since one more mission can only add failures: a breach would show an error, keeping it shows "
    "nothing",
)
def missions(results: Results) -> Iterator[Finding]:
    """Yield rises of R with m, without and with synchronization, and of the references."""
    for name, rows in tables_of(results, BOTH):
        frame = fixed_missions(rows)
        yield largest_rise(f"as m grows, {name}", frame, "missions")
        known = frame[frame["reference_pf"].notna()]
        if known.empty:
            continue
        pf = wide(known, "missions", "reference_pf").to_numpy()
        error = wide(known, "missions", "reference_std_error").to_numpy()
        rise = pf[:, :-1] - pf[:, 1:]
        joint = np.hypot(error[:, :-1], error[:, 1:])
        yield Finding(
            f"references against it, {name}",
            float(np.nansum(rise > STANDARD_ERRORS * joint + ROUNDING)),
            0.0,
            remark=f"{IDENTITY}; {int(np.isfinite(rise).sum())} steps",
        )


@claim(
    "random missions",
    "With a random number of missions, reliability falls with the number of planned flights and "
    "with the probability that each is flown; the curves lie closer the larger tau is.",
    "Section 4.3, Figs. 15(d) and 15(e)",
    "R never rises with N_t (p_m = 0.5) or with p_m (N_t = 10), which is an identity; at the "
    "largest T the spread of the curves never widens with tau, which is evidence",
)
def random_missions(results: Results) -> Iterator[Finding]:
    """Yield rises of R with N_t and p_m, and how the curves close up as tau grows."""
    for what, table, column in (
        ("N_t", "planned", "missions_planned"),
        ("p_m", "flown", "missions_p"),
    ):
        frame = table_of(results, "example-3", table)
        # what tells the profiles apart takes the place of their text
        rows = frame.assign(missions=frame[column])
        yield largest_rise(f"as {what} grows", rows, "missions")
        gaps = spread(at_largest_threshold(rows), "missions", "tau")
        yield widening(f"the spread over {what} at the largest T", gaps)


@claim(
    "tau",
    "With synchronization, reliability rises with tau, and over T it climbs to a plateau below 1.",
    "Sections 4.1 to 4.3 and 4.6; Figs. 12(c), 14(c), 15(b), 18(b)",
    f"R never falls with tau, which is an identity; it changes by at most {LATE:g} over the last "
    "tenth of T, and pf stays above 1e-6 there, which is evidence",
)
def larger_tau(results: Results) -> Iterator[Finding]:
    """Yield falls of R with tau, and what the plateau of R(T) looks like."""
    for name, frame in tables_of(results, SYNC):
        yield largest_fall(f"as tau grows, {name}", frame, "tau")
        curves = wide(frame, "threshold")
        T = curves.columns.to_numpy(dtype=float)
        late = curves.loc[:, T[-1] - 0.1 * (T[-1] - T[0]) <= T]
        yield Finding(
            f"largest change of R over the last tenth of T, {name}",
            float((late.max(axis=1) - late.min(axis=1)).max()),
            LATE,
        )
        plateau = float(curves.iloc[:, -1].min())
        yield Finding(f"smallest pf on the plateau, {name}", plateau, 1e-6, at_least=True)


@claim(
    "gain of tau",
    "As tau grows in equal steps, reliability gains less and less, at every condition.",
    "Section 4.4, Figs. 16(b), (d), (f), (h), (j)",
    "on the plateau (largest T) the second difference of R over tau is never positive",
)
def gain_of_tau(results: Results) -> Iterator[Finding]:
    """Yield how the gain per step of tau grows, at every condition of Example 4."""

    def growth(study: str, name: str) -> float:
        rows = at_largest_threshold(table_of(results, study, f"{name}-sync"))
        return float(np.diff(-wide(rows, "tau").to_numpy(), n=2, axis=1).max())

    for name in INPUTS:
        what = f"largest growth of the gain per step of tau, changed {name}"
        yield Finding(what, growth("example-4", name), 0.0)
    yield Finding(
        "the same where b or k_d scatters three times as much (conditions 16, 18)",
        max(growth("example-5", name) for name in ("b", "k_d")),
        remark="beyond what the text says: far below the plateau of R = 1 gains still grow",
    )


@claim(
    "T or tau",
    "In Example 3 the response threshold governs below 0.545 s and the synchronization threshold "
    "above 0.57 s; there the curves of different m lie closer for larger tau.",
    "Section 4.3, Figs. 15(b) and 15(c)",
    "R ranges less over tau (0.03 to 0.05 s) than over T below the first mark, more above the "
    "second; at the largest T the spread over m never widens with tau",
)
def which_governs(results: Results) -> Iterator[Finding]:
    """Yield the range of R over tau by that over T, early and late."""
    frame = fixed_missions(table_of(results, "example-3", "sync"))
    early, late = frame[frame["threshold"] <= T_LOW], frame[frame["threshold"] >= T_HIGH]
    for words, part, at, at_least in (
        (f"up to T = {T_LOW:g} s", early, early["threshold"].max(), False),
        (f"from T = {T_HIGH:g} s", late, late["threshold"].min(), True),
    ):
        by_tau = spread(part[part["threshold"] == at], "tau", "missions")
        ratios = by_tau / spread(part, "threshold", "missions")
        yield Finding(
            f"range of R over tau by range over T, {words}, "
            f"{'smallest' if at_least else 'largest'} over m",
            float(ratios.min() if at_least else ratios.max()),
            1.0,
            at_least=at_least,
        )
    gaps = spread(at_largest_threshold(frame), "missions", "tau")
    yield widening("the spread over m at the largest T", gaps)


@claim(
    "independence",
    "Taking the wings for independent is conservative; the gap shrinks as T rises, and grows with "
    f"the number of wings (judged where R >= {UPPER:g} only: our restriction).",
    "Section 4.3, Fig. 15(h); section 4.6, Fig. 18(c); conclusion 4",
    "R less R of independent wings is never negative, which is an identity (Jensen); where R of "
    f"the largest system is at least {UPPER:g}, it never grows from one T to the next and never "
    "shrinks from one n to the next; the text makes no such restriction, and without it "
    "the gap does grow",
)
def independence(results: Results) -> Iterator[Finding]:
    """Yield the sign of the gap, and how it changes with T and n."""
    for study in ("example-3", "example-6"):
        gap, reliability = _gap(results, study)
        yield Finding(
            f"smallest R less R of independent wings, {study}",
            float(gap.to_numpy().min()),
            -ROUNDING,
            at_least=True,
            remark=IDENTITY,
        )
        upper = gap[reliability.iloc[:, -1] >= UPPER]
        peaks = gap.idxmax()
        yield Finding(
            f"largest growth of the gap from one T to the next where R >= {UPPER:g}, {study}",
            float(upper.diff().iloc[1:].to_numpy().max()),
            ROUNDING,
            remark=f"the limit on R is ours: below it the gap grows with T, up to T = "
            f"{peaks.min():g} to {peaks.max():g} s",
        )
        yield Finding(
            f"the same over all T, {study}",
            float(gap.diff().iloc[1:].to_numpy().max()),
            remark="what the text says, read by the letter: not so",
        )
        maxima = ", ".join(f"{round(value, 4):g} (n = {n})" for n, value in gap.max().items())
        yield Finding(
            f"largest shrinking of the gap from one n to the next, same range, {study}",
            float(-upper.diff(axis=1).iloc[:, 1:].to_numpy().min()),
            ROUNDING,
            remark=f"largest gap {maxima}",
        )


@claim(
    "dispersion",
    "The more the shared inputs scatter, the larger the error of assuming independence.",
    "Section 4.6, Fig. 18(c); conclusion 4",
    "for every number of wings the largest gap of Example 6 exceeds that of Example 3",
)
def dispersion(results: Results) -> Iterator[Finding]:
    """Yield the gaps of Example 6, whose shared inputs scatter more, over those of Example 3."""
    small, large = (_gap(results, study)[0] for study in ("example-3", "example-6"))
    for n in small.columns.intersection(large.columns):
        yield Finding(
            f"largest gap of Example 6 over that of Example 3, n = {n}",
            float(large[n].max() / small[n].max()),
            1.0,
            at_least=True,
        )


def _gap(results: Results, study: str) -> tuple[pd.DataFrame, pd.DataFrame]:
    """Return gap and correlated reliability, T by n."""
    frame = table_of(results, study, "independence")
    own = frame[frame["tau"].isna()]
    gap = own.pivot(index="threshold", columns="units", values="difference").sort_index(axis=1)
    pf = own.pivot(index="threshold", columns="units", values="pf").sort_index(axis=1)
    return gap, 1.0 - pf
