"""Deployments per second of processor time against general solvers, at equal accuracy."""

from __future__ import annotations

from uqfold.mechanism import deployment_times
from uqfold.mechanism.wing import Wings
from uqfold.validation import Finding, Measurement, Table, Work
from validation.benchmarks.mechanism_speed import (
    DRAWS,
    LARGEST_MEDIAN,
    LARGEST_RMS,
    PARAMETERS,
    Result,
    draws_of_table_6,
    measure_ours,
    measure_peer,
    peers,
    two_cores,
)

OVER_PYTHON, OVER_COMPILED, OVER_SCALAR = 500.0, 50.0, 1.5
"""Smallest ratios that are judged: half of the aims of 1,000 and 100, two thirds of 2.3."""


def measure(work: Work) -> Measurement:
    """Race SciPy with a Python right-hand side on 4, 20 or 60 draws.

    The full tier adds compiled right-hand sides, and CVODE.
    """
    n_slow, tuning = work.pick((4, 1), (20, 8), (60, 10))
    draws = draws_of_table_6(DRAWS)
    wings = Wings(PARAMETERS, draws).table()
    reference = deployment_times(PARAMETERS, tolerance=1e-11, **draws)
    chosen = {
        name: settings
        for name, settings in peers().items()
        if work.tier == "full" or name.endswith("Python right-hand side")
    }
    raced = [
        measure_peer(name, settings, wings[:n_slow], reference, tuning)
        for name, settings in chosen.items()
    ]
    scalar, lanes = measure_ours(draws, reference, copies=work.pick(10, 10, 40))
    if work.fault == "scalar form":
        lanes = scalar
    one, two = two_cores(draws, work.pick(2_000, 4_000, 40_000))
    table = Table.of(
        "Deployments per second of processor time on one core, and errors",
        [_row(result, lanes) for result in (*raced, scalar, lanes)],
    )
    python = max(result.per_second for result in raced if "Python" in result.name)
    compiled = [result.per_second for result in raced if "numba" in result.name]
    over_python = lanes.per_second / python
    findings = [
        Finding("lanes over SciPy with a Python right-hand side", over_python, OVER_PYTHON,
                at_least=True),
        Finding("lanes over the scalar form", lanes.per_second / scalar.per_second, OVER_SCALAR,
                at_least=True),
        Finding("median error of the lanes", lanes.median, LARGEST_MEDIAN, "s"),
        Finding("root mean square error of the lanes", lanes.rms, LARGEST_RMS, "s"),
        Finding("deployments per second and core", lanes.per_second),
        Finding("two cores over one, by the clock", two / one,
                remark="means something on an idle machine only"),
    ]  # fmt: skip
    if compiled:
        ratio = lanes.per_second / max(compiled)
        what = "lanes over the best general solver with compiled parts"
        findings.append(Finding(what, ratio, OVER_COMPILED, at_least=True))
    return Measurement(findings, [table])


def _row(result: Result, lanes: Result) -> dict[str, object]:
    return {
        "contender": result.name,
        "draws": len(result.errors),
        "speed (1/s)": result.per_second,
        "lanes are faster (times)": lanes.per_second / result.per_second,
        "median error (s)": result.median,
        "root mean square error (s)": result.rms,
        "accurate": result.is_accurate(),
    }
