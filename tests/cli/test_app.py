"""The commands: help, errors, files, output on terminals and in pipes."""

import json
import os
import re
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest
import typer

import uqfold
from uqfold.cli import main
from uqfold.cli.app import app
from uqfold.comparison import (
    available_problems,
    comparison_header,
    criteria_of,
    read_records,
)
from uqfold.comparison.records import CSV_NAME, JSON_NAME
from uqfold.methods import available
from uqfold.methods.registry import built_in
from uqfold.problems import catalogue
from uqfold.problems.criterion import Binomial, criteria

QUICK = ["--method", "ffni-spa", "--method", "ffni-pearson", "--threshold", "0,2"]
SEVERAL = ["ffni-spa", "pce", "mc", "openturns-mc"]
FIGURES = {
    f"{stem}.{suffix}"
    for stem in ("comparison", "error-against-evaluations")
    for suffix in ("png", "svg")
}


@pytest.fixture(autouse=True)
def _in_an_empty_folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)


def run(*words: str) -> int:
    with pytest.raises(SystemExit) as exited:
        main(words)
    assert isinstance(exited.value.code, int)
    return exited.value.code


def in_a_process(*words: str, **environment: str) -> subprocess.CompletedProcess[str]:
    return subprocess.run(
        [sys.executable, "-m", "uqfold", *words],
        capture_output=True,
        text=True,
        encoding="utf-8",
        timeout=600,
        check=False,
        # a width that the caller's own terminal has set is no pipe's
        env={**{k: v for k, v in os.environ.items() if k != "COLUMNS"}, **environment},
    )


def rows_of(folder: Path) -> Any:
    """The rows that a comparison has written, without what they took."""
    rows = json.loads((folder / JSON_NAME).read_text(encoding="utf-8"))["rows"]
    return [{**row, "seconds": 0} for row in rows]


def test_compare_prints_the_table_and_writes_records_and_figures(
    capsys: pytest.CaptureFixture[str], tmp_path: Path
) -> None:
    words = ["--method", "ffni-pearson", "--threshold", "0,2", "--tau", "none,16"]
    assert run("compare", "series", *words, "--max-evals", "5000", "--seed", "3") == 0
    out, err = capsys.readouterr()
    assert err == ""
    assert out.startswith("series: Y, seed 3, at most 5,000 evaluations per method\n")
    assert "T = 2, tau = 16, 1 mission" in out
    assert f"written to {Path('uqfold-results', 'series')}: comparison.csv, comparison.json" in out
    assert str(tmp_path) not in out
    folder = tmp_path / "uqfold-results" / "series"
    assert {path.name for path in folder.iterdir()} == {CSV_NAME, JSON_NAME, *FIGURES}
    for path in folder.iterdir():
        content = path.read_bytes()
        assert str(tmp_path).encode() not in content
        assert str(Path.home()).encode() + b"/" not in content


def test_methods_come_from_a_file_under_labels_of_their_own(tmp_path: Path) -> None:
    Path("mine.py").write_text(
        "from uqfold.methods import FFNIPearson\n\n\n"
        "def methods():\n    return {'coarse': FFNIPearson(3), 'fine': FFNIPearson(4)}\n"
    )
    asked = ["--method", "mine.py:methods,ffni-spa", "--threshold", "2", "--no-figures"]
    assert run("compare", "series", *asked, "--out", "run") == 0
    assert list(read_records(tmp_path / "run")["label"].unique()) == ["coarse", "fine", "ffni-spa"]


def test_records_hold_what_was_asked_and_what_compare_gives(tmp_path: Path) -> None:
    words = ["compare", "series", *QUICK, "--tau", "none", "--missions", "1,10:0.7"]
    assert run(*words, "--max-evals", "5000", "--no-figures", "--out", str(tmp_path / "r")) == 0
    again = read_records(tmp_path / "r")
    header = comparison_header(again)
    assert header["finished"] == ["ffni-spa", "ffni-pearson"]
    grid = criteria([0.0, 2.0], missions=[1, Binomial(10, 0.7)])
    assert (criteria_of(header), header["seed"], header["max_evals"]) == (grid, 0, 5000)
    assert header["command"] == (
        "uqfold compare series --method ffni-spa --method ffni-pearson --threshold 0,2 --tau none "
        "--missions 1,10:0.7 --max-evals 5000 --no-figures --out r"
    )
    frame = uqfold.compare(
        uqfold.problems.series(), ["ffni-spa", "ffni-pearson"], grid, max_evals=5000
    )
    assert again.drop(columns="seconds").equals(frame.drop(columns="seconds"))


def test_a_budget_that_suits_the_case_by_default() -> None:
    words = ["--method", "ffni-spa", "--threshold", "101", "--quiet", "--no-figures"]
    assert run("compare", "four-bar", *words) == 0
    header = comparison_header(read_records(Path("uqfold-results", "four-bar")))
    assert header["max_evals"] == 2_000_000


