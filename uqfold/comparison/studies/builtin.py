"""The two tables that every study has: its problems, and their random inputs."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from uqfold.problems.base import Problem

PROBLEMS, INPUTS = "problems", "inputs"

BUILT_IN: dict[str, dict[str, type]] = {
    PROBLEMS: {
        "problem": str,
        "response": str,
        "response_unit": str,
        "units": int,
        "reference_kind": str,
        "reference_how": str,
        "reference_command": str,
    },
    INPUTS: {
        "problem": str,
        "input": str,
        "unit": str,
        "role": str,
        "distribution": str,
        "mean": float,
        "std": float,
    },
}
"""Name -> columns and their types."""


def problem_rows(problems: Mapping[str, Problem]) -> list[dict[str, Any]]:
    """Give the rows of the table of problems."""
    rows = []
    for name, problem in problems.items():
        known = problem.references
        rows.append(
            {
                "problem": name,
                "response": problem.response,
                "response_unit": problem.response_unit,
                "units": problem.n_units,
                "reference_kind": "" if known is None else known.kind,
                "reference_how": "" if known is None else known.how,
                "reference_command": "" if known is None else known.command,
            }
        )
    return rows


def input_rows(problems: Mapping[str, Problem]) -> list[dict[str, Any]]:
    """Give the rows of the table of inputs."""
    rows = []
    for name, problem in problems.items():
        inputs = problem.inputs
        for i, (marginal, unit) in enumerate(
            zip(inputs.marginals, problem.input_units, strict=True)
        ):
            rows.append(
                {
                    "problem": name,
                    "input": inputs.names[i],
                    "unit": unit,
                    "role": "shared" if i < inputs.n_shared else "individual",
                    "distribution": marginal.getImplementation().getClassName(),
                    "mean": marginal.getMean()[0],
                    "std": marginal.getStandardDeviation()[0],
                }
            )
    return rows
