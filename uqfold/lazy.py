"""Names that a package hands out but loads only when they are first used (PEP 562).

They are written once, in the package's ``__init__.pyi``, from which type checkers know them too.
"""

from __future__ import annotations

import ast
import sys
import warnings
from collections.abc import Callable, Mapping
from importlib import import_module
from pathlib import Path
from typing import Any


def attach_stub(
    package: str, file: str, moved: Mapping[str, str] | None = None
) -> tuple[Callable[[str], Any], Callable[[], list[str]], list[str]]:
    """Return ``__getattr__``, ``__dir__`` and ``__all__`` of a package.

    Parameters
    ----------
    package
        Its ``__name__``.
    file
        Its ``__file__``. Beside it lies ``__init__.pyi`` with nothing but statements such as
        ``from package.module import name as name``.
    moved
        Name that the package had in the former release -> dotted name of what it is now. It is
        still understood, with a warning.
    """
    stub = Path(file).with_suffix(".pyi").read_text(encoding="utf-8")
    homes = {
        alias.name: node.module
        for node in ast.parse(stub).body
        if isinstance(node, ast.ImportFrom) and node.module
        for alias in node.names
    }

    def load(name: str) -> Any:
        if name in homes:
            home = homes[name]
            submodule = home == package
            module = import_module(f"{package}.{name}" if submodule else home)
            value = module if submodule else getattr(module, name)
        elif moved and name in moved:
            warnings.warn(f"{package}.{name} is {moved[name]} now", DeprecationWarning, 2)
            home, _, name_there = moved[name].rpartition(".")
            return getattr(import_module(home), name_there)
        else:
            raise AttributeError(f"module {package!r} has no attribute {name!r}")
        setattr(sys.modules[package], name, value)
        return value

    names = sorted(homes)
    return load, lambda: names, names
