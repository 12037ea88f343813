"""Claims on the number of missions, fixed and random."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from uqfold.comparison.claims.claim import IDENTITY, PaperClaim, StudyResults
from uqfold.comparison.claims.curves import (
    BOTH,
    ROUNDING,
    STANDARD_ERRORS,
    at_largest_threshold,
    fixed_missions,
    never_rises,
    spread,
    wide,
)
from uqfold.comparison.findings import Finding

if TYPE_CHECKING:
    import pandas as pd


def more_missions_less_reliability(results: StudyResults) -> list[Finding]:
    """R falls as m rises, without and with synchronization; the references agree."""
    findings = []
    for study, tables in BOTH.items():
        for table in tables:
            frame = fixed_missions(results[study][table])
            findings.append(never_rises(f"as m grows, {study}/{table}", frame, "missions"))
            findings += _references_agree(f"{study}/{table}", frame)
    return findings


def _references_agree(what: str, frame: pd.DataFrame) -> list[Finding]:
    known = frame[frame["reference_pf"].notna()]
    if known.empty:
        return []
    pf = wide(known, "missions", "reference_pf").to_numpy()
    error = wide(known, "missions", "reference_std_error").to_numpy()
    rise = pf[:, :-1] - pf[:, 1:]
    joint = np.hypot(error[:, :-1], error[:, 1:])
    against = int(np.nansum(rise > STANDARD_ERRORS * joint + ROUNDING))
    return [
        Finding(
            f"references against it, {what}",
            float(against),
            0.0,
            remark=f"{IDENTITY}; {int(np.isfinite(rise).sum())} steps",
        )
    ]


def random_number_of_missions(results: StudyResults) -> list[Finding]:
    """R falls as N_t rises, falls as p_m rises, and the curves close up as tau grows."""
    planned, flown = results["example-3"]["planned"], results["example-3"]["flown"]
    findings = []
    for what, frame, column in (
        ("N_t", planned, "missions_planned"),
        ("p_m", flown, "missions_p"),
    ):
        # what tells the profiles apart takes the place of their text
        rows = frame.assign(missions=frame[column])
        findings.append(never_rises(f"as {what} grows", rows, "missions"))
        gaps = spread(at_largest_threshold(rows), "missions").groupby("tau").max().sort_index()
        findings.append(
            Finding(
                f"largest widening of the spread over {what} at the largest T as tau grows",
                float(gaps.diff().max()),
                0.0,
                remark=f"spread {gaps.iloc[0]:.3g} at tau = {gaps.index[0]:g} s, "
                f"{gaps.iloc[-1]:.3g} at {gaps.index[-1]:g} s",
            )
        )
    return findings


MORE_MISSIONS = PaperClaim(
    "missions",
    "The more missions, the lower the reliability, with and without synchronization.",
    "Sections 4.1 to 4.3 and 4.6; Figs. 12(b), 12(c), 14(b), 14(c), 15(a) to 15(c), 18(a), 18(b)",
    "R never rises with m at given T and tau, for the methods and for the references; an identity, "
    "since one more mission can only add failures: a breach would show an error, keeping it shows "
    "nothing",
    BOTH,
    more_missions_less_reliability,
)
RANDOM_MISSIONS = PaperClaim(
    "random missions",
    "With a random number of missions, reliability falls with the number of planned flights and "
    "with the probability that each is flown; the curves lie closer the larger tau is.",
    "Section 4.3, Figs. 15(d) and 15(e)",
    "R never rises with N_t (p_m = 0.5) or with p_m (N_t = 10), which is an identity; at the "
    "largest T the spread of the curves never widens with tau, which is evidence",
    {"example-3": ("planned", "flown")},
    random_number_of_missions,
)
