"""The command that turns records into a report."""

from pathlib import Path

import pytest

from tests.comparison.fakes import toy_frame
from uqfold.cli import main
from uqfold.comparison import write_records
from uqfold.problems.criterion import criteria


@pytest.fixture
def run_dir(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.chdir(tmp_path)
    write_records(toy_frame(criteria(12.0)), tmp_path / "run")
    return Path("run")


def run(*words: str) -> int:
    with pytest.raises(SystemExit) as exited:
        main(words)
    assert isinstance(exited.value.code, int)
    return exited.value.code


def test_the_report_lies_beside_its_records(
    run_dir: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert run("report", "run") == 0
    assert capsys.readouterr().out == f"written: {Path('run', 'report.html')}\n"
    text = (run_dir / "report.html").read_text(encoding="utf-8")
    assert text.startswith("<!doctype html>")
    assert str(run_dir.resolve()) not in text


def test_markdown_brings_its_pictures(run_dir: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert run("report", "run", "--out", "run/report.md") == 0
    out = capsys.readouterr().out
    pictures = sorted(path.name for path in (run_dir / "figures").iterdir())
    n = len(pictures)
    assert out == f"written: {Path('run', 'report.md')}, {n} pictures in figures\n"
    text = (run_dir / "report.md").read_text(encoding="utf-8")
    assert all(f"(figures/{name})" in text for name in pictures)


def test_the_name_of_the_file_says_the_format(run_dir: Path) -> None:
    assert run("report", str(run_dir / "comparison.json"), "--out", "deep/toy.md") == 0
    assert Path("deep", "toy.md").read_text(encoding="utf-8").startswith("# toy: ")
    assert run("report", "run", "--out", "page.HTML") == 0
    assert Path("page.HTML").read_text(encoding="utf-8").startswith("<!doctype html>")


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (["nowhere"], "nowhere: No such file or directory"),
        (["run", "--out", "report.txt"], "suffix of path = '.txt': choose from '.html', '.md'"),
        (["run/comparison.csv"], "comparison.csv is not a readable record"),
        ([], "RUN_DIR"),
    ],
)
def test_bad_arguments_are_refused(
    run_dir: Path, words: list[str], said: str, capsys: pytest.CaptureFixture[str]
) -> None:
    assert run("report", *words) == 2
    out, err = capsys.readouterr()
    assert said in err
    assert "Traceback" not in err
    assert out == ""
    assert not list(run_dir.glob("report*"))


def test_help_has_examples(capsys: pytest.CaptureFixture[str]) -> None:
    assert run("report", "--help") == 0
    assert "uqfold report uqfold-results/folding-wing --out docs/wing.md" in capsys.readouterr().out
