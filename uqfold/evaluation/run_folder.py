"""The folder of one run of a program: which files may be named in it, and how they are read."""

from __future__ import annotations

import codecs
import re
from pathlib import Path, PurePosixPath, PureWindowsPath

from uqfold.checks import one_line, refused, text
from uqfold.evaluation.errors import ExternalRunError

STDOUT, STDERR = "stdout.txt", "stderr.txt"
"""Files in a run's folder that take what the program prints."""
REASON = "reason.txt"
"""File in the folder of a failed run that says why."""

_TAIL, _LINES, _CHARACTERS = 4096, 3, 200
"""How much is shown of what a program printed: the end, in bytes, lines and characters."""
_UTF_16 = (codecs.BOM_UTF16_LE, codecs.BOM_UTF16_BE)


def file_inside(name: str, value: object) -> str:
    """Return the relative path of a file inside a run's folder, in its shortest form.

    Raises
    ------
    TypeError, ValueError
        If it is not text, or leads out of the folder on some system.
    """
    remedy = "give the path of a file inside the run's folder, as in 'mesh/beam.inp'"
    given = text(name, value, what="the path of a file")
    windows = PureWindowsPath(given)
    shortest = PurePosixPath(given).as_posix()
    leads_out = windows.drive or windows.root or ".." in windows.parts or "\0" in given
    if leads_out or shortest in {".", ""} or given.endswith(("/", "\\")):
        raise refused(name, given, remedy)
    return shortest


def text_of(folder: Path, file: str) -> str:
    """Return what a file in a run's folder holds, as `decoded` reads it.

    Raises
    ------
    ExternalRunError
        If it is not an ordinary file, or a link that leads out of the folder.
    OSError
        If there is none, or it cannot be read.
    """
    path = (folder / file).resolve()
    if not path.is_relative_to(folder.resolve()):
        raise ExternalRunError(f"{file} is a link that leads out of the run's folder")
    if path.exists() and not path.is_file():
        raise ExternalRunError(f"{file} is not an ordinary file")
    return decoded(path.read_bytes())


def last_lines(folder: Path) -> str:
    """Return the last lines that a program printed, errors if there are any, as one line."""
    for file in (STDERR, STDOUT):
        path = folder / file
        if path.is_symlink() or not path.is_file():
            continue
        with path.open("rb") as stream:
            stream.seek(max(path.stat().st_size - _TAIL, 0))
            lines = [line.strip() for line in decoded(stream.read()).splitlines()]
        if told := " / ".join(list(filter(None, lines))[-_LINES:]):
            return one_line(told[-_CHARACTERS:])
    return ""


def decoded(content: bytes) -> str:
    r"""Return the text of bytes in whatever encoding, with every line end as a newline.

    UTF-8 where the bytes are that, UTF-16 with its mark, otherwise Latin-1, which any bytes are.

    >>> decoded("Länge = 1\r\n".encode("latin-1")) == decoded("Länge = 1\n".encode())
    True
    """
    encoding = "utf-16" if content.startswith(_UTF_16) else "utf-8-sig"
    try:
        read = content.decode(encoding)
    except UnicodeDecodeError:
        read = content.decode("latin-1")
    return re.sub("\r\n?", "\n", read)
