"""The methods that sample, on the paper's examples, against the references of these."""

from __future__ import annotations

import math
from collections.abc import Callable
from functools import partial
from typing import Any

import numpy as np

from uqfold.methods import available
from uqfold.methods.ask_tell import SequentialMethod
from uqfold.methods.result import NO_ANSWER
from uqfold.problems import folding_wing, four_bar, series
from uqfold.problems.base import Problem
from uqfold.problems.criterion import Criteria, criteria
from uqfold.validation import Finding, Measurement, Table, Work

STANDARD_ERRORS = 4.5
"""Largest difference in joint standard errors."""

Example = tuple[Callable[[], Problem], Criteria]
EXAMPLES: dict[str, Example] = {
    "Example 1": (series, criteria([-2.0, 1.0, 4.0], [None, 16.0], [1, 5])),
    "Example 2": (four_bar, criteria([100.0, 101.5, 103.0], [None, 4.0], [1, 5])),
    "Example 3": (folding_wing, criteria([0.545, 0.555, 0.565], [None, 0.05], [1, 5])),
}


def samplers() -> list[str]:
    """Registered methods that sample the system itself."""
    built = {name: method() for name, method in available().items()}
    return [
        name
        for name, method in built.items()
        if method.stochastic and not isinstance(method, SequentialMethod)
    ]


def answers(example: str, name: str, budget: int, seed: int, fault: str | None) -> Any:
    """Rows of one method on one example: criterion, pf and standard error, reference and its."""
    build, asked = EXAMPLES[example]
    problem = known = build()
    if fault == "uncorrelated":
        inputs = problem.inputs
        problem = Problem(
            problem.model, inputs=inputs.distribution, names=inputs.names, units=problem.units
        )
    result = available()[name]().estimate(problem, asked, max_evals=budget, rng=seed)
    rows = []
    references = known.references
    assert references is not None
    for criterion, row in zip(asked, result, strict=True):
        reference = references.lookup(criterion)
        if reference is None:
            raise ValueError(f"{example} has no reference for {criterion}")
        if row.status in NO_ANSWER or row.status == "doubtful":
            continue
        pf = 1.2 * reference.pf if fault == "stale reference" else reference.pf
        rows.append(
            {
                "example": example,
                "method": name,
                "T": criterion.threshold,
                "tau": criterion.tau,
                "missions": str(criterion.missions),
                "pf": row.pf,
                "standard error": row.std_error,
                "reference": pf,
                "its standard error": reference.std_error,
                "difference (joint standard errors)": (row.pf - pf)
                / math.hypot(row.std_error, reference.std_error),
                "model runs": row.n_evals,
            }
        )
    return rows


def measure(work: Work) -> Measurement:
    """Sample with 200,000 to 20 million runs of a formula, 10,000 to 2 million of the wing."""
    cheap, wing = work.pick((200_000, 10_000), (1_000_000, 100_000), (20_000_000, 2_000_000))
    found = work.parts(
        {
            f"{example}, {name}": partial(
                answers, example, name, wing if example == "Example 3" else cheap, work.seeds[0],
                work.fault,
            )
            for example in EXAMPLES
            for name in samplers()
        }
    )  # fmt: skip
    findings = []
    for label, rows in found.items():
        z = np.array([row["difference (joint standard errors)"] for row in rows])
        findings += [
            Finding(f"{label}: criteria answered without doubt", len(z), 1, at_least=True),
            Finding(
                f"{label}: largest difference",
                float(np.abs(z).max()) if len(z) else math.nan,
                STANDARD_ERRORS,
                "joint standard errors",
            ),
        ]
    rows = [row for part in found.values() for row in part]
    table = Table.of("Estimates and references", rows)
    return Measurement(findings, [table])
