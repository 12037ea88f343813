"""External codes: templates, command, output, folders, failures, parallel runs."""

import math
import sys
import time
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

import uqfold
from tests.evaluation import models
from uqfold.evaluation import Column, Evaluator, ExternalCode, Processes, Regex
from uqfold.evaluation.outputs import ExternalRunError
from uqfold.methods import MonteCarlo

PROGRAM = """
import sys, time
values = dict(line.split(" = ") for line in open("beam.inp").read().splitlines() if " = " in line)
a, b = float(values["a"]), float(values["b"])
if b > 2.0:
    sys.exit("buckled")
if b < -2.0:
    time.sleep(60.0)
print("step 1: y = 0.0")
print("step 2: y =", repr(a + 0.5 * b ** 2))
with open("table.csv", "w") as out:
    out.write("a;y\\n\\n%r;%r\\n" % (a, a + 0.5 * b ** 2))
"""
BEAM = "* {not a placeholder}\na = {{a}}\nb = {{ b }}\nshown = {{a:.3f}}\n"


@pytest.fixture
def code(tmp_path: Path) -> Callable[..., ExternalCode]:
    (tmp_path / "program.py").write_text(PROGRAM)
    (tmp_path / "robust.py").write_text(PROGRAM.replace("2.0", "99.0"))
    (tmp_path / "beam.template").write_text(BEAM)

    def build(**more: object) -> ExternalCode:
        settings: dict[str, object] = {
            "command": [sys.executable, "-S", str(tmp_path / "program.py")],
            "names": ["a", "b"],
            "output": Regex(r"y = (\S+)"),
            "templates": {"beam.inp": tmp_path / "beam.template"},
            "timeout": 10.0,
            "parallel": 2,
            "folder": tmp_path / "runs",
        }
        return ExternalCode(**{**settings, **more})  # type: ignore[arg-type]

    return build


def folders(tmp_path: Path) -> list[Path]:
    return sorted((tmp_path / "runs").iterdir())


@pytest.mark.parametrize("output", [Regex(r"y = (\S+)"), Column("table.csv", 1, delimiter=";")])
def test_responses_are_exact(code: Callable[..., ExternalCode], output: object) -> None:
    x = np.array([[1.0 / 3.0, 0.1], [-2.5e-17, 1.1]])
    np.testing.assert_array_equal(code(output=output)(x), models.quadratic(x))


def test_folders_are_kept_as_asked(code: Callable[..., ExternalCode], tmp_path: Path) -> None:
    x = np.array([[1.0, 0.0], [1.0, 3.0]])
    expected = [1.0, math.nan]
    np.testing.assert_array_equal(code(keep="none")(x), expected)
    assert folders(tmp_path) == []
    np.testing.assert_array_equal(code()(x), expected)
    [failed] = folders(tmp_path)
    assert (failed / "reason.txt").read_text() == "exit code 1: buckled\n"
    assert (failed / "beam.inp").read_text() == (
        "* {not a placeholder}\na = 1.0\nb = 3.0\nshown = 1.000\n"
    )
    code(keep="all")(x)
    assert len(folders(tmp_path)) == 3


def broken(folder: Path) -> float:
    raise KeyError("stress")


@pytest.mark.parametrize(
    ("settings", "row", "reason"),
    [
        ({}, [0.0, 3.0], r"exit code 1: buckled"),
        ({"timeout": 0.5}, [0.0, -3.0], r"took longer than 0.5 s"),
        ({"command": ["no-such-solver", "{{a}}"]}, [0.0, 0.0], r"no-such-solver cannot be started"),
        ({"output": Regex(r"z = (\S+)")}, [0.0, 0.0], r"holds nothing that matches"),
        ({"output": Regex(r"step 2: (.)")}, [0.0, 0.0], r"'y' is no number"),
        ({"output": Regex("(.)", "out.txt")}, [0.0, 0.0], r"FileNotFoundError.*out.txt"),
        ({"output": Column("table.csv", 9)}, [0.0, 0.0], r"no column 9 in row -1"),
        ({"output": lambda folder: math.nan}, [0.0, 0.0], r"the output is NaN"),
        ({"output": broken}, [0.0, 0.0], r"KeyError: 'stress'"),
    ],
)
def test_failures_are_told(
    code: Callable[..., ExternalCode],
    settings: dict[str, object],
    row: list[float],
    reason: str,
) -> None:
    model = code(**settings)
    with pytest.raises(ExternalRunError, match=reason + r"[\s\S]*\(see .*run-") as raised:
        model.run(np.array(row))
    folder = Path(str(raised.value).rpartition("(see ")[2].rstrip(")"))
    assert (folder / "reason.txt").read_text().strip() in str(raised.value)
    session = Evaluator().session(model, 2, None)
    assert np.isnan(session.evaluate(np.array([row]))).all()
    assert "ExternalRunError" in session.first_failure