def test_quiet_prints_nothing_but_writes(capsys: pytest.CaptureFixture[str]) -> None:
    assert run("compare", "series", *QUICK, "--quiet", "--no-figures", "--out", "r") == 0
    assert capsys.readouterr() == ("", "")
    assert {path.name for path in Path("r").iterdir()} == {CSV_NAME, JSON_NAME}


def test_figures_do_not_stay_beside_other_records(tmp_path: Path) -> None:
    folder = tmp_path / "deep" / "r"
    folder.mkdir(parents=True)
    for name in (*FIGURES, "notes.txt"):
        (folder / name).write_text("mine", encoding="utf-8")
    words = ["compare", "series", *QUICK, "--quiet", "--no-figures", "--out", str(folder)]
    assert run(*words) == 0
    assert {path.name for path in folder.iterdir()} == {CSV_NAME, JSON_NAME, "notes.txt"}


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (["wing"], "name = 'wing': choose from 'folding-wing', 'folding-wing-random-"),
        (["series", "--method", "nope"], "'nope': choose from 'ffni-spa', "),
        (["series", "--method", "mc,mc"], "methods: two are labelled 'mc'"),
        (["series", "--threshold", "x"], "--threshold x: give a number"),
        (["series", "--tau", "-1"], "tau = -1.0: give a number >= 0, or None"),
        (["series", "--missions", "0"], "missions = 0"),
        (["series", "--max-evals", "0"], "max_evals = 0"),
        (["series", "--max-evals", "-5"], "max_evals = -5"),
        (["series", "--max-evals", "many"], "--max-evals"),
        (["series", "--seed", "-1"], "rng = -1"),
        (["series", "--failed-runs", "ignore"], "'ignore' is not one of 'bound', 'count-as-"),
        (["series", "--colour"], "--colour"),
        ([], "PROBLEM"),
    ],
)
def test_bad_arguments_are_refused_and_nothing_is_written(
    words: list[str], said: str, capsys: pytest.CaptureFixture[str], tmp_path: Path
) -> None:
    assert run("compare", *words) == 2
    out, err = capsys.readouterr()
    assert said in err
    assert "Traceback" not in err
    assert out == ""
    assert list(tmp_path.iterdir()) == []


def test_an_out_that_is_a_file_is_refused_before_any_work(
    capsys: pytest.CaptureFixture[str],
) -> None:
    Path("taken").write_text("mine", encoding="utf-8")
    assert run("compare", "series", *QUICK, "--out", "taken") == 2
    assert "--out taken: File exists" in capsys.readouterr().err
    assert Path("taken").read_text(encoding="utf-8") == "mine"


def test_without_any_answer_the_exit_code_tells(capsys: pytest.CaptureFixture[str]) -> None:
    assert run("compare", "series", "--method", "ffni-spa", "--tau", "16") == 1
    out, err = capsys.readouterr()
    assert "unsupported [1]" in out
    assert err == "error: no method has an answer\n"


def test_methods_lists_name_and_title_of_each(capsys: pytest.CaptureFixture[str]) -> None:
    assert run("methods") == 0
    lines = capsys.readouterr().out.splitlines()
    assert [line.split()[0] for line in lines] == list(available())
    for line, method in zip(lines, available().values(), strict=True):
        assert line.endswith(method.title)


def test_problems_lists_name_and_description_of_each(capsys: pytest.CaptureFixture[str]) -> None:
    assert run("problems") == 0
    lines = capsys.readouterr().out.splitlines()
    for line, problem in zip(lines, available_problems().values(), strict=True):
        assert line.startswith(f"{problem.name}  ")
        assert line.endswith(problem.description)


def test_the_package_knows_no_example_of_the_paper_by_number(
    capsys: pytest.CaptureFixture[str],
) -> None:
    for words in (["problems"], ["compare", "--help"], ["methods"], ["--help"]):
        assert run(*words) == 0
        assert not re.search(r"Example \d", capsys.readouterr().out)


def test_version(capsys: pytest.CaptureFixture[str]) -> None:
    assert run("--version") == 0
    assert capsys.readouterr().out == f"uqfold {uqfold.__version__}\n"


@pytest.mark.parametrize(
    "words",
    [
        ["--help"],
        ["compare", "--help"],
        ["methods", "--help"],
        ["problems", "--help"],
        ["benchmark", "--help"],
    ],
)
def test_help_has_examples(words: list[str], capsys: pytest.CaptureFixture[str]) -> None:
    assert run(*words) == 0
    out = capsys.readouterr().out
    examples = re.split(r"Examples?:\n", out)[1]
    assert examples.strip().startswith("uqfold ")
    # \b must have kept the lines apart
    assert "\x08" not in out


