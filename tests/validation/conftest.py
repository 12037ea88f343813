"""Folders of cases that do not take each other's place among the imported modules, and scripts.

The scripts in validation/references import each other by file name, as when they are run.
"""

import itertools
import sys
from collections.abc import Callable, Iterator
from importlib import import_module
from pathlib import Path
from types import ModuleType

import pytest

SCRIPTS = Path(__file__).resolve().parents[2] / "validation" / "references"


@pytest.fixture
def script(monkeypatch: pytest.MonkeyPatch) -> Callable[[str], ModuleType]:
    monkeypatch.syspath_prepend(str(SCRIPTS))

    def load(name: str) -> ModuleType:
        module = import_module(name)
        # a module of the same name from elsewhere must not pass for the script
        assert Path(str(module.__file__)).parent == SCRIPTS, module.__file__
        monkeypatch.setitem(sys.modules, name, module)
        return module

    return load


_numbers = itertools.count()


@pytest.fixture
def cases(tmp_path: Path) -> Iterator[Path]:
    name = f"cases_{next(_numbers)}"
    before = list(sys.path)
    yield tmp_path / name
    sys.path[:] = before
    for module in [one for one in sys.modules if one.split(".")[0] == name]:
        del sys.modules[module]
