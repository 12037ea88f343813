"""Checks of the arguments that every estimate takes, before any run is spent."""

from __future__ import annotations

from collections.abc import Iterable
from numbers import Real
from typing import TypeAlias

from uqfold.checks import instance, or_none, real, refused, whole
from uqfold.evaluation import Evaluator
from uqfold.problems.base import Problem
from uqfold.problems.criterion import Criteria, Criterion

CriteriaLike: TypeAlias = Criteria | Criterion | Iterable[Criterion] | float | None


def checked_problem(problem: Problem) -> Problem:
    """Return the problem.

    Raises
    ------
    TypeError
        If it is not a `Problem`.
    """
    return instance("problem", problem, Problem, "give a Problem")


def checked_unit(problem: Problem) -> Problem:
    """Return a problem whose units share one model and its inputs, so that one unit tells of all.

    Raises
    ------
    TypeError, ValueError
        If it is not a `Problem`, or its units have models or inputs of their own.
    """
    if len(checked_problem(problem).kinds.models) > 1:
        raise refused("problem", problem, "give units of one model with the same inputs")
    return problem


def certain_under_tau(problem: Problem, criterion: Criterion) -> str | None:
    """Return why surfaces do not answer tau for units that differ, or None.

    A unit that shares all its inputs has a response given them, not a distribution.
    """
    if criterion.tau is None or problem.kinds.equal:
        return None
    if all(one.n_individual for one in problem.kinds.inputs):
        return None
    return "under tau units that differ need inputs of their own"


def without_own_inputs(problem: Problem, criterion: Criterion) -> str | None:
    """Return why few nodes of the shared inputs tell nothing of units that differ, or None."""
    if len(problem.kinds.models) > 1 and not all(one.n_individual for one in problem.kinds.inputs):
        return (
            "some units share all of their inputs: given these they fail or work for certain, and "
            "a sum over few nodes steps over where that changes"
        )
    return certain_under_tau(problem, criterion)


def without_gauss_rules(problem: Problem) -> str | None:
    """Return why integration by the rules of the inputs is impossible, or None."""
    for name in problem.kinds.with_atoms:
        if name not in problem.kinds.with_steps:
            return f"there is no Gauss rule for {name}, which is not continuous"
    return None


def checked_criteria(problem: Problem, criteria: CriteriaLike) -> Criteria:
    """Return the criteria as a grid; a number is a threshold, None the problem's default ones.

    Raises
    ------
    ValueError
        If there are none.
    TypeError
        If one of them is not a `Criterion`, or the problem is not a `Problem`.
    """
    checked_problem(problem)
    if criteria is None:
        if problem.default_criteria is None:
            raise ValueError(
                f"no criteria given, and problem {problem.name!r} has no default ones: pass "
                "uqfold.criteria(threshold=...)"
            )
        return problem.default_criteria
    if isinstance(criteria, float | Real):
        criteria = Criterion(real("criteria", criteria, finite=False, what="threshold or a grid"))
    if isinstance(criteria, Criterion):
        return Criteria([criteria])
    return criteria if isinstance(criteria, Criteria) else Criteria(criteria)


def checked_budget(max_evals: float | None) -> int | None:
    """Return the budget as a whole number, or None for no budget.

    Raises
    ------
    ValueError, TypeError
        If it is not a whole number >= 1.
    """
    return or_none("max_evals", max_evals, whole, at_least=1)


def checked_evaluator(evaluator: Evaluator | None) -> Evaluator:
    """Return the evaluator; None stands for one with default settings.

    Raises
    ------
    TypeError
        If it is not an `Evaluator`.
    """
    given = or_none("evaluator", evaluator, instance, Evaluator, "give uqfold.Evaluator(...)")
    return Evaluator() if given is None else given
