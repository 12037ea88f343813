"""Peak memory of Monte Carlo runs of a cheap model, with and without a store.

Each run is a process of its own (`run.py`), which prints its peak resident memory at its end.
"""

from __future__ import annotations

import subprocess
import sys
import tempfile
from functools import partial
from pathlib import Path

from uqfold.validation import Finding, Measurement, Table, Work

RUN = Path(__file__).with_name("run.py").read_text(encoding="utf-8")
MOST = 500.0
"""Peak memory allowed (MB)."""
MOST_GROWTH = 10.0
"""Growth allowed from a tenth of the systems (MB)."""


def peak_memory(systems: int, *, seed: int, store: bool = False, keeps: str = "nothing") -> float:
    """Return the peak resident memory (MB) of a Monte Carlo run in a process of its own."""
    with tempfile.TemporaryDirectory() as folder:
        path = str(Path(folder) / "runs.db") if store else ""
        words = [str(systems), str(seed), path, keeps]
        done = subprocess.run(
            [sys.executable, "-c", RUN, *words], capture_output=True, text=True, check=True
        )
    return int(done.stdout) / 1e6


def measure(work: Work) -> Measurement:
    """Measure pairs of runs, one with ten times the systems of the other."""
    keeps = "all" if work.fault == "runs kept" else "nothing"
    sizes = {False: work.pick(1_000_000, 100_000_000), True: work.pick(200_000, 10_000_000)}
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
