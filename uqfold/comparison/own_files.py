"""Files of one's own: what a function in them returns, loaded by ``file.py:function``."""

from __future__ import annotations

import inspect
import sys
import traceback
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from functools import cache
from importlib.util import module_from_spec, spec_from_file_location
from pathlib import Path
from types import ModuleType
from typing import Any, TypeGuard


def is_of_a_file(name: object) -> TypeGuard[str]:
    """Whether a name is ``file.py:function``."""
    return isinstance(name, str) and ".py:" in name


def methods_of_a_file(name: str) -> dict[str, Any]:
    """Return label -> method as a function in a file returns it, named as for problems.

    Raises
    ------
    ValueError
        As `named_problem` does.
    """
    file, _, own = name.rpartition(":")
    found: dict[str, Any] = of_a_file(Path(file), own, "a dict of label -> method", _is_dict)()
    return found


def _is_dict(value: object) -> bool:
    return isinstance(value, dict)


def of_a_file(
    file: Path, name: str, returns: str, is_right: Callable[[object], bool]
) -> Callable[[], Any]:
    """Return what calls a function in a file, which is loaded at once, or is what it should return.

    `returns` says in words what `is_right` checks.
    """
    own = _own(file, name)
    wanted = f"{file}: {name} must be a function without arguments that returns {returns}"

    def build() -> Any:
        if is_right(own):
            return own
        try:
            inspect.signature(own).bind()
        except TypeError as error:
            raise ValueError(f"{wanted}, but {error}") from None
        except ValueError:  # a function that does not tell its arguments
            pass
        with _told_by_line(file):
            built = own()
        if not is_right(built):
            raise ValueError(f"{wanted}, but it returns {type(built).__name__}")
        return built

    return build


def value_of_a_file(name: str, folder: Path) -> Any:
    """Return what a file holds by a name, ``file.py:function``; it is loaded, and not called.

    Raises
    ------
    ValueError
        If there is no such file or name, or the file fails while it is loaded.
    """
    if not is_of_a_file(name):
        raise ValueError(f"name = {name!r}: give FILE.py:FUNCTION")
    file, _, own = name.rpartition(":")
    return _own(folder / file, own)


def _own(file: Path, name: str) -> Any:
    if not file.is_file():
        raise ValueError(f"name = '{file}:{name}': there is no file {file}")
    own = getattr(_loaded(file.resolve()), name, None)
    if own is None:
        raise ValueError(f"name = '{file}:{name}': {file} has no function {name!r}")
    return own


@cache
def _loaded(file: Path) -> ModuleType:
    """Return the module in a file, which stays importable by its name for other processes.

    As when Python runs the file, its folder comes first where modules are looked for, and stays
    there: a model may import a neighbour late, or in another process.
    """
    spec: Any = spec_from_file_location(file.stem, file)
    module = module_from_spec(spec)
    if str(file.parent) not in sys.path:
        sys.path.insert(0, str(file.parent))
    registered = sys.modules.setdefault(file.stem, module)
    try:
        with _told_by_line(file):
            spec.loader.exec_module(module)
    except BaseException:
        if registered is module:
            del sys.modules[file.stem]
        raise
    return module


@contextmanager
def _told_by_line(file: Path) -> Iterator[None]:
    """Turn whatever the code in a file raises into one line with the place in the file."""
    try:
        yield
    except (Exception, SystemExit) as error:
        place = file.name
        frames = traceback.extract_tb(error.__traceback__)
        lines = [one.lineno for one in frames if Path(one.filename).resolve() == file.resolve()]
        if isinstance(error, SyntaxError) and error.filename is not None:
            place, lines = Path(error.filename).name, [error.lineno]
        if lines:
            place += f", line {lines[-1]}"
        said = " ".join(str(error).split())
        raise ValueError(f"{place}: {type(error).__name__}: {said}") from error
