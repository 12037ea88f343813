"""The one door through which every method gets its model values.

The evaluator counts runs per sample, keeps the budget, checks what the model returns, applies the
policy for failed runs, and reports progress. A method sees only `EvaluationSession.evaluate`.
"""

from __future__ import annotations

import sys
from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Literal, get_args

import numpy as np

from uqfold.typing import FloatArray, Model

FailedRunPolicy = Literal["raise", "count-as-failure", "bound"]
ProgressCallback = Callable[[int, int | None], None]

BATCH_ROWS = 4096
GIVE_UP_AFTER = 64
"""A model whose first runs all fail is given up after this many."""


class BudgetExceededError(RuntimeError):
    """A method asked for more runs than `max_evals` allows."""


class FailedRunError(RuntimeError):
    """A model run failed under the policy ``raise``, or every run of the model fails."""


@dataclass(frozen=True)
class Evaluator:
    """How model runs are made: policy for failed runs, batch size, progress.

    Attributes
    ----------
    failed_runs
        ``bound`` (default): a failed run stays open, and pf is bounded by counting all failed
        runs as safe, and all as failed. ``count-as-failure``: a failed run has response +inf.
        ``raise``: the first failed run ends the whole estimate with `FailedRunError`.
    batch_rows
        Rows handed to the model at once.
    progress
        Called with (runs so far, runs expected or None) after every batch.
    """

    failed_runs: FailedRunPolicy = "bound"
    batch_rows: int = BATCH_ROWS
    progress: ProgressCallback | None = None

    def __post_init__(self) -> None:
        if self.failed_runs not in get_args(FailedRunPolicy):
            raise ValueError(
                f"failed_runs = {self.failed_runs!r}: choose from {get_args(FailedRunPolicy)}"
            )
        if self.batch_rows < 1:
            raise ValueError(f"batch_rows = {self.batch_rows}: give at least 1")

    def session(self, model: Model, dimension: int, max_evals: int | None) -> EvaluationSession:
        """Open the counted access to `model` for one estimate."""
        return EvaluationSession(self, model, dimension, max_evals)


@dataclass
class EvaluationSession:
    """Counted, budgeted access to one model during one estimate.

    Attributes
    ----------
    n_evals
        Runs asked for so far, one per row.
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
    n_evals: int = 0
    n_failed: int = 0
    first_failure: str = ""
    expected: int | None = None
    _n_good: int = field(default=0, repr=False)

    @property
    def remaining(self) -> int:
        """Runs that the budget still allows (a very large number without a budget)."""
        return sys.maxsize if self.max_evals is None else self.max_evals - self.n_evals

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
        FailedRunError
            If a run fails under the policy ``raise``, or the first 64 runs all fail.
        ValueError
            If `x` has the wrong shape or holds NaN.
        """
        x = self.admit(x)
        y = np.empty(x.shape[0])
        for start in range(0, x.shape[0], self.settings.batch_rows):
            stop = min(start + self.settings.batch_rows, x.shape[0])
            y[start:stop] = self._batch(x[start:stop])
            if self.settings.progress is not None:
                self.settings.progress(self.n_evals, self.expected)
        return y

    def admit(self, x: FloatArray) -> FloatArray:
        """Check rows that are to be run, without running them; errors as in `evaluate`."""
        x = np.ascontiguousarray(x, dtype=np.float64)
        if x.ndim != 2 or x.shape[1] != self.dimension:
            raise ValueError(f"X has shape {x.shape}, expected (n, {self.dimension})")
        if np.isnan(x).any():
            row = int(np.argmax(np.isnan(x).any(axis=1)))
            raise ValueError(f"row {row} of X holds NaN: {x[row]}")
        if x.shape[0] > self.remaining:
            raise BudgetExceededError(
                f"{x.shape[0]} more runs asked for, but only {self.remaining} of "
                f"max_evals = {self.max_evals} are left"
            )
        return x

    def _batch(self, x: FloatArray) -> FloatArray:
        y = self._run(x)
        failed = np.isnan(y)
        self.n_evals += x.shape[0]
        self.n_failed += int(failed.sum())
        self._n_good += int((~failed).sum())
        if failed.any():
            if not self.first_failure:
                row = int(np.argmax(failed))
                self.first_failure = f"the model returned NaN at x = {_shown(x[row])}"
            if self.settings.failed_runs == "raise":
                raise FailedRunError(self.first_failure)
            if self._n_good == 0 and self.n_failed >= GIVE_UP_AFTER:
                raise FailedRunError(
                    f"all of the first {self.n_failed} runs failed; {self.first_failure}"
                )
            if self.settings.failed_runs == "count-as-failure":
                y[failed] = np.inf
        return y

    def _run(self, x: FloatArray) -> FloatArray:
        """Responses of one batch; a run that raises or has the wrong shape becomes NaN."""
        try:
            return self._called(x)
        except Exception as error:
            if x.shape[0] > 1:
                # one bad row must not take its neighbours with it: halve until it stands alone
                half = x.shape[0] // 2
                first = self._run(x[:half])
                if self._n_good == 0 and half >= GIVE_UP_AFTER and np.isnan(first).all():
                    return np.full(x.shape[0], np.nan)
                return np.concatenate([first, self._run(x[half:])])
            if not self.first_failure:
                what = f"{type(error).__name__}: {error}"
                self.first_failure = f"the model raised {what} at x = {_shown(x[0])}"
            return np.full(1, np.nan)

    def _called(self, x: FloatArray) -> FloatArray:
        # the model gets its own copy: what it does to its argument must not reach the method
        y = np.asarray(self.model(x.copy()), dtype=np.float64)
        if y.shape != (x.shape[0],):
            raise ValueError(f"it returned shape {y.shape}, expected ({x.shape[0]},)")
        return y.copy()


def _shown(x: FloatArray) -> str:
    return "[" + ", ".join(f"{value:.6g}" for value in x) + "]"