def test_help_names_every_case(capsys: pytest.CaptureFixture[str]) -> None:
    assert run("compare", "--help") == 0
    out = capsys.readouterr().out
    # the longest name ran into its description
    own = available_problems().keys() - catalogue.titles()
    assert all(f"  {case}  " in out for case in own)
    assert f"{len(catalogue.titles())} limit states of the literature" in out


@pytest.fixture(scope="module")
def piped(tmp_path_factory: pytest.TempPathFactory) -> tuple[subprocess.CompletedProcess[str], Any]:
    """A comparison of several methods, written into a pipe, and its rows."""
    folder = tmp_path_factory.mktemp("piped")
    return in_a_process(*compared(SEVERAL, folder)), rows_of(folder)


def compared(methods: list[str], folder: Path) -> list[str]:
    words = ["compare", "series", "--threshold", "2", "--tau", "none", "--max-evals", "4000"]
    return [*words, "--method", ",".join(methods), "--no-figures", "--out", str(folder)]


def test_output_into_a_pipe_is_plain_and_wide(
    piped: tuple[subprocess.CompletedProcess[str], Any],
) -> None:
    done, _ = piped
    assert done.returncode == 0
    assert done.stderr == ""
    assert "\x1b" not in done.stdout
    assert not re.search("[─-╿]", done.stdout)
    assert "  interval  " in done.stdout
    assert max(map(len, done.stdout.splitlines())) <= 120


@pytest.mark.thorough
def test_a_terminal_without_the_signs_loses_no_line() -> None:
    words = ["--method", "ffni-spa", "--threshold", "2", "--tau", "none", "--no-figures"]
    done = in_a_process("compare", "series", *words, PYTHONIOENCODING="ascii")
    assert done.returncode == 0
    assert "reference pf 0.01675 ? 1.7e-14" in done.stdout


def test_a_second_run_gives_the_same_rows(
    piped: tuple[subprocess.CompletedProcess[str], Any],
) -> None:
    """Also in another process and without one of the methods."""
    _, first = piped
    fewer = SEVERAL[1:]
    assert run(*compared(fewer, Path("again")), "--quiet") == 0
    assert rows_of(Path("again")) == [row for row in first if row["label"] in fewer]


@pytest.mark.parametrize("words", [[], ["run", "studies/example-1", "--quick"], ["list"]])
def test_studies_are_scripts_now(words: list[str], capsys: pytest.CaptureFixture[str]) -> None:
    """The old command says where they are, in one line, whatever it was asked."""
    assert run("study", *words) == 2
    said = capsys.readouterr().err
    assert "studies are scripts now, run python studies/<name>/study.py" in said


OWN = """
import uqfold
from scipy import stats

def model(x):
    return x[:, 0]

def problem():
    return uqfold.Problem(model, individual={"a": stats.norm(0, 1)})

def broken():
    return 1 / 0
"""


@pytest.fixture
def own(monkeypatch: pytest.MonkeyPatch) -> Iterator[str]:
    """A file with a problem of one's own, in the working folder."""
    monkeypatch.setattr(sys, "path", [*sys.path])
    Path("cantilever.py").write_text(OWN, encoding="utf-8")
    yield "cantilever.py"
    sys.modules.pop("cantilever", None)


@pytest.mark.parametrize(
    ("function", "said"),
    [
        ("model", "model must be a function without arguments that returns a uqfold.Problem"),
        ("broken", "cantilever.py, line 12: ZeroDivisionError: division by zero"),
        ("problem", "no criteria of its own: give --threshold T, or build it with default_crit"),
    ],
)
def test_a_problem_of_ones_own_is_refused_in_one_line(
    own: str, function: str, said: str, capsys: pytest.CaptureFixture[str]
) -> None:
    assert run("compare", f"{own}:{function}") == 2
    err = capsys.readouterr().err
    assert said in err.splitlines()[-1]
    assert "Traceback" not in err


def test_a_problem_itself_may_stand_in_a_file(own: str) -> None:
    with Path(own).open("a", encoding="utf-8") as file:
        file.write("\nready = problem()\n")
    words = ["--method", "mc", "--threshold", "1", "--max-evals", "1000", "--no-figures"]
    assert run("compare", f"{own}:ready", *words, "--quiet") == 0


def test_a_reference_is_a_number_or_the_records_of_a_long_run(
    own: str, capsys: pytest.CaptureFixture[str]
) -> None:
    words = ["compare", f"{own}:problem", "--threshold", "1", "--no-figures"]
    assert run(*words, "--method", "mc", "--max-evals", "5e4", "--quiet", "--out", "long") == 0
    short = [*words, "--method", "ffni-spa"]
    assert run(*short, "--reference", "0.1587") == 0
    assert "reference pf 0.1587" in capsys.readouterr().out
    assert run(*short, "--reference", "long") == 0
    assert "mc, 50,000 runs, seed 0" in capsys.readouterr().out
    assert run(*short, "--reference", "shrot") == 2
    assert "--reference shrot: give probabilities, or a folder" in capsys.readouterr().err