@pytest.mark.parametrize(
    ("settings", "message"),
    [
        ({"command": "solver -x"}, "give a list of words"),
        ({"command": []}, "give a list of words"),
        ({"names": ["a"]}, r"placeholder \{\{b\}\} is no input: choose from a"),
        ({"names": ["a", "b", "c"]}, "input 'c' occurs nowhere"),
        ({"timeout": 0.0}, "timeout = 0.0"),
        ({"parallel": 0}, "parallel = 0"),
        ({"keep": "some"}, "keep = 'some'"),
    ],
)
def test_mistakes_are_refused_when_the_model_is_made(
    code: Callable[..., ExternalCode], settings: dict[str, object], message: str
) -> None:
    with pytest.raises(ValueError, match=message):
        code(**settings)


def test_a_pattern_needs_one_group() -> None:
    with pytest.raises(ValueError, match="one group"):
        Regex("y = .*")


def test_infinity_and_fortran_numbers_are_numbers(tmp_path: Path) -> None:
    (tmp_path / "out.txt").write_text("y = 1.5D-03\n")
    assert Regex(r"y = (\S+)", "out.txt")(tmp_path) == 1.5e-3
    (tmp_path / "out.txt").write_text("1 inf\n2 -Infinity\n")
    assert Column("out.txt", -1)(tmp_path) == -math.inf
    assert Column("out.txt", 1, row=0)(tmp_path) == math.inf


def test_a_timeout_ends_what_the_program_has_started(tmp_path: Path) -> None:
    mark = tmp_path / "mark"
    child = f"import time; time.sleep(1.5); open({str(mark)!r}, 'w')"
    parent = f"import subprocess, sys; subprocess.run([sys.executable, '-c', {child!r}])"
    model = ExternalCode(
        [sys.executable, "-c", parent, "{{a}}"], ["a"], Regex("(.)"), timeout=0.7, keep="none"
    )
    assert np.isnan(model(np.array([[1.0]]))).all()
    time.sleep(1.5)
    assert not mark.exists()


def test_an_estimate_end_to_end(code: Callable[..., ExternalCode], tmp_path: Path) -> None:
    store = tmp_path / "runs.db"
    asked = uqfold.criteria([0.5, 1.5])
    method = MonteCarlo(systems=12)
    robust = [sys.executable, "-S", str(tmp_path / "robust.py")]
    model = code(command=robust, timeout=5.0)
    evaluator = Evaluator(store=store, seconds_per_run=3.0)
    first = method.estimate(models.problem(model), asked, rng=3, evaluator=evaluator)
    expected = method.estimate(models.problem(), asked, rng=3)
    assert first.pf.tolist() == expected.pf.tolist()
    # neither folder nor timeout make another model
    again = method.estimate(
        models.problem(code(command=robust, parallel=1, folder=None)),
        asked,
        rng=3,
        evaluator=evaluator,
    )
    assert again.pf.tolist() == first.pf.tolist()
    assert again[0].n_reused == again.n_evals == 24
    assert folders(tmp_path) == []


def test_runs_are_made_side_by_side(tmp_path: Path) -> None:
    wait = ExternalCode(
        [sys.executable, "-S", "-c", "import time; time.sleep(1.0); print({{a}} + {{b}})"],
        ["a", "b"],
        Regex("(.+)"),
        parallel=4,
    )
    x = np.ones((4, 2))
    started = time.monotonic()
    assert Evaluator().session(wait, 2, None).evaluate(x).tolist() == [2.0] * 4
    assert time.monotonic() - started < 3.5


def test_workers_leave_the_limit_to_the_code(code: Callable[..., ExternalCode]) -> None:
    x = np.array([[0.0, 1.0], [0.0, -3.0]])
    with Processes(2) as pool:
        session = Evaluator(executor=pool, seconds_per_run=1.0).session(code(), 2, None)
        np.testing.assert_array_equal(session.evaluate(x), [0.5, math.nan])
    assert "took longer than 1 s" in session.first_failure
