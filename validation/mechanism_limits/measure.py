"""Limits in which the answer is known: vanishing clearance, no losses, a single impact.

* With the clearance going to zero and ever stiffer joints the wing becomes the one with ideal
  joints, which has one degree of freedom (`ideal_joints.py`). At the stiffness of Table 1 a joint
  yields by some 0.03 mm under the drive, which alone is worth microseconds. Friction by the
  material velocity is left out: its limit is a joint with friction.
* With C_e = 1 and no friction, kinetic and elastic energy together are the work done.
* While one joint alone is in contact, its forces cannot change the momentum along X of rod and
  slider (joint C), or the angular momentum about A of crank and rod (joint B). With friction the
  second is not quite so: the pair of forces acts at the contact points of Eq. (3), which lie apart
  by the penetration.
* Two free bodies that meet part at e times the speed, h (1 + e) = ln((1 + h) / (1 - h e)) with
  h = 3 (1 - C_e^2) / 4: a first integral of Eq. (5) for any mass and stiffness.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import Any

import numpy as np
import pandas as pd
from scipy.integrate import solve_ivp
from scipy.optimize import brentq

from uqfold.mechanism import Trajectory, WingParameters, deployment_times, trajectory
from uqfold.mechanism.contact import contact_forces
from uqfold.validation import Finding, Measurement, Table, Work
from validation.mechanism import ideal_joints
from validation.mechanism.bodies import Bodies
from validation.mechanism.parameter_sets import parameter_sets

CLEARANCES = (1e-3, 1e-4, 1e-5, 1e-6)
"""Clearances on the way to the limit (m)."""
STIFFER = 1000.0
"""Factor on Young's moduli in that limit."""
IDEAL_SETS = ("table 6", "table 10", "table 6 corner +--++", "table 8 condition 3")
LOSSLESS_SETS = (*IDEAL_SETS, "table 1")
RESTITUTIONS = (0.5, 0.9, 1.0)
TO_IDEAL = 2e-6
ENERGY = 1e-6
MOMENTUM = 1e-6
RETURN = 1e-8

Row = dict[str, Any]


def small_clearances(fault: str | None) -> Iterator[Row]:
    """Deployment time minus that of the ideal wing, for each stiffness, clearance and set."""
    wider = 1e-4 if fault == "clearance" else 0.0
    for name in IDEAL_SETS:
        wing = parameter_sets()[name]
        ideal = ideal_joints.deployment_time(wing)
        for factor in (1.0, STIFFER):
            stiff = wing.replace(E_1=factor * wing.E_1, E_2=factor * wing.E_2)
            for C_r in CLEARANCES:
                time = deployment_times(stiff, C_r=C_r + wider, tolerance=1e-10)[0]
                limit = f"ideal joints, stiffness x {factor:g}, C_r = {C_r:g} m"
                yield {"limit": limit, "case": name, "deviation": float(time) - ideal}


def lossless(fault: str | None) -> Iterator[Row]:
    """Largest change of work minus energy without losses, over the drive's work."""
    C_e = 0.999 if fault == "loss" else 1.0
    for name in LOSSLESS_SETS:
        m = trajectory(parameter_sets()[name].replace(C_e=C_e, C_f=0.0), tolerance=1e-11)
        work = m.work_drive + m.work_drag + m.work_gravity
        energy = m.kinetic_energy + m.elastic_energy.sum(axis=1)
        change = float(np.abs(work - energy).max() / m.work_drive[-1])
        yield {"limit": "no losses", "case": name, "deviation": change}


def single_contacts(m: Trajectory) -> Iterator[tuple[int, slice]]:
    """Contacts during which the other joint stays open: joint, and points from onset to loss."""
    touching = m.penetration > 0.0
    for joint in (0, 1):
        switches = np.diff(touching[:, joint].astype(int))
        for begin in np.flatnonzero(switches == 1).tolist():
            loss = begin + np.flatnonzero(switches[begin:] == -1)[:1] + 1
            if loss.size and not touching[begin : loss[0] + 1, 1 - joint].any():
                yield joint, slice(begin, int(loss[0]) + 1)


