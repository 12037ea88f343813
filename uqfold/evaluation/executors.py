"""Where batches of the model is evaluated: in this process, or by any futures executor.

An executor gives a runner for one model. The pipeline submits batches and takes their outcomes in
whatever order they finish; it puts them back in order itself, so that no answer depends on the
number of workers or on who was first.
"""

from __future__ import annotations

import concurrent.futures
import os
import pickle
import time
from abc import ABC, abstractmethod
from collections import deque
from collections.abc import Callable
from types import TracebackType
from typing import Any, ClassVar

from uqfold.checks import instance, or_none, raised, shown, whole
from uqfold.evaluation.batch import Caution, Outcome, run_batch
from uqfold.evaluation.errors import ExecutorError
from uqfold.evaluation.row_model import RowModel
from uqfold.typing import FloatArray, Model

QUEUED_PER_WORKER = 2
"""Batches handed over per worker: one under way, one waiting."""
STOPPING_SECONDS = 15.0
"""How long to wait for runs that are being ended."""


class Runner(ABC):
    """Batches of one model, under way."""

    capacity: int
    """How many batches it takes at a time."""
    retries: int = 0
    """How often rows over which a worker has ended are run again."""

    @property
    @abstractmethod
    def in_flight(self) -> int:
        """Batches submitted and not yet handed out."""

    @abstractmethod
    def submit(self, batch: Any, x: FloatArray, caution: Caution) -> None:
        """Take the rows X (n, d) of a batch; `caution` as in `run_batch`."""

    @abstractmethod
    def finished(self, timeout: float) -> tuple[Any, Outcome] | None:
        """Wait for any batch and hand it out; None if there is none within `timeout` seconds."""

    @abstractmethod
    def abandon(self) -> None:
        """Forget all batches under way."""


class Executor(ABC):
    """Where a model is evaluated in batches; to be used as a context manager, or closed at exit."""

    batch_rows: ClassVar[int] = 64
    """Rows of a batch unless the evaluator says otherwise."""
    small_batch_rows: ClassVar[int] = 16
    """The same for small designs, so that all workers get a part of them."""

    @abstractmethod
    def open(self, model: Model, seconds_per_run: float | None) -> Runner:
        """Return a runner for `model`, which may take `seconds_per_run` for each run.

        Raises
        ------
        ExecutorError
            If the model cannot be handed to the workers.
        ValueError
            If the executor cannot end a run that takes too long.
        """

    def close(self) -> None:  # noqa: B027 - most have nothing of their own to close
        """Release the workers."""

    def __enter__(self) -> Executor:
        """Return the executor."""
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        """Release the workers."""
        self.close()


class InProcess(Executor):
    """Runs the model here and now; right for a compiled or vectorised model."""

    batch_rows: ClassVar[int] = 4096
    small_batch_rows: ClassVar[int] = 4096

    def open(self, model: Model, seconds_per_run: float | None) -> Runner:
        """Return a runner that makes each run when its outcome is asked for."""
        return _InProcessRunner(limited(model, seconds_per_run, "a run in this process"))


class _InProcessRunner(Runner):
    capacity = 1

    def __init__(self, model: Model) -> None:
        self._model = model
        self._waiting: deque[tuple[Any, FloatArray, Caution]] = deque()

    @property
    def in_flight(self) -> int:
        return len(self._waiting)

    def submit(self, batch: Any, x: FloatArray, caution: Caution) -> None:
        self._waiting.append((batch, x, caution))

    def finished(self, timeout: float) -> tuple[Any, Outcome] | None:
        del timeout  # nobody else could look at the clock
        batch, x, caution = self._waiting.popleft()
        return batch, run_batch(self._model, x, caution)

    def abandon(self) -> None:
        self._waiting.clear()


