"""`uqfold study claims`: the committed page is what the committed results give."""

import shutil
from pathlib import Path

import pytest

from uqfold.cli import main

STUDIES = Path(__file__).parents[2] / "studies"


def run(*words: str) -> int:
    with pytest.raises(SystemExit) as exited:
        main(["study", "claims", *words])
    return int(exited.value.code or 0)


def test_committed_page_is_up_to_date(capsys: pytest.CaptureFixture[str]) -> None:
    assert run(str(STUDIES), "--check") == 0, capsys.readouterr().err


def test_changed_results_make_the_page_out_of_date(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    root = tmp_path / "studies"
    # a page of fewer studies, which is up to date until results of one of them are gone
    left_out = ("*.svg", "*.png", ".cache", "which-method", "example-4", "example-5")
    shutil.copytree(STUDIES, root, ignore=shutil.ignore_patterns(*left_out))
    assert run(str(root)) == 0
    assert run(str(root), "--check") == 0
    shutil.rmtree(root / "example-6" / "results")
    assert run(str(root), "--check") == 1
    assert "claims.md is not what the results give" in capsys.readouterr().err
    assert run(str(root)) == 0
    out = capsys.readouterr().out
    assert "dispersion: cannot be judged" in out
    assert "no results of example-6/independence" in out
    assert run(str(root), "--check") == 0


def test_a_folder_without_results_is_said(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert run(str(tmp_path)) == 1
    assert "no study in" in capsys.readouterr().err
