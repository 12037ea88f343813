"""The paper's range of T with random lengths, and which choices that it leaves open were tried.

The wing of Table 10 locks in about two thirds of the time of that of Table 6, but the marks that
the text names for both have the ratio 0.82. The study scans initial angle and lock position with
ideal joints; here wings have their clearances, and contact law and tangential velocity vary too.
Nothing else was tried: not the drive's profile, the masses, or the aerodynamic coefficients.
"""

import math
from itertools import product

import numpy as np

from uqfold.comparison.findings import Finding
from uqfold.evidence import Measurement, Table
from uqfold.evidence.work import Work
from uqfold.mechanism import WingParameters, deployment_times
from validation.paper.claims import measure_claims

CLAIMS = ("range of T, onset",)

LAWS = ("lankarani-nikravesh", "hunt-crossley", "flores-2011", "gonthier")
VELOCITIES = ("geometric", "material")
ANGLES = (-5, -3, -2, -1, 0, 1, 2, 5, 10, 20, 30, 40)
"""Initial angles (degrees)."""
LOCKS = tuple(round(0.1 * i, 1) for i in range(3, 28))
"""Lock positions (m)."""
INPUTS = ("V_q", "k_d", "b")
WINGS = {
    "Table 6": {"V_q": 140.0, "k_d": 550.0, "b": 7e-3},
    "Table 10": {"V_q": 200.0, "k_d": 1100.0, "b": 6e-3},
}
"""Means of the random inputs; both have delta = 0 and C_r = 1.5 mm."""


def scanned() -> list[dict[str, object]]:
    """One row per contact law and velocity: times and their ratio over all angles and locks."""
    rows = []
    for law, velocity in product(LAWS, VELOCITIES):
        times = []
        for angle, lock in product(ANGLES, LOCKS):
            try:
                wing = WingParameters(
                    contact_law=law,
                    tangential_velocity=velocity,
                    theta_1_initial=math.radians(angle),
                    x_lock=lock,
                    C_r=1.5e-3,
                )
            except ValueError:
                # no such wing: the slider starts ahead of its lock, or the arms are too short
                continue
            V_q, k_d, b = (np.array([own[name] for own in WINGS.values()]) for name in INPUTS)
            times.append(deployment_times(wing, V_q=V_q, k_d=k_d, b=b))
        found = np.array(times)
        found = found[np.isfinite(found).all(axis=1)]
        ratio = found[:, 1] / found[:, 0]
        studied = (found[:, 0] > 0.50) & (found[:, 0] < 0.57)
        rows.append(
            {
                "contact law": law,
                "tangential velocity": velocity,
                "wings": len(found),
                "smallest ratio": ratio.min(),
                "largest ratio": ratio.max(),
                "longest time of Table 10 where that of Table 6 is 0.50 to 0.57 s (s)": found[
                    studied, 1
                ].max(),
            }
        )
    return rows


def measure(work: Work) -> Measurement:
    """Judge the claim, and scan; the tiers do not differ."""
    judged = measure_claims(work, CLAIMS)
    rows = scanned()
    largest = max(float(row["largest ratio"]) for row in rows)  # type: ignore[arg-type]
    smallest = min(float(row["smallest ratio"]) for row in rows)  # type: ignore[arg-type]
    wings = sum(int(row["wings"]) for row in rows)  # type: ignore[call-overload]
    finding = Finding(
        "largest ratio of the deployment times of Tables 10 and 6, with clearances",
        largest,
        remark=f"over {wings:,} wings: {len(LAWS)} contact laws, both tangential velocities, "
        f"initial angles from {ANGLES[0]} to {ANGLES[-1]} degrees, locks from {LOCKS[0]:g} to "
        f"{LOCKS[-1]:g} m; smallest {smallest:.2g}; nothing else was scanned",
    )
    table = Table.of("scan", "Deployment times over what the text leaves open", rows)
    return Measurement.of([*judged.findings, finding], [*judged.tables, table])
