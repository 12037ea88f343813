"""Accuracy and cost of the paper's methods."""

from __future__ import annotations

import math
from collections.abc import Iterator

import pandas as pd

from uqfold.validation import Finding
from validation.paper.results import NO_SYNC, SYNC, Results

RUNS = {"example-1": 75, "example-2": 375, "example-3": 1_125, "example-6": 28_125}
"""Evaluations of the paper's methods; those of Example 2 are lost in the text and follow from the
others, which are 3 nodes per shared times 5 per individual input."""
NAMED = {
    "example-1": ("1", "2", "5"),
    "example-2": ("1", "2", "5"),
    "example-3": ("2", "5", "8", "10"),
}
"""Numbers of missions that the text names; what we add is quoted, not judged."""
OUR_OWN = "crossed"
"""A problem that the paper does not have: the other branch of Example 2 is quoted, not judged."""
METHODS = ("ffni-spa", "ffni-pearson")


def agreement(results: Results, visible: float) -> Iterator[Finding]:
    """Yield the largest difference of R from the reference."""
    for label, rows, named in _compared(results):
        difference = (rows["pf"] - rows["reference_pf"]).abs()
        judged = rows.assign(value=difference, resolution=2.0 * rows["reference_std_error"])
        what = f"largest difference of R from the reference, {label}"
        yield _largest(what, judged, visible, named=named)


def errors(results: Results, small: float, seen: float) -> Iterator[Finding]:
    """Yield relative errors, where the paper's Monte Carlo could see them, and in the tail."""
    for label, every, named in _compared(results):
        resolution = 2.0 * every["reference_std_error"] / every["reference_pf"]
        rows = every.assign(value=every["error"], resolution=resolution)
        in_tail = rows["reference_pf"] < seen
        what = f"largest relative error where pf >= {seen:g}, {label}"
        yield _largest(what, rows[~in_tail], small, named=named)
        tail = rows[in_tail & (rows["value"] > rows["resolution"])]
        if not tail.empty:
            worst = tail.loc[tail["value"].idxmax()]
            what = f"largest relative error in the tail, pf < {seen:g}, {label}"
            remark = f"{_where(worst)}; beyond what the paper's Monte Carlo could judge"
            yield Finding(what, worst["value"], remark=remark)


def sample_sizes(results: Results) -> Iterator[Finding]:
    """Yield how far the counts are from those of the tables of sample sizes."""
    for study, runs in RUNS.items():
        rows = pd.concat([results[name] for name in NO_SYNC[study] + SYNC[study]])
        counts = rows.loc[rows["label"].isin(METHODS), "n_evals"].unique()
        what = f"largest distance from {runs:,} evaluations, {study}"
        remark = f"both methods: {', '.join(f'{count:.0f}' for count in sorted(counts))}"
        yield Finding(what, abs(counts - runs).max(), 0.0, remark=remark)


def _compared(results: Results) -> Iterator[tuple[str, pd.DataFrame, bool]]:
    """Yield rows of the paper's methods that have a reference, and whether the text names them.

    By study and problem, and apart for the numbers of missions that the text does not name.
    """
    for study, missions in NAMED.items():
        tables = [results[name] for name in NO_SYNC[study] + SYNC[study]]
        both = pd.concat(tables, ignore_index=True)
        known = both[both["label"].isin(METHODS) & both["reference_pf"].notna()]
        parts = known.assign(added=~known["missions"].isin(missions)).groupby(["problem", "added"])
        for (problem, added), rows in parts:
            words = f", {problem}" if known["problem"].nunique() > 1 else ""
            listed = ", ".join(sorted(rows["missions"].unique(), key=int))
            yield f"{study}{words}, m = {listed}", rows, not added and problem != OUR_OWN


def _largest(what: str, rows: pd.DataFrame, limit: float, *, named: bool) -> Finding:
    """Return the largest ``value``; what the text does not name is quoted without the limit."""
    worst = rows.loc[rows["value"].idxmax()]
    value, uncertainty = worst["value"], worst["resolution"]
    remark = f"{_where(worst)}; median {rows['value'].median():.2g}"
    if not named and value > limit:
        remark += f"; beyond {limit:g}, in a part that the text does not name"
    return Finding(what, value, limit if named else None, uncertainty=uncertainty, remark=remark)


def _where(row: pd.Series) -> str:
    tau = "" if math.isinf(row["tau"]) else f", tau = {row['tau']:g}"
    return (
        f"at T = {row['threshold']:g}{tau}, m = {row['missions']}, "
        f"reference pf {row['reference_pf']:.2g}"
    )
