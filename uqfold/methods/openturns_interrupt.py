"""Keep Ctrl-C a KeyboardInterrupt while OpenTURNS runs.

While an algorithm runs, OpenTURNS has a signal handler of its own in place that throws a C++
exception; thrown while OpenTURNS waits for a Python function it ends the whole process
(https://github.com/openturns/openturns/issues/3135). A Python function that OpenTURNS calls puts
Python's handler back first, so that Ctrl-C is raised there and can be passed on.
"""

from __future__ import annotations

import signal
import threading


def reclaim_interrupt() -> None:
    """Put Python's own handler for Ctrl-C back in place; a no-op outside the main thread."""
    if threading.current_thread() is threading.main_thread():
        handler = signal.getsignal(signal.SIGINT)
        if handler is not None:
            signal.signal(signal.SIGINT, handler)
