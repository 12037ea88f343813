"""What the evaluator costs: time per sample, and memory of long runs."""

import subprocess
import sys
import time
from collections.abc import Callable

import numpy as np
import pytest

import uqfold
from uqfold.evaluation import Evaluator
from uqfold.typing import Model

MEGABYTE = 2**20


def seconds(run: Callable[[], object]) -> float:
    """Processor time of all threads, which other programs disturb less than the clock."""
    started = time.process_time()
    run()
    return time.process_time() - started


def overhead(model: Model, x: np.ndarray, repeats: int) -> tuple[float, float]:
    """Seconds per sample of the model alone, and what the evaluator adds."""
    session = Evaluator().session(model, x.shape[1], None)
    batches = [x[i : i + 4096] for i in range(0, len(x), 4096)]
    pairs = [
        (seconds(lambda: [model(batch) for batch in batches]), seconds(lambda: session.evaluate(x)))
        for _ in range(repeats)
    ]
    alone, counted = (min(times) for times in zip(*pairs, strict=True))
    return alone / len(x), (counted - alone) / len(x)


def test_overhead_on_a_cheap_model_is_below_a_microsecond() -> None:
    x = np.random.default_rng(0).random((200_000, 5))
    _, added = overhead(lambda x: x[:, 0] + x[:, 1] ** 2, x, 5)
    assert added < 1e-6


@pytest.mark.slow
def test_overhead_on_the_wing_is_below_three_percent() -> None:
    problem = uqfold.problems.folding_wing()
    x = problem.inputs.sample(np.random.default_rng(0), 8192)
    alone, added = overhead(problem.model, x, 5)
    assert added < 0.03 * alone


def peak_memory(systems: int) -> int:
    """Peak resident memory (bytes) of a Monte Carlo run in a process of its own."""
    code = (
        "import resource, uqfold\n"
        "from uqfold.inputs.joint import normal\n"
        "problem = uqfold.Problem(lambda x: x[:, 0], individual={'x': normal(0.0, 1.0)})\n"
        f"method = uqfold.methods.MonteCarlo(systems={systems})\n"
        "result = method.estimate(problem, uqfold.criteria(4.0), rng=1)\n"
        f"assert result.n_evals == {systems}\n"
        "print(resource.getrusage(resource.RUSAGE_SELF).ru_maxrss)\n"
    )
    done = subprocess.run(
        [sys.executable, "-c", code], capture_output=True, text=True, check=True, timeout=7200
    )
    return int(done.stdout) * (1 if sys.platform == "darwin" else 1024)


@pytest.mark.skipif(sys.platform == "win32", reason="needs getrusage")
@pytest.mark.parametrize(
    ("few", "many"),
    [
        pytest.param(100_000, 1_000_000, id="1e6"),
        pytest.param(1_000_000, 10_000_000, id="1e7", marks=pytest.mark.slow),
    ],
)
def test_ten_times_the_systems_take_no_more_memory(few: int, many: int) -> None:
    # the history of the counts is all that grows: some 100 bytes per 4,096 systems
    assert peak_memory(many) - peak_memory(few) < 10 * MEGABYTE


@pytest.mark.slow
@pytest.mark.skipif(sys.platform == "win32", reason="needs getrusage")
def test_a_hundred_million_systems_stay_below_500_megabytes() -> None:
    assert peak_memory(100_000_000) < 500 * MEGABYTE
