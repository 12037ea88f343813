"""Counted, budgeted access to one model during one estimate.

Every row that a method asks for passes through here: it is looked up in the store, or handed to
the executor with its batch; the responses are put back in order, counted, and judged by the policy
for failed runs. Everything that a method sees happens in the order of the rows, whatever the
workers do, so that the same seed gives the same answer everywhere.
"""

from __future__ import annotations

import sys
import time
from collections import deque
from collections.abc import Iterable, Iterator
from dataclasses import dataclass, field
from itertools import count
from typing import TYPE_CHECKING, NoReturn

import numpy as np

from uqfold.algebra import program_blas_threads
from uqfold.checks import array
from uqfold.evaluation.batch import GIVE_UP_AFTER, Caution
from uqfold.evaluation.calling import shown
from uqfold.evaluation.errors import (
    BudgetExceededError,
    FailedRunError,
    ModelError,
    TimeLimitError,
)
from uqfold.evaluation.executors import Executor, Runner
from uqfold.evaluation.row_model import RowModel
from uqfold.evaluation.running import RunningEstimate
from uqfold.evaluation.shelf import Shelf
from uqfold.typing import BoolArray, FloatArray, Model

if TYPE_CHECKING:
    from uqfold.evaluation.evaluator import Evaluator

SMALL_CALL = 2048
"""Up to so many rows are stored one by one, and spread over the workers in small batches."""
GRAIN = 64
"""Rows of one entry in the store, for larger calls."""
WAKE_SECONDS = 0.2
"""How often a wait for workers looks at the clock and at Ctrl-C."""
AHEAD = 4
"""Finished batches that may wait for an earlier one, as a multiple of those under way."""
GRACE_SECONDS, GRACE_SHARE = 3.0, 0.1
"""Time beyond the limit for summing up what there is: so much, and this share of the limit."""


@dataclass(eq=False)
class _Batch:
    """Rows handed to the model at once; `y` is a view of the block's responses."""

    x: FloatArray
    y: FloatArray
    grain: int
    block: FloatArray
    last: bool
    missing: BoolArray | None = None
    n_reused: int = 0
    reason: str = ""
    done: bool = False


