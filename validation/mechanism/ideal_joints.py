"""The wing with ideal joints: one degree of freedom, the rod angle, integrated by SciPy.

Velocities are the rod's angular velocity times coefficients that depend on its angle alone; with
them kinetic energy and generalised force give M w' + M' w^2 / 2 = Q. Points are complex numbers.
"""

from __future__ import annotations

import cmath
import math

import numpy as np
from scipy.integrate import solve_ivp

from uqfold.mechanism import WingParameters
from validation.mechanism.independent import DRIVE_CORNERS, Wing, ramp


def deployment_time(p: WingParameters) -> float:
    """Return the time of the lock (s), inf where it is not reached within `p.t_max`."""
    wing = Wing(p)
    J_A, m_2, _, J_2, m_3 = wing.inertia

    def crank(angle: float) -> tuple[float, float]:
        sine = (p.l_2 * math.sin(angle) - p.c) / p.l_1
        return sine, math.sqrt(1.0 - sine * sine)

    def rates(t: float, y: np.ndarray) -> list[float]:
        angle, w = y
        sine, cosine = crank(angle)
        turn = p.l_2 * math.cos(angle) / (p.l_1 * cosine)
        turn_rate = (turn * turn * sine - p.l_2 * math.sin(angle) / p.l_1) / cosine
        B = p.l_1 * complex(cosine, sine)
        half = cmath.rect(0.5 * p.l_2, angle)
        # first and second derivatives of the points by the rod angle
        B_1, B_2 = 1j * B * turn, 1j * B * turn_rate - B * turn * turn
        middle_1, middle_2 = B_1 - 1j * half, B_2 + half
        slider_1, slider_2 = (B_1 - 2j * half).real, (B_2 + 2.0 * half).real
        M = J_A * turn**2 + m_2 * abs(middle_1) ** 2 + J_2 + m_3 * slider_1**2
        half_M_1 = (
            J_A * turn * turn_rate
            + m_2 * (middle_1.conjugate() * middle_2).real
            + m_3 * slider_1 * slider_2
        )
        Q = (
            (wing.weight[0] + wing.drag[0] * abs(sine)) * 0.5 * B_1.real
            + (wing.weight[1] + wing.drag[1] * abs(math.sin(angle))) * middle_1.real
            + (wing.weight[2] + p.k_d * (ramp(t, 0, 0.01) - ramp(t, 0.61, 0.62))) * slider_1
        )
        return [w, (Q - half_M_1 * w * w) / M]

    def lock(_: float, y: np.ndarray) -> float:
        return p.l_1 * crank(y[0])[1] - p.l_2 * math.cos(y[0]) - p.x_lock

    lock.terminal, lock.direction = True, 1  # type: ignore[attr-defined]
    t, y = 0.0, np.array([wing.start()[3], 0.0])
    for end in (*DRIVE_CORNERS, p.t_max):
        run = solve_ivp(
            rates, (t, end), y, method="DOP853", rtol=1e-12, atol=1e-13, events=lock, max_step=0.01
        )
        if len(run.t_events[0]):
            return float(run.t[-1])
        t, y = end, run.y[:, -1]
    return math.inf
