"""How a model is called: with rows X (n, d), each of which has a response of its own.

Nothing in a function says whether it takes rows, or one sample (d,); and what it returns may have
the right shape by chance, as that of a function of one sample has where n = d. So the first rows
that a model is run on tell: some of them are run again alone. What a row means must be the same
alone and among others, or the model is refused. A few rows say little of the many that come later,
so that this is repeated in batches that are much larger.
"""

from __future__ import annotations

import math
import re
import signal
from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass
from typing import Any

import numpy as np

from uqfold.checks import raised, said_by
from uqfold.problems.responses import ResponseError, numbers_in
from uqfold.typing import FloatArray, Model

COMPARED = 2
"""So many rows are run again alone at a time, ordinary ones and those of extreme responses."""
MOST_COMPARED = 2 * COMPARED
"""So many rows of one batch are run again alone at most, if all agree."""
TRIED = 5
"""So many rows are tried, where some of them fail alone."""
REPEATS = 4
"""So often a row is run again alone, where it differs: a model may be noisy."""
SHARE_OF_SPREAD, SHARE_OF_SIZE = 1e-4, 1e-6
"""Difference between a row alone and among others that is rounding, or the tolerance of a solver:
so much of the responses' interquartile range, and of their size."""
NOISE_RANGES, NOISE_RANGES_OF_EXTREMES = 10.0, 100.0
"""A noisy row lies within so many ranges of its repeats, and within so many if it was chosen for
its response."""
FEW = 8
"""So few rows may agree by chance: they may have been in the order in which a model sorts them."""
GROWTH_OF_FEW, GROWTH = 1.5, 8.0
"""Rows are compared again in a batch of this multiple of the few, or many, compared among before.
Where they are noisy, which takes more runs, few are as many."""

_WRAP = "If it takes one sample x (d,), wrap it: uqfold.evaluation.per_sample(model)"
_OTHER_ARGUMENTS = re.compile("positional argument|keyword-only argument|takes no (keyword )?arg")
_NO_NAMES = "only integers, slices"


class UnusableError(Exception):
    """The model cannot be called with rows X (n, d), or gives something else than their responses.

    It never leaves this room: a session turns it into a `ModelError`.
    """


class RaisedError(Exception):
    """What the model raised: a failed run."""


