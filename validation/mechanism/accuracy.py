"""Error of the default tolerance over draws of Table 6, and how chaotic these motions are.

python validation/mechanism/accuracy.py
"""

from __future__ import annotations

import sys
from collections.abc import Callable, Sequence
from typing import Any

import numpy as np
from claims import HERE, Claim, Finding, report, write_rows
from parameter_sets import TABLE_6

from uqfold.mechanism import DEFAULT_TOLERANCE, WingParameters, deployment_times

DRAWS = 1600
TIGHT = 1e-12
"""Local error per step (m) of the reference."""

TOLERANCES = (DEFAULT_TOLERANCE, 1e-7, 1e-8, 1e-9, 1e-10)
NUDGE = 1e-6
"""Relative change of the clearance that shows chaos."""

MEDIAN, ROOT_MEAN_SQUARE, BIAS, LARGEST = 2e-5, 5e-5, 5e-6, 3e-4

CLAIM = Claim(
    name="accuracy",
    statement="At the default tolerance deployment times are as close to converged ones as "
    "estimates of reliability need, without bias.",
    compared_with=f"{DRAWS} draws of Table 6 at a tolerance of 1e-12 m",
    tolerance="median 2e-5 s, root mean square 5e-5 s, bias 5e-6 s, largest 3e-4 s: the times "
    "themselves scatter by 1e-2 s",
    command="python validation/mechanism/accuracy.py",
)

Times = Callable[..., Any]


def measure(draws: int = DRAWS, times: Times = deployment_times) -> list[dict[str, Any]]:
    """One row per tolerance, and one for the clearance nudged at the tight tolerance."""
    rng = np.random.default_rng(8)
    x = {name: rng.normal(mean, sigma, draws) for name, (mean, sigma) in TABLE_6.items()}
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


def main() -> int:
    """Run the case."""
    rows = measure()
    write_rows(HERE / "accuracy.csv", rows)
    return report(CLAIM, judge(rows))


if __name__ == "__main__":
    sys.exit(main())
