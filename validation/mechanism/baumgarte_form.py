"""The paper's own form of the equations against the compiled one, whatever alpha and beta.

Nine coordinates and Lagrange multipliers, Eqs. (17) to (20), share no equation and no time step
with the five coordinates that `deployment_times` uses.

    python validation/mechanism/baumgarte_form.py
"""

from __future__ import annotations

import sys
from collections.abc import Callable, Sequence
from typing import Any

from against_exudyn import SETS, uqfold_time
from against_scipy import AGREEMENT
from claims import HERE, Claim, Finding, report, write_rows
from parameter_sets import parameter_sets

from uqfold.mechanism import WingParameters
from uqfold.mechanism.baumgarte import BaumgarteTrajectory, baumgarte_trajectory

COEFFICIENTS = ((0.0, 0.0), (5.0, 5.0), (50.0, 50.0), (500.0, 500.0), (20.0, 200.0))
"""alpha and beta (1/s)."""

DRIFT = 1e-9
"""Largest violation of a constraint (m, rad)."""

CLAIM = Claim(
    name="baumgarte_form",
    statement="The index-3 equations in Baumgarte's form give the times of the reduced form, "
    "whatever alpha and beta, and their constraints do not drift apart.",
    compared_with="Eqs. (17) to (20) in nine coordinates, Dormand-Prince 5(4)",
    tolerance="2e-6 s, as for SciPy; drift 1e-9 m, far below any penetration",
    command="python validation/mechanism/baumgarte_form.py",
)

Motion = Callable[[WingParameters, float, float], BaumgarteTrajectory]


def motion(wing: WingParameters, alpha: float, beta: float) -> BaumgarteTrajectory:
    """Move the wing in the paper's form."""
    return baumgarte_trajectory(wing, alpha=alpha, beta=beta, tolerance=1e-11)


def compare(
    names: Sequence[str] = SETS,
    time: Callable[[WingParameters], float] = uqfold_time,
    move: Motion = motion,
) -> list[dict[str, Any]]:
    """One row per parameter set and pair of coefficients."""
    rows = []
    for name in names:
        wing = parameter_sets()[name]
        reduced = time(wing)
        for alpha, beta in COEFFICIENTS:
            m = move(wing, alpha, beta)
            rows.append(
                {
                    "set": name,
                    "alpha (1/s)": alpha,
                    "beta (1/s)": beta,
                    "reduced form (s)": reduced,
                    "Baumgarte's form (s)": m.deployment_time,
                    "difference (s)": m.deployment_time - reduced,
                    "position drift (m)": float(m.position_drift.max()),
                    "velocity drift (m/s)": float(m.velocity_drift.max()),
                }
            )
    return rows


def judge(rows: Sequence[dict[str, Any]]) -> list[Finding]:
    """Compare times and drift with their limits."""
    times: dict[str, list[float]] = {}
    for row in rows:
        times.setdefault(row["set"], []).append(row["Baumgarte's form (s)"])
    by_coefficients = max(max(found) - min(found) for found in times.values())
    return [
        Finding("motions", len(rows)),
        Finding(
            "largest difference",
            max(abs(row["difference (s)"]) for row in rows),
            AGREEMENT,
            "s",
        ),
        Finding("largest change by alpha and beta", by_coefficients, AGREEMENT, "s"),
        Finding("largest position drift", max(r["position drift (m)"] for r in rows), DRIFT, "m"),
        Finding("largest velocity drift", max(r["velocity drift (m/s)"] for r in rows), unit="m/s"),
    ]


def main() -> int:
    """Run the case."""
    rows = compare()
    write_rows(HERE / "baumgarte_form.csv", rows)
    return report(CLAIM, judge(rows))


if __name__ == "__main__":
    sys.exit(main())
