"""The way of rows X to their responses y.

A block of rows is split into batches; what the store knows of it is looked up, the model is run on
the rest, and each batch comes out, in order, when all its responses are there. Several batches may
be under way in an executor, whose workers finish them in whatever order; nothing that comes out
depends on that, nor on the size of the batches.
"""

from __future__ import annotations

import math
from collections import deque
from collections.abc import Callable, Generator, Iterable, Iterator
from dataclasses import dataclass

import numpy as np

from uqfold.algebra import program_blas_threads
from uqfold.evaluation.batch import Caution
from uqfold.evaluation.calling import shown
from uqfold.evaluation.errors import BudgetExceededError, ModelError
from uqfold.evaluation.executors import Runner
from uqfold.evaluation.shelf import Shelf
from uqfold.typing import FloatArray, IntArray

WAKE_SECONDS = 0.2
"""How often a wait for workers looks at the clock and at Ctrl-C."""
AHEAD = 4
"""Finished batches that may wait for an earlier one, as a multiple of those under way."""
LONGEST_SECONDS, LONGEST_SHARE = 1.0, 0.05
"""A batch under a time limit is to take at most so long, and this share of what is left."""
GROWTH = 2.0
"""Nor has it more rows than this multiple of the largest one so far."""


@dataclass(eq=False)
class Batch:
    """The rows [start, stop) of a block X (n, d) -> y (n,), where `y` is NaN until it is known.

    Attributes
    ----------
    x, y
        The whole block.
    start, stop
        Which part of it is there when the batch is done.
    asked
        The rows of that part that the model is run on; the store knows the others.
    full
        Whether it ends where a batch without a time limit would end.
    reason
        What its first failed run looked like; empty if none failed.
    """

    x: FloatArray
    y: FloatArray
    start: int
    stop: int
    asked: IntArray
    full: bool
    reason: str = ""
    done: bool = False

    @property
    def is_last(self) -> bool:
        """Whether its block is complete with it."""
        return self.stop == self.y.size


@dataclass(eq=False)
class _Call:
    """Rows of a batch that a worker runs the model on at once.

    `later` are to follow one by one, as the rows of a batch do over which workers have died.
    """

    batch: Batch
    rows: IntArray
    later: IntArray
    deaths: int = 0


class BatchSize:
    """How many rows the model is run on at once.

    Nobody can stop a call of the model, so that with a limit on time a call must be short: the
    first has one row, and the time that runs took decides on the next.

    Parameters
    ----------
    seconds_left
        Tells how much time there is, infinite without a limit.
    """

    def __init__(self, seconds_left: Callable[[], float]) -> None:
        self._seconds_left = seconds_left
        self._rows = 1.0
        self._seconds_per_row = 0.0

    def rows(self, most: int) -> int:
        """Return the number of rows of the next batch, which may have `most`."""
        left = self._seconds_left()
        if math.isinf(left):
            return most
        if self._seconds_per_row > 0.0:
            allowed = min(LONGEST_SECONDS, LONGEST_SHARE * left)
            self._rows = min(self._rows, allowed / self._seconds_per_row)
        return max(1, min(most, int(self._rows)))

    def took(self, rows: int, seconds: float) -> None:
        """Learn from a batch."""
        if seconds > 0.0:  # of a worker that has died nobody knows
            self._seconds_per_row = seconds / rows
        self._rows = max(self._rows, GROWTH * rows)


