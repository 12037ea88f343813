"""Deployments per second of processor time against general solvers, at equal accuracy.

All of them integrate draws of Table 6 in one run. SciPy's solvers integrate the equations of
`independent.py`; each is restarted where a contact begins or ends and where the drive bends, and
has tolerances with which it just meets the accuracy asked for. Speeds on one core are per second of
processor time, so that other work on the machine hardly matters.
"""

from __future__ import annotations

import math
import time
from collections.abc import Callable
from functools import partial
from typing import Any

import numpy as np
import pandas as pd

from uqfold.mechanism import DEFAULT_TOLERANCE, WingParameters, deployment_times
from uqfold.validation import Finding, Measurement, Table, Work
from validation.mechanism import independent
from validation.mechanism.parameter_sets import draws_of_table_6

FASTER = 500.0
"""Smallest ratio that is judged: half of the aim of 1,000."""
WING = WingParameters(C_r=0.0015)
LARGEST_MEDIAN, LARGEST_RMS = 2e-5, 5e-5
"""Accuracy asked for (s)."""
DRAWS, REPEATS = 200, 3
SOLVERS = ("LSODA", "DOP853", "RK45")


def scipy_times(method: str, wings: list[WingParameters]) -> np.ndarray:
    """Return deployment times (s) by SciPy, NaN where it went where no function is defined."""
    how = {"rtol": 1e-4, "atol": 1e-6, "max_step": math.inf, "method": method}

    def deploy(wing: WingParameters) -> float:
        try:
            return independent.deployment_time(wing, **how)
        except (OverflowError, ValueError):
            return math.nan

    # a trial step that is rejected may overflow
    with np.errstate(invalid="ignore", over="ignore"):
        return np.array([deploy(wing) for wing in wings])


def timed(
    name: str, run: Callable[[], np.ndarray], reference: np.ndarray, repeats: int = 1
) -> dict[str, Any]:
    """Run a contender; return its speed, the fastest of the repeats, and its errors.

    The errors are NaN if a run failed.
    """
    seconds = np.inf
    for _ in range(repeats):
        start = time.process_time()
        times = run()
        seconds = min(seconds, time.process_time() - start)
    errors = times[: len(reference)] - reference[: len(times)]
    median, rms = np.median(np.abs(errors)), np.sqrt(np.mean(errors**2))
    return {
        "contender": name,
        "draws": len(errors),
        "speed (1/s)": len(times) / seconds,
        "median error (s)": median,
        "root mean square error (s)": rms,
        "accurate": bool(median <= LARGEST_MEDIAN and rms <= LARGEST_RMS),
    }


def measure(work: Work) -> Measurement:
    """Race SciPy on 4 or 60 draws."""
    draws = draws_of_table_6(DRAWS, work.seeds[0])
    reference = deployment_times(WING, tolerance=1e-11, **draws)
    few = [
        WING.replace(**{name: float(values[i]) for name, values in draws.items()})
        for i in range(work.pick(4, 60))
    ]
    many = {name: np.tile(values, work.pick(10, 40)) for name, values in draws.items()}
    tolerance = 1e-11 if work.fault == "tight" else DEFAULT_TOLERANCE
    ours = partial(deployment_times, WING, tolerance=tolerance, threads=1, **many)
    ours()  # compiles
    rows = [
        *(timed(f"SciPy {one}", partial(scipy_times, one, few), reference) for one in SOLVERS),
        timed("uqfold on one core", ours, reference, REPEATS),
    ]
    speeds = pd.DataFrame(rows)
    own = speeds.iloc[-1]
    speeds["uqfold is faster (times)"] = own["speed (1/s)"] / speeds["speed (1/s)"]
    findings = [
        Finding("uqfold over the fastest solver of SciPy",
                speeds["uqfold is faster (times)"].iloc[:-1].min(), FASTER, at_least=True),
        Finding("its median error", own["median error (s)"], LARGEST_MEDIAN, "s"),
        Finding("its root mean square error", own["root mean square error (s)"], LARGEST_RMS, "s"),
        Finding("deployments per second and core", own["speed (1/s)"]),
    ]  # fmt: skip
    title = "Deployments per second of processor time on one core, and errors"
    return Measurement(findings, [Table.of(title, speeds)])
