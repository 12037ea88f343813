"""What the paper's method saves over Monte Carlo at the error that it makes.

Monte Carlo reaches a relative standard error e with (1 - pf) / (pf e^2) systems. The error asked of
it is that of the paper's method itself, at least 1 %, and at least two standard errors of the
reference.
"""

from __future__ import annotations

from typing import Any

from uqfold.methods.base import ReliabilityMethod
from uqfold.methods.ffni_pearson import FFNIPearson
from uqfold.methods.ffni_saddlepoint import FFNISaddlepoint
from uqfold.validation import Finding, Measurement, Table, Work
from validation.methods.answers import EXAMPLES, answers, references

LEVELS = (0.1, 0.01, 0.001)
"""Failure probabilities at which methods are compared; the nearest reference is taken."""
FEWEST = 100.0
"""Smallest ratio of model runs that is judged."""
SMALLEST_ERROR = 0.01


def compare(example: str, pf: float, nodes: int, *, synchronized: bool) -> dict[str, Any]:
    """Model runs of both methods for the same error."""
    problem = EXAMPLES[example]()
    known = min(
        (
            one
            for one in references(problem)
            if (one.criterion.tau is not None) == synchronized and one.criterion.missions == 1
        ),
        # the nearest on a logarithmic scale
        key=lambda one: abs(one.pf / pf - 1.0) + abs(pf / max(one.pf, 1e-300) - 1.0),
    )
    method: ReliabilityMethod = (FFNIPearson if synchronized else FFNISaddlepoint)(
        3, nodes, check=False
    )
    row = answers(method, problem, [known]).iloc[0]
    own = abs(row["error"])
    error = max(own, SMALLEST_ERROR, 2.0 * known.std_error / known.pf)
    runs = problem.n_units * (1.0 - known.pf) / (known.pf * error**2)
    return {
        "example": example,
        "tau": known.criterion.tau,
        "T": known.criterion.threshold,
        "pf": known.pf,
        "error of the paper's method (%)": 100.0 * own,
        "error asked of Monte Carlo (%)": 100.0 * error,
        "runs of the paper's method": row["n_evals"],
        "runs of Monte Carlo": runs,
        "ratio": runs / row["n_evals"],
    }


def measure(work: Work) -> Measurement:
    """Compare at three failure probabilities; the tiers do not differ."""
    examples, nodes = [*EXAMPLES], 5
    if work.fault == "forty nodes":
        # the wing would run for minutes
        examples, nodes = ["Example 1"], 40
    rows = [
        compare(example, pf, nodes, synchronized=synchronized)
        for example in examples
        for synchronized in (False, True)
        for pf in LEVELS
        # with tau, pf levels off at its plateau
        if not synchronized or pf == LEVELS[0]
    ]
    findings = [
        Finding(f"{example}: fewest runs of Monte Carlo for one of the paper's method",
                min(row["ratio"] for row in rows if row["example"] == example), FEWEST,
                at_least=True)
        for example in examples
    ]  # fmt: skip
    return Measurement(findings, [Table.of("Model runs for the same error", rows)])
