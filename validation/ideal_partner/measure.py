"""The ideal-joint model against SciPy, and how well it follows the model with clearances."""

from __future__ import annotations

import numpy as np
import pandas as pd

from uqfold.mechanism import WingParameters, deployment_times
from uqfold.mechanism.ideal import ideal_deployment_times
from uqfold.validation import Finding, Measurement, Table, Work
from validation.mechanism import ideal_joints
from validation.mechanism.parameter_sets import draws_of_table_6, parameter_sets

AGREEMENT = 1e-8
"""Largest difference (s) at a tight tolerance."""
UNCORRELATED = 1e-3
"""Largest 1 - correlation with the full model: leaves a thousandth of the variance to sample."""


def measure(work: Work) -> Measurement:
    """Compare a sixth of the wings, or all of them, and 500 to 20,000 draws."""
    # friction does not act where the joints are ideal, so either velocity is the same wing
    names = [name for name in parameter_sets() if "material" not in name]
    longer = 1.0 + 1e-6 if work.fault == "guide's offset" else 1.0
    found = []
    for name in names[:: work.pick(6, 1)]:
        wing = parameter_sets()[name]
        moved = wing.replace(c=longer * wing.c)
        ours = float(ideal_deployment_times(moved, tolerance=1e-11)[0])
        found.append(
            {"set": name, "uqfold (s)": ours, "scipy (s)": ideal_joints.deployment_time(wing)}
        )
    rows = pd.DataFrame(found)
    rows["difference (s)"] = rows["uqfold (s)"] - rows["scipy (s)"]

    draws = work.pick(500, 20_000)
    x = draws_of_table_6(draws, work.seeds[0])
    full = deployment_times(WingParameters(), tolerance=1e-8, **x)
    if work.fault == "mixed up":
        x["k_d"] = np.roll(x["k_d"], 1)
    ideal = ideal_deployment_times(WingParameters(), **x)
    correlation = float(np.corrcoef(full, ideal)[0, 1])
    mean, deviation = np.mean(full - ideal), np.std(full - ideal, ddof=1)
    partner = {
        "correlation": correlation,
        "mean difference (s)": mean,
        "standard deviation of the difference (s)": deviation,
    }
    findings = [
        Finding("parameter sets", len(rows)),
        Finding("largest difference", rows["difference (s)"].abs().max(), AGREEMENT, "s"),
        Finding("1 - correlation with the full model", 1.0 - correlation, UNCORRELATED),
        Finding("mean of full minus ideal", mean, unit="s"),
        Finding("its standard deviation", deviation, unit="s"),
    ]
    tables = [
        Table.of("Deployment times with ideal joints", rows),
        Table.of(f"The full model against it, {draws} draws of Table 6", [partner]),
    ]
    return Measurement(findings, tables)
