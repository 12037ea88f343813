"""Importing uqfold, or asking for help, loads nothing heavy."""

import subprocess
import sys

import pytest

HEAVY = ("scipy.stats", "openturns", "chaospy", "sklearn", "pandas", "matplotlib", "numba")


def loaded(code: str) -> set[str]:
    done = subprocess.run(
        [sys.executable, "-c", f"{code}\nimport sys\nprint('\\n'.join(sys.modules))"],
        capture_output=True,
        text=True,
        check=True,
        timeout=60,
    )
    return set(done.stdout.split())


def test_import_uqfold_loads_nothing_heavy() -> None:
    assert loaded("import uqfold").isdisjoint({*HEAVY, "numpy", "typer", "rich"})


def test_the_check_can_fail() -> None:
    assert "numba" in loaded("import uqfold, numba")


@pytest.mark.parametrize("words", [["--help"], ["compare", "--help"], ["--version"], ["compare"]])
def test_help_loads_nothing_heavy(words: list[str]) -> None:
    code = f"import uqfold.cli\ntry:\n    uqfold.cli.main({words})\nexcept SystemExit:\n    pass"
    assert loaded(code).isdisjoint({*HEAVY, "numpy", "scipy"})


def test_every_exported_name_can_be_had() -> None:
    import uqfold
    import uqfold.comparison
    import uqfold.report

    for package in (uqfold, uqfold.comparison, uqfold.report):
        assert [name for name in package.__all__ if getattr(package, name, None) is None] == []
