"""What the evaluator adds to a model's own time, with and without a store.

The model is called directly and through the evaluator, in turns and on the same rows, and the best
of several turns counts. Processor time of all threads is taken, which other programs disturb less
than the clock. The exit code is 1 if a limit is broken: 1 microsecond per sample on a vectorised
cheap model without a store, 3 % of the wing's own time.

    python validation/benchmarks/evaluator_cost.py    # about one minute
"""

from __future__ import annotations

import sys
import tempfile
import time
from collections.abc import Callable
from pathlib import Path

import numpy as np

import uqfold
from uqfold.evaluation import Evaluator, Store
from uqfold.inputs import normal
from uqfold.problems import Problem
from uqfold.typing import FloatArray

BATCH = 4096
"""Rows of a direct call: as many as the evaluator hands over in this process."""
TURNS = 7
MOST_MICROSECONDS = 1.0
MOST_SHARE = 0.03


def cheap_problem() -> Problem:
    """Return a vectorised model of two operations per sample."""
    return Problem(
        lambda x: x[:, 0] + x[:, 1] ** 2,
        individual={name: normal(0.0, 1.0) for name in "abcde"},
        name="cheap",
        version="1",
    )


def processor_seconds(run: Callable[[], object]) -> float:
    """Return the processor time (s) of all threads."""
    started = time.process_time()
    run()
    return time.process_time() - started


def added_seconds(problem: Problem, x: FloatArray, folder: Path) -> tuple[float, float, float]:
    """Return seconds per sample: of the model, added by the evaluator, and with a new store."""

    def alone() -> None:
        for i in range(0, len(x), BATCH):
            problem.model(x[i : i + BATCH])

    def through(store: Store | None) -> None:
        Evaluator(store=store).open(problem, None).evaluate(x)

    times = []
    for turn in range(TURNS):
        with Store(folder / f"{problem.name}-{turn}.db") as store:
            runs = (alone, lambda: through(None), lambda: through(store))
            times.append([processor_seconds(run) for run in runs])
    model, plain, stored = np.min(times, axis=0) / len(x)
    return model, plain - model, stored - model


def main() -> int:
    """Measure a cheap model and the wing."""
    rng = np.random.default_rng(0)
    kept = True
    for problem, samples in (
        (cheap_problem(), 1_000_000),
        (uqfold.problems.folding_wing(), 16_384),
    ):
        x = problem.inputs.sample(rng, samples)
        with tempfile.TemporaryDirectory() as folder:
            model, added, stored = added_seconds(problem, x, Path(folder))
        most = 1e-6 * MOST_MICROSECONDS if problem.name == "cheap" else MOST_SHARE * model
        kept &= added < most
        print(
            f"{problem.name}: {1e6 * model:.3f} us alone, {1e6 * added:+.3f} us through the "
            f"evaluator (at most {1e6 * most:.3f}), {1e6 * stored:+.3f} us with a store"
        )
    return 0 if kept else 1


if __name__ == "__main__":
    sys.exit(main())
