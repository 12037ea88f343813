"""Errors of the paper's method, Eq. (49), against the references of its examples.

Without synchronization the method is FFNI with a saddlepoint approximation, with synchronization
FFNI with a Pearson distribution, each with the paper's numbers of nodes. Where a reference is a
simulation, two of its standard errors are taken off before an error is judged. Each case looks at
one part of the failure probabilities of one example.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from functools import partial
from typing import Any

import numpy as np

from uqfold.methods.base import ReliabilityMethod
from uqfold.methods.ffni_pearson import FFNIPearson
from uqfold.methods.ffni_saddlepoint import FFNISaddlepoint
from uqfold.methods.kriging import Kriging
from uqfold.problems import folding_wing, four_bar, series
from uqfold.problems.base import Problem
from uqfold.problems.reference import Reference
from uqfold.validation import Finding, Measurement, Points, Table, Work

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
    of_part = [one for one in problem.references or () if low < one.pf <= high]
    known = [one for one in of_part if _uncertainty(one) < UNCERTAIN]
    left_out = len(of_part) - len(known)
    if work.fault == "wider inputs":
        problem = _with_wider_inputs(problem)
    if work.fault == "stale reference":
        known = _shifted(known)
    nodes = 2 if work.fault == "two nodes" else 5
    methods: dict[bool, ReliabilityMethod] = {
        False: FFNISaddlepoint(nodes_individual=nodes),
        True: FFNIPearson(nodes_individual=nodes),
    }
    if work.fault == "kriging":
        methods = {False: Kriging(), True: Kriging()}
    rows: list[dict[str, Any]] = []
    findings = []
    for synchronized, method in methods.items():
        of_kind = [one for one in known if (one.criterion.tau is not None) == synchronized]
        if not of_kind:
            continue
        result = method.estimate(problem, [one.criterion for one in of_kind])
        found = [_row(one, answer.pf) for one, answer in zip(of_kind, result, strict=True)]
        rows += found
        kind = "with" if synchronized else "without"
        judged = [row["beyond the reference's"] for row in found]
        findings += [
            Finding(f"criteria {kind} synchronization", len(found)),
            Finding(f"model runs {kind} synchronization", result.n_evals),
            Finding(f"largest error {kind} synchronization", max(judged), LARGEST),
            Finding(f"median error {kind} synchronization", float(np.median(judged))),
        ]
    findings.append(Finding("criteria left out, their reference being too uncertain", left_out))
    return Measurement(findings, [_decades(rows)], [_points(rows)])


def _uncertainty(reference: Reference) -> float:
    return 2.0 * reference.std_error / reference.pf


def _row(reference: Reference, pf: float) -> dict[str, Any]:
    error = pf / reference.pf - 1.0
    return {
        "criterion": reference.criterion,
        "synchronized": reference.criterion.tau is not None,
        "reference": reference,
        "pf": pf,
        "error": error,
        "beyond the reference's": max(abs(error) - _uncertainty(reference), 0.0),
        "decade": math.ceil(math.log10(reference.pf)),
    }


def _decades(rows: Sequence[dict[str, Any]]) -> Table:
    """Signed errors by decade of pf."""
    groups: dict[tuple[bool, int], list[float]] = {}
    for row in sorted(rows, key=lambda row: (row["synchronized"], -row["decade"])):
        groups.setdefault((row["synchronized"], row["decade"]), []).append(100.0 * row["error"])
    table = [
        {
            "synchronization": synchronized,
            "pf up to": 10.0**decade,
            "criteria": len(errors),
            "smallest error (%)": min(errors),
            "median error (%)": float(np.median(errors)),
            "largest error (%)": max(errors),
        }
        for (synchronized, decade), errors in groups.items()
    ]
    return Table.of("Relative error of pf, signed, by decade of pf", table)


def _points(rows: Sequence[dict[str, Any]]) -> Points:
    errors = [
        {"series": method, "x": row["reference"].pf, "y": 100.0 * row["error"]}
        for synchronized, method in ((False, "ffni-spa"), (True, "ffni-pearson"))
        for row in _thinned([row for row in rows if row["synchronized"] == synchronized])
    ]
    title = "Relative error of pf, signed, against the reference's pf"
    return Points(
        title,
        "reference pf",
        "relative error (%)",
        Table.of(title, errors),
        log="x",
        limits={"limit": 100.0 * LARGEST, "-limit": -100.0 * LARGEST},
    )


def _thinned(rows: Sequence[dict[str, Any]]) -> Sequence[dict[str, Any]]:
    """Leave out points that others hide: the extreme errors stay."""
    ordered = sorted(rows, key=lambda row: float(row["error"]))
    step = max(1, math.ceil(len(ordered) / MOST_POINTS))
    return ordered if step == 1 else ordered[:3] + ordered[3:-3:step] + ordered[-3:]


def _shifted(references: Sequence[Reference]) -> list[Reference]:
    """Give every criterion the answer of the next one, as a table does that slipped by a row."""
    answers = [*references[1:], references[0]]
    return [
        Reference(one.criterion, other.pf, other.std_error)
        for one, other in zip(references, answers, strict=True)
    ]


def _with_wider_inputs(problem: Problem) -> Problem:
    inputs = problem.inputs
    spread = dict(zip(inputs.names, inputs.standard_deviations, strict=True))
    return problem.with_moments(
        standard_deviations={name: 1.25 * float(spread[name]) for name in inputs.individual_names}
    )
