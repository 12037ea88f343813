"""Which source code a module depends on, found by following its import statements.

Of a file only what can change a number counts: neither comments nor docstrings do, nor imports for
type checkers. An ``__init__`` of uqfold only hands out names: the modules of those that are used
count. A table of places (``"kriging": "uqfold.methods.kriging:Kriging"``) is not code either: an
entry counts where a file that counts has its key as a text, all entries where such a file outside
the package asks for `EVERY` of them.
"""

from __future__ import annotations

import ast
import re
import sys
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass, field
from functools import lru_cache
from pathlib import Path
from types import ModuleType
from typing import Any

EVERY = "available"
"""The name under which a table of places hands out all of its entries."""
_PLACE = re.compile(r"[A-Za-z_][\w.]*:[A-Za-z_]\w*")
_TEXT_OR_COMMENT = re.compile(
    r"""(?s:"{3}(?:\\.|[^\\])*?"{3}|'{3}(?:\\.|[^\\])*?'{3})"""
    r"""|"(?:\\.|[^"\\\n])*"|'(?:\\.|[^'\\\n])*'|\#[^\n]*"""
)
_DATA = ".csv", ".json"
_PROSE = "title", "theory"
_LEVELS = 4  # folders above a file outside the package in which its imports are looked for


@dataclass
class ImportSearch:
    """Follows imports from file to file.

    Attributes
    ----------
    package
        Folder of uqfold.
    without
        Modules of uqfold (dotted names, with all that begins so) and files that do not count.
    """

    package: Path
    without: tuple[str, ...]
    found: set[Path] = field(default_factory=set)
    waiting: list[Path] = field(default_factory=list)
    roots: list[Path] = field(default_factory=list)
    places: dict[str, str] = field(default_factory=dict)
    texts: set[str] = field(default_factory=set)
    data: dict[Path, list[Path]] = field(default_factory=dict)
    followed: set[str] = field(default_factory=set)
    every: bool = False

    def begin(self, source: str | Path | ModuleType | type) -> None:
        """Begin at a source."""
        if isinstance(source, type):
            source = source.__module__
        if isinstance(source, str):
            if source.partition(".")[0] == self.package.name:
                self.every |= source.endswith(f".{EVERY}")
                self.waiting += self._in_package(source.split("."))
                return
            file = getattr(sys.modules.get(source), "__file__", None)
        elif isinstance(source, ModuleType):
            return self.begin(source.__name__)
        else:
            file = source
        if file is None or {"site-packages", "dist-packages"} & {*Path(file).parts}:
            return
        path = Path(file).resolve()
        self.roots.append(path.parent if path.is_file() else path)
        inside = path.rglob("*") if path.is_dir() else [path]
        self.waiting += [one for one in inside if one.suffix in (".py", *_DATA)]

    def closure(self) -> set[Path]:
        """Return all files that count."""
        while self.waiting:
            path = self.waiting.pop()
            if path in self.found or self._left_out(path):
                continue
            self.found.add(path)
            own = parsed(path)
            outside = not path.is_relative_to(self.package)
            # in the package a name means the same to every file
            for name in own.names if outside else own.names - self.followed:
                steps = name.split(".")
                self.every |= outside and steps[-1] == EVERY
                self.waiting += self._files(steps, path)
            if not outside:
                self.followed |= own.names
                self.waiting += self._data_files(path.parent, own.texts)
            self.places |= own.places
            self.texts |= own.texts
            for key in [key for key in self.places if self.every or key in self.texts]:
                self.waiting += self._files(self.places.pop(key).split("."), path)
        return self.found

    def name(self, path: Path) -> str:
        """Return how a file is called in a digest: beneath the folder that holds its part."""
        if path.is_relative_to(self.package):
            return path.relative_to(self.package.parent).as_posix()
        above = [root.parent for root in self.roots if path.is_relative_to(root.parent)]
        base = above[0].parent if above and path.parent != above[0] else path.parent.parent
        return path.relative_to(base if path.is_relative_to(base) else path.parent).as_posix()

    def _data_files(self, folder: Path, texts: Iterable[str]) -> Iterator[Path]:
        """Data files in or below a folder that begin like one of the texts."""
        if folder not in self.data:
            inside = folder.glob("*") if folder == self.package else folder.rglob("*")
            self.data[folder] = [path for path in inside if path.suffix in _DATA]
        for path in self.data[folder]:
            if any(len(text) > 3 and path.name.startswith(text) for text in texts):
                yield path

    def _left_out(self, path: Path) -> bool:
        if not path.is_relative_to(self.package):
            return str(path) in self.without
        steps = path.relative_to(self.package.parent).with_suffix("").parts
        module = ".".join(steps)
        return path.name == "__init__.py" or any(
            module == name or module.startswith((f"{name}.", f"{name}_")) for name in self.without
        )

    def _files(self, steps: list[str], importer: Path) -> Iterator[Path]:
        if steps[0] == self.package.name:
            yield from self._in_package(steps)
        elif not importer.is_relative_to(self.package):
            for folder in importer.parents[:_LEVELS]:
                for length in range(len(steps), 0, -1):
                    place = folder.joinpath(*steps[:length])
                    if place.with_suffix(".py").is_file():
                        yield place.with_suffix(".py")
                        return

    def _in_package(self, steps: list[str]) -> Iterator[Path]:
        """Files that are behind a dotted name, each step of which may be loaded lazily."""
        folder = self.package
        for i, step in enumerate(steps[1:], start=1):
            if (folder / f"{step}.py").is_file():
                yield folder / f"{step}.py"
                return
            if not (folder / step).is_dir():
                exported = _exports(folder).get(step, "")
                if exported and exported != ".".join(steps[: i + 1]):
                    yield from self._in_package(exported.split("."))
                return
            folder /= step
        if folder != self.package:
            # a room as a whole
            yield from folder.rglob("*.py")


