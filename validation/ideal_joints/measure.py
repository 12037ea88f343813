"""The wing with ideal joints: its model against SciPy, as the limit of the one with clearances.

With the clearance going to zero and ever stiffer joints the wing becomes the one with ideal joints,
which has one degree of freedom. At the stiffness of Table 1 a joint yields by some 0.03 mm under
the drive, which alone is worth microseconds, so stiffer ones are taken. Friction by the material
velocity is left out: its limit is a joint with friction.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from uqfold.mechanism import WingParameters, deployment_times
from uqfold.mechanism.ideal import ideal_deployment_times
from uqfold.validation import Finding, Measurement, Table, Work
from validation.mechanism import ideal_joints
from validation.mechanism.parameter_sets import draws_of_table_6, parameter_sets

CLEARANCES = (1e-3, 1e-4, 1e-5, 1e-6)
"""Clearances on the way to the limit (m)."""
STIFFER = 1000.0
"""Factor on Young's moduli in that limit."""
LIMIT_SETS = ("table 6", "table 10", "table 6 corner +--++", "table 8 condition 3")
AGREEMENT, TO_IDEAL = 1e-8, 2e-6
"""Largest differences (s): from SciPy, and of the wing with the smallest clearance."""
UNCORRELATED = 1e-3
"""Largest 1 - correlation with the full model: leaves a thousandth of the variance to sample."""


def against_scipy(fault: str | None, every: int) -> list[dict[str, Any]]:
    """Compare both solutions of the ideal wing."""
    longer = 1.0 + 1e-6 if fault == "guide's offset" else 1.0
    # friction does not act where the joints are ideal, so either velocity is the same wing
    wings = {name: wing for name, wing in parameter_sets().items() if "material" not in name}
    rows = []
    for name in [*wings][::every]:
        moved = wings[name].replace(c=longer * wings[name].c)
        ours = float(ideal_deployment_times(moved, tolerance=1e-11)[0])
        other = ideal_joints.deployment_time(wings[name])
        rows.append({"set": name, "uqfold (s)": ours, "scipy (s)": other, "gap (s)": ours - other})
    return rows


def small_clearances(fault: str | None) -> list[dict[str, Any]]:
    """Compare the stiff wing with ever smaller clearances with the ideal one."""
    wider = 1e-4 if fault == "clearance" else 0.0
    rows = []
    for name in LIMIT_SETS:
        wing = parameter_sets()[name]
        stiff = wing.replace(E_1=STIFFER * wing.E_1, E_2=STIFFER * wing.E_2)
        ideal = ideal_joints.deployment_time(wing)
        clearances = [C_r + wider for C_r in CLEARANCES]
        times = deployment_times(stiff, C_r=clearances, tolerance=1e-10)
        rows += [
            {"set": name, "clearance (m)": C_r, "gap (s)": float(time) - ideal}
            for C_r, time in zip(CLEARANCES, times, strict=True)
        ]
    return rows


def partner(fault: str | None, draws: int, seed: int) -> dict[str, float]:
    """Return how the ideal wing follows the full one over draws of Table 6."""
    x = draws_of_table_6(draws, seed)
    full = deployment_times(WingParameters(), tolerance=1e-8, **x)
    if fault == "mixed up":
        x["k_d"] = np.roll(x["k_d"], 1)
    gap = full - (ideal := ideal_deployment_times(WingParameters(), **x))
    return {
        "1 - correlation": 1.0 - float(np.corrcoef(full, ideal)[0, 1]),
        "mean of full minus ideal (s)": gap.mean(),
        "its standard deviation (s)": gap.std(ddof=1),
    }


def measure(work: Work) -> Measurement:
    """Compare a sixth of the wings or all of them, four on the way to the limit, and draws."""
    alone = against_scipy(work.fault, work.pick(6, 1))
    limit = small_clearances(work.fault)
    draws = work.pick(500, 20_000)
    follows = partner(work.fault, draws, work.seeds[0])
    closest = [abs(row["gap (s)"]) for row in limit if row["clearance (m)"] == CLEARANCES[-1]]
    findings = [
        Finding("wings", len(alone)),
        Finding("largest difference from SciPy", max(abs(row["gap (s)"]) for row in alone),
                AGREEMENT, "s"),
        Finding(f"time from the ideal wing at C_r = {1e3 * CLEARANCES[-1]:g} mm, stiff",
                max(closest), TO_IDEAL, "s"),
        Finding("1 - correlation with the full model", follows["1 - correlation"], UNCORRELATED),
    ]  # fmt: skip
    tables = [
        Table.of("Deployment times with ideal joints", alone),
        Table.of("Stiff wings with clearances, from the ideal wing", limit),
        Table.of(f"The full model against it, {draws} draws of Table 6", [follows]),
    ]
    return Measurement(findings, tables)
