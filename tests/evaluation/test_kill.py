"""A run that is killed again and again ends with the answer of one that was left alone."""

import json
import signal
import subprocess
import sys
import time
from pathlib import Path

import numpy as np
import pytest

from tests.evaluation.killed_program import BATCH_SECONDS, SYSTEMS, estimate
from uqfold.evaluation import Store

ROOT = Path(__file__).parents[2]
BATCH_ROWS = 64
UNITS = 4


def started(folder: Path) -> "subprocess.Popen[str]":
    arguments = [str(folder / "runs.db"), str(folder / "log"), str(BATCH_ROWS)]
    return subprocess.Popen(
        [sys.executable, "-m", "tests.evaluation.killed_program", *arguments],
        stdout=subprocess.PIPE,
        text=True,
        cwd=ROOT,
    )


def batches_run(folder: Path) -> int:
    log = folder / "log"
    return log.stat().st_size if log.exists() else 0


def killed(folder: Path, rng: np.random.Generator, most: float) -> bool:
    """Start the run and kill it at a random moment; give whether it was still running."""
    before = batches_run(folder)
    program = started(folder)
    if rng.random() < 0.8:
        # most of the time at work, otherwise while it starts
        while batches_run(folder) == before and program.poll() is None:
            time.sleep(0.01)
    time.sleep(rng.uniform(0.0, most))
    program.kill()
    program.communicate(timeout=60)
    return program.returncode == -signal.SIGKILL


@pytest.mark.parametrize(
    "kills",
    [
        pytest.param(3, id="few", marks=pytest.mark.thorough),
        pytest.param(20, id="many", marks=pytest.mark.slow),
    ],
)
def test_a_run_survives_being_killed_at_random_moments(kills: int, tmp_path: Path) -> None:
    expected = estimate(None, str(tmp_path / "alone"), BATCH_ROWS, 0.0)
    batches = SYSTEMS * UNITS // BATCH_ROWS
    assert (tmp_path / "alone").stat().st_size == batches
    rng = np.random.default_rng(kills)
    # so that the kills are spread over the run, and it is still there for the last one
    most = 0.6 * batches * BATCH_SECONDS / kills
    survived = sum(killed(tmp_path, rng, most) for _ in range(kills))
    assert survived == kills
    done = batches_run(tmp_path)
    with Store(tmp_path / "runs.db") as store:
        kept = len(store)
    # all that was finished is kept, but for the batch that was under way at each kill
    assert done - kills <= kept // BATCH_ROWS <= done
    assert kept > 0
    program = started(tmp_path)
    answer = json.loads(program.communicate(timeout=300)[0])
    assert answer["rows"] == expected["rows"]
    assert answer["n_reused"] == kept
    assert batches_run(tmp_path) <= batches + kills
