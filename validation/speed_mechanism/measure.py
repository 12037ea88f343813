"""Deployments per second of processor time against general solvers, at equal accuracy.

All of them integrate the same draws of Table 6 in one run. Every general solver is restarted where
a contact begins or ends and where the drive bends, and has tolerances with which it just meets the
accuracy asked for. Speeds on one core are per second of processor time, so that other work on the
machine hardly matters. What two cores gain is measured by the clock, and means something on an idle
machine only.
"""

from __future__ import annotations

import time
from collections.abc import Callable
from functools import partial
from typing import Any

import numpy as np
import pandas as pd

from uqfold.mechanism import DEFAULT_TOLERANCE, WingParameters, deployment_times
from uqfold.mechanism.deployment import deploy_rows
from uqfold.mechanism.record import NO_RECORD
from uqfold.mechanism.wing import Wings
from uqfold.validation import Finding, Measurement, Table, Work
from validation.mechanism.parameter_sets import draws_of_table_6
from validation.speed_mechanism.solvers import cvode_time, scipy_time

OVER_PYTHON, OVER_COMPILED, OVER_SCALAR = 500.0, 50.0, 1.5
"""Smallest ratios that are judged: half of the aims of 1,000 and 100, two thirds of 2.3."""
PARAMETERS = WingParameters(C_r=0.0015)
LARGEST_MEDIAN, LARGEST_RMS = 2e-5, 5e-5
"""Accuracy asked for (s)."""
DRAWS = 200

PYTHON = {f"SciPy {one}": partial(scipy_time, method=one) for one in ("LSODA", "DOP853", "RK45")}
COMPILED = {f"CVODE {one}": partial(cvode_time, method=one) for one in ("Adams", "BDF")}
"""General solvers, with Python right-hand sides and with compiled ones."""


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


def gain_of_two_cores(draws: dict[str, Any], n: int) -> float:
    """Return the speed on two cores over that on one, by the clock, in turns, best of three."""
    many = {name: np.resize(values, n) for name, values in draws.items()}
    seconds: dict[int, list[float]] = {1: [], 2: []}
    for _ in range(3):
        for threads, measured in seconds.items():
            start = time.perf_counter()
            deployment_times(PARAMETERS, threads=threads, **many)
            measured.append(time.perf_counter() - start)
    return min(seconds[1]) / min(seconds[2])


def measure(work: Work) -> Measurement:
    """Race SciPy with a Python right-hand side on 4, 20 or 60 draws, in the full tier CVODE too."""
    draws = draws_of_table_6(DRAWS, work.seeds[0])
    reference = deployment_times(PARAMETERS, tolerance=1e-11, **draws)
    table = Wings(PARAMETERS, draws).table()
    few = [
        PARAMETERS.replace(**{name: float(values[i]) for name, values in draws.items()})
        for i in range(work.pick(4, 60))
    ]
    many = {name: np.tile(values, work.pick(10, 40)) for name, values in draws.items()}

    def general(deploy: Callable[[WingParameters], float]) -> np.ndarray:
        return np.array([deploy(wing) for wing in few])

    def scalar() -> np.ndarray:
        times = np.empty(len(table))
        deploy_rows(table, DEFAULT_TOLERANCE, times, NO_RECORD)
        return times

    def lanes() -> np.ndarray:
        return deployment_times(PARAMETERS, threads=1, **many)

    rows = []
    for name, deploy in (PYTHON | COMPILED if work.tier == "full" else PYTHON).items():
        deploy(few[0])  # compiles
        rows.append(timed(name, partial(general, deploy), reference))
    scalar()
    lanes()
    rows.append(timed("uqfold, scalar form", scalar, reference, repeats=5))
    if work.fault != "scalar form":
        rows.append(timed("uqfold, lanes on one core", lanes, reference, repeats=5))
    speeds = pd.DataFrame(rows).set_index("contender")
    own = speeds.iloc[-1]
    over = own["speed (1/s)"] / speeds["speed (1/s)"]
    speeds["lanes are faster (times)"] = over
    findings = [
        Finding("lanes over SciPy with a Python right-hand side", over[[*PYTHON]].min(),
                OVER_PYTHON, at_least=True),
        Finding("lanes over the scalar form", over["uqfold, scalar form"], OVER_SCALAR,
                at_least=True),
        Finding("median error of the lanes", own["median error (s)"], LARGEST_MEDIAN, "s"),
        Finding("root mean square error of the lanes", own["root mean square error (s)"],
                LARGEST_RMS, "s"),
        Finding("deployments per second and core", own["speed (1/s)"]),
        Finding("two cores over one, by the clock",
                gain_of_two_cores(draws, work.pick(2_000, 40_000)),
                remark="means something on an idle machine only"),
    ]  # fmt: skip
    if work.tier == "full":
        what = "lanes over the best general solver with compiled parts"
        findings.append(Finding(what, over[[*COMPILED]].min(), OVER_COMPILED, at_least=True))
    title = "Deployments per second of processor time on one core, and errors"
    return Measurement(findings, [Table.of(title, speeds.reset_index())])
