"""Answers of methods to questions whose answers are known, as frames: what most cases judge."""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np
import pandas as pd

from uqfold.methods.base import ReliabilityMethod
from uqfold.problems import folding_wing, four_bar, series
from uqfold.problems.base import Problem
from uqfold.problems.criterion import Criterion
from uqfold.problems.reference import Reference

EXAMPLES: dict[str, Callable[[], Problem]] = {
    "Example 1": series,
    "Example 2": four_bar,
    "Example 3": folding_wing,
}
"""The paper's examples that have references of their own."""


def references(problem: Problem, criteria: Sequence[Criterion] | None = None) -> list[Reference]:
    """Return the references of a problem, of all its criteria or of those given, each of which."""
    known = problem.references
    assert known is not None
    return list(known) if criteria is None else [known.entries[one] for one in criteria]


def answers(
    method: ReliabilityMethod,
    problem: Problem,
    known: Sequence[Reference],
    *,
    max_evals: int | None = None,
    seed: int | None = None,
) -> pd.DataFrame:
    """Ask a method about the criteria of references; return one row for each, as `against` does."""
    asked = [one.criterion for one in known]
    result = method.estimate(problem, asked, max_evals=max_evals, rng=seed)
    return against(result.to_frame(), known)


def against(found: pd.DataFrame, known: Sequence[Reference]) -> pd.DataFrame:
    """Return answers with the references of their criteria, in the same order.

    Parameters
    ----------
    found
        Columns ``pf`` and ``std_error``, and any others.
    known
        The references.

    Returns
    -------
    pandas.DataFrame
        In addition the columns ``criterion`` (in words), ``known``, ``known_error`` (the standard
        error of the reference), ``error`` (relative, signed), and ``z``: the difference in joint
        standard errors, NaN where the answer states none.
    """
    pf, std_error = found["pf"], found["std_error"]
    exact = np.array([one.pf for one in known])
    exact_error = np.array([one.std_error for one in known])
    joint = np.hypot(std_error.where(std_error > 0.0), exact_error)
    return found.assign(
        criterion=[str(one.criterion) for one in known],
        known=exact,
        known_error=exact_error,
        error=pf / exact - 1.0,
        z=(pf - exact) / joint,
    )


def firm(rows: pd.DataFrame) -> pd.DataFrame:
    """Return the rows with an answer that the method does not doubt itself."""
    return rows[rows["pf"].notna() & (rows["status"] != "doubtful")]


def rms(values: pd.Series) -> float:
    """Return the root mean square."""
    return float(np.sqrt(np.mean(values**2)))
