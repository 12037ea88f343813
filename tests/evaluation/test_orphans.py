"""No process that an external code has started outlives its run, its caller or its caller's end."""

import os
import secrets
import signal
import subprocess
import sys
import time
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from tests.evaluation import models, orphans
from uqfold.evaluation import Evaluator, Processes
from uqfold.evaluation.errors import ExternalRunError

pytestmark = pytest.mark.skipif(sys.platform != "linux", reason="reads /proc")

ROOT = Path(__file__).parents[2]
PATIENCE_SECONDS = 60.0
FAMILIES, MEMBERS = 2, 3


@pytest.fixture
def tag() -> str:
    return f"orphan-{secrets.token_hex(8)}"


def waited(true: Callable[[], bool]) -> bool:
    end = time.monotonic() + PATIENCE_SECONDS
    while not true() and time.monotonic() < end:
        time.sleep(0.05)
    return true()


@pytest.mark.parametrize(
    ("how", "number"),
    [
        ("threads", signal.SIGINT),
        pytest.param("threads", signal.SIGTERM, marks=pytest.mark.thorough),
        pytest.param("processes", signal.SIGINT, marks=pytest.mark.thorough),
        ("processes", signal.SIGTERM),
        ("slow", signal.SIGKILL),
        ("direct", signal.SIGINT),
    ],
)
def test_a_caller_that_is_ended_leaves_no_process(
    how: str, number: int, tmp_path: Path, tag: str
) -> None:
    """Ctrl-C and SIGTERM leave no orphan of an external code."""
    program = subprocess.Popen(
        [sys.executable, "-m", "tests.evaluation.orphans", how, str(tmp_path), tag],
        stderr=subprocess.PIPE,
        text=True,
        cwd=ROOT,
    )
    try:
        assert waited(lambda: len(os.listdir(tmp_path)) >= FAMILIES * MEMBERS), program.poll()
        assert len(orphans.tagged(tag)) >= FAMILIES * MEMBERS
        program.send_signal(number)
        _, err = program.communicate(timeout=PATIENCE_SECONDS)
    finally:
        program.kill()
    if number == signal.SIGINT:
        assert err.rstrip().endswith("KeyboardInterrupt")
        # the caller has waited for them
        assert orphans.tagged(tag) == []
    assert waited(lambda: not orphans.tagged(tag))


def test_a_time_out_leaves_no_process(tmp_path: Path, tag: str) -> None:
    """A time-out leaves no orphan, nor does a setsid grandchild survive."""
    for timeout in (1.0, 5.0, 25.0):
        model = orphans.family(orphans.WAITING, tmp_path, tag, timeout)
        with pytest.raises(ExternalRunError, match=f"longer than {timeout:g} s"):
            model.run(np.zeros(1))
        assert orphans.tagged(tag) == []
        # on a slow machine they may not have been started yet
        if len(os.listdir(tmp_path)) >= MEMBERS:
            break
    assert len(os.listdir(tmp_path)) >= MEMBERS


def test_a_run_that_ends_by_itself_leaves_no_process(tmp_path: Path, tag: str) -> None:
    model = orphans.family(orphans.ENDING, tmp_path, tag)
    assert model.run(np.zeros(1)) == 1.0
    assert len(os.listdir(tmp_path)) == MEMBERS
    assert orphans.tagged(tag) == []


def test_a_worker_that_is_ended_leaves_no_process_of_any_model(tmp_path: Path, tag: str) -> None:
    """A model of plain Python that starts programs itself: the time limit ends them as well."""
    model = models.Starting((sys.executable, "-c", orphans.SLEEPING, tag, str(tmp_path / "one")))
    with Processes(1) as pool:
        for seconds in (1.0, 5.0, 25.0):
            session = Evaluator(executor=pool, seconds_per_run=seconds).session(model, 1, None)
            assert np.isnan(session.evaluate(np.zeros((1, 1)))).all()
            assert orphans.tagged(tag) == []
            if (tmp_path / "one").exists():
                break
    assert (tmp_path / "one").exists()
