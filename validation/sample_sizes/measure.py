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


class CountingModel:
    """The model of a problem, or a cheap stand-in, with a count of the rows that it was given."""

    def __init__(self, problem: Problem, *, real: bool) -> None:
        self.problem, self.real = problem, real
        self.count = RowCount()

    def __call__(self, x: FloatArray) -> FloatArray:
        """Give the responses (n,) of X (n, d)."""
        self.count.add(x)
        if self.real:
            return np.asarray(self.problem.model(x))
        # as large and as scattered as the response needs to be; counts do not depend on it
        inputs = self.problem.inputs
        return np.asarray(((x - inputs.means) / inputs.standard_deviations).sum(axis=1))

    def runs(self, method: ReliabilityMethod, criterion: Criterion) -> int:
        """Count the runs of an estimate."""
        inputs = self.problem.inputs
        counted = Problem(
            self,
            inputs=inputs.distribution,
            shared=inputs.shared_names,
            names=inputs.names,
            units=self.problem.units,
        )
        method.estimate(counted, criterion)
        return self.count.rows


def measure(work: Work) -> Measurement:
    """Count both methods on all examples, with the real models in the full tier only."""
    individual = 4 if work.fault == "four nodes" else 5
    shared = 5 if work.fault == "five shared nodes" else 3
    rows, findings = [], []
    for example, (problem, stated) in STATED.items():
        for method, tau in (
            (FFNISaddlepoint(shared, individual), None),
            (FFNIPearson(shared, individual), 1.0),
        ):
            counted = CountingModel(problem(), real=work.tier == "full").runs(
                method, Criterion(1.0, tau)
            )
            kind = "without" if tau is None else "with"
            rows.append(
                {
                    "example": example,
                    "synchronization": tau is not None,
                    "model runs": counted,
                    "in the paper": stated,
                }
            )
            findings.append(
                Finding(
                    f"{example}, {kind} synchronization: runs more or less than {stated:,}",
                    abs(counted - stated),
                    0,
                )
            )
    return Measurement(findings, [Table.of("Model runs", rows)])
