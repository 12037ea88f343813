"""Ctrl-C as Python means it, whatever compiled libraries do with the signal.

OpenTURNS puts a handler of its own in place while it runs, which throws a C++ exception; thrown
while OpenTURNS is waiting for a Python function it takes the whole process down
(https://github.com/openturns/openturns/issues/3135). Here the signal never reaches such a handler:
it is blocked, and a thread that waits for it passes it on to Python.
"""

from __future__ import annotations

import _thread
import signal
import threading
from types import TracebackType

_POLL_SECONDS = 0.1


class Interrupts:
    """While entered, Ctrl-C raises KeyboardInterrupt in the main thread and is remembered.

    Threads inherit the block, so it is to be entered before anything starts one; a thread that
    runs already could still be handed the signal. Where signals cannot be blocked (Windows), or
    outside the main thread, nothing is changed.

    Attributes
    ----------
    requested
        Whether Ctrl-C was pressed; a library may have swallowed the exception since.
    """

    def __init__(self) -> None:
        self.requested = False
        self._leaving = threading.Event()
        self._waiter: threading.Thread | None = None

    def __enter__(self) -> Interrupts:
        """Take the signal over."""
        in_main = threading.current_thread() is threading.main_thread()
        if in_main and hasattr(signal, "sigtimedwait"):
            signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGINT})
            self._waiter = threading.Thread(target=self._pass_on, daemon=True)
            self._waiter.start()
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        """Give the signal back."""
        if self._waiter is not None:
            self._leaving.set()
            self._waiter.join()
            signal.pthread_sigmask(signal.SIG_UNBLOCK, {signal.SIGINT})

    def check(self) -> None:
        """Raise KeyboardInterrupt if Ctrl-C was pressed at any time before."""
        if self.requested:
            raise KeyboardInterrupt

    def _pass_on(self) -> None:
        while not self._leaving.is_set():
            if signal.sigtimedwait({signal.SIGINT}, _POLL_SECONDS) is not None:
                self.requested = True
                _thread.interrupt_main()
