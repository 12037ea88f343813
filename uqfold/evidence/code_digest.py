"""Which source code a case depends on, and a digest of it by part.

The files are found by following the import statements of the case's folder. A room of uqfold that
is imported as a whole (``from uqfold.methods import available``) counts with all its modules, since
its names are loaded lazily; its data files count as well. The frame that measures and keeps records
does not count, nor do checks of arguments: they make no numbers.
"""

from __future__ import annotations

import ast
import hashlib
from collections.abc import Iterable, Iterator, Mapping
from functools import cache
from pathlib import Path

import uqfold
from uqfold.evidence.case import DECLARATION

PACKAGE = Path(uqfold.__file__).resolve().parent
RECORDS = ("quick.json", "full.json")
FRAME = (
    "uqfold/evidence/", "uqfold/lazy.py", "uqfold/typing.py", "uqfold/checks.py",
    "uqfold/comparison/findings.py", "uqfold/__init__.py",
)  # fmt: skip


def code_digests(folder: Path, data: Iterable[str] = ()) -> dict[str, str]:
    """Give part of the source code -> digest for everything that a case depends on.

    Parameters
    ----------
    folder
        Folder of the case; other folders beside it may hold code that it imports.
    data
        Folders with data that it reads, relative to the folder that holds the cases' folder.

    Returns
    -------
    dict[str, str]
        A part is a room of uqfold (``uqfold/methods``), a folder of cases
        (``validation/limits``), or a folder of data.
    """
    root = folder.resolve().parent.parent
    parts: dict[str, dict[str, bytes]] = {}
    for path in sorted(_closure(folder.resolve(), root)):
        name = _name(path, root)
        parts.setdefault("/".join(name.split("/")[:2]), {})[name] = path.read_bytes()
    for part in data:
        read = (root / part).rglob("*.csv")
        parts[part] = {path.relative_to(root).as_posix(): path.read_bytes() for path in read}
    return {part: _digest(files) for part, files in sorted(parts.items())}


def changed_parts(before: Mapping[str, str], now: Mapping[str, str]) -> tuple[str, ...]:
    """Name the parts whose digest differs, or that one of both lacks."""
    return tuple(part for part in sorted({*before, *now}) if before.get(part) != now.get(part))


def _digest(files: Mapping[str, bytes]) -> str:
    whole = hashlib.sha256()
    for name, content in sorted(files.items()):
        whole.update(f"{name}\0{len(content)}\0".encode())
        whole.update(content)
    return whole.hexdigest()[:16]


def _name(path: Path, root: Path) -> str:
    base = PACKAGE.parent if path.is_relative_to(PACKAGE) else root
    return path.relative_to(base).as_posix()


def _closure(folder: Path, root: Path) -> set[Path]:
    start = [
        path
        for path in folder.rglob("*")
        if path.suffix in {".py", ".csv", ".json"} and path.name not in (*RECORDS, DECLARATION)
    ]
    found: set[Path] = set()
    waiting = list(start)
    while waiting:
        path = waiting.pop()
        if path in found or _name(path, root).startswith(FRAME):
            continue
        found.add(path)
        if path.suffix == ".py":
            names = _imported_names(path.read_text(encoding="utf-8"))
            waiting.extend(file for name in names for file in _files(name, root))
            if path.is_relative_to(PACKAGE):
                waiting.extend(path.parent.rglob("*.json"))
    return found


@cache
def _imported_names(source: str) -> tuple[str, ...]:
    """Dotted names that a module imports; the last part may be what a module defines."""
    return tuple(_names(ast.parse(source).body))


def _names(body: list[ast.stmt]) -> Iterator[str]:
    """Dotted names that statements import, except for type checking only."""
    for node in body:
        if isinstance(node, ast.If) and "TYPE_CHECKING" in ast.dump(node.test):
            continue
        for inner in ast.walk(node):
            if isinstance(inner, ast.Import):
                yield from (alias.name for alias in inner.names)
            elif isinstance(inner, ast.ImportFrom) and inner.module and not inner.level:
                yield from (f"{inner.module}.{alias.name}" for alias in inner.names)


def _files(name: str, root: Path) -> Iterator[Path]:
    """Files behind a dotted name, whose last part may be something that a module defines."""
    steps = name.split(".")
    base = PACKAGE.parent if steps[0] == PACKAGE.name else root
    for length in range(len(steps), max(len(steps) - 2, 0), -1):
        place = base.joinpath(*steps[:length])
        if place.with_suffix(".py").is_file():
            yield place.with_suffix(".py")
            return
        if (place / "__init__.py").is_file():
            yield from place.rglob("*.py")
            return
