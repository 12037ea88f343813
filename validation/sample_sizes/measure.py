"""Model runs of the paper's method, counted outside the method."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from uqfold.methods.base import ReliabilityMethod
from uqfold.methods.ffni_pearson import FFNIPearson
from uqfold.methods.ffni_saddlepoint import FFNISaddlepoint
from uqfold.problems import folding_wing, folding_wing_random_lengths, four_bar, series
from uqfold.problems.base import Problem
from uqfold.problems.criterion import Criterion
from uqfold.testing.counting import RowCount
from uqfold.typing import FloatArray
from uqfold.validation import Finding, Measurement, Table, Work

STATED: dict[str, tuple[Callable[[], Problem], int]] = {
    "Example 1": (series, 75),
    "Example 2": (four_bar, 375),
    "Example 3": (folding_wing, 1_125),
    "Example 6": (folding_wing_random_lengths, 28_125),
}
"""Example -> problem, and the number of runs that the paper states."""


def runs(problem: Problem, method: ReliabilityMethod, criterion: Criterion, *, real: bool) -> int:
    """Count the rows that the model of a problem is given, or a cheap stand-in for it."""
    count, inputs = RowCount(), problem.inputs

    def model(x: FloatArray) -> FloatArray:
        count.add(x)
        if real:
            return np.asarray(problem.model(x))
        # as large and as scattered as the response needs to be; counts do not depend on it
        return np.asarray(((x - inputs.means) / inputs.standard_deviations).sum(axis=1))

    counted = Problem(
        model,
        inputs=inputs.distribution,
        shared=inputs.shared_names,
        names=inputs.names,
        units=problem.units,
    )
    method.estimate(counted, criterion)
    return count.rows


def measure(work: Work) -> Measurement:
    """Count both methods on all examples, with the real models in the full tier only."""
    individual = 4 if work.fault == "four nodes" else 5
    shared = 5 if work.fault == "five shared nodes" else 3
    methods = {
        "without": (FFNISaddlepoint(shared, individual, check=False), Criterion(1.0)),
        "with": (FFNIPearson(shared, individual, check=False), Criterion(1.0, 1.0)),
    }
    rows, findings = [], []
    for example, (problem, stated) in STATED.items():
        for kind, (method, criterion) in methods.items():
            counted = runs(problem(), method, criterion, real=work.tier == "full")
            rows.append(
                {
                    "example": example,
                    "synchronization": kind == "with",
                    "model runs": counted,
                    "in the paper": stated,
                }
            )
            what = f"{example}, {kind} synchronization: runs more or less than {stated:,}"
            findings.append(Finding(what, abs(counted - stated), 0))
    return Measurement(findings, [Table.of("Model runs", rows)])
