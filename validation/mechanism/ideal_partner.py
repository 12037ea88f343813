"""The ideal-joint model against SciPy, and how well it follows the model with clearances.

python validation/mechanism/ideal_partner.py
"""

from __future__ import annotations

import sys
from collections.abc import Callable, Sequence
from typing import Any

import ideal_joints
import numpy as np
from claims import HERE, Claim, Finding, report, write_rows
from parameter_sets import TABLE_6, parameter_sets

from uqfold.mechanism import WingParameters, deployment_times
from uqfold.mechanism.ideal import ideal_deployment_times

DRAWS = 2000
AGREEMENT = 1e-8
"""Largest difference (s) at a tight tolerance."""

CLAIM = Claim(
    name="ideal_partner",
    statement="The one-degree-of-freedom model with ideal joints gives the times of SciPy, and "
    "follows the model with clearances closely enough to serve as its cheap partner.",
    compared_with="SciPy DOP853, rtol 1e-12, on another parametrisation (rod angle, complex "
    "numbers); draws of Table 6 for the correlation",
    tolerance="1e-8 s: smooth equations, so both sides converge far below that",
    command="python validation/mechanism/ideal_partner.py",
)

Time = Callable[[WingParameters], float]


def ideal_time(wing: WingParameters) -> float:
    """Deployment time (s) of uqfold's ideal model."""
    return float(ideal_deployment_times(wing, tolerance=1e-11)[0])


def compare(time: Time = ideal_time) -> list[dict[str, Any]]:
    """One row per parameter set that differs for ideal joints."""
    rows = []
    for name, wing in parameter_sets().items():
        if "material" not in name:
            ours, theirs = time(wing), ideal_joints.deployment_time(wing)
            row = {"set": name, "uqfold (s)": ours, "scipy (s)": theirs}
            rows.append(row | {"difference (s)": ours - theirs})
    return rows


def follow() -> dict[str, float]:
    """Correlation with the model with clearances, and mean and spread of the difference (s)."""
    rng = np.random.default_rng(6)
    draws = {name: rng.normal(mean, sigma, DRAWS) for name, (mean, sigma) in TABLE_6.items()}
    full = deployment_times(WingParameters(), tolerance=1e-8, **draws)
    ideal = ideal_deployment_times(WingParameters(), **draws)
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
        Finding(f"1 - correlation with the full model, {DRAWS} draws of Table 6", uncorrelated),
        Finding("mean of full minus ideal", partner["mean difference (s)"], unit="s"),
        Finding(
            "its standard deviation", partner["standard deviation of the difference (s)"], unit="s"
        ),
    ]


def main() -> int:
    """Run the case."""
    rows = compare()
    write_rows(HERE / "ideal_partner.csv", rows)
    return report(CLAIM, judge(rows, follow()))


if __name__ == "__main__":
    sys.exit(main())