@dataclass(eq=False)
class Calls:
    """Calls of one model with rows.

    Attributes
    ----------
    model
        The model.
    in_doubt
        Whether it is still to be found out that the model takes rows.
    outgrown
        Whether there are so many rows that some are to be compared again.
    reasons
        Why runs have failed.
    compare_from
        A batch of so many rows is the next in which rows are to be compared; 0 if none were now.
    """

    model: Model
    in_doubt: bool
    outgrown: bool
    reasons: list[str]
    compare_from: int = 0
    _samples_tried: int = 0

    def responses(self, x: FloatArray) -> FloatArray:
        """Return the responses (n,) of the rows X (n, d).

        Raises
        ------
        RaisedError
            If the model raises.
        UnusableError
            If what it returns are not responses of these rows.
        """
        y = self._one_per_row(self._called(x), x)
        if x.shape[0] > 1:
            if self.in_doubt:
                self._compare(x, y, _telling(y), NOISE_RANGES)
                if x.shape[0] >= FEW:
                    self._compare(x, y, _extremes(y), NOISE_RANGES_OF_EXTREMES)
            elif self.outgrown and not self.compare_from:
                noisy = self._compare(x, y, _extremes(y), NOISE_RANGES_OF_EXTREMES)
                if noisy:
                    self._compare(x, y, _telling(y), NOISE_RANGES)
        return y

    def look_at_sample(self, x: FloatArray) -> None:
        """Refuse the model if it takes the sample x (d,), of which it does not take the row."""
        if not self.in_doubt or self._samples_tried == TRIED:
            return
        self._samples_tried += 1
        try:
            y = numbers_in(self._called(x))
        except (RaisedError, ResponseError):
            return
        if y.size == 1 and not np.isnan(y).any():
            raise UnusableError(
                f"the model takes one sample x ({x.size},), not rows X (n, {x.size}): wrap it, "
                "uqfold.evaluation.per_sample(model)"
            )

    def _called(self, x: FloatArray) -> Any:
        try:
            # the model gets its own copy: what it does to its argument must not reach the method
            return self.model(x.copy())
        except ResponseError as error:
            raise UnusableError(f"the model gives no responses: {said_by(error)}") from error
        except BaseException as error:
            if not is_failed_run(error):
                raise
            if self.in_doubt and (wanted := misunderstood(error, x)):
                raise UnusableError(
                    f"the model raised {raised(error)}. It is called with {wanted}"
                ) from error
            raise RaisedError(raised(error)) from error

    def _one_per_row(self, returned: Any, x: FloatArray) -> FloatArray:
        if returned is None:
            raise UnusableError("the model returned None: it lacks a return statement")
        try:
            y = numbers_in(returned)
        except ResponseError as error:
            raise UnusableError(f"the model gives no responses: {said_by(error)}") from error
        n = x.shape[0]
        if y.shape in {(n,), (n, 1)}:
            self._note_failures(returned, y, x)
            return y.reshape(n)
        if y.shape == () and n == 1:
            # so do models that take rows and drop axes of length one, and those of one sample
            self._note_failures([returned], y, x)
            if self.in_doubt:
                twice = np.repeat(x, 3 if x.shape[1] == 2 else 2, axis=0)
                several = self._one_per_row(self._called(twice), twice)
                self.in_doubt = not all(_same(one, float(y), several) for one in several)
            return y.reshape(1)
        self.look_at_sample(x[0])
        raise UnusableError(
            f"the model returned shape {y.shape} for {n} rows X {x.shape}, expected ({n},). {_WRAP}"
        )

    def _note_failures(self, returned: Any, y: FloatArray, x: FloatArray) -> None:
        failed = np.isnan(y.reshape(-1))
        if failed.any():
            row = int(np.argmax(failed))
            listed = isinstance(returned, list | tuple | np.ndarray)
            entry = returned[row] if listed else np.asanyarray(returned)[row]
            self.reasons.append(f"the model returned {failure_in(entry)} at x = {shown(x[row])}")

    def _compare(
        self, x: FloatArray, y: FloatArray, places: Iterable[int], noise_ranges: float
    ) -> bool:
        """Run some rows again alone; return whether one of them is noisy."""
        compared, failure, noisy = 0, "", False
        for i in places:
            row = x[i : i + 1]
            try:
                alone = float(self._alone(row))
            except RaisedError as error:
                failure = f"raises {error}"
                continue
            if np.isnan(alone):
                failure = "is NaN"
                continue
            if not _same(y[i], alone, y):
                if not self._is_noise(row, y[i], alone, noise_ranges):
                    self.look_at_sample(x[i])
                    raise UnusableError(
                        f"the response to a row depends on the rows beside it: {alone:.6g} alone, "
                        f"{y[i]:.6g} among {x.shape[0]}. Make each row's response its own, or run "
                        f"rows one by one: Evaluator(batch_rows=1). {_WRAP}"
                    )
                noisy = True
            compared += 1
            if compared == COMPARED:
                break
        if compared:
            self.in_doubt = False
            growth = GROWTH_OF_FEW if x.shape[0] < FEW and not noisy else GROWTH
            self.compare_from = math.ceil(growth * x.shape[0])
        elif failure and self.in_doubt:
            self.look_at_sample(x[int(np.flatnonzero(~np.isnan(y))[-1])])
            raise UnusableError(
                f"a row that has a response among {x.shape[0]} {failure} alone: make each row's "
                f"response its own. {_WRAP}"
            )
        return noisy

    def _alone(self, row: FloatArray) -> float:
        y = numbers_in(self._called(row))
        if y.size == 1:
            return float(y.item())
        self.look_at_sample(row[0])
        raise UnusableError(
            f"the model returned shape {y.shape} for one row X {row.shape}, expected (1,). {_WRAP}"
        )

    def _is_noise(self, row: FloatArray, among: float, alone: float, ranges: float) -> bool:
        """Whether the same row gives other responses when it is run again."""
        repeats = [alone]
        for _ in range(REPEATS):
            try:
                repeats.append(self._alone(row))
            except RaisedError:
                continue
        values = np.array(repeats)
        if not np.isfinite([*values, among]).all():
            return len(set(repeats)) > 1
        return bool(abs(among - values.mean()) <= ranges * np.ptp(values))


