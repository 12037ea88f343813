"""Run several methods on one problem and one grid of criteria."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import dataclass, field, replace
from types import MappingProxyType
from typing import TYPE_CHECKING, Any, TypeAlias

from uqfold.checks import (
    function,
    instance,
    keep,
    listed,
    mapping,
    or_none,
    refused,
    text,
    whole,
)
from uqfold.comparison.columns import comparison_row
from uqfold.evaluation import Evaluator
from uqfold.methods.arguments import (
    CriteriaLike,
    checked_budget,
    checked_criteria,
    checked_evaluator,
    checked_problem,
)
from uqfold.methods.base import ReliabilityMethod
from uqfold.methods.registry import available, named
from uqfold.methods.result import ReliabilityResult
from uqfold.methods.seeding import LARGEST_SEED, RandomSource, reduced_seed
from uqfold.problems.base import Problem
from uqfold.problems.criterion import Criteria

if TYPE_CHECKING:
    import pandas as pd

MethodLike: TypeAlias = str | ReliabilityMethod
Methods: TypeAlias = MethodLike | Iterable[MethodLike] | Mapping[str, MethodLike] | None
ComparisonProgress: TypeAlias = Callable[[str, int, int | None], None]
"""Called with (label, runs so far, runs expected or None), first as a method starts, with zero."""


@dataclass(frozen=True)
class ComparisonPlan:
    """A checked question: nothing in it can be refused any more, and nothing has been run.

    Attributes
    ----------
    problem
        What may fail.
    methods
        Label -> method, in the order in which they run.
    criteria
        The grid that every method answers.
    max_evals
        Most runs that each method may spend, or None.
    seed
        Seed that every method gets.
    evaluator
        How model runs are made.
    """

    problem: Problem
    methods: Mapping[str, ReliabilityMethod]
    criteria: Criteria
    max_evals: int | None = None
    seed: int = 0
    evaluator: Evaluator = field(default_factory=Evaluator)

    def __post_init__(self) -> None:
        keep(self, "problem", instance, Problem, "give a Problem")
        keep(self, "methods", instance, (Mapping,), "give a dict of label -> method")
        for label, method in self.methods.items():
            text("a label of methods", label)
            instance(f"methods[{label!r}]", method, (ReliabilityMethod,), "give a method")
        keep(self, "criteria", instance, Criteria, "give criteria(...)")
        keep(self, "max_evals", or_none, whole, at_least=1)
        keep(self, "seed", whole, at_least=0, at_most=LARGEST_SEED)
        keep(self, "evaluator", instance, Evaluator, "give uqfold.Evaluator(...)")


@dataclass(frozen=True)
class MethodRun:
    """One finished method of a comparison.

    Attributes
    ----------
    label
        Its label in the comparison.
    method
        The method with its settings.
    result
        What it answered.
    rows
        The answers as rows of the comparison, one per criterion; see `columns.COLUMNS`.
    """

    label: str
    method: ReliabilityMethod
    result: ReliabilityResult
    rows: tuple[dict[str, Any], ...]


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
    checked_problem(problem)
    return ComparisonPlan(
        problem=problem,
        methods=MappingProxyType(_labelled(methods)),
        criteria=checked_criteria(problem, criteria),
        max_evals=checked_budget(max_evals),
        seed=reduced_seed(rng),
        evaluator=checked_evaluator(evaluator),
    )


def run_comparison(
    plan: ComparisonPlan, progress: ComparisonProgress | None = None
) -> Iterator[MethodRun]:
    """Run the methods of a plan one after the other, and give each as soon as it is finished.

    What has been given stays valid whatever happens later, so that a caller who saves it at once
    loses nothing to an interruption.

    Parameters
    ----------
    plan
        What to run.
    progress
        Called as each method starts and after every batch of model runs.

    Yields
    ------
    MethodRun
        One finished method.

    Raises
    ------
    FailedRunError
        Only under the policy ``raise`` for failed runs.
    """
    instance("plan", plan, ComparisonPlan, "give what plan_comparison returned")
    or_none("progress", progress, function)
    known = plan.problem.references
    references = [None if known is None else known.lookup(one) for one in plan.criteria]
    for label, method in plan.methods.items():
        evaluator = plan.evaluator
        if progress is not None:
            progress(label, 0, None)
            evaluator = replace(evaluator, progress=_both(evaluator, label, progress))
        result = method.estimate(
            plan.problem,
            plan.criteria,
            max_evals=plan.max_evals,
            rng=plan.seed,
            evaluator=evaluator,
        )
        rows = tuple(
            comparison_row(plan.problem.name, label, row, reference)
            for row, reference in zip(result, references, strict=True)
        )
        yield MethodRun(label, method, result, rows)


def compare(
    problem: Problem,
    methods: Methods = None,
    criteria: CriteriaLike = None,
    *,
    max_evals: int | None = None,
    rng: RandomSource = 0,
    evaluator: Evaluator | None = None,
    progress: ComparisonProgress | None = None,
) -> pd.DataFrame:
    """Answer the same question with several methods, and set them beside the reference.

    Parameters
    ----------
    problem
        Model, inputs and units.
    methods
        Names, methods, or a mapping from label to either; one name or method alone will do. None
        takes every available method with its default settings.
    criteria
        What "works" means; None takes the problem's own default criteria.
    max_evals
        Most model runs that each method may spend; None: as many as its settings ask for.
    rng
        Seed, `numpy.random.SeedSequence` or `Generator`; reduced to one seed that every method
        gets, so that a row can be repeated by the method alone.
    evaluator
        How model runs are made: policy for failed runs, batches, progress.
    progress
        Called with (label, runs so far, runs expected or None).

    Returns
    -------
    pandas.DataFrame
        One row per method and criterion, methods in the given order: the columns of
        `uqfold.methods.CriterionResult`, before them ``problem`` and ``label``, after them
        ``reference_pf``, ``reference_std_error`` and ``error``, the relative error of Eq. (49).
        These three are NaN where the problem has no reference for exactly this criterion;
        references are never interpolated. How the comparison was made is in ``attrs``.

    Raises
    ------
    ValueError, TypeError
        For an unknown method, a wrong criterion or a wrong budget, before any run is spent.
    FailedRunError
        Only under the policy ``raise`` for failed runs.

    Examples
    --------
    >>> import uqfold
    >>> frame = uqfold.compare(
    ...     uqfold.problems.series(), ["ffni-spa", "ffni-pearson"], uqfold.criteria(2.0)
    ... )
    >>> frame[["label", "n_evals", "status"]]
              label  n_evals     status
    0      ffni-spa       75  unchecked
    1  ffni-pearson       75  unchecked
    """
    plan = plan_comparison(
        problem, methods, criteria, max_evals=max_evals, rng=rng, evaluator=evaluator
    )
    or_none("progress", progress, function)
    from uqfold.comparison.header import RunHeader
    from uqfold.comparison.records import Records

    header = RunHeader.of(plan)
    rows = tuple(row for run in run_comparison(plan, progress) for row in run.rows)
    return Records(header, rows).to_frame()


def _both(
    evaluator: Evaluator, label: str, progress: ComparisonProgress
) -> Callable[[int, int | None], None]:
    """Report to the comparison's hook and to the evaluator's own."""

    def report(n_evals: int, expected: int | None) -> None:
        progress(label, n_evals, expected)
        if evaluator.progress is not None:
            evaluator.progress(n_evals, expected)

    return report


def _labelled(methods: Methods) -> dict[str, ReliabilityMethod]:
    if methods is None:
        return {name: method() for name, method in available().items()}
    if isinstance(methods, Mapping):
        labelled = mapping("methods", methods, _built)
        if not all(label.strip() for label in labelled):
            raise refused("methods", list(labelled), "give labels that are not empty")
    else:
        one = isinstance(methods, str | ReliabilityMethod)
        given = (methods,) if one else listed("methods", methods, what="list of methods")
        labelled = {}
        for i, item in enumerate(given):
            method = _built("methods" if one else f"methods[{i}]", item)
            if method.name in labelled:
                raise ValueError(
                    f"methods: two are labelled {method.name!r}, give a dict of label -> method"
                )
            labelled[method.name] = method
    if not labelled:
        raise refused("methods", methods, f"choose from {', '.join(available())}")
    return labelled


def _built(name: str, method: MethodLike) -> ReliabilityMethod:
    if isinstance(method, str):
        return named(name, method)
    if isinstance(method, type) and issubclass(method, ReliabilityMethod):
        raise refused(
            name, method, f"it is a class, give an instance: {method.__name__}()", TypeError
        )
    checked: ReliabilityMethod = instance(
        name, method, (ReliabilityMethod,), "give a name or a ReliabilityMethod"
    )
    return checked
