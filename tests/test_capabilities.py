"""The table of what each method answers, in ``docs/which-method.md``, is made by a command."""

import runpy
from pathlib import Path
from typing import Any

import pytest

from uqfold.methods import MonteCarlo

COMMAND = Path(__file__).parents[1] / "docs" / "capabilities.py"


@pytest.fixture(scope="module")
def command() -> dict[str, Any]:
    return runpy.run_path(str(COMMAND))


def test_the_table_is_the_present_one(command: dict[str, Any]) -> None:
    assert command["main"](["--check"]) == 0, "run python docs/capabilities.py"


def test_a_method_that_loses_an_ability_changes_the_table(
    command: dict[str, Any], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(MonteCarlo, "any_structure", False)
    assert command["main"](["--check"]) == 1
