"""A TOML file whose values know the line they stand on, so that an error can name it."""

from __future__ import annotations

import difflib
import tomllib
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any, TypeAlias

PathInFile: TypeAlias = tuple[str | int, ...]


class StudyError(ValueError):
    """Something is wrong with a study; the message names file, line and key, and the remedy."""


@dataclass(frozen=True)
class Place:
    """Where a value stands: file, and path of keys within it.

    Attributes
    ----------
    file
        Name of the file, for messages.
    lines
        Path -> line, from 1, for every key that has a line of its own.
    path
        Keys, and numbers in arrays from 0, that lead to the value.
    """

    file: str
    lines: Mapping[PathInFile, int]
    path: PathInFile = ()

    def at(self, key: str | int) -> Place:
        """Give the place of a value inside this one."""
        return Place(self.file, self.lines, (*self.path, key))

    @property
    def line(self) -> int:
        """Line of the value, or of the nearest value around it that has one."""
        for length in range(len(self.path), 0, -1):
            if self.path[:length] in self.lines:
                return self.lines[self.path[:length]]
        return 1

    @property
    def shown(self) -> str:
        """The path as people read it: ``run[2].thresholds``, arrays counted from 1."""
        text = ""
        for key in self.path:
            text += f"[{key + 1}]" if isinstance(key, int) else f".{key}"
        return text.removeprefix(".")

    def error(self, message: str) -> StudyError:
        """Give the error to raise for the value at this place."""
        where = f"{self.file}, line {self.line}"
        return StudyError(
            f"{where}, {self.shown}: {message}" if self.path else f"{where}: {message}"
        )


def read_document(path: Path) -> tuple[dict[str, Any], Place]:
    """Read a TOML file.

    Returns
    -------
    tuple[dict[str, Any], Place]
        Its content, and the place of the whole.

    Raises
    ------
    StudyError
        If the file cannot be read or is no TOML; the message names the line.
    """
    name = f"{path.parent.name}/{path.name}"
    try:
        text = path.read_text(encoding="utf-8")
    except (OSError, UnicodeDecodeError) as error:
        reason = error.strerror if isinstance(error, OSError) else "it is not UTF-8"
        raise StudyError(f"{name} cannot be read: {reason}") from error
    try:
        content = tomllib.loads(text)
    except RecursionError as error:
        raise StudyError(f"{name} is nested too deeply") from error
    except ValueError as error:
        # also of a number with too many digits
        raise StudyError(f"{name} is no TOML file: {error}") from error
    return content, Place(name, _lines(text))


def nearest(word: str, words: Iterable[str]) -> str:
    """Say what may have been meant by a word that is not among those known."""
    known = sorted(words)
    close = difflib.get_close_matches(word, known, n=1, cutoff=0.5)
    meant = f"did you mean {close[0]!r}? " if close else ""
    return f"{meant}known: {', '.join(known) or 'none'}"


def _lines(text: str) -> dict[PathInFile, int]:
    """Give the line of every table header and every key.

    Each of these is a TOML document of its own, so that the end of one that spans lines is found
    by the parser itself.
    """
    lines: dict[PathInFile, int] = {}
    counts: dict[PathInFile, int] = {}
    table: PathInFile = ()
    started, chunk = 1, ""
    for number, line in enumerate(text.splitlines(), start=1):
        if not chunk:
            started = number
        chunk += f"{line}\n"
        try:
            content = tomllib.loads(chunk)
        except tomllib.TOMLDecodeError:
            continue
        chunk = ""
        if not content:
            continue
        if line.lstrip().startswith("[") and started == number:
            table = _header(content, counts)
            lines.setdefault(table, started)
            continue
        for path in _paths(content):
            lines[(*table, *path)] = started
    return lines


def _header(content: Any, counts: dict[PathInFile, int]) -> PathInFile:
    """Give the path of a table header; each array of tables counts its own tables."""
    path: PathInFile = ()
    while content:
        if isinstance(content, list):
            counts[path] = counts.get(path, -1) + 1
            path = (*path, counts[path])
            content = content[0]
            continue
        [(key, content)] = content.items()
        path = (*path, key)
        if isinstance(content, dict) and path in counts:
            path = (*path, counts[path])
    return path


def _paths(content: Any) -> list[PathInFile]:
    """Give the paths of all values that one statement sets."""
    if isinstance(content, dict):
        items: Iterable[tuple[str | int, Any]] = content.items()
    elif isinstance(content, list):
        items = enumerate(content)
    else:
        return []
    return [path for key, value in items for path in ((key,), *((key, *p) for p in _paths(value)))]
