"""Ctrl-C: the program ends at once, cleanly, and what had finished is kept."""

import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest

from uqfold.comparison import read_records

pytestmark = pytest.mark.skipif(os.name == "nt", reason="no process can be sent Ctrl-C")

ROOT = Path(__file__).parents[2]
PATIENCE_SECONDS = 60.0


def started(folder: Path, *words: str) -> "subprocess.Popen[str]":
    return subprocess.Popen(
        [
            *(sys.executable, "-m", "tests.cli.interrupted_program", "compare", "series"),
            *(*words, "--out", str(folder), "--no-figures"),
        ],
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
        cwd=ROOT,
    )


def interrupted_after(path: Path, program: "subprocess.Popen[str]") -> tuple[int, str, str]:
    """Wait until the file is there, and press Ctrl-C a little later."""
    end = time.monotonic() + PATIENCE_SECONDS
    while not path.exists() and program.poll() is None and time.monotonic() < end:
        time.sleep(0.05)
    time.sleep(0.5)
    program.send_signal(signal.SIGINT)
    out, err = program.communicate(timeout=PATIENCE_SECONDS)
    return program.returncode, out, err


@pytest.mark.parametrize(
    "second",
    [
        pytest.param(["endless"], id="in Python", marks=pytest.mark.thorough),
        pytest.param(["swallowing"], id="swallowed by the method", marks=pytest.mark.thorough),
        # OpenTURNS has a handler of its own in place while it waits for Python
        pytest.param(["openturns-mc", "--max-evals", "200000000"], id="in OpenTURNS"),
    ],
)
def test_the_methods_that_finished_are_kept(second: list[str], tmp_path: Path) -> None:
    words = ["--threshold", "7", "--tau", "none", "--method", "quick", "--method", *second]
    program = started(tmp_path, *words)
    code, out, err = interrupted_after(tmp_path / "comparison.json", program)
    assert (code, err.count("Traceback")) == (130, 0)
    assert "interrupted: 1 of 2 methods finished and are kept in " in err
    assert err.rstrip().endswith(": quick")
    assert "T = 7, 1 mission" in out
    frame = read_records(tmp_path)
    assert set(frame["label"]) == {"quick"}
    assert len(frame.attrs["uqfold-comparison"]["methods"]) == 2


@pytest.mark.thorough
def test_before_any_method_finished_nothing_is_written(tmp_path: Path) -> None:
    program = started(tmp_path / "new", "--threshold", "7", "--method", "endless")
    code, out, err = interrupted_after(tmp_path / "new", program)
    assert (code, out) == (130, "")
    assert err == "interrupted before any method finished; nothing was written\n"
    assert list((tmp_path / "new").iterdir()) == []


def test_the_signal_is_given_back_afterwards() -> None:
    code = (
        "import os, signal, time\n"
        # a program started in the background may have inherited that Ctrl-C is ignored
        "signal.signal(signal.SIGINT, signal.default_int_handler)\n"
        "from uqfold.cli.invocation import Interrupts\n"
        "def wait():\n"
        "    for _ in range(1000): time.sleep(0.01)\n"
        "for _ in range(2):\n"
        "    interrupts = Interrupts()\n"
        "    try:\n"
        "        with interrupts:\n"
        "            os.kill(os.getpid(), signal.SIGINT)\n"
        "            wait()\n"
        "    except KeyboardInterrupt:\n"
        "        print('inside', interrupts.requested)\n"
        "try:\n"
        "    os.kill(os.getpid(), signal.SIGINT)\n"
        "    wait()\n"
        "except KeyboardInterrupt:\n"
        "    print('outside')\n"
    )
    done = subprocess.run(
        [sys.executable, "-c", code],
        capture_output=True,
        text=True,
        timeout=PATIENCE_SECONDS,
        check=True,
        env=os.environ,
    )
    assert done.stdout.split("\n")[:3] == ["inside True", "inside True", "outside"]
