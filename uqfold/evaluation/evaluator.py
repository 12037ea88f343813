"""The one door through which every method gets its model values, and how it is set up."""

from __future__ import annotations

import concurrent.futures
import warnings
from collections.abc import Callable
from dataclasses import dataclass, replace
from os import PathLike
from typing import get_args

from uqfold.checks import choice, flag, function, instance, keep, or_none, real, whole
from uqfold.evaluation.deadline import Deadline
from uqfold.evaluation.description import UndescribedError
from uqfold.evaluation.executors import Executor, Futures, InProcess
from uqfold.evaluation.identity import model_identity
from uqfold.evaluation.pipeline import Pipeline
from uqfold.evaluation.row_model import RowModel
from uqfold.evaluation.samples import KeptSamples
from uqfold.evaluation.session import (
    EvaluationSession,
    FailedRunPolicy,
    ProgressCallback,
    RunningEstimate,
)
from uqfold.evaluation.shelf import SMALL_CALL, Shelf
from uqfold.evaluation.store import Store
from uqfold.problems.base import Problem
from uqfold.typing import Model

MOST_SAMPLES = 100_000
"""Runs that are kept where no number is given."""


@dataclass(frozen=True)
class Evaluator:
    """How a model is evaluated.

    Attributes
    ----------
    failed_runs
        ``bound`` (default): a failed run stays open, and pf is bounded by counting all failed
        runs as safe, and all as failed. ``count-as-failure``: a failed run has response +inf.
        ``raise``: the first failed run ends the whole estimate with `FailedRunError`.
    batch_rows
        Rows handed to the model, or to a worker, at once, at most, and lost when the program is
        killed. None: 1 for a model of one sample at a time, else 4096 in this process, 16 to 256
        in workers. A model of one sample hands over what it has at least every 50 ms.
        Under a limit on time fewer, so that a batch takes a small part of what is left.
    progress
        Called with (runs so far, runs expected or None) after every batch.
    watch
        Called with a `RunningEstimate` by methods that have one.
    store
        Where responses are kept and looked up: a `Store`, or the path of its file. The problem
        has to state the version of its model; without one nothing is stored, and a warning says
        so.
    executor
        Where runs are made: `Processes`, `Dask`, or any `concurrent.futures.Executor`. None: in
        this process; the runs of an `ExternalCode` in as many threads as it asks for.
    max_seconds
        Wall-clock limit of one estimate. Once it is over no more runs are started; methods that
        can, answer with what they have (status ``budget_exhausted``). A run that was started in
        this process is finished, however long it takes.
    seconds_per_run
        Time limit of one run, which fails when it takes longer: with `Processes` or an
        `ExternalCode`. What cannot end a run refuses it.

    samples
        Whether the runs are kept, for the frame `ReliabilityResult.samples`: True keeps 100,000 of
        them at most, a number at most so many; beyond it, every second one, and so on.

    Raises
    ------
    ValueError, TypeError
        If a setting is out of range.
    StoreError
        If the store is not a store, or damaged.
    """

    failed_runs: FailedRunPolicy = "bound"
    batch_rows: int | None = None
    progress: ProgressCallback | None = None
    watch: Callable[[RunningEstimate], None] | None = None
    store: Store | str | PathLike[str] | None = None
    executor: Executor | concurrent.futures.Executor | None = None
    max_seconds: float | None = None
    seconds_per_run: float | None = None
    samples: bool | int = False

    def __post_init__(self) -> None:
        keep(self, "failed_runs", choice, get_args(FailedRunPolicy))
        keep(self, "batch_rows", or_none, whole, at_least=1)
        keep(self, "progress", or_none, function, "give a function of (runs so far, runs expected)")
        keep(self, "watch", or_none, function, "give a function of a RunningEstimate")
        for name in ("max_seconds", "seconds_per_run"):
            keep(self, name, or_none, real, above=0.0, what="number of seconds")
        keep(self, "store", or_none, _as_store)
        keep(self, "samples", _as_samples)
        if isinstance(self.executor, concurrent.futures.Executor):
            object.__setattr__(self, "executor", Futures(self.executor))
        if not (self.executor is None or isinstance(self.executor, Executor)):
            raise TypeError(
                f"executor = {self.executor!r}: give uqfold.evaluation.Processes(), Dask(...), or "
                "a concurrent.futures.Executor"
            )

    def open(self, problem: Problem, max_evals: int | None) -> EvaluationSession:
        """Open the counted access to a problem's model for one estimate.

        Raises
        ------
        ExecutorError
            If the executor cannot take the model.
        ValueError
            If `seconds_per_run` cannot be kept.
        """
        shelf = None
        if isinstance(self.store, Store):
            shelf = _shelf(self.store, problem)
        return self._session(problem.kinds.model, problem.kinds.columns, max_evals, shelf)

    def session(self, model: Model, dimension: int, max_evals: int | None) -> EvaluationSession:
        """Open the counted access to a bare model, of which nothing is stored."""
        return self._session(model, dimension, max_evals, None)

    def session_of_told(
        self, model: Model, dimension: int, max_evals: int | None
    ) -> EvaluationSession:
        """Open the count of responses that come from elsewhere: nothing to run or to store."""
        settings = replace(self, store=None, executor=None, max_seconds=None, seconds_per_run=None)
        return settings._session(model, dimension, max_evals, None, told=True)

    def _session(
        self,
        model: Model,
        dimension: int,
        max_evals: int | None,
        shelf: Shelf | None,
        told: bool = False,
    ) -> EvaluationSession:
        executor = self.executor
        if not isinstance(executor, Executor):
            executor = _default_executor(model)
        row_by_row = isinstance(model, RowModel)

        def most_rows(n: int) -> int:
            # threads of the model's own share the rows, however many a batch may have
            own_threads = self.executor is None and isinstance(executor, Futures)
            if self.seconds_per_run is not None or own_threads:
                return 1
            if self.batch_rows is not None:
                return self.batch_rows
            if row_by_row:
                return 1
            return executor.small_batch_rows if n <= SMALL_CALL else executor.batch_rows

        runner = executor.open(model, self.seconds_per_run)
        deadline = Deadline(self.max_seconds)
        in_doubt = not (row_by_row or told)
        return EvaluationSession(
            Pipeline(runner, most_rows, lambda: deadline.left, shelf, in_doubt),
            deadline,
            dimension,
            max_evals,
            self.failed_runs,
            self.progress,
            self.watch,
            samples=None if self.samples is False else KeptSamples(int(self.samples)),
        )


