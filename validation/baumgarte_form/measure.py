"""The paper's own form of the equations against the compiled one, whatever alpha and beta.

Nine coordinates and Lagrange multipliers, Eqs. (17) to (20), share no equation and no time step
with the five coordinates that `deployment_times` uses.
"""

from __future__ import annotations

import numpy as np
import pandas as pd

from uqfold.validation import Finding, Measurement, Table, Work
from validation.against_exudyn.measure import SETS, uqfold_time
from validation.against_scipy.measure import AGREEMENT
from validation.mechanism.baumgarte import Multibody
from validation.mechanism.independent import follow
from validation.mechanism.parameter_sets import parameter_sets

COEFFICIENTS = ((0.0, 0.0), (5.0, 5.0), (50.0, 50.0), (500.0, 500.0), (20.0, 200.0))
"""alpha and beta (1/s)."""
DRIFT = 1e-9
"""Largest violation of a constraint (m, rad)."""


def measure(work: Work) -> Measurement:
    """Compare the means of Table 6, three sets or all of them, with three pairs or all."""
    names = work.pick(("table 6",), SETS)
    found = []
    for name in names:
        wing = parameter_sets()[name]
        reduced = uqfold_time(wing, work.fault)
        for alpha, beta in COEFFICIENTS[:: work.pick(2, 1)]:
            multibody = Multibody(wing, alpha, beta)
            _, states, locked = follow(multibody)
            drift = [np.abs(multibody.constraints(state)).max(axis=1) for state in states]
            position, velocity = np.max(drift, axis=0)
            found.append(
                {
                    "set": name,
                    "alpha (1/s)": alpha,
                    "beta (1/s)": beta,
                    "reduced form (s)": reduced,
                    "Baumgarte's form (s)": locked,
                    "difference (s)": locked - reduced,
                    "position drift (m)": position + 1e-8 if work.fault == "drift" else position,
                    "velocity drift (m/s)": velocity,
                }
            )
    rows = pd.DataFrame(found)
    times = rows.groupby("set")["Baumgarte's form (s)"]
    by_coefficients = (times.max() - times.min()).max()
    findings = [
        Finding("motions", len(rows)),
        Finding("largest difference", rows["difference (s)"].abs().max(), AGREEMENT, "s"),
        Finding("largest change by alpha and beta", by_coefficients, AGREEMENT, "s"),
        Finding("largest position drift", rows["position drift (m)"].max(), DRIFT, "m"),
        Finding("largest velocity drift", rows["velocity drift (m/s)"].max(), unit="m/s"),
    ]
    title = "Deployment times of both forms, and drift of the constraints"
    return Measurement(findings, [Table.of(title, rows)])
