"""Energy along the motion: nothing appears, nothing is lost unnamed, contacts only dissipate.

For every wing of `parameter_sets.py`, both tangential velocities, and joints without any loss
(C_e = 1, no friction), the work of drive, drag and
gravity is compared with kinetic energy, energy stored in the contacts, and the losses by damping
and friction, at every time step up to the lock.

Friction that is set by the velocity of the geometric contact point, as Eqs. (3) and (4) are
printed, acts against that velocity and not against the sliding of the surfaces, which also turn. So
it may hand back energy for a moment; how much is measured here.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from typing import Any

import numpy as np
import pandas as pd

from uqfold.mechanism import Trajectory, trajectory
from uqfold.validation import Finding, Measurement, Table, Work
from validation.mechanism.parameter_sets import parameter_sets

TOLERANCE = 1e-10
"""Local error per step (m)."""
RESIDUAL = 1e-6
"""Largest residual of the balance, as a share of the drive's work."""
SOME = ("table 6", "table 10 corner -+--+-+")
"""Wings of the quick tier."""
JOINTS: dict[str, dict[str, Any]] = {
    "geometric": {"tangential_velocity": "geometric"},
    "material": {"tangential_velocity": "material"},
    "no losses": {"C_e": 1.0, "C_f": 0.0},
}
"""Kind of joints -> what is changed in a wing."""

FAULTS: dict[str | None, Callable[[Trajectory], Trajectory]] = {
    None: lambda m: m,
    "friction's sign": lambda m: replace(m, friction_loss=-m.friction_loss),
    "damping's sign": lambda m: replace(m, contact_loss=-m.contact_loss),
    "1 % of damping": lambda m: replace(m, contact_loss=0.99 * m.contact_loss),
    "1 % of drag": lambda m: replace(m, work_drag=0.99 * m.work_drag),
    "no elasticity": lambda m: replace(m, elastic_energy=0.0 * m.elastic_energy),
}


def audit(m: Trajectory) -> dict[str, Any]:
    """Residual and losses of one motion; energies in J."""
    friction_steps = np.diff(m.friction_loss, axis=0)
    return {
        "drive's work (J)": m.work_drive[-1],
        "residual (share)": np.abs(m.energy_residual).max() / m.work_drive[-1],
        "lost by damping (J)": m.contact_loss[-1].sum(),
        "smallest loss by damping in a step (J)": np.diff(m.contact_loss, axis=0).min(),
        "lost by friction (J)": m.friction_loss[-1].sum(),
        "smallest loss by friction in a step (J)": friction_steps.min(),
        "handed back by friction in all (J)": -np.minimum(friction_steps, 0.0).sum(),
        "smallest loss by friction so far (J)": m.friction_loss.min(),
    }


def measure(work: Work) -> Measurement:
    """Audit two wings in the quick tier, all of them otherwise."""
    wings = parameter_sets()
    names = SOME if work.tier == "quick" else [one for one in wings if "material" not in one]
    rows = pd.DataFrame(
        {"set": name, "joints": joints}
        | audit(FAULTS[work.fault](trajectory(wings[name].replace(**changed), tolerance=TOLERANCE)))
        for name in names
        for joints, changed in JOINTS.items()
    )
    step = rows["smallest loss by friction in a step (J)"]
    material = step[rows["joints"] == "material"]
    lossy = rows[rows["joints"] != "no losses"]
    losses = lossy[["lost by damping (J)", "lost by friction (J)"]].min(axis=1)
    shares = lossy["handed back by friction in all (J)"] / lossy["lost by friction (J)"]
    damping = lossy["smallest loss by damping in a step (J)"].min()
    so_far = rows["smallest loss by friction so far (J)"].min()
    findings = [
        Finding("motions", len(rows)),
        Finding("largest residual over the drive's work", rows["residual (share)"].max(), RESIDUAL),
        Finding("smallest of the two losses over the drive's work",
                (losses / lossy["drive's work (J)"]).min()),
        Finding("smallest loss by damping in a step", damping, 0.0, "J", at_least=True),
        Finding("smallest loss by friction up to any step", so_far, 0.0, "J", at_least=True),
        Finding("smallest loss by friction in a step, `material`", material.min(), 0.0, "J",
                at_least=True),
        Finding("smallest loss by friction in a step, `geometric`", step.min(), unit="J"),
        Finding("largest share of its loss that friction hands back, `geometric`", shares.max()),
    ]  # fmt: skip
    return Measurement(findings, [Table.of("Energies up to the lock", rows)])
