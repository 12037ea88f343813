"""The wing's motion in the paper's own form: nine coordinates and Lagrange multipliers, Eq. (20).

Coordinates q = (x_1, y_1, theta_1, x_2, y_2, theta_2, x_3, y_3, theta_3) are held together by the
constraints (10), which Baumgarte's terms keep from drifting apart. Nothing of uqfold's reduced form
is used here. Points of the plane are complex numbers.
"""

from __future__ import annotations

import cmath
import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from uqfold.mechanism import WingParameters
from validation.mechanism.independent import HYSTERESIS, follow, ramp


@dataclass(frozen=True, eq=False)
class Motion:
    """Motion of one wing at the n points that the steps ended on.

    Attributes
    ----------
    time
        Time (n,) in s.
    coordinates, velocities
        The nine coordinates (n, 9) in m and rad, and their rates.
    position_drift, velocity_drift
        Largest violation (n,) of a constraint (m, rad), and of its rate (m/s, rad/s).
    deployment_time
        Time of the lock (s), +inf without one.
    """

    time: np.ndarray
    coordinates: np.ndarray
    velocities: np.ndarray
    position_drift: np.ndarray
    velocity_drift: np.ndarray
    deployment_time: float


@dataclass(frozen=True)
class Joint:
    """Body i carries the bearing, body j the journal; s (m) is the centre's place on its x axis."""

    i: int
    s_i: float
    j: int
    s_j: float
    R_j: float
    K: float


