"""The wing's motion a second way: complex numbers, virtual power and SciPy, no kernel of uqfold.

Points of the plane are complex numbers. Each force F at a point r(q) adds Re(conj(F) dr/dq) to the
generalised forces, and r' = sum of dr/dq q' is the velocity of the body's point that is touched.
"""

from __future__ import annotations

import cmath
import math
from collections.abc import Callable, Sequence
from typing import Any

import numpy as np
from scipy.integrate import solve_ivp

DRIVE_CORNERS = (0.01, 0.61, 0.62)
_HAIR = 1e-11

# 1 + h rate / onset rate multiplies the elastic force; h by contact law
HYSTERESIS: dict[str, Callable[[float], float]] = {
    "lankarani-nikravesh": lambda e: 0.75 * (1 - e**2),
    "hunt-crossley": lambda e: 1.5 * (1 - e),
    "flores-2011": lambda e: 8 * (1 - e) / (5 * e),
    "gonthier": lambda e: (1 - e**2) / e,
}


def ramp(x: float, start: float, end: float) -> float:
    """0 below `start`, 1 above `end`, linear in between."""
    return min(max((x - start) / (end - start), 0.0), 1.0)


class Wing:
    """Masses, joints and loads of one parameter record, or of anything with its fields."""

    slider = 4
    """Place of the slider's position among the coordinates."""

    def __init__(self, p: Any) -> None:
        self.p = p
        m_1 = p.rho_1 * p.l_1 * p.w_1 * p.b_1
        m_2 = p.rho_2 * p.l_2 * p.w_2 * p.b_2
        m_3 = p.rho_3 * p.V_3
        about_A = m_1 * (p.l_1**2 / 3 + p.w_1**2 / 12)
        self.inertia = (about_A, m_2, m_2, m_2 * (p.l_2**2 + p.w_2**2) / 12, m_3)
        self.weight = [m * p.g * math.sin(p.delta) for m in (m_1, m_2, m_3)]
        sides = ((p.b_1, p.l_1), (p.b_2, p.l_2))
        self.drag = [0.5 * p.rho_a * p.C_0 * b * length * p.V_q**2 for b, length in sides]
        self.C_r = (p.C_r_B, p.C_r_C)
        self.R_j = [p.R_b - gap for gap in self.C_r]
        materials = (
            (p.E_b_B, p.nu_b_B, p.E_j_B, p.nu_j_B),
            (p.E_b_C, p.nu_b_C, p.E_j_C, p.nu_j_C),
        )
        self.K = [
            4
            / (3 * ((1 - nu_b**2) / E_b + (1 - nu_j**2) / E_j))
            * math.sqrt(p.R_b * R_j / (p.R_b + R_j))
            for R_j, (E_b, nu_b, E_j, nu_j) in zip(self.R_j, materials, strict=True)
        ]
        self.hysteresis = HYSTERESIS[p.contact_law](p.C_e)

    def start(self) -> np.ndarray:
        """Coordinates and velocities before deployment."""
        p = self.p
        B = cmath.rect(p.l_1, p.theta_1_initial)
        rise = B.imag + p.c
        rod = complex(math.sqrt(p.l_2**2 - rise**2), rise)
        middle, C = B - rod / 2, B - rod
        return np.array(
            [p.theta_1_initial, middle.real, middle.imag, cmath.phase(rod), C.real, 0, 0, 0, 0, 0]
        )

    def joint(self, y: Sequence[float], which: int) -> tuple[complex, complex, complex]:
        """Eccentricity, its rate, and the half rod that points at the journal."""
        crank = cmath.rect(self.p.l_1, y[0])
        half = cmath.rect(self.p.l_2 / 2, y[3]) * (1, -1)[which]
        journal = complex(y[1], y[2]) + half
        journal_rate = complex(y[6], y[7]) + 1j * y[8] * half
        if which == 0:
            return journal - crank, journal_rate - 1j * y[5] * crank, half
        return journal - complex(y[4], -self.p.c), journal_rate - y[9], half

    def penetration(self, y: Sequence[float], which: int) -> tuple[float, float]:
        """Penetration of a joint (m) and its rate (m/s)."""
        e, e_rate, _ = self.joint(y, which)
        return abs(e) - self.C_r[which], (e.conjugate() * e_rate).real / max(abs(e), 1e-99)

    def rates(self, t: float, state: np.ndarray, onset: Sequence[float | None]) -> list[float]:
        """Velocities and accelerations, given the onset rate of each contact that is on."""
        p = self.p
        y = state.tolist()
        crank = cmath.rect(p.l_1, y[0])
        Q = [0.0] * 5

        def push_crank(force: complex, point: complex) -> None:
            Q[0] += (force.conjugate() * 1j * point).real

        def push_rod(force: complex, arm: complex) -> None:
            Q[1] += force.real
            Q[2] += force.imag
            Q[3] += (force.conjugate() * 1j * arm).real

        push_crank(complex(self.weight[0] + self.drag[0] * abs(math.sin(y[0]))), crank / 2)
        push_rod(complex(self.weight[1] + self.drag[1] * abs(math.sin(y[3]))), 0)
        Q[4] = self.weight[2] + p.k_d * (ramp(t, 0, 0.01) - ramp(t, 0.61, 0.62))
        for which in (0, 1):
            started = onset[which]
            if started is None:
                continue
            e, e_rate, half = self.joint(y, which)
            depth = abs(e) - self.C_r[which]
            if depth <= 0:
                continue
            R_j = self.R_j[which]
            n = e / abs(e)
            along = n.conjugate() * e_rate  # normal and tangential rate
            if p.tangential_velocity == "geometric":
                slip = along.imag + (R_j - p.R_b) * along.imag / abs(e)
            else:
                slip = along.imag + R_j * y[8] - (p.R_b * y[5] if which == 0 else 0.0)
            loss = self.hysteresis * along.real / started
            F_N = max(0.0, self.K[which] * depth * math.sqrt(depth) * (1 + loss))
            F_T = p.C_f * ramp(abs(slip), p.friction_v_0, p.friction_v_1) * F_N
            F = n * complex(F_N, F_T * math.copysign(1.0, slip))
            push_rod(-F, half + R_j * n)
            if which == 0:
                push_crank(F, crank + p.R_b * n)
            else:
                Q[4] += F.real
        return [*y[5:], *(q / i for q, i in zip(Q, self.inertia, strict=True))]


