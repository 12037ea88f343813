"""One setting for linear algebra whose result decides something: one BLAS thread.

BLAS cuts sums differently for each number of threads. A last bit more or less decides where a
search for hyperparameters ends, or which run an adaptive method makes next, so that answers would
depend on the environment. Matrices as small as ours are also several times slower on threads that
wait for each other.

The number of threads belongs to the process. So the first of its threads that computes saves the
program's setting and the last one restores it, whatever ends their work; a thread that runs the
user's model meanwhile stands aside.
"""

from __future__ import annotations

import os
import threading
from collections.abc import Iterator
from contextlib import contextmanager
from functools import cache
from typing import Any, TypeAlias

_Former: TypeAlias = list[tuple[Any, int]]
"""Libraries, and how many threads the program lets each of them have."""


class _OneThread:
    """Which threads of the program compute on one BLAS thread, and what is to be restored."""

    def __init__(self) -> None:
        self._lock = threading.RLock()
        # with what is to be restored in the one thread that it belongs to
        self._computing: dict[int, _Former] = {}
        self._shared: _Former | None = None

    def holds(self, thread: int) -> bool:
        return thread in self._computing

    def set(self, computing: bool) -> None:
        """Return whether this thread computes; each step may be the last one before Ctrl-C."""
        thread = threading.get_ident()
        with self._lock:
            if computing:
                own = self._computing.setdefault(thread, _settings(own=True))
                _limit(own)
            else:
                for library, threads in self._computing.get(thread, ()):
                    _set(library, threads)
                self._computing.pop(thread, None)
            self._settle()

    def alone(self) -> None:
        """After a fork, in the child: no other thread is there, whatever it was at."""
        thread = threading.get_ident()
        self._lock = threading.RLock()
        self._computing = {key: own for key, own in self._computing.items() if key == thread}
        self._settle()

    def _settle(self) -> None:
        if self._computing:
            if self._shared is None:
                self._shared = _settings(own=False)
            _limit(self._shared)
        elif self._shared is not None:
            for library, threads in self._shared:
                _set(library, threads)
            self._shared = None


def _settings(*, own: bool) -> _Former:
    """Number of threads of all libraries in which it belongs to each thread, or to all."""
    return [
        (library, library.get_num_threads())
        for library in _libraries()
        if own == (getattr(library, "threading_layer", "") == "openmp")
    ]


def _limit(libraries: _Former) -> None:
    for library, _ in libraries:
        _set(library, 1)


def _set(library: Any, threads: int) -> None:
    if library.get_num_threads() == threads:
        return
    # newer threadpoolctl ignores, without a word, all threads but the first that set a number
    clear = getattr(library, "clear_controlling_thread", None)
    for _ in range(1 if clear is None else 3):
        if clear is not None:
            clear(force=True)
        library.set_num_threads(threads)
        if clear is not None:
            clear()
        if library.get_num_threads() == threads:
            break


@cache
def _libraries() -> tuple[Any, ...]:
    """Controllers of the BLAS libraries in this process; finding them takes milliseconds."""
    import numpy as np  # noqa: F401 - each of the two may bring a library of its own
    import scipy.linalg  # noqa: F401
    from threadpoolctl import ThreadpoolController

    return tuple(ThreadpoolController().select(user_api="blas").lib_controllers)


_STATE = _OneThread()
if hasattr(os, "register_at_fork"):
    os.register_at_fork(after_in_child=_STATE.alone)


@contextmanager
def one_blas_thread() -> Iterator[None]:
    """Compute on one BLAS thread; may be nested, and used in several threads at a time.

    The setting of the program is restored when none of its threads computes any more. If the
    program itself changes its setting meanwhile, the former one is restored all the same.
    """
    with _computing(True):
        yield


@contextmanager
def program_blas_threads() -> Iterator[None]:
    """Call the program's own code within `one_blas_thread`: with its own setting.

    While another thread computes, that one's setting stays.
    """
    with _computing(False):
        yield


@contextmanager
def _computing(now: bool) -> Iterator[None]:
    before = _STATE.holds(threading.get_ident())
    if before == now:
        yield
        return
    try:
        _STATE.set(now)
        yield
    finally:
        try:
            _STATE.set(before)
        except BaseException:
            # Ctrl-C while the setting is restored
            _STATE.set(before)
            raise
