"""What the command line writes to, and what it says when that cannot be written."""

from __future__ import annotations

import errno
import io
import os
import sys
from contextlib import suppress
from pathlib import Path
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from rich.console import Console

EXIT_FAILED, EXIT_USAGE, EXIT_INTERRUPTED = 1, 2, 130
PIPED_WIDTH = 120

_NO_ROOM = (errno.ENOSPC, errno.EDQUOT, errno.EFBIG)
_NOT_ALLOWED = (errno.EACCES, errno.EPERM, errno.EROFS)


def open_streams() -> None:
    """Make the standard streams usable, whoever closed them, and whatever they can show."""
    # what is opened next would take the number of a closed one, and what is printed with it
    descriptor = os.open(os.devnull, os.O_RDWR)
    while descriptor <= 2:
        descriptor = os.dup(descriptor)
    os.close(descriptor)
    for name in ("stdout", "stderr"):
        if getattr(sys, name) is None:
            setattr(sys, name, open(os.devnull, "w", encoding="utf-8"))  # noqa: SIM115
        stream = getattr(sys, name)
        if isinstance(stream, io.TextIOWrapper):
            # a terminal that cannot show one sign must not lose the whole table
            stream.reconfigure(errors="replace")


def flush_streams() -> None:
    """Write what is left; OSError if that fails."""
    for stream in (sys.stdout, sys.stderr):
        stream.flush()


def exit_code_of(error: OSError) -> int:
    """Say in one line what could not be read or written; a reader that has left is told nothing."""
    if error.filename is None:
        _silence_stdout()
    if error.errno == errno.EPIPE:
        return 1
    with suppress(OSError):
        print(f"error: {os_error_text(error)}", file=sys.stderr, flush=True)
    return EXIT_USAGE


def os_error_text(error: OSError) -> str:
    """Return what went wrong with which file, and the remedy."""
    where = "the standard output" if error.filename is None else shown_path(Path(error.filename))
    what = error.strerror or type(error).__name__
    if error.errno in _NO_ROOM:
        what += ": make room on the disk, or write elsewhere"
    elif error.errno in _NOT_ALLOWED:
        what += ": give another path, or the right to use this one"
    elif error.filename is not None:
        what += ": give another path"
    return f"{where}: {what}"


def shown_path(path: Path) -> str:
    """Return a path as people would type it here: relative where it lies below this folder."""
    relative = os.path.relpath(path)
    return str(path) if relative.startswith(os.pardir) else relative


def say(text: str) -> None:
    """Say something on the standard error, also when quiet, in one line."""
    print(text, file=sys.stderr, flush=True)


def stdout_console(*, quiet: bool) -> Console:
    """Return the console of the standard output; into a pipe or file the table is set wide."""
    from rich.console import Console

    piped = not sys.stdout.isatty() and "COLUMNS" not in os.environ
    return Console(width=PIPED_WIDTH if piped else None, quiet=quiet)


def _silence_stdout() -> None:
    """Let Python's own last flush go nowhere."""
    with suppress(OSError, ValueError, AttributeError):
        descriptor = os.open(os.devnull, os.O_WRONLY)
        os.dup2(descriptor, sys.stdout.fileno())
        os.close(descriptor)