def deployment_time(
    p: Any,
    rtol: float = 1e-9,
    atol: float = 1e-11,
    max_step: float = 1e-4,
    *,
    method: str = "DOP853",
) -> float:
    """Return the time of the lock (s) by SciPy, +inf without one until `t_max`."""
    return follow(Wing(p), rtol, atol, max_step, method=method)[2]


def follow(
    wing: Any,
    rtol: float = 1e-9,
    atol: float = 1e-11,
    max_step: float = 1e-4,
    *,
    method: str = "DOP853",
) -> tuple[np.ndarray, np.ndarray, float]:
    """Follow a wing by SciPy, restarted wherever a contact begins or ends or the drive bends.

    Parameters
    ----------
    wing
        A `Wing`, or what has its `p`, `start`, `rates`, `penetration` and `slider`.
    rtol, atol, max_step, method
        As in `scipy.integrate.solve_ivp`; `max_step` (s) holds while a joint is in contact.

    Returns
    -------
    tuple
        Times (n,) in s, states (n, d), and the time of the lock (s), +inf without one.
    """
    p = wing.p
    y = wing.start()
    t = 0.0
    times, states = [t], [y]
    onset: list[float | None] = [None, None]

    def lock(_: float, y: np.ndarray) -> float:
        return float(y[wing.slider] - p.x_lock)

    def switch_of(which: int) -> Any:
        def switch(_: float, y: np.ndarray) -> float:
            # a hair of hysteresis, so that a contact that has just ended or begun is seen to have
            margin = _HAIR if onset[which] else -_HAIR
            return wing.penetration(y.tolist(), which)[0] + margin

        return switch

    events: list[Any] = [lock, switch_of(0), switch_of(1)]
    for event in events:
        event.terminal = True
    events[0].direction = 1
    while t < p.t_max:
        for which in (0, 1):
            events[1 + which].direction = -1 if onset[which] else 1
        run = solve_ivp(
            lambda t, y: wing.rates(t, y, onset),
            (t, min([c for c in DRIVE_CORNERS if c > t] + [p.t_max])),
            y,
            method=method,
            rtol=rtol,
            atol=atol,
            events=events,
            max_step=max_step if any(onset) else max(max_step, 1e-3),
        )
        t, y = float(run.t[-1]), run.y[:, -1]
        times.extend(run.t[1:])
        states.extend(run.y.T[1:])
        if len(run.t_events[0]):
            return np.array(times), np.array(states), t
        for which in (0, 1):
            if len(run.t_events[1 + which]):
                speed = max(wing.penetration(y.tolist(), which)[1], p.onset_velocity_floor)
                onset[which] = None if onset[which] else speed
    return np.array(times), np.array(states), math.inf
