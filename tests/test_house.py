"""The picture of the house in ``docs/design.md``."""

import re
import runpy
from pathlib import Path
from typing import Any

import pytest

ROOT = Path(__file__).parents[1]
COMMAND = ROOT / "docs" / "house.py"


@pytest.fixture(scope="module")
def house() -> dict[str, Any]:
    return runpy.run_path(str(COMMAND))


@pytest.mark.thorough
def test_the_picture_is_the_present_one(house: dict[str, Any]) -> None:
    """``docs/design.md`` shows the house on one page, drawn by a command from the imports."""
    assert house["main"](["--check"]) == 0, "run python docs/house.py"
    shown = (ROOT / "docs" / "design.md").read_text(encoding="utf-8")
    assert re.search(r"(?m)^cli +->  report$", shown)
    assert house["drawing"](ROOT / "uqfold") in shown


def test_the_check_can_fail(house: dict[str, Any], tmp_path: Path) -> None:
    package = tmp_path / "uqfold"
    for room, text in (("a", "from uqfold.b.c import x\n"), ("b", ""), ("lone", "")):
        (package / room).mkdir(parents=True)
        (package / room / "__init__.py").write_text(f'"""Room {room}.\n\nMore."""\n{text}')
    (package / "b" / "c.py").write_text("")
    drawn = house["drawing"](package)
    assert "a     ->  b\n" in drawn
    assert "| `lone` | Room lone. |" in drawn
    (package / "b" / "c.py").write_text("def f():\n    from uqfold import a\n")
    with pytest.raises(SystemExit, match="rooms that import each other: a, b"):
        house["drawing"](package)
