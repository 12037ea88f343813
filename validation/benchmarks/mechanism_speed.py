"""Deployments per second: general solvers, the scalar form and the lanes, at equal accuracy.

All of them integrate the same draws of Table 6 in one run. Every general solver is restarted where
a contact begins or ends and where the drive bends, and gets the fastest of several tolerances with
which it meets the accuracy asked for. Speeds on one core are per second of processor time, so that
other work on the machine hardly matters. What two cores gain and how long a first call takes are
measured by the clock, and mean something on an idle machine only.

    python -m validation.benchmarks.mechanism_speed            # about four minutes
    python -m validation.benchmarks.mechanism_speed --quick    # about one minute
"""

from __future__ import annotations

import argparse
import os
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from uqfold.mechanism import DEFAULT_TOLERANCE, WingParameters, deployment_times
from uqfold.mechanism.deployment import deploy_rows
from uqfold.mechanism.record import NO_RECORD
from uqfold.mechanism.wing import Wings
from validation.benchmarks.mechanism_peers import Solver

Draws = dict[str, Any]
"""Values per draw by the names that `deployment_times` takes."""

PARAMETERS = WingParameters(C_r=0.0015)
LARGEST_MEDIAN = 2e-5
LARGEST_RMS = 5e-5
DRAWS = 200
SEED = 4711
ALL_DEPLOYMENTS = 2_000_000
"""Sample size of the paper's Monte Carlo, read as model runs (deployments)."""

FIRST_CALL = """
import time; start = time.perf_counter(), time.process_time()
from uqfold.mechanism import WingParameters, deployment_times
deployment_times(WingParameters())
print(time.perf_counter() - start[0], time.process_time() - start[1])
"""


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

    def is_accurate(self) -> bool:
        """Whether the errors are as small as asked for."""
        return self.median <= LARGEST_MEDIAN and self.rms <= LARGEST_RMS


def draws_of_table_6(n: int) -> Draws:
    """Draws of the random inputs of Table 6, in SI units."""
    rng = np.random.default_rng(SEED)
    return {
        "V_q": rng.normal(140, 10, n),
        "delta": np.radians(rng.normal(0, 5, n)),
        "k_d": rng.normal(550, 10, n),
        "b": rng.normal(0.007, 0.00025, n),
        "C_r": rng.normal(0.0015, 0.00005, n),
    }


def measure(
    name: str, run: Callable[[], np.ndarray], reference: np.ndarray, repeats: int = 1
) -> Result:
    """Run a contender; the fastest of the repeats counts, by processor time."""
    seconds = np.inf
    for _ in range(repeats):
        start = time.process_time()
        times = run()
        seconds = min(seconds, time.process_time() - start)
    return Result(name, len(times) / seconds, times[: len(reference)] - reference[: len(times)])


def peers() -> dict[str, list[Solver]]:
    """General solvers by name, each with the settings to choose from."""
    contenders = {}
    for method in ("LSODA", "DOP853", "RK45"):
        for compiled in (False, True):
            name = f"SciPy {method}, {'numba' if compiled else 'Python'} right-hand side"
            contenders[name] = [
                Solver("SciPy", method, compiled, rtol, rtol * 1e-2) for rtol in (1e-4, 1e-5)
            ]
    for method in ("Adams", "BDF"):
        contenders[f"CVODE {method}, numba right-hand side"] = [
            Solver("CVODE", method, True, rtol, atol)
            for rtol, atol in ((1e-5, 1e-7), (1e-5, 1e-8), (1e-6, 1e-7))
        ]
    return contenders


def measure_peer(
    name: str, settings: list[Solver], wings: np.ndarray, reference: np.ndarray, tuning: int
) -> Result:
    """Choose the fastest setting that is accurate over a few draws, and measure it over all."""

    def runner(solver: Solver, some: np.ndarray) -> Callable[[], np.ndarray]:
        return lambda: np.array([solver.integrate(wing) for wing in some])

    settings[0].integrate(wings[0])  # compiles
    tried = [
        (measure(name, runner(solver, wings[:tuning]), reference), solver) for solver in settings
    ]
    accurate = [pair for pair in tried if pair[0].is_accurate()]
    # the smallest of the tolerances is accurate, if any is
    _, best = max(accurate or tried[-1:], key=lambda pair: pair[0].per_second)
    result = measure(name, runner(best, wings), reference)
    return replace(result, name=f"{name} (rtol {best.rtol:.0e}, atol {best.atol:.0e})")


def measure_ours(draws: Draws, reference: np.ndarray, copies: int) -> tuple[Result, Result]:
    """Scalar form and lanes on one core."""
    wings = Wings(PARAMETERS, draws).table()

    def scalar() -> np.ndarray:
        times = np.empty(len(wings))
        deploy_rows(wings, DEFAULT_TOLERANCE, times, NO_RECORD)
        return times

    many: Draws = {name: np.tile(values, copies) for name, values in draws.items()}

    def lanes() -> np.ndarray:
        return deployment_times(PARAMETERS, threads=1, **many)

    scalar()
    lanes()
    return (
        measure("uqfold, scalar form", scalar, reference, repeats=5),
        measure("uqfold, lanes on one core", lanes, reference, repeats=5),
    )


