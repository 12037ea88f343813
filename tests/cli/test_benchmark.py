"""`uqfold benchmark`: the table, its page, going on, and what is refused."""

import json
import re
from pathlib import Path
from typing import Any

import pytest

from uqfold.cli import main

FEW = ["--method", "mc,openturns-form", "--problem", "rp8", "--seeds", "2", "--max-evals", "1e3"]


@pytest.fixture(autouse=True)
def _in_an_empty_folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)


def run(*words: str) -> int:
    with pytest.raises(SystemExit) as exited:
        main(["benchmark", *words])
    assert isinstance(exited.value.code, int)
    return exited.value.code


def test_it_prints_the_table_and_writes_rows_and_page(
    capsys: pytest.CaptureFixture[str],
) -> None:
    assert run(*FEW, "--out", "few", "--report", "league.md") == 0
    out = capsys.readouterr().out
    assert "openturns-form  0 of 1" in out
    assert "written: few/rows.jsonl, league.md, figures/performance-profile.png" in out
    lines = [json.loads(one) for one in Path("few/rows.jsonl").read_text().splitlines()]
    assert [(one["label"], one["seed"]) for one in lines] == [
        ("mc", 0), ("openturns-form", 0), ("mc", 1),
    ]  # fmt: skip
    page = Path("league.md").read_text(encoding="utf-8")
    assert "uqfold benchmark --method mc,openturns-form --problem rp8 --seeds 2" in page


def test_what_the_limit_of_time_ended_is_said(capsys: pytest.CaptureFixture[str]) -> None:
    words = ["--method", "mc,openturns-form", "--problem", "rp8", "--seeds", "1"]
    assert run(*words, "--max-evals", "1e8", "--max-seconds", "0.02", "--out", "few") == 0
    said = capsys.readouterr().out
    assert re.search(r"\nended by --max-seconds, \d of 2 answers: mc 1", said)


def test_a_narrow_terminal_and_programs_get_what_they_can_read(
    capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    words = ["--method", "openturns-form", "--problem", "rp8", "--report", "league.md"]
    monkeypatch.setenv("COLUMNS", "60")
    assert run(*words) == 0
    said = capsys.readouterr().out
    assert max(map(len, said.partition("\n\n")[0].splitlines())) <= 60
    assert "no room for: " in said
    assert run(*words, "--json") == 0
    (row,) = json.loads(capsys.readouterr().out)
    assert (row["label"], row["questions"], row["bias"]) == ("openturns-form", 1, None)


def test_what_was_interrupted_is_kept_and_how_to_go_on_is_said(
    capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    def interrupted(*_: Any) -> None:
        raise KeyboardInterrupt

    monkeypatch.setattr("uqfold.methods.OpenTURNSFORM._solve", interrupted)
    assert run(*FEW, "--out", "few") == 130
    said = capsys.readouterr().err
    assert "interrupted: 1 of 3 answers are kept in few/rows.jsonl; to go on: uqfold bench" in said
    assert len(Path("few/rows.jsonl").read_text().splitlines()) == 1


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (["--problem", "rp-8"], "problems = 'rp-8': did you mean 'rp8'?"),
        (["--method", "openturns-from"], "did you mean 'openturns-form'?"),
        (["--seeds", "0"], "seeds = 0"),
        (["--max-evals", "0"], "max_evals = 0"),
        (["--report", "league.txt"], "suffix of report = '.txt'"),
        (["--method", "none.py:methods"], "there is no file none.py"),
    ],
)
def test_wrong_words_are_refused(
    words: list[str], said: str, capsys: pytest.CaptureFixture[str]
) -> None:
    assert run(*words) == 2
    assert said in capsys.readouterr().err