def is_failed_run(error: BaseException) -> bool:
    """Whether what a model raises is a failed run: all but an interrupt and what a signal means.

    ``sys.exit()`` in a model is a failed run; raised by a handler of a signal, which may come
    while the model is running, it ends the program.
    """
    if isinstance(error, Exception):
        return True
    if isinstance(error, KeyboardInterrupt):
        return False
    handlers = {_code(signal.getsignal(one)) for one in signal.valid_signals()} - {None}
    trace = error.__traceback__
    while trace is not None:
        if trace.tb_frame.f_code in handlers:
            return False
        trace = trace.tb_next
    return True


def failure_in(entry: Any) -> str:
    """Return what makes one entry of the responses a failed run, for messages."""
    while isinstance(entry, list | tuple) or getattr(entry, "ndim", 0) > 0:
        entry = entry[0]
    if isinstance(entry, np.ma.core.MaskedConstant):
        return "a masked entry"
    if isinstance(entry, complex | np.complexfloating) and entry.imag != 0.0:
        return "a complex number"
    if entry is None or type(entry).__name__ == "NAType":
        return "None" if entry is None else "<NA>"
    try:
        return "a number too large for a float" if entry == entry else "NaN"  # noqa: PLR0124
    except Exception:  # a NaN that signals, say
        return "NaN"


def misunderstood(error: BaseException, x: FloatArray) -> str:
    """Return what a model is called with if it raised because it expects something else, or "".

    It takes several arguments, or looks for inputs by name: neither depends on the values in X
    (n, d) or x (d,).
    """
    size, wrap = x.shape[-1], "uqfold.evaluation.per_sample"
    called = f"rows X (n, {size})" if x.ndim == 2 else f"one sample x ({size},)"
    first = "X[:, 0]" if x.ndim == 2 else "x[0]"
    if (
        isinstance(error, TypeError)
        and _OTHER_ARGUMENTS.search(said_by(error))
        and _at_the_call(error)
    ):
        return (
            f"{called} as the only argument, of which {first} is the first input: change it, or "
            f"wrap it: {wrap}(lambda x: model(*x))"
        )
    by_name = isinstance(error, IndexError) and said_by(error).startswith(_NO_NAMES)
    if isinstance(error, AttributeError):
        by_name = isinstance(error.obj, np.ndarray) and error.obj.shape == x.shape
    if not by_name:
        return ""
    of_one = f", or x[0] of one sample with {wrap}(model)" if x.ndim == 2 else ""
    return f"{called}, an array without names: write {first} for the first input{of_one}"


def _at_the_call(error: BaseException) -> bool:
    """Whether it was raised where the model is called, not by what the model calls itself."""
    trace = error.__traceback__
    while trace is not None and trace.tb_next is not None:
        trace = trace.tb_next
    return trace is not None and str(trace.tb_frame.f_globals.get("__name__")).startswith("uqfold.")


def shown(x: FloatArray) -> str:
    """Return one sample as text for messages."""
    return "[" + ", ".join(f"{value:.6g}" for value in x) + "]"


def _code(handler: Callable[..., Any] | int | None) -> Any:
    return getattr(getattr(handler, "__func__", handler), "__code__", None)


def _telling(y: FloatArray) -> Iterator[int]:
    """Rows that tell most: the last, which what adds up or sorts changes, and a middling one."""
    known = np.flatnonzero(~np.isnan(y))
    if known.size == 0:
        return
    order = known[np.argsort(y[known], kind="stable")]
    places = [known[-1], order[order.size // 2], known[0], order[0], order[-1], *known[:TRIED]]
    yield from [int(i) for i in dict.fromkeys(places)][:TRIED]


def _extremes(y: FloatArray) -> list[int]:
    """Rows that tell most of many: what is sorted, scaled or clipped shows at the ends."""
    known = np.flatnonzero(np.isfinite(y))
    if known.size == 0:
        return []
    return [int(known[np.argmin(y[known])]), int(known[np.argmax(y[known])])]


def _same(among: float, alone: float, y: FloatArray) -> bool:
    if among == alone:
        return True
    if not np.isfinite([among, alone]).all():
        return False
    finite = y[np.isfinite(y)]
    # halved, so that the difference of two large numbers does not overflow
    low, middle, high = np.quantile(0.5 * finite, [0.25, 0.5, 0.75])
    size = max(abs(among), abs(alone), 2.0 * abs(middle))
    allowed = SHARE_OF_SPREAD * (high - low) + 0.5 * SHARE_OF_SIZE * size
    return bool(abs(0.5 * among - 0.5 * alone) <= allowed)
