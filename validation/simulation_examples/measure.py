"""The methods that sample, on the paper's examples, against the references of these."""

from __future__ import annotations

from dataclasses import replace
from functools import partial

import pandas as pd

from uqfold.methods import available
from uqfold.methods.ask_tell import SequentialMethod
from uqfold.problems.base import Problem
from uqfold.problems.criterion import criteria
from uqfold.validation import Finding, Measurement, Table, Work
from validation.methods.answers import EXAMPLES, answers, firm, references

STANDARD_ERRORS = 4.5
"""Largest difference in joint standard errors."""
ASKED = {
    "Example 1": criteria([-2.0, 1.0, 4.0], [None, 16.0], [1, 5]),
    "Example 2": criteria([100.0, 101.5, 103.0], [None, 4.0], [1, 5]),
    "Example 3": criteria([0.545, 0.555, 0.565], [None, 0.05], [1, 5]),
}


def samplers() -> list[str]:
    """Registered methods that sample the system itself."""
    built = {name: method() for name, method in available().items()}
    return [
        name
        for name, method in built.items()
        if method.stochastic and not isinstance(method, SequentialMethod)
    ]


def ask(example: str, name: str, budget: int, seed: int, fault: str | None) -> pd.DataFrame:
    """Ask one method about one example; return the answers that it does not doubt."""
    problem = EXAMPLES[example]()
    known = references(problem, list(ASKED[example]))
    if fault == "stale reference":
        known = [replace(one, pf=min(1.2 * one.pf, 1.0)) for one in known]
    if fault == "uncorrelated":
        inputs = problem.inputs
        problem = Problem(
            problem.model, inputs=inputs.distribution, names=inputs.names, units=problem.units
        )
    return firm(answers(available()[name](), problem, known, max_evals=budget, seed=seed))


def measure(work: Work) -> Measurement:
    """Sample with 200,000 to 20 million runs of a formula, 10,000 to 2 million of the wing."""
    cheap, wing = work.pick((200_000, 10_000), (20_000_000, 2_000_000))
    budgets = {"Example 1": cheap, "Example 2": cheap, "Example 3": wing}
    found = work.parts(
        {
            f"{example}, {name}": partial(ask, example, name, budget, work.seeds[0], work.fault)
            for example, budget in budgets.items()
            for name in samplers()
        }
    )
    findings = []
    for label, rows in found.items():
        what, largest = f"{label}: largest difference", rows["z"].abs().max()
        findings += [
            Finding(f"{label}: criteria answered without doubt", len(rows), 1, at_least=True),
            Finding(what, largest, STANDARD_ERRORS, "joint standard errors"),
        ]
    columns = {
        "threshold": "T", "tau": "tau", "missions": "missions", "pf": "pf",
        "std_error": "standard error", "known": "reference", "known_error": "its standard error",
        "z": "difference (joint standard errors)", "n_evals": "model runs",
    }  # fmt: skip
    rows = pd.concat(found, names=["example, method"]).reset_index("example, method")
    table = rows[["example, method", *columns]].rename(columns=columns)
    return Measurement(findings, [Table.of("Estimates and references", table)])
