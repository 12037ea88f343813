"""The ideal-joint model against SciPy, and how well it follows the model with clearances."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from typing import Any

import numpy as np

from uqfold.mechanism import WingParameters, deployment_times
from uqfold.mechanism.ideal import ideal_deployment_times
from uqfold.validation import Finding, Measurement, Table, Work
from validation.mechanism import ideal_joints
from validation.mechanism.parameter_sets import draws_of_table_6, parameter_sets

AGREEMENT = 1e-8
"""Largest difference (s) at a tight tolerance."""

UNCORRELATED = 1e-3
"""Largest 1 - correlation with the full model: leaves a thousandth of the variance to sample."""

Time = Callable[[WingParameters], float]


def ideal_time(wing: WingParameters) -> float:
    """Deployment time (s) of uqfold's ideal model."""
    return float(ideal_deployment_times(wing, tolerance=1e-11)[0])


def compare(names: Iterable[str], time: Time = ideal_time) -> list[dict[str, Any]]:
    """One row per parameter set: both times and their difference."""
    rows = []
    for name in names:
        wing = parameter_sets()[name]
        ours, theirs = time(wing), ideal_joints.deployment_time(wing)
        row = {"set": name, "uqfold (s)": ours, "scipy (s)": theirs}
        rows.append(row | {"difference (s)": ours - theirs})
    return rows


def follow(draws: int, seed: int, *, mixed_up: bool = False) -> dict[str, float]:
    """Correlation with the model with clearances, and mean and spread of the difference (s)."""
    x = draws_of_table_6(draws, seed)
    full = deployment_times(WingParameters(), tolerance=1e-8, **x)
    if mixed_up:
        x["k_d"] = np.roll(x["k_d"], 1)
    ideal = ideal_deployment_times(WingParameters(), **x)
    return {
        "correlation": float(np.corrcoef(full, ideal)[0, 1]),
        "mean difference (s)": float(np.mean(full - ideal)),
        "standard deviation of the difference (s)": float(np.std(full - ideal, ddof=1)),
    }


def judge(rows: Sequence[dict[str, Any]], partner: dict[str, float]) -> list[Finding]:
    """Compare the largest difference with its limit, and quote how the models go together."""
    difference = max(abs(row["difference (s)"]) for row in rows)
    uncorrelated = 1.0 - partner["correlation"]
    return [
        Finding("parameter sets", len(rows)),
        Finding("largest difference", difference, AGREEMENT, "s"),
        Finding("1 - correlation with the full model", uncorrelated, UNCORRELATED),
        Finding("mean of full minus ideal", partner["mean difference (s)"], unit="s"),
        Finding(
            "its standard deviation", partner["standard deviation of the difference (s)"], unit="s"
        ),
    ]


def _long_offset(wing: WingParameters) -> float:
    return ideal_time(wing.replace(c=wing.c * (1.0 + 1e-6)))


def measure(work: Work) -> Measurement:
    """Compare a sixth of the wings, or all of them, and 500 to 20,000 draws."""
    draws = work.pick(500, 2_000, 20_000)
    # friction does not act where the joints are ideal, so either velocity is the same wing
    names = [name for name in parameter_sets() if "material" not in name]
    time = _long_offset if work.fault == "guide's offset" else ideal_time
    partner = follow(draws, work.seeds[0], mixed_up=work.fault == "mixed up")
    rows = compare(names[:: work.pick(6, 1, 1)], time)
    tables = [
        Table.of("Deployment times with ideal joints", rows),
        Table.of(f"The full model against it, {draws} draws of Table 6", [partner]),
    ]
    return Measurement(judge(rows, partner), tables)