class Pipeline:
    """Responses of one model, from a store or by running it.

    Parameters
    ----------
    runner
        Where the model is run.
    most_rows
        Tells the largest batch of a block with so many rows.
    seconds_left
        As for `BatchSize`.
    shelf
        Where responses are kept, or None.
    in_doubt
        Whether it is still to be found out that the model takes rows: a few of the first are then
        run again alone, which counts nowhere, and nothing is stored before. Where a time limit
        makes the first batches small, it is done again in larger ones.
    """

    def __init__(
        self,
        runner: Runner,
        most_rows: Callable[[int], int],
        seconds_left: Callable[[], float],
        shelf: Shelf | None,
        in_doubt: bool,
    ) -> None:
        self.runner = runner
        self._most_rows = most_rows
        self._seconds_left = seconds_left
        self._size = BatchSize(seconds_left)
        self._shelf = shelf
        self._in_doubt = in_doubt
        self._in_question: Batch | None = None
        # responses that were told come once: no row of them can be run again
        self._compare_from = 2 if in_doubt else math.inf
        self._any_good = False

    def batches(
        self, blocks: Iterable[FloatArray], check: Callable[[], None]
    ) -> Generator[Batch, None, None]:
        """Yield the batches of blocks X (n, d), in order, each when it is done.

        Blocks are drawn only as workers need them.

        Parameters
        ----------
        blocks
            May raise BudgetExceededError or ValueError, which is passed on after the batches of
            the blocks before.
        check
            Raises when no more runs are to be started.

        Raises
        ------
        ModelError
            If the model does not take rows, or returns something else than a response for each.
        EngineError
            If store or executor fail.
        """
        coming = self._split(blocks)
        queue: deque[Batch] = deque()
        more, refused = True, None
        try:
            while more or queue:
                if queue and queue[0].done:
                    yield queue.popleft()
                elif more and self._has_room(len(queue)):
                    try:
                        batch = next(coming, None)
                    except (BudgetExceededError, ValueError) as error:
                        batch, refused = None, error
                    if batch is None:
                        more = False
                    else:
                        check()
                        self._begin(batch, is_first=not queue)
                        queue.append(batch)
                else:
                    self._wait(check)
            if refused is not None:
                raise refused
        finally:
            self._end()

    def _split(self, blocks: Iterable[FloatArray]) -> Iterator[Batch]:
        for x in blocks:
            n, most = x.shape[0], self._most_rows(x.shape[0])
            y = np.full(n, np.nan) if self._shelf is None else self._shelf.look_up(x)
            asked = np.flatnonzero(np.isnan(y))
            self._any_good = self._any_good or asked.size < n
            start = taken = 0
            while True:
                rows = asked[taken : taken + min(self._size.rows(most), most - taken % most)]
                taken += rows.size
                stop = n if taken == asked.size else int(rows[-1]) + 1
                yield Batch(x, y, start, stop, rows, full=stop == n or taken % most == 0)
                if stop == n:
                    break
                start = stop

    def _has_room(self, n_waiting: int) -> bool:
        capacity = self.runner.capacity
        return self.runner.in_flight < capacity and n_waiting < AHEAD * capacity

    def _begin(self, batch: Batch, *, is_first: bool) -> None:
        """Have the model run on the rows that are not known."""
        if batch.asked.size == 0:
            batch.done = True
            return
        may_give_up = is_first and batch.full and not self._any_good
        self._submit(_Call(batch, batch.asked, batch.asked[:0]), may_give_up)

    def _submit(self, call: _Call, may_give_up: bool = False) -> None:
        if self._in_doubt and self._in_question is None:
            self._in_question = call.batch
        caution = Caution(
            may_give_up,
            in_doubt=self._in_doubt and call.batch is self._in_question,
            outgrown=call.rows.size >= self._compare_from,
        )
        with program_blas_threads():
            self.runner.submit(call, call.batch.x[call.rows], caution)

    def _wait(self, check: Callable[[], None]) -> None:
        """Wait until rows of any batch have been run, and keep their responses."""
        with program_blas_threads():
            while (found := self.runner.finished(WAKE_SECONDS)) is None:
                check()
        call: _Call
        call, outcome = found
        if outcome.unusable:
            raise ModelError(outcome.unusable)
        if outcome.died and self._run_again(call):
            return
        batch, rows = call.batch, call.rows[: outcome.y.size]
        rest = call.rows[outcome.y.size :]
        batch.y[rows] = outcome.y
        died = f"{outcome.died} at x = {shown(batch.x[rows[0]])}" if outcome.died else ""
        batch.reason = batch.reason or outcome.reason or died
        batch.done = rest.size == call.later.size == 0
        self._any_good = self._any_good or not np.isnan(outcome.y).all()
        self._compare_from = max(self._compare_from, outcome.compare_from)
        self._size.took(rows.size, outcome.seconds)
        if batch is self._in_question:
            self._in_doubt = self._in_doubt and outcome.in_doubt
            self._in_question = None if batch.done else batch
        if self._shelf is not None:
            if not self._in_doubt:
                self._shelf.release()
            # one row alone has the response that it has, whatever the model makes of several
            hold = self._in_doubt and rows.size > 1
            self._shelf.keep(batch.x, batch.y, rows, outcome.seconds, hold=hold)
        if not batch.done:
            check()
            following = (rest, call.later) if rest.size else (call.later[:1], call.later[1:])
            self._submit(_Call(batch, *following))

    def _run_again(self, call: _Call) -> bool:
        """Run rows again over which a worker has died; False if one row alone still does that."""
        call.deaths += 1
        alone = call.rows.size == 1
        if call.deaths <= (self.runner.retries if alone else min(self.runner.retries, 1)):
            self._submit(call)
        elif not alone:
            self._submit(_Call(call.batch, call.rows[:1], call.rows[1:]))
        else:
            return False
        return True

    def _end(self) -> None:
        self._in_question = None
        if self.runner.in_flight:
            self.runner.abandon()
        if self._shelf is not None:
            self._shelf.flush()