class Futures(Executor):
    """Any `concurrent.futures.Executor`: threads, processes, MPI, a client of some cluster.

    Parameters
    ----------
    executor
        It stays the caller's, who starts it and shuts it down.
    workers
        How many batches it runs at the same time; by default what it says itself, or the number
        of cores.

    Raises
    ------
    TypeError, ValueError
        If the executor is none, or the number out of range.
    """

    def __init__(self, executor: concurrent.futures.Executor, workers: int | None = None) -> None:
        self.executor = instance(
            "executor", executor, concurrent.futures.Executor, "give a concurrent.futures.Executor"
        )
        own = getattr(executor, "_max_workers", None)
        asked = or_none("workers", workers, whole, at_least=1)
        self.workers = asked or (own if isinstance(own, int) else None) or os.cpu_count() or 1

    def open(self, model: Model, seconds_per_run: float | None) -> Runner:
        """Return a runner; a model for a pool of processes has to be picklable."""
        model = limited(model, seconds_per_run, f"a run in a {type(self.executor).__name__}")
        if isinstance(self.executor, concurrent.futures.ProcessPoolExecutor):
            pickled(model)
        return FuturesRunner(self.executor, model, self.workers)


class FuturesRunner(Runner):
    """Batches of one model, under way as futures."""

    def __init__(self, executor: concurrent.futures.Executor, model: Model, workers: int) -> None:
        self.capacity = QUEUED_PER_WORKER * workers
        self._executor = executor
        self._model = model
        self._run: Callable[[Any, FloatArray, Caution], Outcome] = run_batch
        self._batches: dict[concurrent.futures.Future[Outcome], Any] = {}

    @property
    def in_flight(self) -> int:
        """Batches whose futures are not done, or not handed out."""
        return len(self._batches)

    def submit(self, batch: Any, x: FloatArray, caution: Caution) -> None:
        """Hand the rows X (n, d) of a batch to the executor."""
        try:
            future = self._executor.submit(self._run, self._model, x, caution)
        except RuntimeError as error:
            raise self._broken(error) from error
        self._batches[future] = batch

    def finished(self, timeout: float) -> tuple[Any, Outcome] | None:
        """Wait for the first future that is done, within `timeout` seconds."""
        done, _ = concurrent.futures.wait(
            self._batches, timeout, return_when=concurrent.futures.FIRST_COMPLETED
        )
        if not done:
            return None
        future = next(one for one in self._batches if one in done)
        batch = self._batches.pop(future)
        try:
            return batch, future.result()
        except (Exception, concurrent.futures.CancelledError) as error:
            # what the model raises is part of an outcome, so this is the executor's own
            return batch, self._without_outcome(error)

    def abandon(self) -> None:
        """Cancel what has not begun, and end the runs that can be ended."""
        for future in self._batches:
            future.cancel()
        threads = isinstance(self._executor, concurrent.futures.ThreadPoolExecutor)
        if threads and isinstance(self._model, RowModel):
            # a thread that has taken its row may start the run a moment later
            last = time.monotonic() + STOPPING_SECONDS
            while left := [future for future in self._batches if not future.done()]:
                if not self._model.stop() or time.monotonic() > last:
                    break
                concurrent.futures.wait(left, 0.02)
        self._batches.clear()

    def _without_outcome(self, error: BaseException) -> Outcome:
        """Return what can still be told of a batch that has no outcome, or raise."""
        raise self._broken(error) from error

    def _broken(self, error: BaseException) -> ExecutorError:
        return ExecutorError(
            f"the {type(self._executor).__name__} gave no responses ({raised(error)}); "
            f"uqfold.evaluation.Processes replaces workers that die"
        )


def limited(model: Model, seconds_per_run: float | None, what: str) -> Model:
    """Return the model with a time limit that it keeps itself.

    Raises
    ------
    ValueError
        If it cannot, for executors that cannot end a run either.
    """
    if seconds_per_run is None:
        return model
    kept = model.with_time_limit(seconds_per_run) if isinstance(model, RowModel) else None
    if kept is None:
        raise ValueError(
            f"seconds_per_run = {seconds_per_run:g}: {what} cannot be ended from outside. Use "
            "executor=uqfold.evaluation.Processes(), an ExternalCode, or no limit"
        )
    return kept


def pickled(model: Model) -> bytes:
    """Return the model as bytes for a worker process.

    Raises
    ------
    ExecutorError
        If it cannot be pickled.
    """
    try:
        return pickle.dumps(model)
    except Exception as error:
        raise ExecutorError(
            f"the model {shown(model)} cannot be handed to another process "
            f"({raised(error)}): make it a "
            "function at the top level of a module (no lambda, nothing defined inside a function), "
            "or a frozen dataclass with __call__"
        ) from error
