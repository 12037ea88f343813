"""One estimate whose evaluations are made by the caller: ask for rows, tell their responses."""

from __future__ import annotations

import contextvars
import threading
import time
import weakref
from collections.abc import Callable, Mapping
from contextlib import suppress
from functools import partial
from os import PathLike
from typing import Any, TypeVar

import numpy as np
from numpy.typing import ArrayLike

from uqfold.checks import array, refused, shown
from uqfold.checks import path as checked_path
from uqfold.evaluation import EvaluationSession
from uqfold.methods import session_file
from uqfold.methods.result import ReliabilityResult
from uqfold.problems.responses import ResponseError, numbers_in
from uqfold.typing import FloatArray

T = TypeVar("T")


class Elsewhere:
    """Stands in for the model in the thread of a method: hands rows out, waits for responses."""

    def __init__(self) -> None:
        self._turn = threading.Condition()
        self._x: FloatArray | None = None
        self._y: list[FloatArray] = []
        self._ended = False
        self._left = False

    def __call__(self, x: FloatArray) -> FloatArray:
        """Return the responses (n,) of rows X (n, d) once somebody has told them."""
        with self._turn:
            self._x = x
            self._turn.notify_all()
            self._turn.wait_for(lambda: self._y or self._left)
            if not self._y:
                raise _LeftError
            return self._y.pop()

    def run(self, work: Callable[[], None]) -> None:
        """Do the work of a method in a thread of its own, in the context of the caller."""

        def whole() -> None:
            with suppress(_LeftError):
                work()
            with self._turn:
                self._ended = True
                self._turn.notify_all()

        context = contextvars.copy_context()
        threading.Thread(target=context.run, args=(whole,), daemon=True).start()

    def asked(self) -> FloatArray | None:
        """Wait for the method: return the rows that it asks for, or None at its end."""
        with self._turn:
            self._turn.wait_for(lambda: self._x is not None or self._ended)
            return self._x

    def tell(self, y: FloatArray) -> None:
        """Let the method go on with responses (n,)."""
        with self._turn:
            self._x = None
            self._y.append(y)
            self._turn.notify_all()

    def leave(self) -> None:
        """Let the thread end where it waits."""
        with self._turn:
            self._left = True
            self._turn.notify_all()


class _LeftError(KeyboardInterrupt):
    """The session is gone. No method takes it for a failed run."""


class AskTellSession:
    """One estimate whose evaluations are made outside; from `ReliabilityMethod.start`.

    ::

        session = method.start(problem, criteria, rng=1, max_evals=100)
        while not session.done:
            x = session.ask()
            session.tell(x, my_model(x))
        result = session.result()

    On the same processor the result is that of `estimate` with the same arguments, bit for bit,
    except for `seconds`, which counts the method's own time only. The method works in a thread of
    its own, which waits while runs are made.

    Parameters
    ----------
    elsewhere
        What the method has for a model.
    session
        The count of its runs.
    header
        What identifies the run in a file, besides the rows.
    solve
        Runs the method.
    finish
        Makes the result of what `solve` has returned and of the method's own seconds.
    """

    def __init__(
        self,
        elsewhere: Elsewhere,
        session: EvaluationSession,
        header: Mapping[str, Any],
        solve: Callable[[], T],
        finish: Callable[[T, float], ReliabilityResult],
    ) -> None:
        self._elsewhere, self._session, self._header = elsewhere, session, header
        self._finish: Callable[[float], ReliabilityResult] | None = None
        self._error: BaseException | None = None
        self._told: list[tuple[FloatArray, FloatArray]] = []
        self._asked: FloatArray | None = None
        self._answers: FloatArray = np.empty(0)
        self._open: dict[bytes, list[int]] = {}
        self._seconds = 0.0
        ended: list[Callable[[float], ReliabilityResult] | BaseException] = []

        def work() -> None:
            try:
                ended.append(partial(finish, solve()))
            except _LeftError:
                raise
            except BaseException as error:
                ended.append(error)

        self._ended = ended
        # the thread knows nothing of this object, which is gone when nobody holds it any more
        weakref.finalize(self, elsewhere.leave).atexit = False
        elsewhere.run(work)
        self._advance()

    @property
    def done(self) -> bool:
        """Whether nothing more is to be asked, and the result is there."""
        return self._finish is not None or self._error is not None

    @property
    def seed(self) -> int:
        """The recorded seed."""
        return int(self._header["seed"])

    @property
    def n_evals(self) -> int:
        """Responses told so far, those of an unfinished batch included."""
        return sum(y.size for _, y in self._told) + self._answers.size - self._missing

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
        if self._finish is None:
            raise RuntimeError(
                f"{self._missing} responses are still wanted: ask() for their rows and tell() them"
            )
        return self._finish(self._seconds)

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
        batches = list(self._told)
        if self._asked is not None:
            batches.append((self._asked, self._answers))
        told = np.ones(sum(x.shape[0] for x, _ in batches), dtype=np.bool_)
        if self._asked is not None:
            first = told.size - self._asked.shape[0]
            told[[first + row for some in self._open.values() for row in some]] = False
        session_file.write(path, self._header, batches, told)

    def replay(self, saved: session_file.SavedSession) -> None:
        """Tell a fresh session all responses of a file.

        Raises
        ------
        SessionFileError
            If the file belongs to another run, or this session asks for other rows than those in
            the file.
        """
        saved.check_belongs_to(self._header)
        first = 0
        while first < saved.y.size:
            rows = slice(first, first + (0 if self._asked is None else self._asked.shape[0]))
            x, y, told = saved.x[rows], saved.y[rows], saved.told[rows]
            if self._asked is None or not session_file.same_rows(x, self._asked[: x.shape[0]]):
                raise session_file.SessionFileError(
                    f"{saved.path}: this method asks for other rows than those in the file, which "
                    "another version of the method or other inputs have made"
                )
            first += x.shape[0]
            self.tell(self._asked[: x.shape[0]][told], y[told])

    def _close_batch(self) -> None:
        assert self._asked is not None
        x, y = self._asked, self._answers
        self._told.append((x, y))
        self._asked, self._answers = None, np.empty(0)
        self._elsewhere.tell(y)
        self._advance()
        if self._error is not None:
            raise self._error

    def _advance(self) -> None:
        """Wait until the method has its next question, or has come to its end."""
        started = time.perf_counter()
        x = self._elsewhere.asked()
        self._seconds += time.perf_counter() - started
        if x is None:
            [end] = self._ended
            if isinstance(end, BaseException):
                self._error = end
            else:
                self._finish = end
            return
        # adding zero turns -0.0 into 0.0, so that equal rows have equal bytes
        self._asked = x + 0.0
        self._answers = np.full(x.shape[0], np.nan)
        self._open = {}
        for index, row in enumerate(self._asked):
            self._open.setdefault(row.tobytes(), []).append(index)


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