def momentum_change(
    p: WingParameters, m: Trajectory, joint: int, points: slice, fault: str | None
) -> float:
    """Change of momentum beyond the impulse from outside, over the impulse of the contact.

    Masses and loads come from `bodies.py`.
    """
    bodies = Bodies(p)
    (m_1, m_2, m_3), (J_1, J_2, _) = bodies.mass, bodies.inertia
    t, q, v = m.time[points], m.coordinates[points], m.velocities[points].copy()
    if fault == "momentum":
        # the rod keeps 0.1 % more of the speed that an impact gave it
        v[:, 1] *= 1.001
    load_1, load_2 = (
        bodies.weight[i] + bodies.drag[i] * np.abs(np.sin(angle))
        for i, angle in enumerate((q[:, 0], q[:, 3]))
    )
    if joint == 1:
        drive = p.k_d * np.clip(np.minimum(100.0 * t, 62.0 - 100.0 * t), 0.0, 1.0)
        load_3 = drive + bodies.weight[2]
        whole, part = m_2 * v[:, 1] + m_3 * v[:, 4], m_3 * v[:, 4]
        outside, on_part = load_2 + load_3, load_3
    else:
        part = (J_1 + m_1 * p.l_1**2 / 4.0) * v[:, 0]
        whole = part + m_2 * (q[:, 1] * v[:, 2] - q[:, 2] * v[:, 1]) + J_2 * v[:, 3]
        on_part = -load_1 * 0.5 * p.l_1 * np.sin(q[:, 0])
        outside = on_part - load_2 * q[:, 2]
    impulse = part[-1] - part[0] - np.trapezoid(on_part, t)
    return float(abs((whole[-1] - whole[0] - np.trapezoid(outside, t)) / impulse))


def momentum(fault: str | None) -> Iterator[Row]:
    """Momentum through the contacts of one joint alone, early in the motion."""
    for C_f in (0.0, 0.1):
        for name in IDEAL_SETS:
            wing = parameter_sets()[name].replace(C_f=C_f, t_max=0.06)
            m = trajectory(wing, tolerance=1e-11)
            for joint, points in single_contacts(m):
                label = f"{name}, joint {'BC'[joint]} at {m.time[points.start]:.5f} s"
                change = momentum_change(wing, m, joint, points, fault)
                yield {"limit": f"momentum, C_f = {C_f:g}", "case": label, "deviation": change}


def returned(C_e: float) -> float:
    """Speed after over speed before an impact of two free bodies, by the kernel of the contact."""
    K, m, speed = 3.5e9, 2.0, 0.4
    damping = 0.75 * (1.0 - C_e**2) / speed

    def rates(_: float, y: np.ndarray) -> list[float]:
        depth = max(float(y[0]), 0.0)
        normal, _t = contact_forces(depth, float(y[1]), 0.0, K, damping, 0.1, 1e-3, 1.0 / 9e-3)
        return [y[1], -normal / m]

    def apart(_: float, y: np.ndarray) -> float:
        return float(y[0])

    apart.terminal, apart.direction = True, -1  # type: ignore[attr-defined]
    run = solve_ivp(
        rates, (0.0, 0.1), [0.0, speed], method="DOP853", rtol=1e-12, atol=1e-16, events=apart,
        max_step=1e-5,
    )  # fmt: skip
    return float(-run.y_events[0][0][1] / speed)


def expected_return(C_e: float) -> float:
    """Return the same ratio from the first integral."""
    h = 0.75 * (1.0 - C_e**2)
    if h == 0.0:
        return 1.0
    return float(brentq(lambda e: h * (1.0 + e) - math.log((1.0 + h) / (1.0 - h * e)), 0.1, 1.0))


def impacts(fault: str | None) -> Iterator[Row]:
    """Difference of the returned speed from the first integral."""
    late = 1.02 if fault == "late onset" else 1.0
    for C_e in RESTITUTIONS:
        expected = expected_return(C_e)
        found = returned(math.sqrt(1.0 - (1.0 - C_e**2) / late))
        label = f"C_e = {C_e:g}, returned {expected:.6f}"
        yield {"limit": "single impact", "case": label, "deviation": found - expected}


def measure(work: Work) -> Measurement:
    """Measure all limits; the tiers do not differ."""
    rows = pd.DataFrame(
        row
        for limit in (small_clearances, lossless, momentum, impacts)
        for row in limit(work.fault)
    )
    largest = rows["deviation"].abs().groupby(rows["limit"]).max()
    stiff, real = (f"ideal joints, stiffness x {factor:g}, C_r" for factor in (STIFFER, 1.0))
    findings = [
        *(Finding(f"time from the ideal wing, C_r = {1e3 * C_r:g} mm, stiff",
                  largest[f"{stiff} = {C_r:g} m"],
                  TO_IDEAL if C_r == CLEARANCES[-1] else None, "s") for C_r in CLEARANCES),
        Finding(f"the same at the stiffness of Table 1, C_r = {1e3 * CLEARANCES[-1]:g} mm",
                largest[f"{real} = {CLEARANCES[-1]:g} m"], unit="s"),
        Finding("energy without losses, over the drive's work", largest["no losses"], ENERGY),
        Finding("contacts of one joint alone", rows["limit"].str.startswith("momentum").sum()),
        Finding("momentum without friction, over the impulse", largest["momentum, C_f = 0"],
                MOMENTUM),
        Finding("momentum with friction, over the impulse", largest["momentum, C_f = 0.1"]),
        Finding("returned speed from the first integral", largest["single impact"], RETURN),
    ]  # fmt: skip
    table = Table.of("Deviation from each limit (s, or as a share)", rows)
    return Measurement(findings, [table])
