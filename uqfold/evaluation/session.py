"""Counted, budgeted access to one model during one estimate.

A `Pipeline` makes responses of rows; here they are counted, judged by the policy for failed runs
and handed out. All of that happens in the order of the rows, whatever the workers do, so that the
same seed gives the same answer everywhere.
"""

from __future__ import annotations

import sys
from collections.abc import Callable, Iterable, Iterator
from contextlib import closing, contextmanager
from dataclasses import dataclass, field, replace
from typing import Literal

import numpy as np

from uqfold.checks import array, whole
from uqfold.evaluation.batch import GIVE_UP_AFTER
from uqfold.evaluation.deadline import Deadline
from uqfold.evaluation.errors import BudgetExceededError, FailedRunError, TimeLimitError
from uqfold.evaluation.gradients import gradients_at
from uqfold.evaluation.pipeline import Batch, Pipeline
from uqfold.evaluation.samples import KeptSamples, Label
from uqfold.typing import FloatArray, Model

FailedRunPolicy = Literal["raise", "count-as-failure", "bound"]
ProgressCallback = Callable[[int, int | None], None]


@dataclass(frozen=True)
class RunningEstimate:
    """Where an estimate stands, for the progress display.

    Attributes
    ----------
    criterion
        The criterion as text.
    pf, ci_low, ci_high
        Failure probability so far, and its interval.
    """

    criterion: str
    pf: float
    ci_low: float
    ci_high: float


