"""The commands on studies: files, errors, states, exit codes."""

import os
import subprocess
import sys
from pathlib import Path

import pytest

from uqfold.cli import main

FILE = """\
schema = "uqfold-study/1"
title = "A small study"
question = "How sure are we?"

[problems.series]
case = "series"

[[run]]
name = "body"
problem = "series"
methods = ["ffni-spa", "mc"]
thresholds = [0, 2, 4]
missions = [1, 2]
max_evals = 20000
quick = { thresholds = [0, 4], max_evals = 8000 }

[[table]]
name = "sizes"
kind = "evaluations"
table = "body"

[[figure]]
name = "curves"
kind = "reliability"
table = "body"
panels = "missions"
parts = ["reliability", "pf", "error"]
title = "Reliability"
"""


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.chdir(tmp_path)
    made = tmp_path / "studies" / "small"
    made.mkdir(parents=True)
    (made / "study.toml").write_text(FILE)
    return made


def run(*words: str) -> int:
    with pytest.raises(SystemExit) as exited:
        main(words)
    assert isinstance(exited.value.code, int)
    return exited.value.code


def test_run_list_and_check(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert run("study", "list") == 0
    assert "results: missing" in capsys.readouterr().out
    assert run("study", "check") == 1
    assert "results: missing" in capsys.readouterr().out
    assert run("study", "run", "studies/small") == 0
    assert "A small study" in capsys.readouterr().out
    files = {path.relative_to(folder).as_posix() for path in folder.rglob("*") if path.is_file()}
    assert files == {
        "study.toml",
        "report.md",
        "results/record.json",
        *(f"results/{name}.csv" for name in ("problems", "inputs", "body")),
        *(f"figures/curves.{suffix}" for suffix in ("png", "svg")),
    }
    page = (folder / "report.md").read_text()
    assert "![Reliability](figures/curves.png)" in page
    assert "| ffni-spa | 75 | - |" in page
    assert str(folder.parent) not in page
    assert run("study", "list") == 0
    assert "results: present" in capsys.readouterr().out
    assert run("study", "check") == 0
    assert "studies/small: holds" in capsys.readouterr().out


def test_check_finds_wrong_results(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert run("study", "run", "studies/small", "--quiet") == 0
    path = folder / "results" / "body.csv"
    head, first, *rest = path.read_text().splitlines()
    pf = first.split(",")[head.split(",").index("pf")]
    path.write_text("\n".join([head, first.replace(pf, "0.5"), *rest]) + "\n")
    assert run("study", "check", "studies/small") == 1
    assert "changed by hand" in capsys.readouterr().out
    # a record that was made to fit does not help: the numbers are computed again
    record = folder / "results" / "record.json"
    import hashlib
    import json

    document = json.loads(record.read_text())
    [entry] = [one for one in document["tables"] if one["name"] == "body"]
    entry["sha256"] = hashlib.sha256(path.read_bytes()).hexdigest()
    record.write_text(json.dumps(document))
    assert run("study", "check", "studies/small", "--no-run") == 0
    assert run("study", "check", "studies/small") == 1
    assert "committed 0.5" in capsys.readouterr().out


def test_redraw_runs_nothing(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert run("study", "run", "studies/small", "--redraw") == 1
    assert "there are no results" in capsys.readouterr().err
    assert run("study", "run", "studies/small", "--no-store") == 0
    assert not (folder.parent / ".cache").exists()
    before = (folder / "figures" / "curves.svg").read_bytes()
    (folder / "figures" / "curves.svg").unlink()
    (folder / "figures" / "of-before.png").touch()
    assert run("study", "run", "studies/small", "--redraw") == 0
    assert (folder / "figures" / "curves.svg").read_bytes() == before
    assert not (folder / "figures" / "of-before.png").exists()
    (folder / "study.toml").write_text(FILE.replace("missions = [1, 2]", "missions = [1, 3]"))
    assert run("study", "run", "studies/small", "--redraw") == 1
    assert "another study.toml" in capsys.readouterr().err


def test_an_interrupted_run_goes_on(
    folder: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    assert run("study", "run", "studies/small", "--store", "kept", "--quiet") == 0
    expected = (folder / "results" / "body.csv").read_bytes()
    started: list[str] = []

    def interrupt(bar: object, title: str, n_evals: int, expected: int | None) -> None:
        if title not in started:
            started.append(title)
        if len(started) == 2:
            raise KeyboardInterrupt

    with monkeypatch.context() as patched:
        patched.setattr("uqfold.cli.study_session.ComparisonProgressBar.__call__", interrupt)
        assert run("study", "run", "studies/small") == 130
    assert "to go on from there: uqfold study run studies/small" in capsys.readouterr().err
    assert started == ["body / series / ffni-spa", "body / series / mc"]
    # what is left of the earlier results is not taken for those of this run
    assert run("study", "list") == 0
    assert "results: incomplete" in capsys.readouterr().out
    started.clear()
    with monkeypatch.context() as patched:
        patched.setattr(
            "uqfold.cli.study_session.ComparisonProgressBar.__call__",
            lambda bar, title, n_evals, expected: started.append(title),
        )
        assert run("study", "run", "studies/small") == 0
    assert set(started) == {"body / series / mc"}
    assert (folder / "results" / "body.csv").read_bytes() == expected


def test_quick_goes_elsewhere(folder: Path) -> None:
    assert run("study", "run", "studies/small", "--quick", "--quiet") == 0
    assert not (folder / "results").exists()
    assert Path("uqfold-results/studies-quick/small/report.md").exists()


def test_errors_name_file_line_and_key(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    (folder / "study.toml").write_text(FILE.replace('"ffni-spa"', '"ffni-sap"'))
    assert run("study", "run", "studies/small") == 1
    error = capsys.readouterr().err
    assert "small/study.toml, line 11, run[1].methods" in error
    assert "did you mean 'ffni-spa'?" in error
    assert run("study", "list") == 1
    assert run("study", "run", "studies/none") == 1


def test_the_example_of_the_page_runs(folder: Path) -> None:
    text = (Path(__file__).parents[2] / "docs" / "studies.md").read_text(encoding="utf-8")
    for language, name in (("toml", "study.toml"), ("python", "my_model.py")):
        block = text[text.index(f"```{language}\n") :].partition("\n")[2].partition("```")[0]
        (folder / name).write_text(block)
    assert run("study", "run", "studies/small", "--quick", "--quiet", "--out", "made") == 0
    report = Path("made/report.md").read_text()
    assert "| load |  | once per system | Gumbel |" in report
    # Monte Carlo, which draws, ran with the budget of the reduced form
    table = Path("made/results/body.csv").read_text().splitlines()
    assert len(table) == 1 + 2 * 2 * 2 * 3


def test_help_with_examples() -> None:
    for words in ([], ["run"], ["list"], ["check"], ["keys"]):
        done = subprocess.run(
            [sys.executable, "-m", "uqfold", "study", *words, "--help"],
            capture_output=True,
            text=True,
            check=True,
            env={**os.environ, "COLUMNS": "100"},
        )
        assert "Example" in done.stdout
