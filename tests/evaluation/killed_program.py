"""A Monte Carlo run with a store, made to be killed; run in a process of its own.

Arguments: the store's file, a file that takes one byte per finished batch, rows of a batch.
Prints the answer.
"""

import json
import os
import sys
import time
from dataclasses import dataclass, field

import numpy as np

import uqfold
from uqfold.evaluation import Evaluator
from uqfold.methods import MonteCarlo
from uqfold.testing.counting import RowCount
from uqfold.typing import FloatArray

BATCH_SECONDS = 0.06  # more than what is not worth a commit
SYSTEMS = 800


@dataclass(frozen=True)
class Slow:
    """The response of Example 1, taking its time; nothing of it is a parameter."""

    log: str = field(compare=False)
    seconds: float = field(compare=False)
    count: RowCount = field(default_factory=RowCount, compare=False)

    def __call__(self, x: FloatArray) -> FloatArray:
        from uqfold.problems.series_system import series_response

        y = np.asarray(series_response(x))
        if not self.count.add(x):
            return y
        time.sleep(self.seconds)
        with open(self.log, "ab", buffering=0) as log:
            os.write(log.fileno(), b".")
        return y


def estimate(store: str | None, log: str, batch_rows: int, seconds: float) -> dict[str, object]:
    series = uqfold.problems.series()
    problem = uqfold.Problem(
        Slow(log, seconds),
        inputs=series.inputs.distribution,
        names=series.inputs.names,
        shared=series.inputs.shared_names,
        units=series.n_units,
        name="slow series",
        version="1",
    )
    result = MonteCarlo(systems=SYSTEMS).estimate(
        problem,
        uqfold.criteria([-1.0, 2.0], tau=[None, 16.0]),
        rng=5,
        evaluator=Evaluator(store=store, batch_rows=batch_rows),
    )
    return {
        "rows": [[row.pf.hex(), row.std_error.hex(), row.n_evals] for row in result],
        "n_reused": result[0].n_reused,
    }


if __name__ == "__main__":
    print(json.dumps(estimate(sys.argv[1], sys.argv[2], int(sys.argv[3]), BATCH_SECONDS)))