def two_cores(draws: Draws, n: int) -> tuple[float, float]:
    """Deployments per second by the clock on one core and on two, in turns, best of three."""
    many: Draws = {name: np.resize(values, n) for name, values in draws.items()}
    seconds: dict[int, list[float]] = {1: [], 2: []}
    for _ in range(3):
        for threads, measured in seconds.items():
            start = time.perf_counter()
            deployment_times(PARAMETERS, threads=threads, **many)
            measured.append(time.perf_counter() - start)
    return n / min(seconds[1]), n / min(seconds[2])


def first_calls() -> list[tuple[float, float]]:
    """Seconds (clock, processor) of a first call: with an empty cache, then in a later process."""
    seconds = []
    with tempfile.TemporaryDirectory() as cache:
        for _ in range(2):
            run = subprocess.run(
                [sys.executable, "-c", FIRST_CALL],
                env=os.environ | {"NUMBA_CACHE_DIR": cache},
                check=True,
                capture_output=True,
                text=True,
            )
            clock, processor = map(float, run.stdout.split())
            seconds.append((clock, processor))
    return seconds


def verdict(text: str, value: float, limit: float, *, at_least: bool) -> None:
    """Print one aim and whether it is met."""
    met = value >= limit if at_least else value <= limit
    sign = "at least" if at_least else "at most"
    print(f"  {'met    ' if met else 'NOT MET'} {text}: {value:,.4g} ({sign} {limit:,.4g})")


def main() -> None:
    """Measure all contenders and print the table and the aims."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--quick", action="store_true", help="few draws for every contender")
    quick = parser.parse_args().quick
    n_slow, tuning = (8, 4) if quick else (60, 10)
    draws = draws_of_table_6(DRAWS)
    wings = Wings(PARAMETERS, draws).table()
    reference = deployment_times(PARAMETERS, tolerance=1e-11, **draws)

    results = [
        measure_peer(name, settings, wings[:n_slow], reference, tuning)
        for name, settings in peers().items()
    ]
    scalar, lanes = measure_ours(draws, reference, copies=10 if quick else 40)
    print(f"one core, per second of processor time; load of the machine {os.getloadavg()[0]:.1f}")
    print(f"{'contender':62} {'draws':>5} {'1/s':>9} {'lanes are':>10} {'median':>8} {'rms':>8}")
    for result in [*results, scalar, lanes]:
        print(
            f"{result.name:62} {len(result.errors):5} {result.per_second:9.1f} "
            f"{lanes.per_second / result.per_second:9.1f}x {result.median:8.1e} {result.rms:8.1e}"
            f"{'' if result.is_accurate() else '  not accurate'}"
        )
    one, two = two_cores(draws, 4_000 if quick else 40_000)
    print(f"by the clock: {one:.0f} per second on one core, {two:.0f} on two")
    (clock, processor), (later, later_processor) = first_calls()
    print(
        f"processor time of the first call: {processor:.1f} s, in a later process "
        f"{later_processor:.1f} s"
    )

    def fastest(prefix: str, part: str) -> float:
        return max(r.per_second for r in results if r.name.startswith(prefix) and part in r.name)

    print("aims")
    ratio = lanes.per_second / fastest("SciPy", "Python")
    verdict("lanes over SciPy with a Python right-hand side", ratio, 1000, at_least=True)
    ratio = lanes.per_second / max(r.per_second for r in results if "numba" in r.name)
    verdict("lanes over the best general solver with compiled parts", ratio, 100, at_least=True)
    ratio = lanes.per_second / scalar.per_second
    verdict("lanes over the scalar form", ratio, 2.3, at_least=True)
    verdict("deployments per second and core", lanes.per_second, 7800, at_least=True)
    verdict("two cores over one, by the clock", two / one, 1.8, at_least=True)
    minutes = ALL_DEPLOYMENTS / two / 60
    verdict("8 million deployments on two cores (min, by the clock)", minutes, 10, at_least=False)
    verdict("first call with compilation (s, by the clock)", clock, 15, at_least=False)
    verdict("first call of later processes (s, by the clock)", later, 2, at_least=False)
    errors = lanes.errors
    verdict("median error (s)", lanes.median, LARGEST_MEDIAN, at_least=False)
    verdict("root mean square error (s)", lanes.rms, LARGEST_RMS, at_least=False)
    verdict("size of the mean error (s)", abs(float(np.mean(errors))), 5e-6, at_least=False)
    verdict("largest error (s)", float(np.max(np.abs(errors))), 3e-4, at_least=False)


if __name__ == "__main__":
    main()
