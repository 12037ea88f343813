"""The wing with ideal joints: one degree of freedom, the rod angle, integrated by SciPy.

All nine coordinates q of the bodies are functions of that angle, which turns at the rate w. With
their derivatives q' and q'' virtual power gives  sum m q'^2 w' = sum (Q - m q'' w^2) q'.
"""

from __future__ import annotations

import cmath
import math

import numpy as np
from scipy.integrate import solve_ivp

from uqfold.mechanism import WingParameters
from validation.mechanism.bodies import Bodies
from validation.mechanism.independent import DRIVE_CORNERS


def deployment_time(p: WingParameters) -> float:
    """Return the time of the lock (s), inf where it is not reached within `p.t_max`."""
    bodies = Bodies(p)
    m = np.column_stack([bodies.mass, bodies.mass, bodies.inertia]).ravel()

    def motion(angle: float) -> np.ndarray:
        """Return q, q' and q'', (3, 9)."""
        rod = [cmath.rect(p.l_2 / 2, angle) * factor for factor in (1, 1j, -1)]
        sine = (2 * rod[0].imag - p.c) / p.l_1
        crank = math.asin(sine)
        turn = 2 * rod[1].imag / (p.l_1 * math.cos(crank))
        turn_rate = 2 * rod[2].imag / (p.l_1 * math.cos(crank)) + turn**2 * math.tan(crank)
        arm = cmath.rect(p.l_1 / 2, crank)
        middle = [arm, 1j * turn * arm, (1j * turn_rate - turn**2) * arm]
        angles = [(crank, angle), (turn, 1.0), (turn_rate, 0.0)]
        rows = []
        for A, half, (theta_1, theta_2) in zip(middle, rod, angles, strict=True):
            B, C = 2 * A - half, 2 * A - 2 * half
            rows.append([A.real, A.imag, theta_1, B.real, B.imag, theta_2, C.real, C.imag, 0.0])
        return np.array(rows)

    def rates(t: float, y: np.ndarray) -> list[float]:
        angle, w = y
        q, q_1, q_2 = motion(angle)
        Q = np.array(bodies.forces(t, q.tolist(), (w * q_1).tolist(), [None, None]))
        return [w, ((Q - m * q_2 * w**2) @ q_1) / (m @ q_1**2)]

    def lock(_: float, y: np.ndarray) -> float:
        return float(motion(y[0])[0, 6]) - p.x_lock

    lock.terminal, lock.direction = True, 1  # type: ignore[attr-defined]
    t, y = 0.0, np.array([bodies.start()[5], 0.0])
    for end in (*DRIVE_CORNERS, p.t_max):
        run = solve_ivp(
            rates, (t, end), y, method="DOP853", rtol=1e-12, atol=1e-13, events=lock, max_step=0.01
        )
        if len(run.t_events[0]):
            return float(run.t[-1])
        t, y = end, run.y[:, -1]
    return math.inf
