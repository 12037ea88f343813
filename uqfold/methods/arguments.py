"""Checks of the arguments that every estimate takes, before any run is spent."""

from __future__ import annotations

from collections.abc import Iterable
from typing import TypeAlias

from uqfold.problems.base import Problem
from uqfold.problems.criterion import Criteria, Criterion

CriteriaLike: TypeAlias = Criteria | Criterion | Iterable[Criterion] | None


def checked_criteria(problem: Problem, criteria: CriteriaLike) -> Criteria:
    """Give the criteria as a grid; None stands for the problem's default criteria.

    Raises
    ------
    ValueError
        If there are none.
    TypeError
        If one of them is no `Criterion`.
    """
    if criteria is None:
        if problem.default_criteria is None:
            raise ValueError(
                f"no criteria given, and problem {problem.name!r} has no default ones: pass "
                "uqfold.criteria(threshold=...)"
            )
        return problem.default_criteria
    if isinstance(criteria, Criterion):
        return Criteria([criteria])
    return criteria if isinstance(criteria, Criteria) else Criteria(criteria)


def checked_budget(max_evals: int | None) -> int | None:
    """Give the budget as a whole number, or None for no budget.

    Raises
    ------
    ValueError
        If it is not a whole number >= 1.
    """
    if max_evals is None:
        return None
    if isinstance(max_evals, bool) or int(max_evals) != max_evals or max_evals < 1:
        raise ValueError(f"max_evals = {max_evals}: give a whole number >= 1, or None")
    return int(max_evals)
