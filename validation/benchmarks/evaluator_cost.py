"""What the evaluator adds to a model's own time, with and without a store.

The model is called directly and through the evaluator, in turns and on the same rows, and the best
of several turns counts. Processor time of all threads is taken, which other programs disturb less
than the clock. Nothing is stored, since speeds belong to a machine.

    python validation/benchmarks/evaluator_cost.py    # about one minute
"""

from __future__ import annotations

import tempfile
import time
from pathlib import Path

import numpy as np

import uqfold
from uqfold.evaluation import Evaluator
from uqfold.inputs import normal
from uqfold.problems import Problem

BATCH = 4096
"""Rows of a direct call: as many as the evaluator hands over in this process."""
TURNS = 7

CHEAP = Problem(
    lambda x: x[:, 0] + x[:, 1] ** 2,
    individual={name: normal(0.0, 1.0) for name in "abcde"},
    name="cheap",
    version="1",
)


def microseconds(problem: Problem, samples: int, store: Path) -> tuple[float, float, float]:
    """Return processor time per sample: of the model, through the evaluator, with a new store."""
    x = problem.inputs.sample(np.random.default_rng(0), samples)
    runs = (
        lambda: [problem.model(x[i : i + BATCH]) for i in range(0, samples, BATCH)],
        lambda: Evaluator().open(problem, None).evaluate(x),
        lambda: Evaluator(store=store).open(problem, None).evaluate(x),
    )
    found = []
    for run in runs:
        store.unlink(missing_ok=True)
        started = time.process_time()
        run()
        found.append(time.process_time() - started)
    return tuple(1e6 * seconds / samples for seconds in found)


def main() -> None:
    """Measure a cheap vectorised model and the wing."""
    for problem, samples in ((CHEAP, 1_000_000), (uqfold.problems.folding_wing(), 16_384)):
        with tempfile.TemporaryDirectory() as folder:
            turns = [microseconds(problem, samples, Path(folder) / "runs.db") for _ in range(TURNS)]
        model, plain, stored = np.min(turns, axis=0)
        print(
            f"{problem.name}: {model:.3f} us a sample alone, {plain - model:+.3f} us through the "
            f"evaluator, {stored - model:+.3f} us with a store"
        )


if __name__ == "__main__":
    main()
