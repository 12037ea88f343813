"""Run several methods on one problem and one grid of criteria."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import asdict, replace
from typing import TYPE_CHECKING, Any, TypeAlias

from uqfold.checks import function, instance, listed, mapping, or_none, refused, text
from uqfold.comparison.columns import ATTRIBUTE, comparison_row, rows_to_frame
from uqfold.comparison.given_references import given_references
from uqfold.comparison.header import header_of
from uqfold.comparison.own_files import is_of_a_file, methods_of_a_file
from uqfold.evaluation import Evaluator
from uqfold.methods.arguments import (
    CriteriaLike,
    checked_budget,
    checked_criteria,
    checked_evaluator,
)
from uqfold.methods.base import ReliabilityMethod
from uqfold.methods.registry import available, named
from uqfold.methods.response_surface import ErrorParts
from uqfold.methods.result import ReliabilityResult
from uqfold.methods.seeding import RandomSource, reduced_seed
from uqfold.problems.base import Problem
from uqfold.problems.known_answers import ReferenceLike

if TYPE_CHECKING:
    import pandas as pd

MethodLike: TypeAlias = str | ReliabilityMethod
Methods: TypeAlias = MethodLike | Iterable[MethodLike] | Mapping[str, MethodLike] | None
ComparisonProgress: TypeAlias = Callable[[str, int, int | None], None]
"""Called with (label, runs so far, runs expected or None), first as a method starts, with zero."""


def run_comparison(
    problem: Problem,
    methods: Methods = None,
    criteria: CriteriaLike = None,
    *,
    max_evals: int | None = None,
    rng: RandomSource = 0,
    reference: ReferenceLike | None = None,
    evaluator: Evaluator | None = None,
    progress: ComparisonProgress | None = None,
    command: str = "",
) -> Iterator[pd.DataFrame]:
    """Check what is asked, then run one method after the other; yield the comparison after each.

    What has been yielded stays valid whatever happens later, so that a caller who saves it at once
    loses nothing to an interruption. The arguments are checked at once, and the first method runs
    when the first frame is asked for.

    Parameters
    ----------
    problem, methods, criteria, max_evals, rng, reference, evaluator, progress
        As for `compare`.
    command
        The command as typed, for the header.

    Yields
    ------
    pandas.DataFrame
        The rows of the methods that have finished, with the header of the whole comparison.

    Raises
    ------
    ValueError, TypeError, FailedRunError
        As `compare` does.
    """
    grid = checked_criteria(problem, criteria)
    labelled = labelled_methods(methods)
    budget, seed = checked_budget(max_evals), reduced_seed(rng)
    how = checked_evaluator(evaluator)
    or_none("progress", progress, function)
    text("command", command, empty=True)
    references = problem.references
    if reference is not None:
        references = given_references(reference, grid, problem)

    def frames() -> Iterator[pd.DataFrame]:
        header: dict[str, Any] = {
            **header_of(problem, labelled, command, references),
            "criteria": [asdict(one) for one in grid],
            "finished": [],
            "seed": seed,
            "max_evals": budget,
            "failed_runs": how.failed_runs,
        }
        rows = list[dict[str, Any]]()
        for label, method in labelled.items():
            told = how if progress is None else _told(how, progress, label)
            result = method.estimate(problem, grid, max_evals=budget, rng=seed, evaluator=told)
            for row, criterion in zip(result, grid, strict=True):
                known = None if references is None else references.lookup(criterion)
                rows.append(comparison_row(problem.name, label, row, known))
            frame = rows_to_frame(rows)
            header = {**header, "finished": [*header["finished"], label]}
            if parts := _error_parts(result):
                header["error_parts"] = {**header.get("error_parts", {}), label: parts}
            frame.attrs[ATTRIBUTE] = header
            yield frame

    return frames()


def compare(
    problem: Problem,
    methods: Methods = None,
    criteria: CriteriaLike = None,
    *,
    max_evals: int | None = None,
    rng: RandomSource = 0,
    reference: ReferenceLike | None = None,
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
        What "works" means: a grid, a threshold alone, or None for the problem's own default.
    max_evals
        Most evaluations that each method may spend; None: as many as its settings ask for.
    rng
        Seed, `numpy.random.SeedSequence` or `Generator`; reduced to one seed that every method
        gets, so that a row can be repeated by the method alone.
    reference
        Known answers to measure errors against, instead of the problem's own: one failure
        probability for each criterion; a dict of threshold or `Criterion` -> pf or (pf,
        std_error); the result of a long run, or the path of its records; or a frame with columns
        ``threshold`` and ``pf``.
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
        For an unknown method, a wrong criterion, budget or reference, before any run is spent.
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
    0      ffni-spa      205  converged
    1  ffni-pearson      205  converged
    """
    *_, frame = run_comparison(
        problem,
        methods,
        criteria,
        max_evals=max_evals,
        rng=rng,
        reference=reference,
        evaluator=evaluator,
        progress=progress,
    )
    return frame


def _told(how: Evaluator, progress: ComparisonProgress, label: str) -> Evaluator:
    """Return an evaluator that also tells the progress of a comparison."""
    progress(label, 0, None)

    def tell(n_evals: int, expected: int | None) -> None:
        progress(label, n_evals, expected)
        if how.progress is not None:
            how.progress(n_evals, expected)

    return replace(how, progress=tell)


def _error_parts(result: ReliabilityResult) -> dict[str, float]:
    """What the stated errors of a surface consist of: parts of pf, root mean squares of rows."""
    import numpy as np

    errors = getattr(result.details, "errors", None)
    pf = np.array([row.pf for row in result])
    if not isinstance(errors, ErrorParts) or not (pf > 0.0).any():
        return {}
    return {
        part: float(np.sqrt(np.mean((of_pf[pf > 0.0] / pf[pf > 0.0]) ** 2)))
        for part, of_pf in vars(errors).items()
    }


def labelled_methods(methods: Methods) -> dict[str, ReliabilityMethod]:
    """Return label -> method of what `compare` takes as methods, checked; None: all there are.

    ``FILE.py:FUNCTION`` among the names stands for the methods that the function returns.
    """
    if methods is None:
        methods = list(available())
    if isinstance(methods, Mapping):
        named = list(mapping("methods", methods, _built).items())
    elif isinstance(methods, str | ReliabilityMethod):
        named = _named("methods", methods)
    else:
        given = listed("methods", methods, what="list of methods")
        named = [pair for i, one in enumerate(given) for pair in _named(f"methods[{i}]", one)]
    labels = [label for label, _ in named]
    if not all(label.strip() for label in labels):
        raise refused("methods", labels, "give labels that are not empty")
    if twice := [label for label in labels if labels.count(label) > 1]:
        raise ValueError(f"methods: two are labelled {twice[0]!r}, give a dict of label -> method")
    if not named:
        raise refused("methods", methods, f"choose from {', '.join(available())}")
    return dict(named)


def _named(name: str, method: MethodLike) -> list[tuple[str, ReliabilityMethod]]:
    if is_of_a_file(method):
        return list(mapping(name, methods_of_a_file(method), _built).items())
    built = _built(name, method)
    return [(built.name, built)]


def _built(name: str, method: MethodLike) -> ReliabilityMethod:
    if isinstance(method, str):
        return named(name, method)
    if isinstance(method, type) and issubclass(method, ReliabilityMethod):
        remedy = f"it is a class, give an instance: {method.__name__}()"
        raise refused(name, method, remedy, TypeError)
    return instance(name, method, ReliabilityMethod, "give a name or a ReliabilityMethod")  # type: ignore[type-abstract]