@dataclass(eq=False)
class EvaluationSession:
    """Counted, budgeted access to one model during one estimate; made by `Evaluator.open`.

    Attributes
    ----------
    pipeline
        What runs the model.
    deadline
        When no more runs are started.
    dimension
        Number of inputs d.
    max_evals
        The budget, or None.
    failed_runs, progress, watch
        As for `Evaluator`.
    lift
        Makes rows for the model of those that are asked for, or None: these are all there is.
    slopes
        Of each kind of units, the gradient of its model, or None.
    n_evals
        Evaluations asked for so far, one per row.
    n_reused
        How many of them came from the store.
    n_failed
        How many of them failed.
    first_failure
        What the first failed run looked like, for messages; empty if none failed.
    n_gradients
        Gradients asked for so far, one per row; they are no evaluations.
    expected
        Evaluations that the method expects to need in all, for the progress display.
    samples
        Keeps the runs, if they are to be kept.
    """

    pipeline: Pipeline
    deadline: Deadline
    dimension: int
    max_evals: int | None
    failed_runs: FailedRunPolicy = "bound"
    progress: ProgressCallback | None = None
    watch: Callable[[RunningEstimate], None] | None = None
    lift: Callable[[FloatArray], FloatArray] | None = None
    slopes: tuple[Model | None, ...] = ()
    n_evals: int = 0
    n_reused: int = 0
    n_failed: int = 0
    first_failure: str = ""
    n_gradients: int = 0
    expected: int | None = None
    samples: KeptSamples | None = None
    _reserved: int = field(default=0, repr=False)

    @property
    def remaining(self) -> int:
        """Evaluations that the budget still allows (a very large number without a budget)."""
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
            If fewer than n evaluations are left; none is spent then.
        TimeLimitError
            If the wall-clock limit is over before the last batch; it holds the responses of the
            rows before.
        FailedRunError
            If a run fails under the policy ``raise``, or the first 64 runs all fail.
        ModelError
            If the model does not take rows, or returns something else than a response for each.
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
        there = nothing = np.empty(0)  # what the block under way has so far
        admitted = map(self._reserve, blocks)
        try:
            with closing(self.pipeline.batches(admitted, self.check_deadline)) as batches:
                for batch in batches:
                    self._count(batch)
                    there = batch.y[: batch.stop]
                    if batch.is_last:
                        y, there = self._judged(there), nothing
                        yield y
        except TimeLimitError as error:
            error.responses = self._judged(there)
            raise
        finally:
            self._reserved = 0

    def gradients(self, x: FloatArray, kind: int = 0) -> FloatArray:
        """Return derivatives (n, d) of the response by the inputs at rows x (n, d).

        Parameters
        ----------
        x
            Inputs of units of one kind, shared ones first.
        kind
            Which kind; `slopes` tells whether its model offers a gradient.

        Raises
        ------
        GradientError
            If the gradient raises, or has another shape.
        TimeLimitError
            If the wall-clock limit is over.
        ValueError
            If that kind's model offers none.
        """
        x = array("x", x, ("n", "d"), finite=False)
        slope = self.slopes[whole("kind", kind, at_least=0, at_most=len(self.slopes) - 1)]
        if slope is None:
            raise ValueError(f"kind = {kind}: its model offers no gradient")
        self.check_deadline()
        self.n_gradients += len(x)
        return gradients_at(slope, x)

    def admit(self, x: FloatArray) -> FloatArray:
        """Return rows that are to be run, checked; errors as in `evaluate`."""
        x = np.ascontiguousarray(array("X", x, ("n", self.dimension), finite=False))
        if np.isnan(x).any():
            row = int(np.argmax(np.isnan(x).any(axis=1)))
            raise ValueError(f"row {row} of X holds NaN: {x[row]}")
        if x.shape[0] > self.remaining:
            raise BudgetExceededError(
                f"{x.shape[0]} more runs asked for, but only {self.remaining} of "
                f"max_evals = {self.max_evals} are left"
            )
        return x if self.lift is None else self.lift(x)

    def check_time(self) -> None:
        """Raise if the wall-clock limit is over: for work between and after evaluations.

        Whoever catches the error may sum up what there is: for a few seconds and a tenth of the
        limit nothing is raised again, except that no more runs are started.

        Raises
        ------
        TimeLimitError
            If the limit is over, and the time for summing up too if the error was raised before.
        """
        self.deadline.check(self.n_evals, summing_up=True)

    def check_deadline(self) -> None:
        """Raise if no run is started any more: before work that is nothing without runs.

        Raises
        ------
        TimeLimitError
            If the wall-clock limit is over, also while there is still time for summing up.
        """
        self.deadline.check(self.n_evals, summing_up=False)

    def expect(self, n_evals: int) -> None:
        """Tell the progress display how many evaluations there will be in all."""
        self.expected = n_evals if self.max_evals is None else min(n_evals, self.max_evals)

    @contextmanager
    def share(self, most: int) -> Iterator[EvaluationSession]:
        """Hand out a part of the budget as a session of its own; its runs are counted here too.

        Parameters
        ----------
        most
            Evaluations that it may spend; no more than are left.
        """
        before, expected = self.n_evals, self.expected

        def progress(n_evals: int, _: int | None) -> None:
            if self.progress is not None:
                self.progress(before + n_evals, expected)

        part = replace(
            self, max_evals=min(most, self.remaining), progress=progress,
            n_evals=0, n_reused=0, n_failed=0, first_failure="", n_gradients=0, expected=None,
        )  # fmt: skip
        try:
            yield part
        finally:
            self.n_evals += part.n_evals
            self.n_reused += part.n_reused
            self.n_failed += part.n_failed
            self.n_gradients += part.n_gradients
            self.first_failure = self.first_failure or part.first_failure

    def label(self, **labels: Label) -> None:
        """Say what the next runs are, for whoever keeps them; arrays have one entry for each run.

        A method that streams blocks, of which some may be drawn ahead, says nothing of single runs.
        """
        if self.samples is not None:
            self.samples.label(**labels)

    @property
    def watched(self) -> bool:
        """Whether anybody looks at running estimates."""
        return self.watch is not None

    def report(self, estimate: RunningEstimate) -> None:
        """Show where the estimate stands."""
        if self.watch is not None:
            self.watch(estimate)

    def _reserve(self, x: FloatArray) -> FloatArray:
        """Admit a block, and set its evaluations aside until they are counted."""
        x = self.admit(x)
        self._reserved += x.shape[0]
        return x

    def _count(self, batch: Batch) -> None:
        """Count a batch; raise where its failed runs end the estimate."""
        if self.samples is not None:
            rows = slice(batch.start, batch.stop)
            self.samples.add(batch.x[rows], batch.y[rows])
        failed = np.isnan(batch.y[batch.start : batch.stop])
        self._reserved -= failed.size
        self.n_evals += failed.size
        self.n_reused += failed.size - batch.asked.size
        self.n_failed += int(np.count_nonzero(failed))
        if failed.any():
            self.first_failure = self.first_failure or batch.reason
            if self.failed_runs == "raise":
                raise FailedRunError(self.first_failure)
            if batch.full and self.n_failed == self.n_evals >= GIVE_UP_AFTER:
                raise FailedRunError(
                    f"all of the first {self.n_failed} runs failed; {self.first_failure}"
                )
        if failed.size and self.progress is not None:
            self.progress(self.n_evals, self.expected)

    def _judged(self, y: FloatArray) -> FloatArray:
        """Return responses as the method sees them: an open run is NaN, a failure infinite."""
        return np.where(np.isnan(y), np.inf, y) if self.failed_runs == "count-as-failure" else y
