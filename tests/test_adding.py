"""Five minutes to a change: each addition of ``docs/adding.md``, made in a copy of the house."""

import json
import os
import re
import shutil
import subprocess
import sys
from pathlib import Path
from typing import Any

import pytest

from uqfold.testing import CHECKS

ROOT = Path(__file__).parents[1]
PAGE = (ROOT / "docs" / "adding.md").read_text(encoding="utf-8")
FILES = dict(re.findall(r"^`([^`\n]+)`\n\n```\w+\n(.*?)```", PAGE, re.MULTILINE | re.DOTALL))
LINES = {
    "uqfold/methods/registry.py": r'^`("antithetic": "[^`]+)`$',
    "uqfold/analysis/__init__.pyi": r"^`(from uqfold\.analysis\.margin [^`]+)`$",
}
BESIDE = {
    "test_readme.py": "::test_table_of_methods_is_that_of_the_registry",
    "methods/test_theory.py": "",
    "plots/test_comparison.py": "::test_methods_have_a_look_of_their_own",
    "test_public_names.py": "",
}
"""Tests that once had to be changed for a new method, or that see what a package hands out."""
PROGRAM = """
import contextlib, io, json, runpy, sys
from pathlib import Path
import uqfold
from uqfold.cli import main
from uqfold.testing import check_method

def said(*words):
    out = io.StringIO()
    with contextlib.redirect_stdout(out), contextlib.suppress(SystemExit):
        main(words)
    return out.getvalue()

method = uqfold.methods.build("antithetic")
kept = ["same_seed_same_answer", "budget_is_kept", "rows_are_well_formed", "synchronization"]
found = {"package": uqfold.__file__, "listed": said("methods")}
found["kept"] = check_method(method, only=kept) == kept
found["style"] = uqfold.plots.method_styles(["antithetic"])["antithetic"].color
words = "--method", "antithetic", "--method", "ffni-spa", "--no-figures", "--out", "run"
found["compared"] = said("compare", "beam.py:beam", *words)
header = uqfold.comparison.read_records("run").attrs["uqfold-comparison"]
found["theory"] = header["methods"][0]["theory"]["summary"]
found["source"] = sorted(header["source"])
found["margin"] = uqfold.analysis.margin(uqfold.problems.series(), 2.0)
found["validated"] = said("validate", "beam_median", "--quick", "--update", "--out", "measured")
sys.argv = ["study.py", "--quick"]
with contextlib.redirect_stdout(io.StringIO()), contextlib.suppress(SystemExit):
    runpy.run_path("studies/beam/study.py", run_name="__main__")
found["report"] = Path("studies/.quick/beam/report.md").read_text()
print(json.dumps(found))
"""


@pytest.fixture(scope="module")
def house(tmp_path_factory: pytest.TempPathFactory) -> Path:
    house = tmp_path_factory.mktemp("house")
    # with its byte code, which need not be compiled anew
    shutil.copytree(ROOT / "uqfold", house / "uqfold")
    kept = ("studies/runner.py", "studies/paper.py", "docs/methods/index.md", "pyproject.toml")
    for name in kept:
        (house / name).parent.mkdir(parents=True, exist_ok=True)
        shutil.copy(ROOT / name, house / name)
    for path, text in FILES.items():
        (house / path).parent.mkdir(parents=True, exist_ok=True)
        (house / path).write_text(text, encoding="utf-8")
    (house / "validation" / "__init__.py").touch()
    for path, pattern in LINES.items():
        (line,) = re.findall(pattern, PAGE, re.MULTILINE)
        text = (house / path).read_text(encoding="utf-8")
        if path.endswith(".pyi"):
            text += line + "\n"
        else:
            text = text.replace('    "mc": ', f'    {line}\n    "mc": ', 1)
        (house / path).write_text(text, encoding="utf-8")
    return house


def run(house: Path, *words: str) -> "subprocess.CompletedProcess[str]":
    return subprocess.run(
        [sys.executable, *words],
        capture_output=True,
        text=True,
        check=False,
        cwd=house,
        env={**os.environ, "PYTHONPATH": str(house)},
        timeout=300,
    )


@pytest.fixture(scope="module")
def found(house: Path) -> dict[str, Any]:
    done = run(house, "-W", "error", "-c", PROGRAM)
    assert done.returncode == 0, done.stderr
    made: dict[str, Any] = json.loads(done.stdout.splitlines()[-1])
    assert Path(made["package"]).is_relative_to(house)
    return made


def test_a_method_is_one_file_and_one_line(found: dict[str, Any]) -> None:
    assert "antithetic" in found["listed"]
    assert "Monte Carlo, antithetic pairs" in found["listed"]
    assert found["kept"]
    assert re.fullmatch("#[0-9A-F]{6}", found["style"])
    assert found["theory"].startswith("Monte Carlo whose systems come in pairs")
    assert "uqfold/methods" in found["source"]


@pytest.mark.thorough
def test_nothing_else_breaks_when_a_method_is_added(house: Path) -> None:
    for name in (*BESIDE, "comparison/fakes.py"):
        (house / "tests" / name).parent.mkdir(parents=True, exist_ok=True)
        shutil.copy(ROOT / "tests" / name, house / "tests" / name)
    options = "-q", "-n", "0", "-p", "no:cacheprovider", "-k", "not type_checker"
    tests = (f"tests/{name}{test}" for name, test in BESIDE.items())
    done = run(house, "-m", "pytest", *options, *tests)
    assert done.returncode == 0, done.stdout


def test_the_page_says_what_every_check_of_the_contract_wants() -> None:
    table = PAGE.partition("| check |")[2].partition("\n\n")[0]
    assert re.findall(r"(?m)^\| `(\w+)` \| \S", table) == list(CHECKS)


def test_a_problem_is_one_file(found: dict[str, Any]) -> None:
    assert "beam: deflection (mm)" in found["compared"]
    assert "T = 15 mm, 1 mission" in found["compared"]
    assert "antithetic" in found["compared"]


def test_an_analysis_is_one_file_and_one_line(found: dict[str, Any]) -> None:
    assert found["margin"] == pytest.approx(8.0740767, rel=1e-6)


def test_a_validation_case_is_one_folder(found: dict[str, Any], house: Path) -> None:
    assert "1 holds; 1 of 1 planted faults noticed" in found["validated"]
    assert (house / "validation" / "beam_median" / "quick.json").is_file()


def test_a_study_is_one_folder(found: dict[str, Any], house: Path) -> None:
    assert found["report"].startswith("# A beam: how sure is its deflection?")
    assert (house / "studies" / ".quick" / "beam" / "results" / "curves.csv").is_file()
