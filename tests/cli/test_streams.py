"""What the program says when something cannot be written: one line, exit 2, no traceback."""

import os
import subprocess
import sys
from pathlib import Path

import pytest

from tests.comparison.fakes import toy_frame
from uqfold.cli import main
from uqfold.comparison import write_records
from uqfold.problems.criterion import criteria

pytestmark = pytest.mark.skipif(sys.platform != "linux", reason="/dev/full and shell")

ROOT = Path(__file__).parents[2]
COMPARE = "compare series --method ffni-spa --threshold 4 --tau none --no-figures --out out"


@pytest.fixture(autouse=True)
def _in_an_empty_folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)


def shell(tmp_path: Path, line: str) -> "subprocess.CompletedProcess[str]":
    path = os.pathsep.join([str(ROOT), *filter(None, [os.environ.get("PYTHONPATH")])])
    return subprocess.run(
        ["bash", "-o", "pipefail", "-c", line.replace("uqfold", f"{sys.executable} -m uqfold")],
        capture_output=True,
        text=True,
        check=False,
        timeout=120,
        cwd=tmp_path,
        env={**os.environ, "PYTHONPATH": path},
    )


def refused(capsys: pytest.CaptureFixture[str], words: str) -> str:
    with pytest.raises(SystemExit) as exited:
        main(words.split())
    assert exited.value.code == 2
    return " ".join(capsys.readouterr().err.split())


@pytest.mark.thorough
def test_a_full_standard_output_is_told_and_the_work_is_kept(tmp_path: Path) -> None:
    done = shell(tmp_path, f"uqfold {COMPARE} > /dev/full")
    assert done.returncode == 2
    assert done.stderr.splitlines()[-1] == (
        "error: the standard output: No space left on device: make room on the disk, or write "
        "elsewhere"
    )
    assert "Traceback" not in done.stderr
    assert "Exception ignored" not in done.stderr
    assert (tmp_path / "out" / "comparison.json").is_file()


@pytest.mark.thorough
def test_closed_streams_end_no_work(tmp_path: Path) -> None:
    done = shell(tmp_path, f"uqfold {COMPARE} >&- 2>&- <&-")
    assert (done.returncode, done.stderr) == (0, "")
    assert sorted(os.listdir(tmp_path / "out")) == ["comparison.csv", "comparison.json"]


def test_a_reader_that_leaves_is_told_nothing(tmp_path: Path) -> None:
    done = shell(tmp_path, "uqfold methods | true")
    assert (done.returncode, done.stderr) == (1, "")


@pytest.mark.parametrize(
    ("out", "message"),
    [
        ("file", "--out file: File exists: give another path"),
        ("file/new", "--out file/new: Not a directory: give another path"),
        ("/proc/new", "--out /proc/new: No such file or directory: give another path"),
    ],
)
@pytest.mark.parametrize("word", ["compare", "validate"])
def test_a_place_that_cannot_be_written_is_refused_before_work_is_spent(
    capsys: pytest.CaptureFixture[str],
    monkeypatch: pytest.MonkeyPatch,
    tmp_path: Path,
    out: str,
    message: str,
    word: str,
) -> None:
    """Read-only ``--out``, existing and new."""
    (tmp_path / "file").touch()

    def spend(*_: object) -> None:
        raise AssertionError("work was spent")

    monkeypatch.setattr("uqfold.methods.base.ReliabilityMethod.estimate", spend)
    monkeypatch.setattr("uqfold.validation.runner.Validation.run", spend)
    words = {
        "compare": "compare series --method mc",
        "validate": f"validate against_other_codes --quick --cases {ROOT / 'validation'}",
    }[word]
    said = refused(capsys, f"{words} --out {out}")
    assert message.removeprefix("--out ") in said
    assert "Traceback" not in said


def test_a_disk_that_fills_up_on_the_way_is_told_and_the_table_shown(
    capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    def full(*_: object) -> None:
        raise OSError(28, "No space left on device", "out/comparison.csv")

    monkeypatch.setattr("uqfold.comparison.records.write_records", full)
    with pytest.raises(SystemExit) as exited:
        main(COMPARE.split())
    assert exited.value.code == 2
    out, err = capsys.readouterr()
    assert "ffni-spa" in out
    assert "error: out/comparison.csv: No space left on device: make room on the disk" in err


@pytest.mark.parametrize(
    ("out", "message"),
    [("full.html", "full.html: No space left"), ("folder.html", "folder.html: Is a directory")],
)
def test_a_report_that_cannot_be_written_is_told(
    capsys: pytest.CaptureFixture[str], tmp_path: Path, out: str, message: str
) -> None:
    write_records(toy_frame(criteria(12.0)), tmp_path)
    (tmp_path / "folder.html").mkdir()
    (tmp_path / "full.html").symlink_to("/dev/full")
    assert message in refused(capsys, f"report {tmp_path} --out {tmp_path / out}")


def test_a_report_of_unreadable_records_is_refused(
    capsys: pytest.CaptureFixture[str], tmp_path: Path
) -> None:
    """Deep nesting, and numbers of 400 digits."""
    for text in ("[" * 100_000, '{"schema": 1' + "0" * 400 + "}", '{"schema": 1e999}'):
        (tmp_path / "comparison.json").write_text(text)
        assert "not a readable record" in refused(capsys, f"report {tmp_path}")


def test_a_cluster_that_is_no_address_is_refused(capsys: pytest.CaptureFixture[str]) -> None:
    """``--cluster foo`` waited for a minute."""
    assert "cluster = 'foo'" in refused(capsys, f"{COMPARE} --cluster foo")
