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
from uqfold.evaluation.errors import ExternalRunError
from uqfold.evaluation.outputs import number, response
from uqfold.inputs import normal
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
    assert (failed / "reason.txt").read_text() == "exit code 1; it printed last: buckled\n"
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
        ({}, [0.0, 3.0], r"exit code 1; it printed last: buckled"),
        ({"timeout": 0.5}, [0.0, -3.0], r"took longer than 0.5 s"),
        ({"command": ["no-such-solver", "{{a}}"]}, [0.0, 0.0], r"no-such-solver cannot be started"),
        (
            {"output": Regex(r"z = (\S+)")},
            [0.0, 0.0],
            r"holds nothing that matches .*; it printed last: step 1: y = 0.0 / step 2: y = 0.0",
        ),
        ({"output": Regex(r"step 2: (.)")}, [0.0, 0.0], r"'y' is not a number"),
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
        ({"names": ["a"]}, r"placeholder \{\{b\}\} is not an input: choose from a"),
        ({"names": ["a", "b", "c"]}, "input 'c' occurs nowhere"),
        ({"timeout": 0.0}, "timeout = 0.0"),
        ({"parallel": 0}, "parallel = 0"),
        ({"keep": "some"}, "keep = 'some'"),
        ({"names": ["a", "a"]}, "name each once, not 'a' twice"),
        ({"names": ["a", "b c"]}, r"names\[1\] = 'b c'"),
        ({"names": []}, "at least one name"),
        ({"command": ["solver\0"]}, r"command\[0\] = 'solver"),
        ({"command": ["", "{{a}}{{b}}"]}, "give a list of words"),
        ({"timeout": math.nan}, "timeout = nan"),
        ({"command": ["solver", "{{a:d}}", "{{b}}"]}, r"\{\{a:d\}\} has no format for a number"),
        ({"command": ["solver", "{{a:9999999e}}", "{{b}}"]}, "has no format for a number"),
    ],
)
def test_mistakes_are_refused_when_the_model_is_made(
    code: Callable[..., ExternalCode], settings: dict[str, object], message: str
) -> None:
    with pytest.raises(ValueError, match=message):
        code(**settings)


@pytest.mark.parametrize(
    ("settings", "message"),
    [
        ({"names": "ab"}, "names = 'ab': give a list"),
        ({"names": ["a", 2]}, r"names\[1\] = 2"),
        ({"command": ["solver", 5]}, r"command\[1\] = 5"),
        ({"output": "y = (.)"}, r"output = 'y = .*give Regex\(\.\.\.\), Column"),
        ({"timeout": "10"}, "timeout = '10'"),
        ({"parallel": True}, "parallel = True"),
        ({"folder": 5}, "folder = 5"),
        ({"templates": ["beam.inp"]}, "give a mapping of files to templates"),
        ({"templates": {"beam.inp": 7}}, r"templates\['beam.inp'\] = 7"),
    ],
)
def test_settings_of_another_type_are_refused(
    code: Callable[..., ExternalCode], settings: dict[str, object], message: str
) -> None:
    with pytest.raises(TypeError, match=message):
        code(**settings)


OUTSIDE = ("../x.txt", "/x.txt", "a/../../x.txt", "..", ".", "", "a/", "C:\\x", "..\\x.txt", "x\0y")


@pytest.mark.parametrize("name", OUTSIDE)
def test_no_file_outside_the_folder_of_a_run_is_written_or_read(
    code: Callable[..., ExternalCode], name: str, tmp_path: Path
) -> None:
    """A template named ``../x.txt`` is refused, and so is an output."""
    template = tmp_path / "beam.template"
    with pytest.raises(ValueError, match="file"):
        code(templates={name: template})
    with pytest.raises(ValueError, match="file = "):
        Column(name, 0)
    with pytest.raises(ValueError, match="file = "):
        Regex("(.)", name)


@pytest.mark.parametrize(
    "names", [["stdout.txt"], ["Reason.TXT"], ["./stderr.txt"], ["a", "./a"], ["a", "a/b"]]
)
def test_no_two_files_of_a_run_are_the_same(
    code: Callable[..., ExternalCode], names: list[str], tmp_path: Path
) -> None:
    with pytest.raises(ValueError, match="templates"):
        code(templates=dict.fromkeys(names, tmp_path / "beam.template"))


def test_a_link_out_of_the_folder_of_a_run_is_not_followed(tmp_path: Path) -> None:
    (tmp_path / "secret.txt").write_text("7\n")
    folder = tmp_path / "run"
    folder.mkdir()
    (folder / "out.txt").symlink_to(tmp_path / "secret.txt")
    (folder / "reason.txt").symlink_to(tmp_path / "secret.txt")
    with pytest.raises(ExternalRunError, match="link that leads out"):
        Regex("(.)", "out.txt")(folder)
    (folder / "inner.txt").symlink_to("real.txt")
    (folder / "real.txt").write_text("8\n")
    assert Column("inner.txt", 0)(folder) == 8.0


def test_a_planted_link_does_not_lead_the_reason_elsewhere(tmp_path: Path) -> None:
    (tmp_path / "kept.txt").write_text("kept")
    link = "import os, sys; os.symlink(sys.argv[1], 'reason.txt'); sys.exit(3 + 0 * {{a:.0f}})"
    model = ExternalCode(
        [sys.executable, "-S", "-c", link, str(tmp_path / "kept.txt")],
        ["a"],
        Regex("(.)"),
        folder=tmp_path / "runs",
    )
    with pytest.raises(ExternalRunError, match="exit code 3"):
        model.run(np.ones(1))
    assert (tmp_path / "kept.txt").read_text() == "kept"
    [folder] = folders(tmp_path)
    assert (folder / "reason.txt").read_text() == "exit code 3\n"


