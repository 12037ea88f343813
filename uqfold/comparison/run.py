"""Run several methods on one problem and one grid of criteria."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import replace
from typing import TYPE_CHECKING, Any, TypeAlias

from uqfold.checks import function, instance, or_none, text
from uqfold.comparison.columns import comparison_row, rows_to_frame
from uqfold.comparison.header import ATTRIBUTE, header_of
from uqfold.comparison.plan import ComparisonPlan, Methods, plan_comparison
from uqfold.evaluation import Evaluator
from uqfold.methods.arguments import CriteriaLike
from uqfold.methods.seeding import RandomSource
from uqfold.problems.base import Problem

if TYPE_CHECKING:
    import pandas as pd

ComparisonProgress: TypeAlias = Callable[[str, int, int | None], None]
"""Called with (label, runs so far, runs expected or None), first as a method starts, with zero."""


def run_comparison(
    plan: ComparisonPlan, progress: ComparisonProgress | None = None, command: str = ""
) -> Iterator[pd.DataFrame]:
    """Run the methods of a plan one after the other; yield the comparison so far after each.

    What has been yielded stays valid whatever happens later, so that a caller who saves it at once
    loses nothing to an interruption.

    Parameters
    ----------
    plan
        What to run.
    progress
        Called as each method starts and after every batch of evaluations.
    command
        The command as typed, for the header.

    Yields
    ------
    pandas.DataFrame
        The rows of the methods that have finished, with the header of the whole comparison; see
        `compare`.

    Raises
    ------
    FailedRunError
        Only under the policy ``raise`` for failed runs.
    """
    instance("plan", plan, ComparisonPlan, "give what plan_comparison returned")
    or_none("progress", progress, function)
    text("command", command, empty=True)
    header = header_of(plan, command)
    known = plan.problem.references
    references = [None if known is None else known.lookup(one) for one in plan.criteria]
    rows = list[dict[str, Any]]()
    for label, method in plan.methods.items():
        evaluator = plan.evaluator
        if progress is not None:
            progress(label, 0, None)
            evaluator = replace(evaluator, progress=_telling(progress, label, evaluator.progress))
        result = method.estimate(
            plan.problem,
            plan.criteria,
            max_evals=plan.max_evals,
            rng=plan.seed,
            evaluator=evaluator,
        )
        rows += [
            comparison_row(plan.problem.name, label, row, reference)
            for row, reference in zip(result, references, strict=True)
        ]
        frame = rows_to_frame(rows)
        header = {**header, "finished": [*header["finished"], label]}
        frame.attrs[ATTRIBUTE] = header
        yield frame


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
        Most evaluations that each method may spend; None: as many as its settings ask for.
    rng
        Seed, `numpy.random.SeedSequence` or `Generator`; reduced to one seed that every method
        gets, so that a row can be repeated by the method alone.
    evaluator
        How the model is run: policy for failed runs, batches, progress.
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
    0      ffni-spa       95  converged
    1  ffni-pearson       95  converged
    """
    plan = plan_comparison(
        problem, methods, criteria, max_evals=max_evals, rng=rng, evaluator=evaluator
    )
    *_, frame = run_comparison(plan, progress)
    return frame


def _telling(
    progress: ComparisonProgress, label: str, own: Callable[[int, int | None], None] | None
) -> Callable[[int, int | None], None]:
    def tell(n_evals: int, expected: int | None) -> None:
        progress(label, n_evals, expected)
        if own is not None:
            own(n_evals, expected)

    return tell
