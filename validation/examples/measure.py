"""Errors of the paper's method, Eq. (49), against the references of its examples.

Without synchronization the method is FFNI with a saddlepoint approximation, with synchronization
FFNI with a Pearson distribution, each with the paper's numbers of nodes. Where a reference is a
simulation, two of its standard errors are taken off before an error is judged. Each case looks at
one part of the failure probabilities of one example.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import replace
from functools import partial

import numpy as np
import pandas as pd

from uqfold.methods.ffni_pearson import FFNIPearson
from uqfold.methods.ffni_saddlepoint import FFNISaddlepoint
from uqfold.methods.kriging import Kriging
from uqfold.problems import folding_wing, four_bar, series
from uqfold.problems.base import Problem
from uqfold.problems.reference import Reference
from uqfold.validation import Finding, Measurement, Points, Table, Work
from validation.methods.answers import answers, references

PROBLEMS: dict[str, Callable[[], Problem]] = {
    "series": series,
    "four_bar": four_bar,
    "four_bar_crossed": partial(four_bar, branch="crossed"),
    "folding_wing": folding_wing,
}
PARTS = {"body": (0.1, 1.0), "tail": (1e-6, 0.1)}
"""Failure probabilities above the first number, up to the second: what a reliability curve shows,
and what lies below."""
LARGEST = 0.1
"""Largest error that is called small."""
UNCERTAIN = 0.05
"""References with two standard errors above this share of pf judge nothing."""
MOST_POINTS = 150


def measure(work: Work) -> Measurement:
    """Measure all criteria of one part; the tiers do not differ."""
    problem = PROBLEMS[work.settings["problem"]]()
    low, high = PARTS[work.settings["part"]]
    of_part = [one for one in references(problem) if low < one.pf <= high]
    known = [one for one in of_part if 2.0 * one.std_error / one.pf < UNCERTAIN]
    left_out = len(of_part) - len(known)
    if work.fault == "wider inputs":
        problem = _with_wider_inputs(problem)
    if work.fault == "stale reference":
        known = _slipped(known)
    nodes = 2 if work.fault == "two nodes" else 5
    found, findings = [], []
    for synchronized, ffni in ((False, FFNISaddlepoint), (True, FFNIPearson)):
        of_kind = [one for one in known if (one.criterion.tau is not None) == synchronized]
        if not of_kind:
            continue
        method = Kriging() if work.fault == "kriging" else ffni(nodes_individual=nodes, check=False)
        rows = answers(method, problem, of_kind).assign(synchronization=synchronized)
        found.append(rows)
        uncertainty = 2.0 * rows["known_error"] / rows["known"]
        judged = (rows["error"].abs() - uncertainty).clip(lower=0.0)
        kind = "with" if synchronized else "without"
        findings += [
            Finding(f"criteria {kind} synchronization", len(rows)),
            Finding(f"model runs {kind} synchronization", rows["n_evals"].iloc[0]),
            Finding(f"largest error {kind} synchronization", judged.max(), LARGEST),
            Finding(f"median error {kind} synchronization", judged.median()),
        ]
    findings.append(Finding("criteria left out, their reference being too uncertain", left_out))
    rows = pd.concat(found).assign(percent=lambda rows: 100.0 * rows["error"])
    return Measurement(findings, [_decades(rows)], [_points(rows)])


def _decades(rows: pd.DataFrame) -> Table:
    """Return signed errors by decade of pf."""
    decades = rows.assign(decade=10.0 ** np.ceil(np.log10(rows["known"])))
    decades = decades.sort_values(["synchronization", "decade"], ascending=[True, False])
    groups = decades.groupby(["synchronization", "decade"], sort=False)["percent"]
    table = groups.agg(["size", "min", "median", "max"]).reset_index()
    table.columns = pd.Index(
        ["synchronization", "pf up to", "criteria", "smallest error (%)", "median error (%)",
         "largest error (%)"]
    )  # fmt: skip
    return Table.of("Relative error of pf, signed, by decade of pf", table)


def _points(rows: pd.DataFrame) -> Points:
    shown = pd.concat([_thinned(own) for _, own in rows.groupby("synchronization")])
    named = shown["synchronization"].map({False: "ffni-spa", True: "ffni-pearson"})
    errors = pd.DataFrame({"series": named, "x": shown["known"], "y": shown["percent"]})
    title = "Relative error of pf, signed, against the reference's pf"
    return Points(
        title,
        "reference pf",
        "relative error (%)",
        Table.of(title, errors),
        log="x",
        limits={"limit": 100.0 * LARGEST, "-limit": -100.0 * LARGEST},
    )


def _thinned(rows: pd.DataFrame) -> pd.DataFrame:
    """Leave out points that others hide: the extreme errors stay."""
    ordered = rows.sort_values("error", kind="stable")
    step = max(1, math.ceil(len(ordered) / MOST_POINTS))
    shown = [ordered[:3], ordered[3:-3:step], ordered[-3:]]
    return ordered if step == 1 else pd.concat(shown)


def _slipped(known: Sequence[Reference]) -> list[Reference]:
    """Return the answers one criterion late, as a table has them that slipped by a row."""
    after = [*known[1:], known[0]]
    return [
        replace(other, criterion=one.criterion) for one, other in zip(known, after, strict=True)
    ]


def _with_wider_inputs(problem: Problem) -> Problem:
    inputs = problem.inputs
    spread = dict(zip(inputs.names, inputs.standard_deviations, strict=True))
    return problem.with_moments(
        standard_deviations={name: 1.25 * float(spread[name]) for name in inputs.individual_names}
    )
