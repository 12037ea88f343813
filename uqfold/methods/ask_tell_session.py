"""One estimate whose evaluations are made by the caller: ask for rows, tell their responses."""

from __future__ import annotations

import time
from dataclasses import dataclass, field
from os import PathLike
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from uqfold.algebra import one_blas_thread
from uqfold.checks import array, instance, refused, shown
from uqfold.checks import path as checked_path
from uqfold.evaluation import Evaluator
from uqfold.methods import session_file
from uqfold.methods.arguments import CriteriaLike, checked_evaluator
from uqfold.methods.base import OpenRun, Solution
from uqfold.methods.result import ReliabilityResult
from uqfold.methods.seeding import RandomSource
from uqfold.methods.steps import SteppedMethod
from uqfold.problems.base import Problem
from uqfold.problems.responses import ResponseError, numbers_in
from uqfold.typing import FloatArray


@dataclass
class _ToldModel:
    """Stands in for the model: hands out responses that were told, in order."""

    y: FloatArray = field(default_factory=lambda: np.empty(0))
    position: int = 0

    def __call__(self, x: FloatArray) -> FloatArray:
        self.position += x.shape[0]
        return self.y[self.position - x.shape[0] : self.position]


class AskTellSession:
    """One estimate whose evaluations are made outside; from `SequentialMethod.start`.

    ::

        session = method.start(problem, criteria, rng=1, max_evals=100)
        while not session.done:
            x = session.ask()
            session.tell(x, my_model(x))
        result = session.result()

    On the same processor the result is that of `estimate` with the same arguments, bit for bit,
    except for `seconds`, which counts the method's own time only.
    """

    def __init__(
        self,
        method: SteppedMethod,
        problem: Problem,
        criteria: CriteriaLike,
        max_evals: int | None,
        rng: RandomSource,
        evaluator: Evaluator | None,
    ) -> None:
        instance("method", method, (SteppedMethod,), "give a method such as Kriging()")
        self._method = method
        self._told = _ToldModel()
        settings = checked_evaluator(evaluator)
        self._run: OpenRun = method._opened(
            problem, criteria, max_evals, rng, settings, model=self._told
        )
        self._steps = method._steps(self._run.task)
        self._history: list[tuple[FloatArray, FloatArray]] = []
        self._asked: FloatArray | None = None
        self._answers: FloatArray = np.empty(0)
        self._open: dict[bytes, list[int]] = {}
        self._solution: Solution | None = None
        self._error: Exception | None = None
        self._seconds = 0.0
        if self._run.task.criteria:
            self._advance(None)
        else:
            self._solution = Solution([])

    @property
    def done(self) -> bool:
        """Whether nothing more is to be asked, and the result is there."""
        return self._solution is not None or self._error is not None

    @property
    def seed(self) -> int:
        """The recorded seed."""
        return self._run.task.seed

    @property
    def n_evals(self) -> int:
        """Responses told so far, those of an unfinished batch included."""
        open_rows = 0 if self._asked is None else self._asked.shape[0] - self._missing
        return self._run.task.session.n_evals + open_rows

    @property
    def _missing(self) -> int:
        return sum(len(rows) for rows in self._open.values())

    def ask(self) -> FloatArray:
        """Return the rows X (n, d) whose responses are wanted next, columns shared inputs first.

        They may run in parallel. Asking again gives the rows of the same batch that are still
        without a response.

        Raises
        ------
        RuntimeError
            If the session is done.
        """
        if self._asked is None:
            raise RuntimeError("the session is done: nothing more is to be run, call result()")
        rows = sorted(row for some in self._open.values() for row in some)
        return self._asked[rows]

    def tell(self, x: ArrayLike, y: ArrayLike) -> None:
        """Hand over the responses of rows that were asked for.

        Parameters
        ----------
        x
            Rows (n, d) of the last `ask`, all or some of them, in any order.
        y
            Their responses (n,) or (n, 1), real numbers. +-inf are valid responses; NaN, None or a
            masked entry marks a failed run.

        Raises
        ------
        RuntimeError
            If the session is done.
        TypeError
            If `x` or `y` holds something that is not a real number.
        ValueError
            If shapes do not fit, or a row was not asked for or has its response already; nothing
            is taken over then.
        FailedRunError
            Under the policy ``raise``, if a run failed.
        """
        if self._asked is None:
            raise RuntimeError("the session is done: it takes no more responses")
        # adding zero turns -0.0 into 0.0, so that equal rows have equal bytes
        rows = array("x", x, ("n", self._asked.shape[1]), finite=False) + 0.0
        values = _told_responses(y)
        if values.shape != rows.shape[:1]:
            raise refused("y", y, f"give one response for each of {rows.shape[0]} rows")
        waiting = {key: list(some) for key, some in self._open.items()}
        for row, value in zip(rows, values, strict=True):
            places = waiting.get(row.tobytes())
            if not places:
                raise ValueError(f"row {row} was not asked for, or has its response already")
            self._answers[places.pop(0)] = value
        self._open = {key: some for key, some in waiting.items() if some}
        if not self._open:
            self._close_batch()

    def result(self) -> ReliabilityResult:
        """Return the result.

        Raises
        ------
        RuntimeError
            If responses are still wanted.
        FailedRunError
            Under the policy ``raise``, if a run failed.
        """
        if self._error is not None:
            raise self._error
        if self._solution is None:
            raise RuntimeError(
                f"{self._missing} responses are still wanted: ask() for their rows and tell() them"
            )
        return self._method._finished(self._run, self._solution, self._seconds)

    def save(self, path: str | PathLike[str]) -> None:
        """Write all responses told so far to a file, from which `resume` goes on.

        The file replaces a former one at once, so that an interrupted save loses nothing. Nor does
        one of another process: a file with responses that this session has not is left as it is.

        Raises
        ------
        SessionFileError
            If the file belongs to another run, or holds responses that this session has not.
        ValueError, TypeError
            If the path is none.
        OSError
            If it cannot be written.
        """
        path = checked_path("path", path)
        batches = list(self._history)
        if self._asked is not None:
            batches.append((self._asked, self._answers))
        told = np.ones(sum(x.shape[0] for x, _ in batches), dtype=np.bool_)
        if self._asked is not None:
            first = told.size - self._asked.shape[0]
            told[[first + row for some in self._open.values() for row in some]] = False
        session_file.write(path, self.header(), batches, told)

    def header(self) -> dict[str, Any]:
        """Return what identifies this run in a file."""
        task = self._run.task
        return session_file.header(
            self._method, task.problem, self._run.asked, task.seed, task.session
        )

    def replay(self, saved: session_file.SavedSession) -> None:
        """Tell a fresh session all responses of a file.

        Raises
        ------
        SessionFileError
            If this session asks for other rows than those in the file.
        """
        for x, y, told in saved.batches:
            if self._asked is None or not session_file.same_rows(x, self._asked):
                raise session_file.SessionFileError(
                    f"{saved.path}: this method asks for other rows than those in the file, which "
                    "another version of the method or other inputs have made"
                )
            self.tell(self._asked[told], y[told])

    def _close_batch(self) -> None:
        assert self._asked is not None
        x, y = self._asked, self._answers
        self._history.append((x, y))
        self._told.y = np.concatenate([self._told.y, y])
        self._asked = None
        try:
            responses = self._run.task.session.evaluate(x)
        except Exception as error:
            self._end(error)
            return
        self._advance(responses)

    def _advance(self, responses: FloatArray | None) -> None:
        """Run the method up to its next question or its end."""
        started = time.perf_counter()
        task = self._run.task
        try:
            with one_blas_thread():
                x = next(self._steps) if responses is None else self._steps.send(responses)
            self._asked = task.session.admit(x) + 0.0
        except StopIteration as stop:
            found: Solution = stop.value
            self._solution = self._method._guarded(task, lambda: found)
        except Exception as error:
            self._end(error)
        else:
            self._answers = np.full(self._asked.shape[0], np.nan)
            self._open = {}
            for index, row in enumerate(self._asked):
                self._open.setdefault(row.tobytes(), []).append(index)
        self._seconds += time.perf_counter() - started

    def _end(self, error: Exception) -> None:
        """End like `estimate` ends when its hook raises."""
        try:
            self._solution = self._method._failed(self._run.task, error)
        except Exception as raised:
            self._error = raised
            raise


def _told_responses(y: ArrayLike) -> FloatArray:
    try:
        values = numbers_in(y)
    except ResponseError as error:
        raise TypeError(f"y = {shown(y)}: {error}") from error
    if _is_complex(y):
        raise TypeError("y holds complex numbers: give real ones, NaN for a failed run")
    return values[:, 0] if values.ndim == 2 and values.shape[1] == 1 else values


def _is_complex(y: object) -> bool:
    if isinstance(y, list | tuple):
        return any(_is_complex(one) for one in y)
    return isinstance(y, complex) or getattr(y, "dtype", np.dtype(float)).kind == "c"