@dataclass(frozen=True)
class Parsed:
    """What counts in a file.

    Attributes
    ----------
    content
        What can change a number.
    names
        Dotted names that it imports and uses.
    places
        Key -> dotted name, in tables of places.
    texts
        Its texts.
    """

    content: bytes
    names: frozenset[str] = frozenset()
    places: Mapping[str, str] = field(default_factory=dict)
    texts: frozenset[str] = frozenset()


def parsed(path: Path) -> Parsed:
    """Return what counts in a file, as it is now."""
    stat = path.stat()
    return _parsed_once(path, stat.st_mtime_ns, stat.st_size)


@lru_cache(maxsize=4096)
def _parsed_once(path: Path, _mtime: int, _size: int) -> Parsed:
    content = path.read_bytes()
    if path.suffix != ".py":
        return Parsed(content)
    source = content.decode("utf-8")
    tree = ast.parse(source)
    nodes = list(_nodes(tree))
    left_out, places = list[ast.stmt](), dict[str, str]()
    for node in nodes:
        if isinstance(node, ast.Module | ast.ClassDef | ast.FunctionDef | ast.AsyncFunctionDef):
            left_out += [one for one in node.body if _is_text(one)]
            if isinstance(node, ast.ClassDef):
                left_out += [one for one in node.body if _is_prose(one)]
        elif isinstance(node, ast.If) and _chain(node.test)[-1] == "TYPE_CHECKING":
            left_out += node.body
    for statement in tree.body:
        table = _table(statement)
        if table:
            places |= {key: place.replace(":", ".") for key, place in table.items()}
            left_out.append(statement)
    lines = {line for node in left_out for line in range(node.lineno, node.end_lineno + 1)}  # type: ignore[operator]
    rest = [node for node in nodes if getattr(node, "lineno", 0) not in lines]
    constants = (one.value for one in rest if isinstance(one, ast.Constant))
    texts = {one for one in constants if isinstance(one, str) and 0 < len(one) < 100}
    return Parsed(_code(source, lines), frozenset(_names(rest)), places, frozenset(texts))


