"""Options of the evaluation engine: store, limit on time, how to resume."""

import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest

from uqfold.cli import main
from uqfold.comparison import read_records

ROOT = Path(__file__).parents[2]
ONE = ["compare", "series", "--threshold", "4", "--tau", "none", "--no-figures"]


@pytest.fixture(autouse=True)
def _in_an_empty_folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)


def run(*words: str) -> int:
    with pytest.raises(SystemExit) as exited:
        main(words)
    assert isinstance(exited.value.code, int)
    return exited.value.code


def test_a_store_serves_the_second_run(tmp_path: Path) -> None:
    words = [*ONE, "--method", "mc", "--max-evals", "20000", "--store", "runs.db"]
    frames = []
    for reused in (0, 20_000):
        assert run(*words, "--out", "r") == 0
        frames.append(read_records(tmp_path / "r"))
        assert frames[-1]["n_evals"].tolist() == [20_000]
        assert frames[-1]["n_reused"].tolist() == [reused]
    assert frames[0]["pf"].tolist() == frames[1]["pf"].tolist()


def test_a_file_that_is_no_store_is_a_usage_error(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    (tmp_path / "notes.txt").write_text("milk, bread, butter\n" * 50)
    assert run(*ONE, "--store", "notes.txt") == 2
    assert "not a store of uqfold" in " ".join(capsys.readouterr().err.split())


def test_the_wall_clock_limit_holds_for_each_method(tmp_path: Path) -> None:
    words = [*ONE, "--method", "mc", "--max-evals", "2000000000", "--max-seconds", "1"]
    started = time.monotonic()
    assert run(*words, "--out", "r") == 0
    assert time.monotonic() - started < 30.0
    [row] = read_records(tmp_path / "r").to_dict("records")
    assert row["status"] == "budget_exhausted"
    assert "the wall-clock limit of 1 s is over" in row["message"]


@pytest.mark.parametrize(
    ("words", "message"),
    [
        (["--max-seconds", "0"], "max_seconds = 0.0"),
    ],
)
def test_words_that_mean_nothing_are_usage_errors(
    words: list[str], message: str, capsys: pytest.CaptureFixture[str]
) -> None:
    assert run(*ONE, *words) == 2
    assert message in " ".join(capsys.readouterr().err.split())


@pytest.mark.thorough
@pytest.mark.skipif(
    not hasattr(signal, "sigtimedwait"), reason="Ctrl-C is left to Python on this system"
)
def test_ctrl_c_keeps_the_store_and_says_how_to_go_on(tmp_path: Path) -> None:
    # of four missions, so that an interruption falls among the blocks
    words = ["compare", "series", "--threshold", "4", "--tau", "none", "--missions", "4"]
    words += ["--method", "mc", "--max-evals", "400000000", "--store", str(tmp_path / "my runs.db")]
    program = subprocess.Popen(
        [sys.executable, "-m", "uqfold", *words], stderr=subprocess.PIPE, text=True, cwd=tmp_path
    )
    size, end = 0, time.monotonic() + 60.0
    # 100,000 rows take some megabytes
    while size < 3_000_000 and program.poll() is None and time.monotonic() < end:
        time.sleep(0.05)
        size = sum(path.stat().st_size for path in tmp_path.iterdir() if path.is_file())
    program.send_signal(signal.SIGINT)
    _, err = program.communicate(timeout=60)
    assert program.returncode == 130
    said = err.splitlines()[-2:]
    assert said[0] == "interrupted before any method finished; nothing was written"
    kept, _, command = said[1].partition("; to go on from there: ")
    assert kept.endswith(" evaluations are kept in my runs.db")
    assert int(kept.split()[0].replace(",", "")) > 100_000
    command_words = " ".join(words[:-1])
    assert command == f"uqfold {command_words} '{words[-1]}'"
