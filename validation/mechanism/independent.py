"""The wing's motion a second way: virtual power and SciPy, no kernel of uqfold.

Five coordinates suffice where the crank turns about its pivot and the slider keeps to its guide:
angle of the crank, place and angle of the rod, place of the slider along the guide. A force on the
crank works through the motion of its centroid.
"""

from __future__ import annotations

import cmath
import math
from collections.abc import Sequence
from typing import Any

import numpy as np
from scipy.integrate import solve_ivp

from uqfold.mechanism import WingParameters
from validation.mechanism.bodies import Bodies

DRIVE_CORNERS = (0.01, 0.61, 0.62)
_HAIR = 1e-11


class FiveCoordinateWing:
    """Equations of motion in five coordinates, as `follow` takes them."""

    slider = 4
    """Place of the slider's position among the coordinates."""

    def __init__(self, p: WingParameters) -> None:
        self.p = p
        self.bodies = Bodies(p)
        _, m_2, m_3 = self.bodies.mass
        J_1, J_2, _ = self.bodies.inertia
        self.inertia = (J_1 + self.bodies.mass[0] * p.l_1**2 / 4, m_2, m_2, J_2, m_3)

    def start(self) -> np.ndarray:
        """Return coordinates and velocities (10,) before deployment."""
        return np.array([*self.bodies.start()[2:7], *[0.0] * 5])

    def motion(self, y: Sequence[float]) -> tuple[list[float], list[float]]:
        """Return the nine coordinates of the bodies, and their rates."""
        crank = cmath.rect(self.p.l_1 / 2, y[0])
        rate = 1j * y[5] * crank
        return (
            [crank.real, crank.imag, *y[:5], -self.p.c, 0.0],
            [rate.real, rate.imag, *y[5:], 0.0, 0.0],
        )

    def penetration(self, y: Sequence[float], which: int) -> tuple[float, float]:
        """Return the penetration of a joint (m) and its rate (m/s)."""
        return self.bodies.penetration(*self.motion(y), which)

    def rates(self, t: float, state: np.ndarray, onset: Sequence[float | None]) -> list[float]:
        """Return velocities and accelerations, given the onset rate of each contact that is on."""
        y = state.tolist()
        q, v = self.motion(y)
        Q = self.bodies.forces(t, q, v, onset)
        # the moment about the pivot: Q_1 dx_1/dtheta_1 + Q_2 dy_1/dtheta_1 + Q_3
        about_A = q[0] * Q[1] - q[1] * Q[0] + Q[2]
        return [*y[5:], *(F / m for F, m in zip([about_A, *Q[3:7]], self.inertia, strict=True))]


def deployment_time(p: WingParameters, **how: Any) -> float:
    """Return the time of the lock (s) by SciPy, +inf without one; `how` as in `follow`."""
    return follow(FiveCoordinateWing(p), **how)[2]


def follow(
    wing: Any,
    *,
    rtol: float = 1e-9,
    atol: float = 1e-11,
    max_step: float = 1e-4,
    method: str = "DOP853",
) -> tuple[np.ndarray, np.ndarray, float]:
    """Follow a wing by SciPy, restarted wherever a contact begins or ends or the drive bends.

    Parameters
    ----------
    wing
        A `FiveCoordinateWing`, or what has its `p`, `start`, `rates`, `penetration` and `slider`.
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
