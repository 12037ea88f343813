"""Claims on independent against correlated wings."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from uqfold.comparison.claims.claim import IDENTITY, PaperClaim, StudyResults
from uqfold.comparison.claims.curves import ROUNDING
from uqfold.comparison.findings import Finding

if TYPE_CHECKING:
    import pandas as pd

UPPER = 0.9
"""Reliability of the largest system from which a curve is on its upper part: our restriction, the
text says it of all T."""


def independence_is_conservative(results: StudyResults) -> list[Finding]:
    """R of independent wings is not larger; the gap shrinks with T and grows with n."""
    findings = []
    for study in ("example-3", "example-6"):
        gap, reliability = _tables(results[study]["independence"])
        findings.append(
            Finding(
                f"smallest R less R of independent wings, {study}",
                float(gap.to_numpy().min()),
                -ROUNDING,
                at_least=True,
                remark=IDENTITY,
            )
        )
        upper = gap[reliability.iloc[:, -1] >= UPPER]
        peaks = gap.idxmax()
        findings += [
            Finding(
                f"largest growth of the gap from one T to the next where R >= {UPPER:g}, {study}",
                float(upper.diff().iloc[1:].to_numpy().max()),
                ROUNDING,
                remark=f"the limit on R is ours: below it the gap grows with T, up to T = "
                f"{peaks.min():g} to {peaks.max():g} s",
            ),
            Finding(
                f"the same over all T, {study}",
                float(gap.diff().iloc[1:].to_numpy().max()),
                remark="what the text says, read by the letter: not so",
            ),
            Finding(
                f"largest shrinking of the gap from one n to the next, same range, {study}",
                float(-upper.diff(axis=1).iloc[:, 1:].to_numpy().min()),
                ROUNDING,
                remark=f"largest gap {_largest(gap)}",
            ),
        ]
    return findings


def more_dispersion_more_error(results: StudyResults) -> list[Finding]:
    """Example 6, whose shared inputs scatter more, has the larger gaps."""
    small, _ = _tables(results["example-3"]["independence"])
    large, _ = _tables(results["example-6"]["independence"])
    return [
        Finding(
            f"largest gap of Example 6 over that of Example 3, n = {n}",
            float(large[n].max() / small[n].max()),
            1.0,
            at_least=True,
        )
        for n in small.columns.intersection(large.columns)
    ]


def _tables(frame: pd.DataFrame) -> tuple[pd.DataFrame, pd.DataFrame]:
    """Give gap and correlated reliability, T by n."""
    own = frame[frame["tau"].isna()]
    gap = own.pivot(index="threshold", columns="units", values="difference").sort_index(axis=1)
    pf = own.pivot(index="threshold", columns="units", values="pf").sort_index(axis=1)
    return gap, 1.0 - pf


def _largest(gap: pd.DataFrame) -> str:
    maxima = gap.max()
    return ", ".join(f"{np.round(value, 4):g} (n = {n})" for n, value in maxima.items())


CONSERVATIVE = PaperClaim(
    "independence",
    "Taking the wings for independent is conservative; the gap shrinks as T rises, and grows with "
    f"the number of wings (judged where R >= {UPPER:g} only: our restriction).",
    "Section 4.3, Fig. 15(h); section 4.6, Fig. 18(c); conclusion 4",
    "R less R of independent wings is never negative, which is an identity (Jensen); where R of "
    f"the largest system is at least {UPPER:g}, it never grows from one T to the next and never "
    "shrinks from one n to the next; the text makes no such restriction, and without it "
    "the gap does grow",
    {"example-3": ("independence",), "example-6": ("independence",)},
    independence_is_conservative,
)
DISPERSION = PaperClaim(
    "dispersion",
    "The more the shared inputs scatter, the larger the error of assuming independence.",
    "Section 4.6, Fig. 18(c); conclusion 4",
    "for every number of wings the largest gap of Example 6 exceeds that of Example 3",
    {"example-3": ("independence",), "example-6": ("independence",)},
    more_dispersion_more_error,
)
