"""What made a number: the source code that it depends on, versions, seed, settings, command.

The code is found by following import statements (see `uqfold.imports`), so that nobody keeps a list
of it.
"""

from __future__ import annotations

import datetime
import hashlib
import os
import platform
import shlex
from collections.abc import Iterable, Mapping, Sequence
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path
from types import ModuleType
from typing import Any

import uqfold
from uqfold.imports import ImportSearch, parsed

PACKAGE = Path(__file__).resolve().parent
RECORDED_PACKAGES = "numpy", "scipy", "numba", "openturns"
"""Packages whose versions are always recorded."""
# they check, write, import and explain; methods.theory with all that begins so
MAKES_NO_NUMBERS = (
    "uqfold.checks", "uqfold.documents", "uqfold.imports", "uqfold.lazy", "uqfold.methods.theory",
    "uqfold.provenance", "uqfold.typing", "uqfold.writing",
)  # fmt: skip


def source_digest(
    *sources: str | Path | ModuleType | type,
    without: Iterable[str] = (),
    package: Path = PACKAGE,
) -> dict[str, str]:
    """Return part of the source code -> digest, for all code that the sources depend on.

    Parameters
    ----------
    sources
        Dotted names of modules, modules, classes (which stand for their modules), files, or
        folders with all the Python and data files (CSV, JSON) in them. What is installed, other
        than uqfold, does not count: its version says what it is.
    without
        Modules or packages that make no numbers, besides `MAKES_NO_NUMBERS`: dotted names of
        uqfold, or files outside.
    package
        Folder of uqfold.

    Returns
    -------
    dict[str, str]
        A part is a room of uqfold (``uqfold/methods``) or a folder outside it with the one above
        (``validation/limits``). It has a digest of those of its files that count.

    Examples
    --------
    >>> list(source_digest("uqfold.moments.cumulants"))
    ['uqfold/moments']
    """
    search = ImportSearch(package.resolve(), (*MAKES_NO_NUMBERS, *without))
    for source in sources:
        search.begin(source)
    parts: dict[str, dict[str, bytes]] = {}
    for path in search.closure():
        name = search.name(path)
        part = "/".join(name.split("/")[:2])
        parts.setdefault(part, {})[name] = parsed(path).content
    return {part: _digest(files) for part, files in sorted(parts.items())}


def changed_parts(before: Mapping[str, str], now: Mapping[str, str]) -> tuple[str, ...]:
    """Return the parts whose digest differs, or that one of both lacks."""
    return tuple(part for part in sorted({*before, *now}) if before.get(part) != now.get(part))


def made_by(
    *sources: str | Path | ModuleType | type,
    seed: int | None = None,
    settings: Mapping[str, Any] | None = None,
    command: str = "",
    packages: Iterable[str] = (),
    without: Iterable[str] = (),
) -> dict[str, Any]:
    """Return what made a number, as a dict that JSON knows.

    Parameters
    ----------
    sources, without
        See `source_digest`.
    seed, settings, command
        As the caller knows them; `shown_command` gives a command without absolute paths.
    packages
        Packages whose versions matter besides `RECORDED_PACKAGES`.

    Returns
    -------
    dict
        ``seed``, ``settings`` and ``command`` as given, ``date`` (UTC, ISO 8601), ``machine``,
        ``versions`` (name -> version) and ``source`` (part -> digest).
    """
    return {
        "seed": seed,
        "settings": dict(settings or {}),
        "command": command,
        "date": now(),
        "machine": machine(),
        "versions": versions(packages),
        "source": source_digest(*sources, without=without),
    }


def now() -> str:
    """Return the time, UTC, ISO 8601, to the second."""
    return datetime.datetime.now(datetime.UTC).isoformat(timespec="seconds")


def machine() -> str:
    """Return on what kind of machine this runs, without naming it."""
    model = platform.processor() or platform.machine() or "unknown processor"
    try:
        text = Path("/proc/cpuinfo").read_text(encoding="utf-8")
        names = [line.partition(":")[2] for line in text.splitlines() if line[:10] == "model name"]
        model = " ".join(names[0].split()) if names else model
    except OSError:
        pass
    return f"{model}, {os.cpu_count() or 1} cores, {platform.system()}"


def versions(packages: Iterable[str] = ()) -> dict[str, str]:
    """Return name -> version of uqfold, Python, `RECORDED_PACKAGES` and further packages.

    None of them is imported.
    """
    found = {"uqfold": uqfold.__version__, "python": platform.python_version()}
    for name in (*RECORDED_PACKAGES, *packages):
        try:
            found[name] = version(name)
        except PackageNotFoundError:
            found[name] = "not installed"
    return found


def shown_command(words: Sequence[str]) -> str:
    """Return a command as typed, but without any absolute path of this machine.

    A path below the working directory becomes relative to it; of any other only the last part
    remains, after ``.../``.

    Examples
    --------
    >>> shown_command(["uqfold", "compare", "series", "--out=/home/someone/results"])
    'uqfold compare series --out=.../results'
    """
    return shlex.join(map(_without_absolute_path, words))


def _without_absolute_path(word: str) -> str:
    option, equals, value = word.partition("=") if word.startswith("-") else ("", "", word)
    if not os.path.isabs(value):
        return word
    path, here = Path(value), Path.cwd()
    shown = path.relative_to(here) if path.is_relative_to(here) else Path("...", path.name)
    return f"{option}{equals}{shown.as_posix()}"


def _digest(files: Mapping[str, bytes]) -> str:
    whole = hashlib.sha256()
    for name, content in sorted(files.items()):
        whole.update(f"{name}\0{len(content)}\0".encode())
        whole.update(content)
    return whole.hexdigest()[:16]
