"""Writing a file so that it appears whole or not at all.

Every file that this package writes for its users goes through here.
"""

from __future__ import annotations

import os
import secrets
import stat
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from os import PathLike
from pathlib import Path
from typing import BinaryIO

_TRIED_BYTES = 65_536


@contextmanager
def replacing(path: str | PathLike[str]) -> Iterator[BinaryIO]:
    """Open a file to be written in binary, which takes the place of `path` once it is complete.

    Until then it has a name that nobody can foresee, in the same folder, and is open to nothing
    that was there before: no file is overwritten and no link followed. What `path` was stays
    as it is after an error or an interruption; where it was a link, the link is replaced. A device
    or a pipe is written to directly, since it has no content to be kept.

    Parameters
    ----------
    path
        The file; its folder has to exist.

    Raises
    ------
    OSError
        If it cannot be written; the error names `path`.
    """
    target = Path(path)
    try:
        if _is_special(target):
            with target.open("wb") as device:
                yield device
            return
        temporary, stream = _new_file(target)
        try:
            with stream:
                yield stream
            os.replace(temporary, target)
        except BaseException:
            with suppress(OSError):
                temporary.unlink()
            raise
    except OSError as error:
        ours = error.filename is None or Path(error.filename).parent == target.parent
        if not ours or error.errno is None:
            raise
        # whoever reads the message knows the file by its own name
        raise OSError(error.errno, error.strerror, str(target)) from error


def write_text(path: str | PathLike[str], text: str) -> None:
    """Write text in UTF-8, line ends as they are; as `replacing` does.

    Half a character (of a file name that is not UTF-8, say) is written as JSON escapes it.

    Raises
    ------
    OSError
        If it cannot be written.
    """
    with replacing(path) as stream:
        stream.write(text.encode(errors="backslashreplace"))


def check_writable(folder: str | PathLike[str]) -> None:
    """Make a folder if it is missing, and try whether files can be written there.

    Raises
    ------
    OSError
        If not; before any work is spent. The error names the folder.
    """
    directory = Path(folder)
    try:
        directory.mkdir(parents=True, exist_ok=True)
        temporary, stream = _new_file(directory / "try")
        try:
            with stream:
                stream.write(bytes(_TRIED_BYTES))
        finally:
            temporary.unlink()
    except OSError as error:
        raise OSError(error.errno, error.strerror or str(error), str(directory)) from error


def _is_special(target: Path) -> bool:
    """Whether there is something that is neither a file nor a folder, perhaps behind a link."""
    try:
        mode = target.stat().st_mode
    except OSError:
        return False
    return not (stat.S_ISREG(mode) or stat.S_ISDIR(mode))


def _new_file(target: Path) -> tuple[Path, BinaryIO]:
    flags = os.O_WRONLY | os.O_CREAT | os.O_EXCL
    flags |= getattr(os, "O_NOFOLLOW", 0) | getattr(os, "O_CLOEXEC", 0) | getattr(os, "O_BINARY", 0)
    while True:
        temporary = target.with_name(f".{secrets.token_hex(12)}{target.suffix}")
        try:
            return temporary, os.fdopen(os.open(temporary, flags, 0o666), "wb")
        except FileExistsError:
            continue
