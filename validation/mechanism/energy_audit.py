"""Energy along the motion: nothing appears, nothing is lost unnamed, contacts only dissipate.

For every wing of `parameter_sets.py` and both tangential velocities, the work of drive, drag and
gravity is compared with kinetic energy, energy stored in the contacts, and the losses by damping
and friction, at every time step up to the lock.

Friction that is set by the velocity of the geometric contact point, as Eqs. (3) and (4) are
printed, acts against that velocity and not against the sliding of the surfaces, which also turn. So
it may hand back energy for a moment; how much is measured here.

    python validation/mechanism/energy_audit.py
"""

from __future__ import annotations

import sys
from collections.abc import Callable, Mapping, Sequence
from typing import Any

import numpy as np
from claims import HERE, Claim, Finding, report, write_rows
from parameter_sets import parameter_sets

from uqfold.mechanism import Trajectory, WingParameters, trajectory

TOLERANCE = 1e-10
"""Local error per step (m)."""

RESIDUAL = 1e-6
"""Largest residual of the balance, as a share of the drive's work."""

CLAIM = Claim(
    name="energy_audit",
    statement="The work of drive, drag and gravity is kinetic and elastic energy plus the losses "
    "in the joints, and no joint ever gives out more than it took in.",
    compared_with="balance of energies along the motion",
    tolerance="residual 1e-6 of the drive's work, above the error of the steps and the sums (1e-7) "
    "and far below either loss (2e-3); losses not negative, without allowance",
    command="python validation/mechanism/energy_audit.py",
)

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


def main() -> int:
    """Run the case."""
    rows = [{"set": name} | audit(wing) for name, wing in both_velocities(parameter_sets()).items()]
    write_rows(HERE / "energy_audit.csv", rows)
    return report(CLAIM, judge(rows))


if __name__ == "__main__":
    sys.exit(main())