class Multibody:
    """Eqs. (1) to (20) for one wing, as `follow` takes them; alpha and beta in 1/s."""

    slider = 6

    def __init__(self, p: WingParameters, alpha: float, beta: float) -> None:
        self.p, self.alpha, self.beta = p, alpha, beta
        lengths, widths = np.array([p.l_1, p.l_2]), np.array([p.w_1, p.w_2])
        thicknesses = np.array([p.b_1, p.b_2])
        m = [*(np.array([p.rho_1, p.rho_2]) * lengths * widths * thicknesses), p.rho_3 * p.V_3]
        # theta_3 is constrained to 0, so any inertia of the slider serves (kg m^2)
        J = [*(m[:2] * (lengths**2 + widths**2) / 12), 1.0]
        # masses and constraints' derivatives of Eq. (20); those by theta_1 come with the pose
        self.matrix = np.diag([*np.column_stack([m, m, J]).ravel(), 0.0, 0.0, 0.0, 0.0])
        for row, column in ((0, 0), (1, 1), (2, 7), (3, 8)):
            self.matrix[9 + row, column] = self.matrix[column, 9 + row] = 1.0
        drag = p.rho_a / 2 * p.C_0 * thicknesses * lengths * p.V_q**2
        self.drag = drag.tolist()
        self.weight = [one * p.g * math.sin(p.delta) for one in m]
        self.hysteresis = HYSTERESIS[p.contact_law](p.C_e)
        crank, rod = p.l_1 / 2, p.l_2 / 2
        self.joints = (
            self._joint(0, crank, rod, p.C_r_B, (p.E_b_B, p.nu_b_B), (p.E_j_B, p.nu_j_B)),
            self._joint(2, 0.0, -rod, p.C_r_C, (p.E_b_C, p.nu_b_C), (p.E_j_C, p.nu_j_C)),
        )

    def _joint(
        self,
        i: int,
        s_i: float,
        s_j: float,
        C_r: float,
        bearing: tuple[float, float],
        journal: tuple[float, float],
    ) -> Joint:
        R_i = self.p.R_b
        R_j = R_i - C_r
        h_i, h_j = ((1 - nu**2) / E for E, nu in (bearing, journal))
        K = 4 / (3 * (h_i + h_j)) * math.sqrt(R_i * R_j / (R_i + R_j))
        return Joint(i, s_i, 1, s_j, R_j, K)

    def start(self) -> np.ndarray:
        """Return coordinates and velocities (18,) at rest, the slider on the side nearer to A."""
        p = self.p
        B = cmath.rect(p.l_1, p.theta_1_initial)
        theta_2 = math.asin((B.imag + p.c) / p.l_2)
        C = B - cmath.rect(p.l_2, theta_2)
        crank, rod = B / 2, (B + C) / 2
        q = [crank.real, crank.imag, p.theta_1_initial, rod.real, rod.imag, theta_2, C.real, -p.c]
        return np.array([*q, *[0.0] * 10])

    def _gap(self, joint: Joint, y: Sequence[float]) -> tuple[complex, complex, complex, complex]:
        """Return the eccentricity (1), its rate, and the arms of both centres about centroids."""
        i, j = 3 * joint.i, 3 * joint.j
        arm_i, arm_j = cmath.rect(joint.s_i, y[i + 2]), cmath.rect(joint.s_j, y[j + 2])
        e = complex(y[j] - y[i], y[j + 1] - y[i + 1]) + arm_j - arm_i
        rate = complex(y[9 + j] - y[9 + i], y[10 + j] - y[10 + i])
        return e, rate + 1j * (y[11 + j] * arm_j - y[11 + i] * arm_i), arm_i, arm_j

    def penetration(self, y: Sequence[float], which: int) -> tuple[float, float]:
        """Return the penetration (2) of a joint (m) and its rate (m/s)."""
        joint = self.joints[which]
        e, rate, _, _ = self._gap(joint, y)
        depth = abs(e) - (self.p.R_b - joint.R_j)
        return depth, (e.conjugate() * rate).real / max(abs(e), 1e-99)

    def _add_contact(self, joint: Joint, onset: float, y: Sequence[float], Q: list[float]) -> None:
        """Add the contact forces (5) to (8) of a joint and their moments (9) to `Q`."""
        p = self.p
        e, rate, arm_i, arm_j = self._gap(joint, y)
        depth = abs(e) - (p.R_b - joint.R_j)
        if depth <= 0.0:
            return
        n = e / abs(e)
        i, j = 3 * joint.i, 3 * joint.j
        v = n.conjugate() * rate  # normal and tangential
        if p.tangential_velocity == "material":
            v_t = v.imag + joint.R_j * y[11 + j] - p.R_b * y[11 + i]
        else:  # the contact points move with n, which turns at v.imag / |e|
            v_t = v.imag + (joint.R_j - p.R_b) * v.imag / abs(e)
        F_N = max(0.0, joint.K * depth**1.5 * (1.0 + self.hysteresis * v.real / onset))
        # the journal drags the bearing along: opposite to the sign printed in (7)
        F_T = p.C_f * ramp(abs(v_t), p.friction_v_0, p.friction_v_1) * F_N
        F = n * complex(F_N, math.copysign(F_T, v_t))
        for first, force, arm in ((i, F, arm_i + p.R_b * n), (j, -F, arm_j + joint.R_j * n)):
            Q[first] += force.real
            Q[first + 1] += force.imag
            Q[first + 2] += (arm.conjugate() * force).imag

    def constraints(self, y: Sequence[float]) -> tuple[np.ndarray, np.ndarray]:
        """Return the constraints (10), (4,), and their rates."""
        p = self.p
        crank, rate = cmath.rect(p.l_1 / 2, y[2]), 1j * y[11] * cmath.rect(p.l_1 / 2, y[2])
        return (
            np.array([y[0] - crank.real, y[1] - crank.imag, y[7] + p.c, y[8]]),
            np.array([y[9] - rate.real, y[10] - rate.imag, y[16], y[17]]),
        )

    def rates(self, t: float, state: np.ndarray, onset: Sequence[float | None]) -> np.ndarray:
        """Return the rates (18,) by Eq. (20), given the onset rate of each contact that is on."""
        p, y = self.p, state.tolist()
        Q = [0.0] * 9
        Q[0] = self.drag[0] * abs(math.sin(y[2])) + self.weight[0]
        Q[3] = self.drag[1] * abs(math.sin(y[5])) + self.weight[1]
        Q[6] = self.weight[2] + p.k_d * (ramp(t, 0.0, 0.01) - ramp(t, 0.61, 0.62))
        for joint, started in zip(self.joints, onset, strict=True):
            if started is not None:
                self._add_contact(joint, started, y, Q)
        crank = cmath.rect(p.l_1 / 2, y[2])
        matrix = self.matrix.copy()
        matrix[9, 2] = matrix[2, 9] = crank.imag
        matrix[10, 2] = matrix[2, 10] = -crank.real
        phi, phi_rate = self.constraints(y)
        gamma = np.array([-crank.real, -crank.imag, 0.0, 0.0]) * y[11] ** 2
        right = gamma - 2.0 * self.alpha * phi_rate - self.beta**2 * phi
        return np.concatenate([state[9:], np.linalg.solve(matrix, np.append(Q, right))[:9]])


def baumgarte_motion(
    parameters: WingParameters, alpha: float = 50.0, beta: float = 50.0, rtol: float = 1e-9
) -> Motion:
    """Return the motion of one wing by Eq. (20), up to the lock, or to t_max without one.

    Parameters
    ----------
    parameters
        The wing.
    alpha, beta
        Stabilization coefficients (1/s): the drift depends on them, the motion does not.
    rtol
        Relative tolerance of the time steps; the absolute one is a hundredth.
    """
    multibody = Multibody(parameters, alpha, beta)
    time, states, locked = follow(multibody, rtol, rtol / 100)
    drift = np.array([multibody.constraints(state) for state in states])
    position, velocity = np.abs(drift).max(axis=2).T
    return Motion(time, states[:, :9], states[:, 9:], position, velocity, locked)
