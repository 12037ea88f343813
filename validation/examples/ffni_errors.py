"""Errors of the paper's method, Eq. (49), against the references of its examples.

Without synchronization the method is FFNI with a saddlepoint approximation, with synchronization
FFNI with a Pearson distribution, each with the paper's numbers of nodes. Where a reference is a
simulation, two of its standard errors are taken off before an error is judged.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from uqfold.comparison.findings import Finding
from uqfold.evidence import Axis, Figure, Measurement, Series, Table
from uqfold.evidence.work import Work
from uqfold.methods.base import ReliabilityMethod
from uqfold.methods.ffni_pearson import FFNIPearson
from uqfold.methods.ffni_saddlepoint import FFNISaddlepoint
from uqfold.methods.kriging import Kriging
from uqfold.problems.base import Problem
from uqfold.problems.reference import Reference

LARGEST = 0.1
"""Largest error that is called small."""

UNCERTAIN = 0.05
"""References with two standard errors above this share of pf judge nothing."""


@dataclass(frozen=True)
class Part:
    """A range of failure probabilities: above `low`, up to `high`."""

    low: float
    high: float

    def has(self, pf: float) -> bool:
        """Whether a failure probability belongs to it."""
        return self.low < pf <= self.high


BODY = Part(0.1, 1.0)
"""What a reliability curve shows."""

TAIL = Part(1e-6, 0.1)


def measure_errors(work: Work, problem: Problem, part: Part) -> Measurement:
    """Measure the errors of one example.

    Parameters
    ----------
    work
        The order; knows the faults ``two nodes``, ``stale reference`` and ``wider inputs``, and
        the remedy ``kriging``.
    problem
        The example, with its references.
    part
        The failure probabilities to look at.
    """
    asked = [
        one
        for one in problem.references or ()
        if part.has(one.pf) and _uncertainty(one) < UNCERTAIN
    ]
    left_out = sum(part.has(one.pf) for one in problem.references or ()) - len(asked)
    if work.fault == "wider inputs":
        problem = _with_wider_inputs(problem)
    known = _shifted(asked) if work.fault == "stale reference" else asked
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
        judged = [row["error beyond the reference's"] for row in found]
        findings += [
            Finding(f"criteria {kind} synchronization", len(found)),
            Finding(f"model runs {kind} synchronization", result.n_evals),
            Finding(f"largest error {kind} synchronization", max(judged), LARGEST),
            Finding(f"median error {kind} synchronization", float(np.median(judged))),
        ]
    findings.append(Finding("criteria left out, their reference being too uncertain", left_out))
    return Measurement.of(findings, [_decades(rows)], _figures(problem, rows))


def _uncertainty(reference: Reference) -> float:
    return 2.0 * reference.std_error / reference.pf


def _row(reference: Reference, pf: float) -> dict[str, Any]:
    criterion = reference.criterion
    error = pf / reference.pf - 1.0
    return {
        "T": criterion.threshold,
        "tau": criterion.tau,
        "missions": str(criterion.missions),
        "pf": pf,
        "reference": reference.pf,
        "two standard errors": 2.0 * reference.std_error,
        "error": error,
        "error beyond the reference's": max(abs(error) - _uncertainty(reference), 0.0),
    }


def _decades(rows: Sequence[dict[str, Any]]) -> Table:
    """Signed errors by decade of pf."""
    table = []
    for synchronized in (False, True):
        kind = [row for row in rows if (row["tau"] is not None) == synchronized]
        decades = sorted({math.ceil(math.log10(row["reference"])) for row in kind}, reverse=True)
        for decade in decades:
            errors = [
                row["error"] for row in kind if math.ceil(math.log10(row["reference"])) == decade
            ]
            table.append(
                {
                    "synchronization": synchronized,
                    "pf up to": 10.0**decade,
                    "criteria": len(errors),
                    "smallest error (%)": 100.0 * min(errors),
                    "median error (%)": 100.0 * float(np.median(errors)),
                    "largest error (%)": 100.0 * max(errors),
                }
            )
    return Table.of("decades", "Relative error of pf, signed, by decade of pf", table)


def _figures(problem: Problem, rows: Sequence[dict[str, Any]]) -> list[Figure]:
    errors = Figure(
        "errors",
        "Relative error of pf, signed, against the reference's pf",
        Axis("reference pf", scale="log"),
        Axis("relative error", "%"),
        tuple(
            Series(
                f"{method}, {kind} synchronization",
                tuple(row["reference"] for row in of_kind),
                tuple(100.0 * row["error"] for row in of_kind),
                style="points",
                method=method,
            )
            for kind, method in (("without", "ffni-spa"), ("with", "ffni-pearson"))
            if (of_kind := _thinned(rows, synchronized=kind == "with"))
        ),
        y_marks=(("limit", 100.0 * LARGEST), ("limit", -100.0 * LARGEST)),
    )
    curve = [row for row in rows if row["tau"] is None and row["missions"] == "1"]
    if not curve:
        return [errors]
    curve.sort(key=lambda row: float(row["T"]))
    x = tuple(row["T"] for row in curve)
    band = [(row["reference"], row["two standard errors"]) for row in curve]
    return [
        Figure(
            "curve",
            "Failure probability of the system in one mission, without synchronization",
            Axis("threshold T", problem.response_unit),
            Axis("failure probability", scale="log"),
            (
                Series(
                    "reference", x, tuple(pf for pf, _ in band),
                    tuple(pf - two for pf, two in band), tuple(pf + two for pf, two in band),
                    reference=True,
                ),
                Series("ffni-spa", x, tuple(row["pf"] for row in curve), style="points",
                       method="ffni-spa"),
            ),
        ),
        errors,
    ]  # fmt: skip


def _thinned(rows: Sequence[dict[str, Any]], *, synchronized: bool) -> list[dict[str, Any]]:
    """Leave out points of a figure that others hide: the extreme errors stay."""
    kind = [row for row in rows if (row["tau"] is not None) == synchronized]
    ordered, most = sorted(kind, key=lambda row: float(row["error"])), 150
    step = max(1, math.ceil(len(ordered) / most))
    return ordered[:3] + ordered[3:-3:step] + ordered[-3:] if len(ordered) > most else ordered


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