def test_results_of_another_problem_are_not_overwritten(
    own: str, capsys: pytest.CaptureFixture[str]
) -> None:
    words = ["--method", "ffni-spa", "--threshold", "1", "--no-figures", "--quiet", "--out", "r"]
    assert run("compare", f"{own}:problem", *words) == 0
    assert run("compare", "series", *words) == 2
    assert "--out r holds records of 'model': give another" in capsys.readouterr().err
    assert run("compare", f"{own}:problem", *words) == 0


def test_programs_get_json(own: str, capsys: pytest.CaptureFixture[str]) -> None:
    """The lists of names, and of a comparison the record."""
    for command, name in (("methods", "mc"), ("problems", "series")):
        assert run(command, "--json") == 0
        assert name in json.loads(capsys.readouterr().out)
    words = ["--method", "ffni-spa", "--threshold", "1", "--no-figures", "--out", "r"]
    assert run("compare", f"{own}:problem", *words, "--json") == 0
    assert capsys.readouterr().out == (Path("r") / JSON_NAME).read_text(encoding="utf-8")


def test_doctor_says_what_there_is_and_what_is_wrong(
    capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    assert run("doctor", "--json") == 0
    found = json.loads(capsys.readouterr().out)
    assert found["versions"]["uqfold"] == uqfold.__version__
    assert found["threads"]["cores"] >= 1
    assert found["compiled"]["deployment of a wing"] == "0.5356 s"
    assert found["wrong"] == []
    monkeypatch.setattr("uqfold.evaluation.store.Store.__init__", unreadable)
    assert run("doctor") == 1
    out = capsys.readouterr().out
    assert out.endswith("no store can be kept in this folder: no room\n")
    assert re.search(r"^  numpy +\d", out, re.MULTILINE)


def unreadable(*_: object) -> None:
    raise OSError("no room")


def test_a_table_holds_at_60_columns(
    own: str, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("COLUMNS", "60")
    words = ["--method", "ffni-spa,mc", "--threshold", "1", "--max-evals", "1000", "--no-figures"]
    assert run("compare", f"{own}:problem", *words, "--reference", "0.1587") == 0
    lines = capsys.readouterr().out.splitlines()
    assert max(map(len, lines)) <= 60
    assert any(line.split() == ["method", "pf", "interval", "error", "status"] for line in lines)


def test_names_complete_and_help_lists_the_methods(capsys: pytest.CaptureFixture[str]) -> None:
    assert run("compare", "--help") == 0
    words = re.split(r"[\s,]+", capsys.readouterr().out)
    assert set(built_in()) <= set(words)
    typed = {"COMP_WORDS": "uqfold compare --method co", "COMP_CWORD": "3"}
    done = in_a_process(_UQFOLD_COMPLETE="complete_bash", **typed)
    assert done.stdout.split() == ["conditional-mc"]


def test_problems_of_ones_own_are_kept_apart_by_file_and_function(own: str) -> None:
    """Two files with a function `problem` do not write into one folder."""
    words = ["--method", "mc", "--threshold", "1", "--max-evals", "1000", "--no-figures"]
    assert run("compare", f"{own}:problem", *words, "--quiet") == 0
    folder = Path("uqfold-results", "cantilever-problem")
    assert len(read_records(folder)) == 1


@pytest.mark.parametrize("words", [["compare"], ["validate"], ["report"], ["problems"]])
def test_help_fits_a_terminal_of_80_columns(
    words: list[str], capsys: pytest.CaptureFixture[str]
) -> None:
    assert run(*words, "--help") == 0
    assert max(map(len, capsys.readouterr().out.splitlines())) <= 80


@pytest.mark.parametrize("command", ["compare", "benchmark", "serve"])
def test_problems_and_methods_are_completed(command: str) -> None:
    found = typer.main.get_command(app).commands[command]  # type: ignore[attr-defined]
    offered = {
        one.name: [
            item.value
            for item in one.shell_complete(
                found.make_context(command, [], resilient_parsing=True), ""
            )
        ]
        for one in found.params
        if one.name in ("problem", "method")
    }
    assert "four-branch" in offered["problem"]
    assert command == "serve" or "subset-simulation" in offered["method"]


def test_examples_of_the_help_fit_into_80_columns() -> None:
    for command in typer.main.get_command(app).commands.values():  # type: ignore[attr-defined]
        for line in command.help.splitlines():
            assert len(line) <= 78 or not line.startswith("  "), line  # else it is wrapped