def _is_text(node: ast.stmt) -> bool:
    return (
        isinstance(node, ast.Expr)
        and isinstance(node.value, ast.Constant)
        and isinstance(node.value.value, str)
    )


def _is_prose(node: ast.stmt) -> bool:
    """Whether a statement of a class says what it is called, or how it is explained."""
    target = node.targets[0] if isinstance(node, ast.Assign) else getattr(node, "target", None)
    return isinstance(target, ast.Name) and target.id in _PROSE


def _table(node: ast.stmt) -> dict[str, str]:
    """Return the table of places that a statement makes, or nothing."""
    if isinstance(node, ast.Assign | ast.AnnAssign) and isinstance(node.value, ast.Dict):
        try:
            table: dict[str, Any] = ast.literal_eval(node.value)
        except ValueError:
            return {}
        if all(isinstance(one, str) and _PLACE.fullmatch(one) for one in table.values()):
            return table
    return {}


def _code(source: str, left_out: set[int]) -> bytes:
    """Return the lines that count, without comments and empty lines."""
    lines = _TEXT_OR_COMMENT.sub(_without_comment, source).split("\n")
    kept = (line.rstrip() for i, line in enumerate(lines, start=1) if i not in left_out)
    return "\n".join(filter(None, kept)).encode()


def _without_comment(found: re.Match[str]) -> str:
    return "" if found[0].startswith("#") else found[0]


def _nodes(tree: ast.AST) -> Iterator[ast.AST]:
    """Yield what `ast.walk` does except for contexts, in half of its time."""
    waiting: list[Any] = [tree]
    while waiting:
        node = waiting.pop()
        if isinstance(node, list):
            waiting += node
        elif isinstance(node, ast.AST):
            yield node
            waiting += [getattr(node, name, None) for name in node._fields if name != "ctx"]


def _names(nodes: Iterable[ast.AST]) -> Iterator[str]:
    """Dotted names that are imported; of a module that is imported, what is used of it."""
    modules, chains, inner, used = dict[str, str](), list[ast.expr](), set[int](), set[str]()
    for node in nodes:
        if isinstance(node, ast.Import):
            for alias in node.names:
                whole = alias.name if alias.asname else alias.name.partition(".")[0]
                modules[alias.asname or whole] = whole
                yield alias.name
        elif isinstance(node, ast.ImportFrom):
            for alias in node.names:
                name = f"{node.module}.{alias.name}" if node.module else alias.name
                modules[alias.asname or alias.name] = name
        elif isinstance(node, ast.Attribute | ast.Name):
            chains.append(node)
            if isinstance(node, ast.Attribute):
                inner.add(id(node.value))
    for node in chains:
        if id(node) not in inner:
            first, *steps = _chain(node)
            if first in modules:
                used.add(first)
                yield ".".join((modules[first], *steps))
    # what is imported only to be handed on
    yield from (name for first, name in modules.items() if first not in used)


def _chain(node: ast.expr) -> list[str]:
    """Return the names of ``a.b.c``; the first is empty where it is none."""
    steps = list[str]()
    while isinstance(node, ast.Attribute):
        steps.insert(0, node.attr)
        node = node.value
    return [node.id if isinstance(node, ast.Name) else "", *steps]


@lru_cache(maxsize=64)
def _exports(folder: Path) -> dict[str, str]:
    """Return name -> dotted name, of what a package hands out."""
    stub = folder / "__init__.pyi"
    file = stub if stub.is_file() else folder / "__init__.py"
    statements = ast.walk(ast.parse(file.read_text(encoding="utf-8")))
    return {
        alias.asname or alias.name: f"{node.module}.{alias.name}"
        for node in statements
        if isinstance(node, ast.ImportFrom) and node.module
        for alias in node.names
    }
