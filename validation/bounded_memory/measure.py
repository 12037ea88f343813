"""Peak memory of Monte Carlo runs of a cheap model, with and without a store.

Each run has a process of its own, which reports its peak resident memory at its end.
"""

from __future__ import annotations

import subprocess
import sys
import tempfile
from functools import partial
from pathlib import Path

from uqfold.validation import Finding, Measurement, Table, Work

MEGABYTE = 1e6
MOST = 500.0
"""Peak memory allowed (MB)."""
MOST_GROWTH = 10.0
"""Growth allowed from a tenth of the systems (MB)."""

RUN = """
import resource, sys
from pathlib import Path
import uqfold
from uqfold.evaluation import Evaluator
from uqfold.inputs import normal

systems, seed, store, keeps = int(sys.argv[1]), int(sys.argv[2]), sys.argv[3], sys.argv[4]
kept = []

def model(x):
    y = x[:, 0] + 0.5 * x[:, 1]
    if keeps == "all":
        kept.append((x, y))
    return y

problem = uqfold.Problem(
    model, individual={"a": normal(0.0, 1.0), "b": normal(0.0, 1.0)}, name="cheap", version="1"
)
method = uqfold.methods.MonteCarlo(systems=systems)
evaluator = Evaluator(store=store or None)
result = method.estimate(problem, uqfold.criteria(4.0), rng=seed, evaluator=evaluator)
assert result.n_evals == systems
peak = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
status = Path("/proc/self/status")
if status.exists():
    # on Linux the peak of the process that started this one is inherited by the first number
    [peak] = [int(line.split()[1]) for line in status.read_text().splitlines() if "VmHWM" in line]
print(peak)
"""


def peak_memory(systems: int, *, seed: int, store: bool = False, keeps: str = "nothing") -> float:
    """Peak resident memory (MB) of a Monte Carlo run in a process of its own."""
    with tempfile.TemporaryDirectory() as folder:
        path = str(Path(folder) / "runs.db") if store else ""
        done = subprocess.run(
            [sys.executable, "-c", RUN, str(systems), str(seed), path, keeps],
            capture_output=True,
            text=True,
            check=True,
        )
    unit = 1 if sys.platform == "darwin" else 1024
    return int(done.stdout) * unit / MEGABYTE


def measure(work: Work) -> Measurement:
    """Measure pairs of runs, one with ten times the systems of the other."""
    keeps = "all" if work.fault == "runs kept" else "nothing"
    sizes = {
        False: work.pick(1_000_000, 100_000_000),
        True: work.pick(200_000, 10_000_000),
    }
    runs = [(store, n) for store, many in sizes.items() for n in (many // 10, many)]
    peak = partial(peak_memory, seed=work.seeds[0], keeps=keeps)
    peaks = work.parts({f"{n}, store: {store}": partial(peak, n, store=store) for store, n in runs})
    rows = [
        {"store": store, "systems": n, "peak memory (MB)": value}
        for (store, n), value in zip(runs, peaks.values(), strict=True)
    ]
    findings = []
    for few, many in zip(rows[::2], rows[1::2], strict=True):
        kind = "with a store" if many["store"] else "without a store"
        most = float(many["peak memory (MB)"])
        growth = most - float(few["peak memory (MB)"])
        findings += [
            Finding(f"systems, {kind}", many["systems"]),
            Finding(f"peak memory, {kind}", most, MOST, "MB"),
            Finding(f"growth from a tenth of the systems, {kind}", growth, MOST_GROWTH, "MB"),
        ]
    return Measurement(findings, [Table.of("Peak resident memory", rows)])
