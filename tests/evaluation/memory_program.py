"""One Monte Carlo run of a cheap model; prints the peak resident memory of its process (bytes).

Its words: number of systems, and the path of a store (may be empty).
"""

import resource
import sys
from pathlib import Path

import uqfold
from uqfold.inputs import normal
from uqfold.typing import FloatArray


def model(x: FloatArray) -> FloatArray:
    """Return a sum of two normal variables."""
    y: FloatArray = x[:, 0] + 0.5 * x[:, 1]
    return y


if __name__ == "__main__":
    systems, store = int(sys.argv[1]), sys.argv[2]
    inputs = {"a": normal(0.0, 1.0), "b": normal(0.0, 1.0)}
    problem = uqfold.Problem(model, individual=inputs, name="cheap", version="1")
    method = uqfold.methods.MonteCarlo(systems=systems)
    evaluator = uqfold.Evaluator(store=store or None)
    result = method.estimate(problem, uqfold.criteria(4.0), rng=1, evaluator=evaluator)
    assert result.n_evals == systems
    status = Path("/proc/self/status")
    if status.exists():
        # on Linux the other number begins with the peak of the process that started this one
        [line] = [one for one in status.read_text().splitlines() if one.startswith("VmHWM")]
        print(1024 * int(line.split()[1]))
    else:
        peak = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
        print(peak if sys.platform == "darwin" else 1024 * peak)
