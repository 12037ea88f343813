"""What the paper's method saves over Monte Carlo at the error that it makes.

Monte Carlo reaches a relative standard error e with (1 - pf) / (pf e^2) systems. The error asked of
it is that of the paper's method itself, at least 1 %, and at least two standard errors of the
reference.
"""

from __future__ import annotations

import time
from collections.abc import Callable
from typing import Any

from uqfold.methods.base import ReliabilityMethod
from uqfold.methods.ffni_pearson import FFNIPearson
from uqfold.methods.ffni_saddlepoint import FFNISaddlepoint
from uqfold.methods.monte_carlo import MonteCarlo
from uqfold.problems import folding_wing, four_bar, series
from uqfold.problems.base import Problem
from uqfold.problems.criterion import Criterion
from uqfold.problems.reference import Reference
from uqfold.validation import Finding, Measurement, Table, Work

EXAMPLES: dict[str, Callable[[], Problem]] = {
    "Example 1": series,
    "Example 2": four_bar,
    "Example 3": folding_wing,
}
LEVELS = (0.1, 0.01, 0.001)
"""Failure probabilities at which methods are compared; the nearest reference is taken."""

FEWEST = 100.0
"""Smallest ratio of model runs that is judged."""

SMALLEST_ERROR = 0.01


def nearest(references: list[Reference], pf: float, *, synchronized: bool) -> Reference:
    """Give the reference of one mission whose pf comes nearest, on a logarithmic scale."""
    kind = [
        one
        for one in references
        if (one.criterion.tau is not None) == synchronized and one.criterion.missions == 1
    ]
    return min(kind, key=lambda one: abs(one.pf / pf - 1.0) + abs(pf / max(one.pf, 1e-300) - 1.0))


def compare(example: str, pf: float, fault: str | None, *, synchronized: bool) -> dict[str, Any]:
    """Model runs of both methods for the same error."""
    problem = EXAMPLES[example]()
    assert problem.references is not None
    reference = nearest(list(problem.references), pf, synchronized=synchronized)
    nodes = 40 if fault == "forty nodes" else 5
    method: ReliabilityMethod = (FFNIPearson if synchronized else FFNISaddlepoint)(3, nodes)
    row = method.estimate(problem, reference.criterion)[0]
    own = abs(row.pf / reference.pf - 1.0)
    error = max(own, SMALLEST_ERROR, 2.0 * reference.std_error / reference.pf)
    systems = (1.0 - reference.pf) / (reference.pf * error**2)
    runs = systems * problem.n_units
    return {
        "example": example,
        "tau": reference.criterion.tau,
        "T": reference.criterion.threshold,
        "pf": reference.pf,
        "error of the paper's method (%)": 100.0 * own,
        "error asked of Monte Carlo (%)": 100.0 * error,
        "runs of the paper's method": row.n_evals,
        "runs of Monte Carlo": runs,
        "ratio": runs / row.n_evals,
    }


def seconds_ratio(runs: int) -> float:
    """Processor time of Monte Carlo over that of the paper's method on the wing, per model run."""
    problem, criterion = folding_wing(), Criterion(0.56)
    spent = []
    for method, budget in ((FFNISaddlepoint(), 1_125), (MonteCarlo(), runs)):
        start = time.process_time()
        n_evals = method.estimate(problem, criterion, max_evals=budget, rng=1).n_evals
        spent.append((time.process_time() - start) / n_evals)
    return spent[1] / spent[0]


def measure(work: Work) -> Measurement:
    """Compare at three failure probabilities; the tiers differ in how long speeds are measured."""
    cases = EXAMPLES
    if work.fault == "forty nodes":
        # the wing would run for minutes
        cases = {"Example 1": series}
    rows = [
        compare(example, pf, work.fault, synchronized=synchronized)
        for example in cases
        for synchronized in (False, True)
        for pf in LEVELS
        # with tau, pf levels off at its plateau
        if not synchronized or pf == LEVELS[0]
    ]
    per_run = seconds_ratio(work.pick(2_000, 10_000, 100_000))
    findings = [
        Finding(f"{example}: fewest runs of Monte Carlo for one of the paper's method",
                min(row["ratio"] for row in rows if row["example"] == example), FEWEST,
                at_least=True)
        for example in cases
    ]  # fmt: skip
    findings.append(
        Finding("seconds per run of Monte Carlo over those of the paper's method, wing", per_run,
                remark="with a model that costs something, runs are what counts")
    )  # fmt: skip
    return Measurement(findings, [Table.of("Model runs for the same error", rows)])
