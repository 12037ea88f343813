"""Error of the default tolerance over draws of Table 6, and how chaotic these motions are."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any

import numpy as np

from uqfold.mechanism import DEFAULT_TOLERANCE, WingParameters, deployment_times
from uqfold.validation import Finding, Measurement, Table, Work
from validation.mechanism.parameter_sets import draws_of_table_6

TIGHT = 1e-12
"""Local error per step (m) of the reference."""

TOLERANCES = (DEFAULT_TOLERANCE, 1e-7, 1e-8, 1e-9, 1e-10)
NUDGE = 1e-6
"""Relative change of the clearance that shows chaos."""

MEDIAN, ROOT_MEAN_SQUARE, BIAS, LARGEST = 2e-5, 5e-5, 5e-6, 3e-4

Times = Callable[..., Any]


def errors(draws: int, seed: int, times: Times) -> list[dict[str, Any]]:
    """One row per tolerance, and one for the clearance nudged at the tight tolerance."""
    x = draws_of_table_6(draws, seed)
    wing = WingParameters()
    expected = deployment_times(wing, tolerance=TIGHT, **x)
    nudged = x | {"C_r": x["C_r"] * (1.0 + NUDGE)}
    runs = [
        (f"tolerance {tolerance:g} m", times(wing, tolerance=tolerance, **x))
        for tolerance in TOLERANCES
    ]
    runs.append(("nudged clearance", deployment_times(wing, tolerance=TIGHT, **nudged)))
    rows = []
    for name, found in runs:
        error = found - expected
        size = np.abs(error)
        rows.append(
            {
                "run": name,
                "median (s)": float(np.median(size)),
                "root mean square (s)": float(np.sqrt(np.mean(error**2))),
                "bias (s)": float(np.mean(error)),
                "standard error of the bias (s)": float(np.std(error, ddof=1) / np.sqrt(draws)),
                "largest (s)": float(size.max()),
                "share above 1e-6 s": float(np.mean(size > 1e-6)),
                "share above 1e-5 s": float(np.mean(size > 1e-5)),
                "change of the standard deviation (s)": float(found.std() - expected.std()),
            }
        )
    return rows


def judge(rows: Sequence[dict[str, Any]]) -> list[Finding]:
    """Compare the errors of the default tolerance with their limits."""
    default, nudged = rows[0], rows[-1]
    tight = rows[-2]
    bias = abs(default["bias (s)"]) - 2.0 * default["standard error of the bias (s)"]
    return [
        Finding("median error", default["median (s)"], MEDIAN, "s"),
        Finding("root mean square error", default["root mean square (s)"], ROOT_MEAN_SQUARE, "s"),
        Finding("size of the mean error, less two standard errors", max(bias, 0.0), BIAS, "s"),
        Finding("largest error", default["largest (s)"], LARGEST, "s"),
        Finding("median error at 1e-10 m", tight["median (s)"], 1e-6, "s"),
        Finding("clearance changed by 1e-6: median change", nudged["median (s)"], unit="s"),
        Finding("share of draws changed by over 1e-6 s", nudged["share above 1e-6 s"]),
        Finding("share of draws changed by over 1e-5 s", nudged["share above 1e-5 s"]),
        Finding("largest change", nudged["largest (s)"], unit="s"),
        Finding(
            "change of the standard deviation of all draws",
            abs(nudged["change of the standard deviation (s)"]),
            unit="s",
        ),
    ]


def _coarse(*arguments: Any, tolerance: float, **x: Any) -> Any:
    return deployment_times(*arguments, tolerance=100.0 * tolerance, **x)


def _late(*arguments: Any, **x: Any) -> Any:
    return deployment_times(*arguments, **x) + 1e-5


TIMES = {None: deployment_times, "coarse": _coarse, "late": _late}


def measure(work: Work) -> Measurement:
    """Measure with 400, 1,600 or 20,000 draws."""
    draws = work.pick(400, 1_600, 20_000)
    rows = errors(draws, work.seeds[0], TIMES[work.fault])
    title = f"Errors of deployment times over {draws} draws of Table 6"
    return Measurement(judge(rows), [Table.of(title, rows)])