def _shelf(store: Store, problem: Problem) -> Shelf | None:
    """Return where the model of a problem has its responses; None, with a warning, if it cannot."""
    try:
        identity = model_identity(problem)
    except UndescribedError as error:
        reason = f"what the model of {problem.name!r} holds cannot be told from others: {error}"
        remedy = (
            "Make it a frozen dataclass of plain values (field(compare=False) for what has no "
            "influence on a response), a function, or functools.partial of one"
        )
    else:
        if identity is not None:
            return Shelf(store, identity, row_by_row=isinstance(problem.kinds.model, RowModel))
        reason = f"problem {problem.name!r} does not state the version of its model"
        remedy = "Give Problem(version=...), and another one whenever it changes"
    warnings.warn(f"nothing is stored: {reason}. {remedy}", stacklevel=3)
    return None


def _as_store(name: str, value: object) -> Store:
    if isinstance(value, str | PathLike):
        return Store(value)
    return instance(name, value, Store, "give a Store or the path of its file")


def _as_samples(name: str, value: object) -> int | bool:
    """Return how many runs are kept at most, or False."""
    try:
        return MOST_SAMPLES if flag(name, value) else False
    except TypeError:
        return whole(name, value, at_least=1)


def _default_executor(model: Model) -> Executor:
    if isinstance(model, RowModel) and model.parallel > 1:
        return Futures(concurrent.futures.ThreadPoolExecutor(model.parallel))
    return InProcess()
