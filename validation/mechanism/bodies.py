"""Masses and forces of the wing, once more and plainly: three free bodies, no kernel of uqfold.

Each body has the coordinates x, y (m) of its centroid and its angle (rad): crank, rod and slider,
nine coordinates q with rates v. Points of the plane and forces are complex numbers. What holds the
crank to its pivot and the slider to its guide is no force here: `independent.py`, `baumgarte.py`
and `exudyn_wing.py` each bring their own way to keep these two constraints.
"""

from __future__ import annotations

import cmath
import math
from collections.abc import Callable, Sequence
from typing import NamedTuple

from uqfold.mechanism import WingParameters

HYSTERESIS: dict[str, Callable[[float], float]] = {
    "lankarani-nikravesh": lambda e: 0.75 * (1 - e**2),
    "hunt-crossley": lambda e: 1.5 * (1 - e),
    "flores-2011": lambda e: 8 * (1 - e) / (5 * e),
    "gonthier": lambda e: (1 - e**2) / e,
}
"""Contact law -> h of the coefficient of restitution e; the elastic force is multiplied by
1 + h rate / onset rate."""


class Joint(NamedTuple):
    """A joint with clearance: body `i` carries the bearing, the rod the journal."""

    i: int
    s_i: float
    """Place of the bearing's centre on the x axis of its body (m)."""
    s_j: float
    """Place of the journal's centre on the rod (m)."""
    C_r: float
    R_j: float
    K: float


class Bodies:
    """Masses, joints and loads of one parameter record; SI units."""

    def __init__(self, p: WingParameters) -> None:
        self.p = p
        m_1 = p.rho_1 * p.l_1 * p.w_1 * p.b_1
        m_2 = p.rho_2 * p.l_2 * p.w_2 * p.b_2
        self.mass = (m_1, m_2, p.rho_3 * p.V_3)
        # the slider does not turn, so that any inertia serves
        self.inertia = (m_1 * (p.l_1**2 + p.w_1**2) / 12, m_2 * (p.l_2**2 + p.w_2**2) / 12, 1.0)
        self.weight = [m * p.g * math.sin(p.delta) for m in self.mass]
        areas = (p.b_1 * p.l_1, p.b_2 * p.l_2, 0.0)
        self.drag = [0.5 * p.rho_a * p.C_0 * area * p.V_q**2 for area in areas]
        self.hysteresis = HYSTERESIS[p.contact_law](p.C_e)
        self.joints = (
            self._joint(0, p.l_1 / 2, p.l_2 / 2, "B"),
            self._joint(2, 0.0, -p.l_2 / 2, "C"),
        )

    def _joint(self, i: int, s_i: float, s_j: float, letter: str) -> Joint:
        """Return the joint whose clearance and materials end with a letter, B or C."""
        C_r, E_b, nu_b, E_j, nu_j = (
            getattr(self.p, f"{name}_{letter}") for name in ("C_r", "E_b", "nu_b", "E_j", "nu_j")
        )
        R_b, R_j = self.p.R_b, self.p.R_b - C_r
        softness = (1 - nu_b**2) / E_b + (1 - nu_j**2) / E_j
        return Joint(i, s_i, s_j, C_r, R_j, 4 / (3 * softness) * math.sqrt(R_b * R_j / (R_b + R_j)))

    def start(self) -> list[float]:
        """Return the coordinates (9,) before deployment, the slider on the side nearer to A."""
        p = self.p
        B = cmath.rect(p.l_1, p.theta_1_initial)
        theta_2 = math.asin((B.imag + p.c) / p.l_2)
        C = B - cmath.rect(p.l_2, theta_2)
        crank, rod = B / 2, (B + C) / 2
        return [crank.real, crank.imag, p.theta_1_initial, rod.real, rod.imag, theta_2, C.real,
                -p.c, 0.0]  # fmt: skip

    def penetration(
        self, q: Sequence[float], v: Sequence[float], which: int
    ) -> tuple[float, float]:
        """Return the penetration of a joint (m) and its rate (m/s)."""
        e, rate, _, _ = _eccentricity(self.joints[which], q, v)
        return abs(e) - self.joints[which].C_r, (e.conjugate() * rate).real / max(abs(e), 1e-99)

    def forces(
        self, t: float, q: Sequence[float], v: Sequence[float], onset: Sequence[float | None]
    ) -> list[float]:
        """Return forces (N) and moments about the centroids (N m), (9,).

        Parameters
        ----------
        t
            Time (s).
        q, v
            Coordinates (9,) and their rates.
        onset
            Penetration rate (m/s) at which the contact of each joint began; None without contact.
        """
        p = self.p
        Q = [0.0] * 9
        for body in range(3):
            Q[3 * body] = self.weight[body] + self.drag[body] * abs(math.sin(q[3 * body + 2]))
        Q[6] += p.k_d * (ramp(t, 0.0, 0.01) - ramp(t, 0.61, 0.62))
        for joint, started in zip(self.joints, onset, strict=True):
            e, rate, arm_i, arm_j = _eccentricity(joint, q, v)
            depth = abs(e) - joint.C_r
            if started is None or depth <= 0.0:
                continue
            n = e / abs(e)
            along = n.conjugate() * rate  # normal and tangential
            if p.tangential_velocity == "material":
                slip = along.imag + joint.R_j * v[5] - p.R_b * v[3 * joint.i + 2]
            else:  # the contact points move with n, which turns at along.imag / |e|
                slip = along.imag + (joint.R_j - p.R_b) * along.imag / abs(e)
            loss = self.hysteresis * along.real / started
            F_N = max(0.0, joint.K * depth * math.sqrt(depth) * (1.0 + loss))
            # the journal drags the bearing along: opposite to the sign printed in (7)
            F_T = p.C_f * ramp(abs(slip), p.friction_v_0, p.friction_v_1) * F_N
            F = n * complex(F_N, math.copysign(F_T, slip))
            on_bearing, on_journal = arm_i + p.R_b * n, arm_j + joint.R_j * n
            for body, force, arm in ((joint.i, F, on_bearing), (1, -F, on_journal)):
                Q[3 * body] += force.real
                Q[3 * body + 1] += force.imag
                Q[3 * body + 2] += (arm.conjugate() * force).imag
        return Q


def ramp(x: float, start: float, end: float) -> float:
    """0 below `start`, 1 above `end`, linear in between."""
    return min(max((x - start) / (end - start), 0.0), 1.0)


def _eccentricity(
    joint: Joint, q: Sequence[float], v: Sequence[float]
) -> tuple[complex, complex, complex, complex]:
    """Return journal minus bearing, its rate, and the arms of both about the centroids."""
    i = 3 * joint.i
    arm_i, arm_j = cmath.rect(joint.s_i, q[i + 2]), cmath.rect(joint.s_j, q[5])
    e = complex(q[3] - q[i], q[4] - q[i + 1]) + arm_j - arm_i
    rate = complex(v[3] - v[i], v[4] - v[i + 1]) + 1j * (v[5] * arm_j - v[i + 2] * arm_i)
    return e, rate, arm_i, arm_j
