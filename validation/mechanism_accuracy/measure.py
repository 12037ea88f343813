"""Error of the default tolerance over draws of Table 6, and how chaotic these motions are."""

from __future__ import annotations

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
COARSER = {"coarse": 100.0}
LATER = {"late": 1e-5}
"""Planted faults: a tolerance that is larger, and times (s) that are later."""


def error_row(name: str, found: np.ndarray, expected: np.ndarray) -> dict[str, Any]:
    """Return the errors of one run over all draws."""
    error = found - expected
    size = np.abs(error)
    return {
        "run": name,
        "median (s)": np.median(size),
        "root mean square (s)": np.sqrt(np.mean(error**2)),
        "bias (s)": np.mean(error),
        "standard error of the bias (s)": np.std(error, ddof=1) / np.sqrt(len(error)),
        "largest (s)": size.max(),
        "share above 1e-6 s": np.mean(size > 1e-6),
        "share above 1e-5 s": np.mean(size > 1e-5),
        "change of the standard deviation (s)": found.std() - expected.std(),
    }


def measure(work: Work) -> Measurement:
    """Measure with 400, 1,600 or 20,000 draws."""
    draws, fault = work.pick(400, 20_000), work.fault or ""
    x, wing = draws_of_table_6(draws, work.seeds[0]), WingParameters()
    expected = deployment_times(wing, tolerance=TIGHT, **x)
    rows = []
    for tolerance in TOLERANCES:
        coarse = COARSER.get(fault, 1.0) * tolerance
        found = deployment_times(wing, tolerance=coarse, **x) + LATER.get(fault, 0.0)
        rows.append(error_row(f"tolerance {tolerance:g} m", found, expected))
    x["C_r"] = x["C_r"] * (1.0 + NUDGE)
    found = deployment_times(wing, tolerance=TIGHT, **x)
    rows.append(error_row("nudged clearance", found, expected))

    default, tight, nudged = rows[0], rows[-2], rows[-1]
    bias = abs(default["bias (s)"]) - 2.0 * default["standard error of the bias (s)"]
    findings = [
        Finding("median error", default["median (s)"], MEDIAN, "s"),
        Finding("root mean square error", default["root mean square (s)"], ROOT_MEAN_SQUARE, "s"),
        Finding("size of the mean error, less two standard errors", max(bias, 0.0), BIAS, "s"),
        Finding("largest error", default["largest (s)"], LARGEST, "s"),
        Finding("median error at 1e-10 m", tight["median (s)"], 1e-6, "s"),
        Finding("clearance changed by 1e-6: median change", nudged["median (s)"], unit="s"),
        Finding("share of draws changed by over 1e-6 s", nudged["share above 1e-6 s"]),
        Finding("share of draws changed by over 1e-5 s", nudged["share above 1e-5 s"]),
        Finding("largest change", nudged["largest (s)"], unit="s"),
        Finding("change of the standard deviation of all draws",
                abs(nudged["change of the standard deviation (s)"]), unit="s"),
    ]  # fmt: skip
    title = f"Errors of deployment times over {draws} draws of Table 6"
    return Measurement(findings, [Table.of(title, rows)])