def test_a_pattern_needs_one_group() -> None:
    with pytest.raises(ValueError, match="one group"):
        Regex("y = .*")
    with pytest.raises(ValueError, match="regular expression"):
        Regex("(y")


@pytest.mark.parametrize(
    "written",
    ["1_5", "1__5", "1,5", "1.5 mm", "0x1F", "0x1p3", "１５", "٣", "1e", "e5", ".", "--1", "1.5E+",
     "1.#INF", "1.5D400", "****", "", "1\u00a0500", "True", "1-200", "nan(0x8)", "1.5E 3"],
)  # fmt: skip
def test_what_is_no_number_of_c_or_fortran_is_refused(written: str, tmp_path: Path) -> None:
    """An output ``1_5`` is not 15; neither as text of a function."""
    with pytest.raises(ExternalRunError, match=r"is not a number|too large"):
        number(written)
    with pytest.raises(ExternalRunError):
        response(written)
    (tmp_path / "out.txt").write_text(f"y = {written}\n")
    with pytest.raises(ExternalRunError):
        Regex(r"y =(.*)", "out.txt")(tmp_path)


@pytest.mark.parametrize(
    ("written", "expected"),
    [("-12", -12.0), (" 1.5E+03\n", 1500.0), ("1.5d-3", 0.0015), ("+.5", 0.5), ("7.", 7.0),
     ("1.5-103", 1.5e-103), ("-0.25+120", -0.25e120), ("INF", math.inf), ("-infinity", -math.inf),
     ("0.1", 0.1), ("-0.0", 0.0), ("123456789012345678901234567890", 1.2345678901234568e29)],
)  # fmt: skip
def test_numbers_of_c_and_fortran_are_read(written: str, expected: float) -> None:
    assert number(written) == response(written) == expected


@pytest.mark.parametrize("returned", [True, b"1", None, [1.0], np.ones(1), 1j, math.nan])
def test_an_output_that_is_no_number_is_a_failed_run(returned: object) -> None:
    with pytest.raises(ExternalRunError, match="the output"):
        response(returned)
    assert response(np.float32(0.5)) == response(np.array(0.5)) == 0.5


@pytest.mark.parametrize(
    ("pattern", "line"),
    [(r"y = (\d+)", "y = 1.5E+03"), (r"y = ([\d.]+)", "y = 1.5E+03"), (r"y = .*(\d+)", "y = 15"),
     (r"y = (\d+)", "y = 1_5"), (r"y = ([\d.]+)", "y = 1.5D-3"), (r"y = ([\d.]+)", "y = 1.5-103")],
)  # fmt: skip
def test_a_part_of_a_number_is_not_taken_for_it(pattern: str, line: str, tmp_path: Path) -> None:
    (tmp_path / "out.txt").write_text(line + "\n")
    with pytest.raises(ExternalRunError, match="a part of the number only"):
        Regex(pattern, "out.txt")(tmp_path)


def test_a_unit_or_a_full_stop_may_follow_a_number(tmp_path: Path) -> None:
    (tmp_path / "out.txt").write_text("t = 15ms, y=-2.5. Done\n")
    assert Regex(r"t = (\d+)", "out.txt")(tmp_path) == 15.0
    assert Regex(r"y=([-\d]+\.\d+)", "out.txt")(tmp_path) == -2.5


@pytest.mark.parametrize("encoding", ["latin-1", "utf-8", "utf-8-sig", "utf-16"])
@pytest.mark.parametrize("end", ["\n", "\r\n"])
def test_outputs_are_read_in_any_encoding(encoding: str, end: str, tmp_path: Path) -> None:
    """Outputs in Latin-1 or with CRLF; 0x85 is a sign in Latin-1, and ends no line."""
    text = f"Länge\x85 = 1.5 µm{end}Größe = 2.5{end}{end}"
    (tmp_path / "out.txt").write_bytes(text.encode(encoding))
    assert Regex(r"^Größe = (\S+)$", "out.txt")(tmp_path) == 2.5
    assert Column("out.txt", 2)(tmp_path) == 2.5
    assert Column("out.txt", -2, row=0)(tmp_path) == 1.5


def test_bytes_that_are_no_text_end_no_run(tmp_path: Path) -> None:
    (tmp_path / "out.txt").write_bytes(b"\x00\xff\xfe\x80 y = 2.5\n")
    assert Regex(r"y = (\S+)", "out.txt")(tmp_path) == 2.5


def test_templates_keep_their_bytes(tmp_path: Path) -> None:
    """Templates in Latin-1 or with CRLF: every byte but the placeholders stays as it is."""
    other = bytes(range(256)) + "Länge\r\nGröße".encode("latin-1") + b"\r\r\n\n\xef\xbb\xbf"
    (tmp_path / "template").write_bytes(other + b"{{a}}" + other)
    model = ExternalCode(
        [sys.executable, "-S", "-c", "print('y = 1.5')"],
        ["a"],
        Regex("y = (.+)"),
        {"deep/beam.inp": tmp_path / "template"},
        folder=tmp_path / "runs",
        keep="all",
    )
    assert model.run(np.array([0.25])) == 1.5
    [folder] = folders(tmp_path)
    assert (folder / "deep" / "beam.inp").read_bytes() == other + b"0.25" + other
    # and such a model has an entry of its own in a store
    with_store = Evaluator(store=tmp_path / "runs.db")
    problem = uqfold.Problem(model, individual={"a": normal(0, 1)}, name="p", version="1")
    for reused in (0, 2):
        session = with_store.open(problem, None)
        session.evaluate(np.array([[0.25], [0.25]]))
        assert session.n_reused == reused


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
