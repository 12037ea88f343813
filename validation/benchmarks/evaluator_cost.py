"""What the evaluator adds to a model's own time, with and without a store.

The model is called directly and through the evaluator, in turns and on the same rows, and the best
of several turns counts. Processor time of all threads is taken, which other programs disturb less
than the clock. The exit code is 1 if a limit is broken: 1 microsecond per sample on a vectorised
cheap model without a store, 3 % of the wing's own time.

    python validation/benchmarks/evaluator_cost.py            # about one minute
    python validation/benchmarks/evaluator_cost.py --quick    # a quarter of that
"""

from __future__ import annotations

import argparse
import sys
import tempfile
import time
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

import numpy as np

import uqfold
from uqfold.evaluation import Evaluator, Store
from uqfold.inputs import normal
from uqfold.problems import Problem
from uqfold.typing import FloatArray

BATCH = 4096
"""Rows of a direct call: as many as the evaluator hands over in this process."""
MOST_MICROSECONDS = 1.0
MOST_SHARE = 0.03


def cheap_problem() -> Problem:
    """A vectorised model of two operations per sample."""
    return Problem(
        lambda x: x[:, 0] + x[:, 1] ** 2,
        individual={name: normal(0.0, 1.0) for name in "abcde"},
        name="cheap",
        version="1",
    )


def processor_seconds(run: Callable[[], object]) -> float:
    """Processor time (s) of all threads."""
    started = time.process_time()
    run()
    return time.process_time() - started


def added_seconds(problem: Problem, x: FloatArray, turns: int, folder: Path) -> list[float]:
    """Seconds per sample: of the model alone, added by the evaluator, and added with a new store.

    Parameters
    ----------
    problem
        The model.
    x
        Rows (n, d).
    turns
        How often each is run.
    folder
        Where the stores are made.
    """
    batches = [x[i : i + BATCH] for i in range(0, len(x), BATCH)]

    def alone() -> None:
        for batch in batches:
            problem.model(batch)

    def through(store: Store | None) -> None:
        Evaluator(store=store).open(problem, None).evaluate(x)

    best = [float("inf")] * 3
    for turn in range(turns):
        with Store(folder / f"{problem.name}-{turn}.db") as store:
            runs = (alone, lambda: through(None), lambda: through(store))
            best = [min(b, processor_seconds(run)) for b, run in zip(best, runs, strict=True)]
    model, plain, stored = (seconds / len(x) for seconds in best)
    return [model, plain - model, stored - model]


def main(arguments: Sequence[str] | None = None) -> int:
    """Run the command line."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--quick", action="store_true", help="fewer samples and turns")
    options: Any = parser.parse_args(arguments)
    many, few, turns = (200_000, 8_192, 3) if options.quick else (1_000_000, 16_384, 7)
    rng = np.random.default_rng(0)
    kept = []
    heads = ("evaluator", "share", "with a store", "share")
    print(f"{'model':<12} {'alone':>12} " + "{:>12} {:>8} {:>14} {:>8}".format(*heads))
    for problem, samples in ((cheap_problem(), many), (uqfold.problems.folding_wing(), few)):
        x = problem.inputs.sample(rng, samples)
        with tempfile.TemporaryDirectory() as folder:
            model, added, stored = added_seconds(problem, x, turns, Path(folder))
        print(
            f"{problem.name:<12} {model * 1e6:9.3f} us {added * 1e6:9.3f} us {added / model:8.2%} "
            f"{stored * 1e6:11.3f} us {stored / model:8.2%}"
        )
        if problem.name == "cheap":
            kept.append(added * 1e6 < MOST_MICROSECONDS)
        else:
            kept.append(added < MOST_SHARE * model)
    print(
        f"below {MOST_MICROSECONDS:g} us per cheap sample: {'yes' if kept[0] else 'no'}; "
        f"below {MOST_SHARE:.0%} of the wing: {'yes' if kept[1] else 'no'}"
    )
    return 0 if all(kept) else 1


if __name__ == "__main__":
    sys.exit(main())