@dataclass
class EvaluationSession:
    """Counted, budgeted access to one model during one estimate.

    Attributes
    ----------
    in_doubt
        Whether it is still to be found out that the model takes rows: a few of the first are then
        run again alone, which counts nowhere.
    n_evals
        Runs asked for so far, one per row.
    n_reused
        How many of them came from the store.
    n_failed
        How many of them failed.
    first_failure
        What the first failed run looked like, for messages; empty if none failed.
    expected
        Runs that the method expects to need in all, for the progress display.
    """

    settings: Evaluator
    model: Model
    dimension: int
    max_evals: int | None
    executor: Executor
    shelf: Shelf | None = None
    in_doubt: bool = True
    n_evals: int = 0
    n_reused: int = 0
    n_failed: int = 0
    first_failure: str = ""
    expected: int | None = None
    _n_good: int = field(default=0, repr=False)
    _reserved: int = field(default=0, repr=False)

    def __post_init__(self) -> None:
        self._runner: Runner = self.executor.open(self.model, self.settings.seconds_per_run)
        self._numbers = count()
        self.in_doubt = self.in_doubt and not isinstance(self.model, RowModel)
        self._in_question: int | None = None
        self._unkept: list[tuple[FloatArray, FloatArray, int, float]] = []
        limit = self.settings.max_seconds
        self._deadline = None if limit is None else time.monotonic() + limit
        self._summed_up_by: float | None = None

    @property
    def remaining(self) -> int:
        """Runs that the budget still allows (a very large number without a budget)."""
        if self.max_evals is None:
            return sys.maxsize
        return self.max_evals - self.n_evals - self._reserved

    def evaluate(self, x: FloatArray) -> FloatArray:
        """Run the model on every row.

        Parameters
        ----------
        x
            Inputs (n, d), columns shared inputs first.

        Returns
        -------
        FloatArray
            Responses (n,). +-inf are valid responses; NaN marks a failed run and occurs only
            under the policy ``bound``.

        Raises
        ------
        BudgetExceededError
            If fewer than n runs are left; no run is spent then.
        TimeLimitError
            If the wall-clock limit is over before the last batch; it holds the responses of the
            rows before.
        FailedRunError
            If a run fails under the policy ``raise``, or the first 64 runs all fail.
        ModelError
            If the model does not take rows, or gives something else than a response for each.
        EngineError
            If store or executor fail.
        ValueError
            If `x` has the wrong shape or holds NaN.
        """
        [y] = self.stream([x])
        return y

    def stream(self, blocks: Iterable[FloatArray]) -> Iterator[FloatArray]:
        """Run the model on one block of rows after the other, several at a time if workers wait.

        Blocks are drawn only as workers need them, so that a long stream takes no more memory
        than a short one. Those that were drawn ahead and not taken are not counted.

        Parameters
        ----------
        blocks
            Inputs (n, d) of each block.

        Yields
        ------
        FloatArray
            Responses (n,) of the blocks, in order.

        Raises
        ------
        BudgetExceededError, TimeLimitError, FailedRunError, ModelError, EngineError, ValueError
            As `evaluate` does, when it is the turn of the block.
        """
        coming = self._batches(blocks)
        queue: deque[_Batch] = deque()
        under_way: dict[int, _Batch] = {}
        postponed: Exception | None = None
        drawn = False
        made = np.empty(0)  # what the block under way has so far
        try:
            while True:
                while queue and queue[0].done:
                    batch = queue.popleft()
                    self._account(batch)
                    made = batch.block[: 0 if batch.last else made.size + batch.y.size]
                    if batch.last:
                        yield batch.block
                room = self._runner.in_flight < self._runner.capacity
                if room and not drawn and len(queue) < AHEAD * self._runner.capacity:
                    try:
                        following = next(coming, None)
                    except (BudgetExceededError, ValueError) as error:
                        # what was asked for before is still owed
                        following, postponed = None, error
                    if following is None:
                        drawn = True
                    else:
                        queue.append(following)
                        self._begin(following, under_way, first=len(queue) == 1)
                elif queue:
                    self._collect(under_way)
                else:
                    break
            if postponed is not None:
                raise postponed
        except TimeLimitError as error:
            error.responses = made
            raise
        finally:
            self._reserved = 0
            if self._runner.in_flight:
                self._runner.abandon()
            self._in_question = None
            self._unkept.clear()
            if self.shelf is not None:
                self.shelf.flush()

    def admit(self, x: FloatArray) -> FloatArray:
        """Check rows that are to be run, without running them; errors as in `evaluate`."""
        x = np.ascontiguousarray(array("X", x, ("n", self.dimension), finite=False))
        if np.isnan(x).any():
            row = int(np.argmax(np.isnan(x).any(axis=1)))
            raise ValueError(f"row {row} of X holds NaN: {x[row]}")
        if x.shape[0] > self.remaining:
            raise BudgetExceededError(
                f"{x.shape[0]} more runs asked for, but only {self.remaining} of "
                f"max_evals = {self.max_evals} are left"
            )
        return x

    def check_time(self) -> None:
        """Raise if the wall-clock limit is over: for work between and after model runs.

        Whoever catches the error may sum up what there is: for a few seconds and a tenth of the
        limit nothing is raised again, except that no more runs are started.

        Raises
        ------
        TimeLimitError
            If the limit is over, and the time for summing up too if the error was raised before.
        """
        limit = self._deadline if self._summed_up_by is None else self._summed_up_by
        if limit is not None and time.monotonic() >= limit:
            self._time_is_over()

    def check_deadline(self) -> None:
        """Raise if no run is started any more: before work that is nothing without runs.

        Raises
        ------
        TimeLimitError
            If the wall-clock limit is over, also while there is still time for summing up.
        """
        if self._deadline is not None and time.monotonic() >= self._deadline:
            self._time_is_over()

    @property
    def watched(self) -> bool:
        """Whether anybody looks at running estimates."""
        return self.settings.watch is not None

    def report(self, estimate: RunningEstimate) -> None:
        """Show where the estimate stands."""
        if self.settings.watch is not None:
            self.settings.watch(estimate)

    def _batches(self, blocks: Iterable[FloatArray]) -> Iterator[_Batch]:
        """Cut blocks into batches, in a way that depends on nothing but the settings."""
        for block in blocks:
            x = self.admit(block)
            n = x.shape[0]
            self._reserved += n
            y = np.full(n, np.nan)
            grain = 1 if n <= SMALL_CALL or isinstance(self.model, RowModel) else GRAIN
            rows = self._batch_rows(grain)
            for start in range(0, max(n, 1), rows):
                here = slice(start, start + rows)
                yield _Batch(x[here], y[here], grain, y, last=start + rows >= n)

    def _batch_rows(self, grain: int) -> int:
        if self.settings.batch_rows is not None:
            return self.settings.batch_rows
        if isinstance(self.model, RowModel):
            return 1
        return self.executor.small_batch_rows if grain == 1 else self.executor.batch_rows

    def _begin(self, batch: _Batch, under_way: dict[int, _Batch], *, first: bool) -> None:
        """Look a batch up in the store, and hand over what is not there."""
        self.check_deadline()
        x = batch.x
        if self.shelf is not None:
            batch.y[:] = self.shelf.look_up(x, batch.grain)
            batch.missing = np.isnan(batch.y)
            batch.n_reused = x.shape[0] - int(batch.missing.sum())
            x = x[batch.missing]
        if x.shape[0] == 0:
            batch.done = True
            return
        number = next(self._numbers)
        under_way[number] = batch
        asks = self.in_doubt and self._in_question is None
        if asks:
            self._in_question = number
        with program_blas_threads():
            self._runner.submit(number, x, Caution(first and self._n_good == 0, asks))

    def _collect(self, under_way: dict[int, _Batch]) -> None:
        """Wait for any batch under way, and keep its responses."""
        with program_blas_threads():
            while (found := self._runner.finished(WAKE_SECONDS)) is None:
                self.check_deadline()
        number, outcome = found
        batch = under_way.pop(number)
        if outcome.unusable:
            raise ModelError(outcome.unusable)
        if number == self._in_question:
            self.in_doubt, self._in_question = outcome.in_doubt, None
        if batch.missing is None:
            batch.y[:] = outcome.y
        else:
            batch.y[batch.missing] = outcome.y
        batch.reason, batch.done = outcome.reason, True
        if self.shelf is not None:
            if self.in_doubt and batch.x.shape[0] > 1:
                # from here on others may write into these arrays
                kept = batch.x.copy(), batch.y.copy(), batch.grain, outcome.seconds
                self._unkept.append(kept)
                return
            if not self.in_doubt:
                for entry in self._unkept:
                    self.shelf.keep(*entry)
                self._unkept.clear()
            self.shelf.keep(batch.x, batch.y, batch.grain, outcome.seconds)

    def _account(self, batch: _Batch) -> None:
        """Count a batch, and apply the policy for failed runs."""
        n = batch.x.shape[0]
        failed = np.isnan(batch.y)
        n_failed = int(np.count_nonzero(failed))
        self._reserved -= n
        self.n_evals += n
        self.n_reused += batch.n_reused
        self.n_failed += n_failed
        self._n_good += n - n_failed
        if n_failed:
            self._judge(batch, failed)
        if n and self.settings.progress is not None:
            self.settings.progress(self.n_evals, self.expected)

    def _judge(self, batch: _Batch, failed: BoolArray) -> None:
        if not self.first_failure:
            row = int(np.argmax(failed))
            returned = f"the model returned NaN at x = {shown(batch.x[row])}"
            self.first_failure = batch.reason or returned
        if self.settings.failed_runs == "raise":
            raise FailedRunError(self.first_failure)
        if self._n_good == 0 and self.n_failed >= GIVE_UP_AFTER:
            raise FailedRunError(
                f"all of the first {self.n_failed} runs failed; {self.first_failure}"
            )
        if self.settings.failed_runs == "count-as-failure":
            batch.y[failed] = np.inf

    def _time_is_over(self) -> NoReturn:
        limit = self.settings.max_seconds
        assert limit is not None
        assert self._deadline is not None
        self._summed_up_by = self._deadline + GRACE_SECONDS + GRACE_SHARE * limit
        raise TimeLimitError(
            f"the wall-clock limit of {limit:g} s is over after {self.n_evals} runs "
            "(max_seconds of the evaluator)"
        )
