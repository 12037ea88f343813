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
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

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


@dataclass(frozen=True)
class Result:
    """Speed of one contender and its errors (s) over the draws it was given."""

    name: str
    per_second: float
    errors: np.ndarray

    @property
    def median(self) -> float:
        """Median size of the errors (s); NaN if a run failed."""
        return float(np.median(np.abs(self.errors)))

    @property
    def rms(self) -> float:
        """Root mean square of the errors (s); NaN if a run failed."""
        return float(np.sqrt(np.mean(self.errors**2)))

    @property
    def accurate(self) -> bool:
        """Whether the errors are as small as asked for."""
        return self.median <= LARGEST_MEDIAN and self.rms <= LARGEST_RMS


def timed(
    name: str, run: Callable[[], np.ndarray], reference: np.ndarray, repeats: int = 1
) -> Result:
    """Run a contender; the fastest of the repeats counts, by processor time."""
    seconds = np.inf
    for _ in range(repeats):
        start = time.process_time()
        times = run()
        seconds = min(seconds, time.process_time() - start)
    return Result(name, len(times) / seconds, times[: len(reference)] - reference[: len(times)])


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
) -> Result:
    """Choose the fastest setting that is accurate over a few draws, and time it over all."""

    def runner(solver: Solver, some: list[WingParameters]) -> Callable[[], np.ndarray]:
        return lambda: np.array([solver.integrate(wing) for wing in some])

    settings[0].integrate(wings[0])  # compiles
    tried = [(timed(name, runner(one, wings[:tuning]), reference), one) for one in settings]
    accurate = [pair for pair in tried if pair[0].accurate]
    # the smallest of the tolerances is accurate, if any is
    _, best = max(accurate or tried[-1:], key=lambda pair: pair[0].per_second)
    result = timed(name, runner(best, wings), reference)
    return replace(result, name=f"{name} (rtol {best.rtol:.0e}, atol {best.atol:.0e})")


def ours(draws: dict[str, Any], reference: np.ndarray, copies: int) -> tuple[Result, Result]:
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
    return (
        timed("uqfold, scalar form", scalar, reference, repeats=5),
        timed("uqfold, lanes on one core", lanes, reference, repeats=5),
    )


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
    scalar, lanes = ours(draws, reference, copies=work.pick(10, 10, 40))
    if work.fault == "scalar form":
        lanes = scalar
    two_cores = gain_of_two_cores(draws, work.pick(2_000, 4_000, 40_000))

    def over(results: list[Result]) -> float:
        return lanes.per_second / max(result.per_second for result in results)

    python = [result for result in raced if "Python" in result.name]
    compiled = [result for result in raced if "numba" in result.name]
    findings = [
        Finding("lanes over SciPy with a Python right-hand side", over(python), OVER_PYTHON,
                at_least=True),
        Finding("lanes over the scalar form", over([scalar]), OVER_SCALAR, at_least=True),
        Finding("median error of the lanes", lanes.median, LARGEST_MEDIAN, "s"),
        Finding("root mean square error of the lanes", lanes.rms, LARGEST_RMS, "s"),
        Finding("deployments per second and core", lanes.per_second),
        Finding("two cores over one, by the clock", two_cores,
                remark="means something on an idle machine only"),
    ]  # fmt: skip
    if compiled:
        what = "lanes over the best general solver with compiled parts"
        findings.append(Finding(what, over(compiled), OVER_COMPILED, at_least=True))
    rows = [
        {
            "contender": result.name,
            "draws": len(result.errors),
            "speed (1/s)": result.per_second,
            "lanes are faster (times)": lanes.per_second / result.per_second,
            "median error (s)": result.median,
            "root mean square error (s)": result.rms,
            "accurate": result.accurate,
        }
        for result in (*raced, scalar, lanes)
    ]
    title = "Deployments per second of processor time on one core, and errors"
    return Measurement(findings, [Table.of(title, rows)])
