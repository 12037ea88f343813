"""The wall-clock limit of the estimate under way, kept by loops that do not know who asked.

A limit on time holds only if every long loop looks at the clock: drawing inputs, fitting a
surface, integrating, refining. Such loops call `check_time` about once a second or oftener. It
does nothing unless an estimate with a limit is under way in this thread.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from contextvars import ContextVar

_CHECK: ContextVar[Callable[[], None] | None] = ContextVar("uqfold_time_limit", default=None)


def check_time() -> None:
    """Raise what the estimate under way raises once its time is over; else do nothing.

    Raises
    ------
    uqfold.evaluation.TimeLimitError
        If the limit is over.
    """
    check = _CHECK.get()
    if check is not None:
        check()


@contextmanager
def time_checked_by(check: Callable[[], None] | None) -> Iterator[None]:
    """Let `check_time` call `check` within this context; None: nothing is checked.

    Parameters
    ----------
    check
        Raises when the time is over. It replaces that of an outer context.
    """
    token = _CHECK.set(check)
    try:
        yield
    finally:
        _CHECK.reset(token)
