"""Ctrl-C while OpenTURNS runs: it waits, and is let in where Python code may raise.

OpenTURNS runs Python code for a user's function, but also to look at each sample that it is given.
What is raised there passes through its own loops, which make another error of it, or go on.
"""

from __future__ import annotations

import ctypes
import signal
import threading
from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any

_get_c_handler, _set_c_handler = ctypes.pythonapi.PyOS_getsig, ctypes.pythonapi.PyOS_setsig
_get_c_handler.restype, _get_c_handler.argtypes = ctypes.c_void_p, [ctypes.c_int]
_set_c_handler.restype, _set_c_handler.argtypes = ctypes.c_void_p, [ctypes.c_int, ctypes.c_void_p]
_OF_PYTHON = _get_c_handler(signal.SIGINT)
"""What the operating system calls where Python has a handler."""


def reclaim_interrupt() -> None:
    """Put Python's own handler for Ctrl-C in place, where OpenTURNS has another while it runs."""
    handler = signal.getsignal(signal.SIGINT)
    if threading.current_thread() is threading.main_thread():
        if handler is not None:
            signal.signal(signal.SIGINT, handler)
    elif callable(handler):
        _set_c_handler(signal.SIGINT, _OF_PYTHON)


class DeferredInterrupt:
    """A context in which Ctrl-C waits for the end; other threads than the main one never see it.

    Raises
    ------
    KeyboardInterrupt
        At the end, or whatever else the program's own handler does.
    """

    def __init__(self) -> None:
        self._handler: Any = None
        self._pressed: list[Any] = []

    def __enter__(self) -> DeferredInterrupt:
        handler = signal.getsignal(signal.SIGINT)
        if threading.current_thread() is threading.main_thread() and callable(handler):
            signal.signal(signal.SIGINT, self._note)
            self._handler = handler
        return self

    def __exit__(self, *_: object) -> None:
        if self._handler is not None:
            signal.signal(signal.SIGINT, self._handler)
            self._answer()

    @contextmanager
    def let_in(self) -> Iterator[None]:
        """Within the context: let Ctrl-C in while Python code runs that OpenTURNS has called."""
        reclaim_interrupt()
        if self._handler is None:
            yield
            return
        try:
            signal.signal(signal.SIGINT, self._handler)
            self._answer()
            yield
        finally:
            signal.signal(signal.SIGINT, self._note)

    def _note(self, _: int, frame: Any) -> None:
        self._pressed.append(frame)

    def _answer(self) -> None:
        if self._pressed:
            frame = self._pressed.pop()
            self._pressed.clear()
            self._handler(signal.SIGINT, frame)
