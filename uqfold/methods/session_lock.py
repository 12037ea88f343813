"""A lock on one file against other processes; the system takes it back when its holder dies."""

from __future__ import annotations

import os
import sys
import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

WAIT_SECONDS = 30.0
"""How long to wait for another process, which needs a moment only."""
_LOOK_SECONDS = 0.02


class LockedError(OSError):
    """Another process has held the lock all the time."""


@contextmanager
def locked(path: Path) -> Iterator[None]:
    """Hold the lock on a file that may not exist yet, and may be replaced meanwhile.

    On POSIX it is the lock (`flock(2)`) of its folder, so that nothing is left behind; on Windows
    that of a file ``<name>.lock`` beside it. Where a file system has no locks none is held.

    Raises
    ------
    LockedError
        If another process holds it for `WAIT_SECONDS`.
    OSError
        If the folder does not exist, or cannot be opened.
    """
    if sys.platform == "win32":
        descriptor = os.open(f"{path}.lock", os.O_RDWR | os.O_CREAT)
    else:
        descriptor = os.open(path.parent, os.O_RDONLY)
    try:
        last = time.monotonic() + WAIT_SECONDS
        while not _taken(descriptor):
            if time.monotonic() > last:
                raise LockedError(f"another process has been writing for {WAIT_SECONDS:g} s")
            time.sleep(_LOOK_SECONDS)
        yield
    finally:
        # which ends the lock
        os.close(descriptor)


def _taken(descriptor: int) -> bool:
    """Try to take the lock; whether there is nothing more to wait for."""
    if sys.platform == "win32":
        import msvcrt

        try:
            msvcrt.locking(descriptor, msvcrt.LK_NBLCK, 1)
        except OSError:
            return False
        return True
    import fcntl

    try:
        fcntl.flock(descriptor, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except BlockingIOError:
        return False
    except OSError:
        # a file system without locks, such as some over a network
        return True
    return True
