"""Distributions written in Python behind OpenTURNS' interface.

OpenTURNS calls them value by value. Whatever such a call raises, Ctrl-C above all, passes through
its compiled loops, which ends the whole process. So Ctrl-C waits until the call has returned.
"""

from __future__ import annotations

import signal
import sys
import threading
from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any

_KIND = "class=PythonDistribution"


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
