"""Running the model on one batch of samples, wherever that happens.

The functions here run in the calling process, in a thread, in a worker process or on a cluster, so
they know neither session nor store, and give the same responses everywhere.
"""

from __future__ import annotations

import time
from abc import ABC, abstractmethod
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np

from uqfold.time_limit import time_checked_by
from uqfold.typing import FloatArray, Model

GIVE_UP_AFTER = 64
"""A model whose first runs all fail is given up after this many."""


@dataclass(frozen=True, eq=False)
class Outcome:
    """Responses of one batch.

    Attributes
    ----------
    y
        Responses (n,); NaN marks a failed run.
    reason
        What the first failed run raised; empty if none raised.
    seconds
        Time that the batch took where it was run (s).
    """

    y: FloatArray
    reason: str
    seconds: float


class RowModel(ABC):
    """A model that runs one sample at a time; its failed runs leave the other samples alone."""

    parallel: int = 1
    """Runs to be made at the same time where no executor is given."""

    @abstractmethod
    def run(self, x: FloatArray) -> float:
        """Give the response of one sample x (d,); raise if the run fails."""

    def with_time_limit(self, seconds: float) -> RowModel | None:
        """Give this model with a limit on the time of one run, or None if it cannot keep one."""
        del seconds
        return None

    def stop(self) -> bool:
        """End the runs that other threads are making; tell whether this model can do that."""
        return False

    def __call__(self, x: FloatArray) -> FloatArray:
        """Responses (n,) of X (n, d); raises what the first failed run raises."""
        return np.array([self.run(row) for row in x], dtype=np.float64)


@dataclass(frozen=True)
class PerSample(RowModel):
    """A scalar function of one sample as a response model; see `per_sample`."""

    function: Callable[[FloatArray], Any]

    def run(self, x: FloatArray) -> float:
        """Response of one sample x (d,).

        Raises
        ------
        ValueError
            If the function gives more or less than one number.
        """
        y = np.asarray(self.function(x.copy()), dtype=np.float64)
        if y.size != 1:
            raise ValueError(f"it returned shape {y.shape} for one sample, expected one number")
        return float(y.item())


def per_sample(function: Callable[[FloatArray], Any]) -> PerSample:
    """Make a response model of a scalar function of one sample.

    Parameters
    ----------
    function
        Takes x (d,), columns shared inputs first; gives one number. NaN or an exception is a
        failed run, +inf is a valid response.

    Returns
    -------
    PerSample
        A model that takes X (n, d). An executor is handed single samples, so that all its
        workers are busy and each finished run is stored.

    Examples
    --------
    >>> import numpy as np
    >>> model = per_sample(lambda x: x[0] ** 2)
    >>> model(np.array([[2.0], [3.0]]))
    array([4., 9.])
    """
    return PerSample(function)


def run_batch(model: Model, x: FloatArray, may_give_up: bool = False) -> Outcome:
    """Run the model on every row; a run that raises or has the wrong shape becomes NaN.

    Parameters
    ----------
    model
        The response model, or a `RowModel`.
    x
        Inputs (n, d).
    may_give_up
        Whether no run has been good so far: rows are then left out as failed after the first 64
        or more have all failed by raising.
    """
    started = time.perf_counter()
    reasons: list[str] = []
    # the limit of the estimate ends no run that was started, whatever the model is made of
    with time_checked_by(None):
        y = _rows(model, x, reasons) if isinstance(model, RowModel) else None
        if y is None:
            y = _halved(model, x, may_give_up, reasons)
    return Outcome(y, reasons[0] if reasons else "", time.perf_counter() - started)


def _rows(model: RowModel, x: FloatArray, reasons: list[str]) -> FloatArray:
    y = np.full(x.shape[0], np.nan)
    for i, row in enumerate(x):
        try:
            y[i] = model.run(row)
        except Exception as error:
            reasons.append(_raised(error, row))
    return y


def _halved(model: Model, x: FloatArray, may_give_up: bool, reasons: list[str]) -> FloatArray:
    """One bad row must not take its neighbours with it: halve until it stands alone."""
    try:
        return _called(model, x)
    except Exception as error:
        if x.shape[0] > 1:
            half = x.shape[0] // 2
            first = _halved(model, x[:half], may_give_up, reasons)
            if may_give_up and half >= GIVE_UP_AFTER and np.isnan(first).all():
                return np.full(x.shape[0], np.nan)
            return np.concatenate([first, _halved(model, x[half:], False, reasons)])
        reasons.append(_raised(error, x[0]))
        return np.full(1, np.nan)


def _called(model: Model, x: FloatArray) -> FloatArray:
    # the model gets its own copy: what it does to its argument must not reach the method
    returned = np.asarray(model(x.copy()))
    if np.iscomplexobj(returned):
        raise TypeError("it returned complex numbers")
    y = np.asarray(returned, dtype=np.float64)
    if y.shape != (x.shape[0],):
        raise ValueError(f"it returned shape {y.shape}, expected ({x.shape[0]},)")
    return y.copy()


def _raised(error: Exception, x: FloatArray) -> str:
    return f"the model raised {type(error).__name__}: {error} at x = {shown(x)}"


def shown(x: FloatArray) -> str:
    """Give one sample as text for messages."""
    return "[" + ", ".join(f"{value:.6g}" for value in x) + "]"
