"""The paper's own form of the equations against the compiled one, whatever alpha and beta.

Nine coordinates and Lagrange multipliers, Eqs. (17) to (20), share no equation and no time step
with the five coordinates that `deployment_times` uses.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace
from typing import Any

from uqfold.mechanism import WingParameters
from uqfold.validation import Finding, Measurement, Table, Work
from validation.against_exudyn.measure import SETS, uqfold_time
from validation.against_scipy.measure import AGREEMENT
from validation.mechanism.baumgarte import Motion, baumgarte_motion
from validation.mechanism.faulty import late_onset
from validation.mechanism.parameter_sets import parameter_sets

COEFFICIENTS = ((0.0, 0.0), (5.0, 5.0), (50.0, 50.0), (500.0, 500.0), (20.0, 200.0))
"""alpha and beta (1/s)."""

DRIFT = 1e-9
"""Largest violation of a constraint (m, rad)."""

Move = Callable[[WingParameters, float, float], Motion]


def compare(
    names: Sequence[str],
    time: Callable[[WingParameters], float] = uqfold_time,
    move: Move = baumgarte_motion,
    coefficients: Sequence[tuple[float, float]] = COEFFICIENTS,
) -> list[dict[str, Any]]:
    """One row per parameter set and pair of coefficients."""
    rows = []
    for name in names:
        wing = parameter_sets()[name]
        reduced = time(wing)
        for alpha, beta in coefficients:
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


def _late_onset(wing: WingParameters) -> float:
    return uqfold_time(late_onset(wing))


def _drifting(wing: WingParameters, alpha: float, beta: float) -> Motion:
    m = baumgarte_motion(wing, alpha, beta)
    return replace(m, position_drift=m.position_drift + 1e-8)


def measure(work: Work) -> Measurement:
    """Compare the means of Table 6, three sets or all of them, with three pairs or all."""
    names = work.pick(("table 6",), SETS[:3], SETS)
    coefficients = COEFFICIENTS if work.tier == "full" else COEFFICIENTS[::2]
    time = _late_onset if work.fault == "late onset" else uqfold_time
    move = _drifting if work.fault == "drift" else baumgarte_motion
    rows = compare(names, time, move, coefficients)
    table = Table.of("Deployment times of both forms, and drift of the constraints", rows)
    return Measurement(judge(rows), [table])
