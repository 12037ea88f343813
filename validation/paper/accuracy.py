"""Claims on accuracy and cost of the paper's methods."""

from __future__ import annotations

import math
from collections.abc import Iterator

import pandas as pd

from uqfold.validation import Finding
from validation.paper.claims import BOTH, Results, claim, table_of, tables_of

RUNS = {"example-1": 75, "example-2": 375, "example-3": 1_125, "example-6": 28_125}
"""Evaluations of the paper's methods; those of Example 2 are lost in the text and follow from the
others, which are 3 nodes per shared times 5 per individual input."""
OUR_OWN = "crossed"
"""A problem that the paper does not have: the other branch of Example 2 is quoted, not judged."""
METHODS = ("ffni-spa", "ffni-pearson")
VISIBLE = 0.02
"""Difference of reliability that a reader of a curve can see: a fiftieth of its axis."""
SMALL = 0.10
"""Relative error of pf that we call small; the text prints no number."""
SEEN = 3e-3
"""pf that the paper's Monte Carlo resolves to 3 % (m = 1) or 8 % (m = 10), one standard error, in
systems of four units. Its sample sizes are read as numbers of evaluations (deployments), as those
of the proposed methods beside them in the same tables are: 2,000,000 make 500,000 such systems."""
NAMED = {
    "example-1": ("1", "2", "5"),
    "example-2": ("1", "2", "5"),
    "example-3": ("2", "5", "8", "10"),
}
"""Numbers of missions that the text names; what we add is quoted, not judged."""


@claim(
    "agreement",
    "In Examples 1 to 3 the reliability curves of the proposed methods agree with Monte Carlo.",
    "Sections 4.1 to 4.3; Figs. 12(a) to 12(c), 14(a) to 14(c), 15(a), 15(b); conclusion 1",
    f"R differs from the reference by at most {VISIBLE:g}, what can be seen in a curve (the limit "
    "is ours), at the numbers of missions that the text names; others are quoted",
)
def agreement(results: Results) -> Iterator[Finding]:
    """Yield the largest difference of R from the reference."""
    for label, frame, ours in _compared(results):
        gap = (frame["pf"] - frame["reference_pf"]).abs()
        worst = frame.loc[gap.idxmax()]
        yield Finding(
            f"largest difference of R from the reference, {label}",
            float(gap.max()),
            None if ours else VISIBLE,
            uncertainty=2.0 * float(worst["reference_std_error"]),
            remark=_where(worst) + _beyond(float(gap.max()), VISIBLE, ours=ours),
        )


@claim(
    "errors",
    "The relative error of the failure probability, Eq. (49), is small in Examples 1 to 3.",
    "Sections 4.1 to 4.3; Figs. 12(d), 12(e), 14(d), 14(e), 15(f), 15(g)",
    f"error at most {SMALL:.0%} wherever pf >= {SEEN:g}, which the paper's Monte Carlo resolves to "
    "3 to 8 % if its sample sizes are numbers of evaluations, like those beside them; at the "
    "numbers of missions that the text names; the text prints no error, both limits are ours",
)
def errors(results: Results) -> Iterator[Finding]:
    """Yield relative errors, where the paper's Monte Carlo could see them, and in the tail."""
    for label, frame, ours in _compared(results):
        resolution = 2.0 * frame["reference_std_error"] / frame["reference_pf"]
        seen = frame[frame["reference_pf"] >= SEEN]
        worst = seen.loc[seen["error"].idxmax()]
        yield Finding(
            f"largest relative error where pf >= {SEEN:g}, {label}",
            float(worst["error"]),
            None if ours else SMALL,
            uncertainty=float(resolution[worst.name]),
            remark=f"{_where(worst)}; median {seen['error'].median():.2g}"
            + _beyond(float(worst["error"]), SMALL, ours=ours),
        )
        tail = frame[(frame["reference_pf"] < SEEN) & (frame["error"] > resolution)]
        if not tail.empty:
            worst = tail.loc[tail["error"].idxmax()]
            yield Finding(
                f"largest relative error in the tail, pf < {SEEN:g}, {label}",
                float(worst["error"]),
                remark=f"{_where(worst)}; beyond what the paper's Monte Carlo could judge",
            )


@claim(
    "sample sizes",
    "The methods take 75, 1,125 and 28,125 evaluations in Examples 1, 3 and 6 (and 375 in Example "
    "2, whose table is lost).",
    "Tables 3, 5, 7; section 4.6",
    "evaluations as counted outside the methods are exactly these",
)
def sample_sizes(results: Results) -> Iterator[Finding]:
    """Yield how far the counts are from those of the tables of sample sizes."""
    for study, runs in RUNS.items():
        counts: set[int] = set()
        for _, frame in tables_of(results, {study: BOTH[study]}):
            counts |= set(frame.loc[frame["label"].isin(METHODS), "n_evals"].astype(int))
        yield Finding(
            f"largest distance from {runs:,} evaluations, {study}",
            float(max(abs(count - runs) for count in counts)),
            0.0,
            remark=f"both methods: {', '.join(map(str, sorted(counts)))}",
        )


def _compared(results: Results) -> Iterator[tuple[str, pd.DataFrame, bool]]:
    """Yield rows of the paper's methods that have a reference, and whether they are our own.

    By study and problem, and apart for the numbers of missions that the text does not name.
    """
    for study, missions in NAMED.items():
        tables = [table_of(results, study, name) for name in BOTH[study]]
        both = pd.concat(tables, ignore_index=True)
        known = both[both["label"].isin(METHODS) & both["reference_pf"].notna()]
        problems = known["problem"].unique()
        for problem in problems:
            words = f", {problem}" if len(problems) > 1 else ""
            frame = known[known["problem"] == problem]
            named = frame["missions"].isin(missions)
            for part, add in ((frame[named], False), (frame[~named], True)):
                if not part.empty:
                    listed = ", ".join(sorted(part["missions"].unique(), key=int))
                    yield f"{study}{words}, m = {listed}", part, add or problem == OUR_OWN


def _beyond(value: float, limit: float, *, ours: bool) -> str:
    """Return words for a number that is only quoted and would break the limit."""
    if not ours or value <= limit:
        return ""
    return f"; beyond {limit:g}, in a part that the text does not name"


def _where(row: pd.Series) -> str:
    tau = "" if math.isnan(row["tau"]) else f", tau = {row['tau']:g}"
    return (
        f"at T = {row['threshold']:g}{tau}, m = {row['missions']}, "
        f"reference pf {row['reference_pf']:.2g}"
    )
