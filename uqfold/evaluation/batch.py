"""Running the model on one batch of samples, wherever that happens.

The functions here run in the calling process, in a thread, in a worker process or on a cluster, so
they know neither session nor store, and give the same responses everywhere.
"""

from __future__ import annotations

import math
import time
from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from uqfold.checks import raised
from uqfold.evaluation.calling import (
    Calls,
    RaisedError,
    UnusableError,
    failure_in,
    is_failed_run,
    misunderstood,
    shown,
)
from uqfold.evaluation.row_model import RowModel
from uqfold.problems.responses import one_number
from uqfold.time_limit import time_checked_by
from uqfold.typing import FloatArray, Model

GIVE_UP_AFTER = 64
"""A model whose first runs all fail is given up after this many."""
HAND_OVER_SECONDS = 0.05
"""So long samples are run one after the other before their responses are handed over."""


@dataclass(frozen=True)
class Caution:
    """What is not known of a model yet.

    Attributes
    ----------
    may_give_up
        No run has been good so far: rows are left out as failed after the first 64 or more have
        all failed by raising.
    in_doubt
        It is still to be found out whether the model takes rows.
    outgrown
        The batch has so many rows that some are to be compared with themselves alone again.
    """

    may_give_up: bool = False
    in_doubt: bool = False
    outgrown: bool = False


@dataclass(frozen=True, eq=False)
class Outcome:
    """Responses of one batch.

    Attributes
    ----------
    y
        Responses (n,); NaN marks a failed run. Of a `RowModel` those of the first samples, as many
        as have been run when it is time to hand them over; the others are still to be run.
    reason
        What the first failed run looked like; empty if none failed.
    seconds
        Time that the batch took where it was run (s).
    in_doubt
        Whether it is still to be found out that the model takes rows.
    compare_from
        A batch of so many rows is the next in which rows are to be compared; 0 if none were here.
    unusable
        Why the model cannot be used at all; empty if it can.
    died
        How the worker has ended over these rows, which may be run again; empty if it has not.
    """

    y: FloatArray
    reason: str
    seconds: float
    in_doubt: bool = False
    compare_from: int = 0
    unusable: str = ""
    died: str = ""

    @classmethod
    def lost(cls, *, reason: str = "", died: str = "") -> Outcome:
        """Return what there is of a row whose worker has ended, or was ended: NaN."""
        return cls(np.array(np.nan), reason, 0.0, in_doubt=True, died=died)


def run_batch(model: Model, x: FloatArray, caution: Caution) -> Outcome:
    """Run the model on every row; a run that raises becomes NaN.

    Parameters
    ----------
    model
        The response model, or a `RowModel`.
    x
        Inputs (n, d).
    caution
        What is not known of the model yet.
    """
    started = time.perf_counter()
    reasons: list[str] = []
    in_doubt = caution.in_doubt and not isinstance(model, RowModel)
    calls = Calls(model, in_doubt, caution.outgrown, reasons)
    unusable = ""
    # the limit of the estimate ends no run that was started, whatever the model is made of
    with time_checked_by(None):
        try:
            if isinstance(model, RowModel):
                last = started + HAND_OVER_SECONDS
                y = np.array(list(_samples(model, x, reasons, last)), dtype=np.float64)
            else:
                y = _halved(calls, x, caution.may_give_up)
        except UnusableError as error:
            y, unusable = np.full(x.shape[0], np.nan), str(error)
    seconds = time.perf_counter() - started
    reason = reasons[0] if reasons else ""
    return Outcome(y, reason, seconds, calls.in_doubt, calls.compare_from, unusable)


def _samples(model: RowModel, x: FloatArray, reasons: list[str], last: float) -> Iterator[float]:
    """Run the model on the samples X (n, d) until it is `last`, at least on one."""
    for row in x:
        yield _sample(model, row, reasons)
        if time.perf_counter() >= last:
            break


def _sample(model: RowModel, x: FloatArray, reasons: list[str]) -> float:
    """Run the model on one sample x (d,)."""
    try:
        returned = model.run(x)
        y = one_number(returned)
    except BaseException as error:
        if not is_failed_run(error):
            raise
        told = raised(error)
        if wanted := misunderstood(error, x):
            raise UnusableError(f"the model raised {told}. It is called with {wanted}") from error
        reasons.append(_raised(told, x))
        return math.nan
    if math.isnan(y):
        reasons.append(f"the model returned {failure_in(returned)} at x = {shown(x)}")
    return y


def _halved(calls: Calls, x: FloatArray, may_give_up: bool) -> FloatArray:
    """One row that raises must not take its neighbours with it: halve until it stands alone."""
    try:
        return calls.responses(x)
    except RaisedError as error:
        if x.shape[0] > 1:
            half = x.shape[0] // 2
            first = _halved(calls, x[:half], may_give_up)
            if may_give_up and half >= GIVE_UP_AFTER and np.isnan(first).all():
                return np.full(x.shape[0], np.nan)
            return np.concatenate([first, _halved(calls, x[half:], False)])
        calls.look_at_sample(x[0])
        calls.reasons.append(_raised(str(error), x[0]))
        return np.full(1, np.nan)


def _raised(error: str, x: FloatArray) -> str:
    return f"the model raised {error} at x = {shown(x)}"
