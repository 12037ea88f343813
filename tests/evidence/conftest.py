"""Folders of cases that do not take each other's place among the imported modules."""

import itertools
import sys
from collections.abc import Iterator
from pathlib import Path

import pytest

_numbers = itertools.count()


@pytest.fixture
def cases(tmp_path: Path) -> Iterator[Path]:
    name = f"cases_{next(_numbers)}"
    before = list(sys.path)
    yield tmp_path / name
    sys.path[:] = before
    for module in [one for one in sys.modules if one.split(".")[0] == name]:
        del sys.modules[module]
