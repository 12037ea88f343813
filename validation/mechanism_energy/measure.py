"""Energy along the motion: nothing appears, nothing is lost unnamed, contacts only dissipate.

For every wing of `parameter_sets.py` and both tangential velocities, the work of drive, drag and
gravity is compared with kinetic energy, energy stored in the contacts, and the losses by damping
and friction, at every time step up to the lock.

Friction that is set by the velocity of the geometric contact point, as Eqs. (3) and (4) are
printed, acts against that velocity and not against the sliding of the surfaces, which also turn. So
it may hand back energy for a moment; how much is measured here.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from typing import Any

import numpy as np

from uqfold.mechanism import Trajectory, WingParameters, trajectory
from uqfold.validation import Finding, Measurement, Table, Work
from validation.mechanism.parameter_sets import parameter_sets

TOLERANCE = 1e-10
"""Local error per step (m)."""

RESIDUAL = 1e-6
"""Largest residual of the balance, as a share of the drive's work."""

Motion = Callable[[WingParameters], Trajectory]


def motion(wing: WingParameters) -> Trajectory:
    """Move the wing with small steps."""
    return trajectory(wing, tolerance=TOLERANCE)


def audit(wing: WingParameters, move: Motion = motion) -> dict[str, Any]:
    """Residual and losses of one motion; energies in J."""
    m = move(wing)
    friction_steps = np.diff(m.friction_loss, axis=0)
    return {
        "tangential velocity": wing.tangential_velocity,
        "drive's work (J)": float(m.work_drive[-1]),
        "residual (share)": float(np.abs(m.energy_residual).max() / m.work_drive[-1]),
        "lost by damping (J)": float(m.contact_loss[-1].sum()),
        "smallest loss by damping in a step (J)": float(np.diff(m.contact_loss, axis=0).min()),
        "lost by friction (J)": float(m.friction_loss[-1].sum()),
        "smallest loss by friction in a step (J)": float(friction_steps.min()),
        "handed back by friction in all (J)": float(-np.minimum(friction_steps, 0.0).sum()),
        "smallest loss by friction so far (J)": float(m.friction_loss.min()),
    }


def both_velocities(sets: Mapping[str, WingParameters]) -> dict[str, WingParameters]:
    """Every wing with either tangential velocity."""
    return {
        f"{name}, {velocity}": wing.replace(tangential_velocity=velocity)
        for name, wing in sets.items()
        if "material" not in name
        for velocity in ("geometric", "material")
    }


def judge(rows: Sequence[Mapping[str, Any]]) -> list[Finding]:
    """Compare residuals and signs with what they have to be."""

    def column(name: str, velocity: str | None = None) -> list[float]:
        return [row[name] for row in rows if velocity in (None, row["tangential velocity"])]

    step = "smallest loss by friction in a step (J)"
    back = "handed back by friction in all (J)"
    losses = [
        min(row["lost by damping (J)"], row["lost by friction (J)"]) / row["drive's work (J)"]
        for row in rows
    ]
    shares = [row[back] / row["lost by friction (J)"] for row in rows]
    damping = min(column("smallest loss by damping in a step (J)"))
    so_far = min(column("smallest loss by friction so far (J)"))
    return [
        Finding("motions", len(rows)),
        Finding(
            "largest residual over the drive's work", max(column("residual (share)")), RESIDUAL
        ),
        Finding("smallest of the two losses over the drive's work", min(losses)),
        Finding("smallest loss by damping in a step", damping, 0.0, "J", at_least=True),
        Finding("smallest loss by friction up to any step", so_far, 0.0, "J", at_least=True),
        Finding(
            "smallest loss by friction in a step, `material`",
            min(column(step, "material")),
            0.0,
            "J",
            at_least=True,
        ),
        Finding("smallest loss by friction in a step, `geometric`", min(column(step)), unit="J"),
        Finding("largest share of its loss that friction hands back, `geometric`", max(shares)),
    ]


FAULTS: dict[str, Callable[[Trajectory], Trajectory]] = {
    "friction's sign": lambda m: replace(m, friction_loss=-m.friction_loss),
    "damping's sign": lambda m: replace(m, contact_loss=-m.contact_loss),
    "1 % of damping": lambda m: replace(m, contact_loss=0.99 * m.contact_loss),
    "1 % of drag": lambda m: replace(m, work_drag=0.99 * m.work_drag),
    "no elasticity": lambda m: replace(m, elastic_energy=0.0 * m.elastic_energy),
}

SOME = ("table 6", "table 10 corner -+--+-+")


def measure(work: Work) -> Measurement:
    """Audit two wings in the quick tier, all of them otherwise."""
    wings = parameter_sets()
    if work.tier == "quick":
        wings = {name: wings[name] for name in SOME}
    fault = FAULTS.get(work.fault or "", lambda m: m)
    rows = [
        {"set": name} | audit(wing, lambda wing: fault(motion(wing)))
        for name, wing in both_velocities(wings).items()
    ]
    return Measurement(judge(rows), [Table.of("Energies up to the lock", rows)])
