"""The scripts in validation/references import each other by file name, as when they are run."""

import sys
from collections.abc import Callable
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
