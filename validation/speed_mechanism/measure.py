"""Deployments per second of processor time against general solvers, at equal accuracy.

All of them integrate the same draws of Table 6 in one run. Every general solver is restarted where
a contact begins or ends and where the drive bends, and gets the fastest of several tolerances with
which it meets the accuracy asked for. Speeds on one core are per second of processor time, so that
other work on the machine hardly matters. What two cores gain is measured by the clock, and means
something on an idle machine only.
"""

from __future__ import annotations

import time
from collections.abc import Callable
from typing import Any

import numpy as np
import pandas as pd

from uqfold.mechanism import DEFAULT_TOLERANCE, WingParameters, deployment_times
from uqfold.mechanism.deployment import deploy_rows
from uqfold.mechanism.record import NO_RECORD
from uqfold.mechanism.wing import Wings
from uqfold.validation import Finding, Measurement, Table, Work
from validation.mechanism.parameter_sets import draws_of_table_6
from validation.speed_mechanism.solvers import Solver

OVER_PYTHON, OVER_COMPILED, OVER_SCALAR = 500.0, 50.0, 1.5
"""Smallest ratios that are judged: half of the aims of 1,000 and 100, two thirds of 2.3."""

PARAMETERS = WingParameters(C_r=0.0015)
LARGEST_MEDIAN, LARGEST_RMS = 2e-5, 5e-5
"""Accuracy asked for (s)."""
DRAWS = 200


def timed(run: Callable[[], np.ndarray], reference: np.ndarray, repeats: int = 1) -> dict[str, Any]:
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
        "draws": len(errors),
        "speed (1/s)": len(times) / seconds,
        "median error (s)": median,
        "root mean square error (s)": rms,
        "accurate": bool(median <= LARGEST_MEDIAN and rms <= LARGEST_RMS),
    }


def peers(*, compiled: bool) -> dict[str, list[Solver]]:
    """Return general solvers by name, each with the settings to choose from."""
    kinds = {False: "Python"} | ({True: "numba"} if compiled else {})
    contenders = {
        f"SciPy {method}, {word} right-hand side": [
            Solver("SciPy", method, kind, rtol, rtol * 1e-2) for rtol in (1e-4, 1e-5)
        ]
        for method in ("LSODA", "DOP853", "RK45")
        for kind, word in kinds.items()
    }
    for method in ("Adams", "BDF") if compiled else ():
        contenders[f"CVODE {method}, numba right-hand side"] = [
            Solver("CVODE", method, True, rtol, atol)
            for rtol, atol in ((1e-5, 1e-7), (1e-5, 1e-8), (1e-6, 1e-7))
        ]
    return contenders


def race(
    name: str,
    settings: list[Solver],
    wings: list[WingParameters],
    reference: np.ndarray,
    tuning: int,
) -> dict[str, Any]:
    """Choose the fastest setting that is accurate over a few draws, and time it over all."""

    def speed(solver: Solver, some: list[WingParameters]) -> dict[str, Any]:
        return timed(lambda: np.array([solver.integrate(wing) for wing in some]), reference)

    settings[0].integrate(wings[0])  # compiles
    tried = [(speed(one, wings[:tuning]), one) for one in settings]
    accurate = [pair for pair in tried if pair[0]["accurate"]]
    # the smallest of the tolerances is accurate, if any is
    _, best = max(accurate or tried[-1:], key=lambda pair: pair[0]["speed (1/s)"])
    name = f"{name} (rtol {best.rtol:.0e}, atol {best.atol:.0e})"
    return {"contender": name} | speed(best, wings)


def ours(draws: dict[str, Any], reference: np.ndarray, copies: int) -> list[dict[str, Any]]:
    """Time scalar form and lanes on one core."""
    wings = Wings(PARAMETERS, draws).table()
    many = {name: np.tile(values, copies) for name, values in draws.items()}

    def scalar() -> np.ndarray:
        times = np.empty(len(wings))
        deploy_rows(wings, DEFAULT_TOLERANCE, times, NO_RECORD)
        return times

    def lanes() -> np.ndarray:
        return deployment_times(PARAMETERS, threads=1, **many)

    scalar()
    lanes()
    return [
        {"contender": "uqfold, scalar form"} | timed(scalar, reference, repeats=5),
        {"contender": "uqfold, lanes on one core"} | timed(lanes, reference, repeats=5),
    ]


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
    """Race SciPy with a Python right-hand side on 4, 20 or 60 draws.

    The full tier adds compiled right-hand sides, and CVODE.
    """
    n_slow, tuning = work.pick((4, 1), (20, 8), (60, 10))
    draws = draws_of_table_6(DRAWS, work.seeds[0])
    reference = deployment_times(PARAMETERS, tolerance=1e-11, **draws)
    wings = [
        PARAMETERS.replace(**{name: float(values[i]) for name, values in draws.items()})
        for i in range(n_slow)
    ]
    raced = [
        race(name, settings, wings, reference, tuning)
        for name, settings in peers(compiled=work.tier == "full").items()
    ]
    rows = pd.DataFrame([*raced, *ours(draws, reference, copies=work.pick(10, 10, 40))])
    two_cores = gain_of_two_cores(draws, work.pick(2_000, 4_000, 40_000))
    lanes = rows.iloc[-2 if work.fault == "scalar form" else -1]
    rows["lanes are faster (times)"] = lanes["speed (1/s)"] / rows["speed (1/s)"]

    def over(kind: str) -> float:
        return rows.loc[rows["contender"].str.contains(kind), "lanes are faster (times)"].min()

    findings = [
        Finding("lanes over SciPy with a Python right-hand side", over("Python"), OVER_PYTHON,
                at_least=True),
        Finding("lanes over the scalar form", over("scalar form"), OVER_SCALAR, at_least=True),
        Finding("median error of the lanes", lanes["median error (s)"], LARGEST_MEDIAN, "s"),
        Finding("root mean square error of the lanes", lanes["root mean square error (s)"],
                LARGEST_RMS, "s"),
        Finding("deployments per second and core", lanes["speed (1/s)"]),
        Finding("two cores over one, by the clock", two_cores,
                remark="means something on an idle machine only"),
    ]  # fmt: skip
    if work.tier == "full":
        what = "lanes over the best general solver with compiled parts"
        findings.append(Finding(what, over("numba"), OVER_COMPILED, at_least=True))
    title = "Deployments per second of processor time on one core, and errors"
    return Measurement(findings, [Table.of(title, rows)])
