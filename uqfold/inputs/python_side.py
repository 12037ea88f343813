"""Where Python meets the compiled loops of OpenTURNS: Ctrl-C, and distributions written in Python.

While any of its functions runs, OpenTURNS has a handler of its own for Ctrl-C, which throws a C++
exception wherever the program is, in whatever thread
(https://github.com/openturns/openturns/issues/3135): often the end of the process, otherwise an
error like any other. Whatever a distribution written in Python raises passes through the same
loops. So a Python function that OpenTURNS calls puts Python's handler back first, and Ctrl-C waits
until OpenTURNS has returned.
"""

from __future__ import annotations

import ctypes
import signal
import sys
import threading
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import fields
from typing import Any

import numpy as np

_KIND = "class=PythonDistribution"

_get_c_handler, _set_c_handler = ctypes.pythonapi.PyOS_getsig, ctypes.pythonapi.PyOS_setsig
_get_c_handler.restype, _get_c_handler.argtypes = ctypes.c_void_p, [ctypes.c_int]
_set_c_handler.restype, _set_c_handler.argtypes = ctypes.c_void_p, [ctypes.c_int, ctypes.c_void_p]
_OF_PYTHON = _get_c_handler(signal.SIGINT) if callable(signal.getsignal(signal.SIGINT)) else None
"""What the operating system calls where Python has a handler; taken before OpenTURNS runs."""


def reclaim_interrupt() -> None:
    """Put Python's own handler for Ctrl-C back in place, in any thread."""
    handler = signal.getsignal(signal.SIGINT)
    if not callable(handler):
        if handler is not None:
            _set_c_handler(signal.SIGINT, int(handler) or None)
    elif _OF_PYTHON is not None:
        _set_c_handler(signal.SIGINT, _OF_PYTHON)
    elif threading.current_thread() is threading.main_thread():
        signal.signal(signal.SIGINT, handler)


def uninterrupted(function: Any) -> Any:
    """Return an OpenTURNS function through which Ctrl-C waits until it has returned."""
    import openturns as ot

    d = function.getInputDimension()

    def same(rows: Any) -> Any:
        reclaim_interrupt()
        # OpenTURNS never frees what it is given back in a form of its own
        return np.asarray(rows)

    return ot.ComposedFunction(
        ot.Function(function), ot.PythonFunction(d, d, same, func_sample=same)
    )


class WithoutCaches:
    """Pickles the fields of a record and not what was computed from them."""

    def __getstate__(self) -> dict[str, Any]:
        return {one.name: getattr(self, one.name) for one in fields(self)}  # type: ignore[arg-type]


def written_in_python(distribution: Any) -> bool:
    """Whether OpenTURNS calls Python for this distribution, or for a part of it."""
    return _KIND in repr(distribution)


def python_object(distribution: Any) -> Any | None:
    """Return the Python object behind an OpenTURNS distribution, or None if it has none.

    OpenTURNS keeps the object to itself, but calls it: a profile hook sees the call, in a thread
    of its own, so that nobody else's hook is touched.
    """
    if not repr(distribution).startswith(_KIND):
        return None
    import openturns as ot

    seen: list[Any] = []

    def hook(frame: Any, event: str, _: Any) -> None:
        own = frame.f_locals.get("self") if event == "call" and not seen else None
        if isinstance(own, ot.PythonDistribution):
            seen.append(own)

    def call() -> None:
        sys.setprofile(hook)
        try:
            distribution.computeCDF([0.0])
        except (RuntimeError, TypeError, ValueError):
            pass  # what it cannot compute is found where it is needed
        finally:
            sys.setprofile(None)

    thread = threading.Thread(target=call)
    thread.start()
    thread.join()
    return seen[0] if seen else None


@contextmanager
def interrupt_deferred() -> Iterator[None]:
    """Let Ctrl-C wait until the end of this context; other threads than the main one never see it.

    Raises
    ------
    KeyboardInterrupt
        At the end, or whatever else the program's own handler does.
    """
    handler = signal.getsignal(signal.SIGINT)
    if threading.current_thread() is not threading.main_thread() or not callable(handler):
        yield
        return
    pressed: list[Any] = []
    signal.signal(signal.SIGINT, lambda _, frame: pressed.append(frame))
    try:
        yield
    finally:
        signal.signal(signal.SIGINT, handler)
    if pressed:
        handler(signal.SIGINT, pressed[0])
