"""A comparison that has been asked for, checked before anything is run."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from typing import TypeAlias

from uqfold.checks import instance, listed, mapping, refused, several
from uqfold.evaluation import Evaluator
from uqfold.methods.arguments import (
    CriteriaLike,
    checked_budget,
    checked_criteria,
    checked_evaluator,
)
from uqfold.methods.base import ReliabilityMethod
from uqfold.methods.registry import available, named
from uqfold.methods.seeding import RandomSource, reduced_seed
from uqfold.problems.base import Problem
from uqfold.problems.criterion import Criteria

MethodLike: TypeAlias = str | ReliabilityMethod
Methods: TypeAlias = MethodLike | Iterable[MethodLike] | Mapping[str, MethodLike] | None


@dataclass(frozen=True)
class ComparisonPlan:
    """A checked question, made by `plan_comparison`; nothing has been run.

    Attributes
    ----------
    problem
        What may fail.
    methods
        Label -> method, in the order in which they run.
    criteria
        The grid that every method answers.
    max_evals
        Most evaluations that each method may spend, or None.
    seed
        Seed that every method gets.
    evaluator
        How the model is run.
    """

    problem: Problem
    methods: Mapping[str, ReliabilityMethod]
    criteria: Criteria
    max_evals: int | None
    seed: int
    evaluator: Evaluator


def plan_comparison(
    problem: Problem,
    methods: Methods = None,
    criteria: CriteriaLike = None,
    *,
    max_evals: int | None = None,
    rng: RandomSource = 0,
    evaluator: Evaluator | None = None,
) -> ComparisonPlan:
    """Check the arguments of a comparison, without running anything; see `compare` for them."""
    grid = checked_criteria(problem, criteria)
    return ComparisonPlan(
        problem=problem,
        methods=_labelled(methods),
        criteria=grid,
        max_evals=checked_budget(max_evals),
        seed=reduced_seed(rng),
        evaluator=checked_evaluator(evaluator),
    )


def _labelled(methods: Methods) -> dict[str, ReliabilityMethod]:
    if methods is None:
        methods = list(available())
    if isinstance(methods, Mapping):
        labelled = mapping("methods", methods, _built)
        if not all(label.strip() for label in labelled):
            raise refused("methods", list(labelled), "give labels that are not empty")
    else:
        built = (
            (_built("methods", methods),)
            if isinstance(methods, str | ReliabilityMethod)
            else several("methods", listed("methods", methods, what="list of methods"), _built)
        )
        names = [method.name for method in built]
        twice = [name for i, name in enumerate(names) if name in names[:i]]
        if twice:
            raise ValueError(
                f"methods: two are labelled {twice[0]!r}, give a dict of label -> method"
            )
        labelled = dict(zip(names, built, strict=True))
    if not labelled:
        raise refused("methods", methods, f"choose from {', '.join(available())}")
    return labelled


def _built(name: str, method: MethodLike) -> ReliabilityMethod:
    if isinstance(method, str):
        return named(name, method)
    if isinstance(method, type) and issubclass(method, ReliabilityMethod):
        remedy = f"it is a class, give an instance: {method.__name__}()"
        raise refused(name, method, remedy, TypeError)
    return instance(name, method, ReliabilityMethod, "give a name or a ReliabilityMethod")  # type: ignore[type-abstract]
