"""General solvers on the wing's equations, restarted wherever a contact begins or ends.

With a Python right-hand side they integrate `validation.mechanism.independent`; with a compiled
one the kernels of uqfold, in compiled code of their own.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
from numba import njit
from scipy.integrate import solve_ivp

from uqfold.mechanism import WingParameters
from uqfold.mechanism.loads import (
    DRIVE_FALL_END,
    DRIVE_FALL_START,
    DRIVE_RISE_END,
    drive_force,
)
from uqfold.mechanism.motion import accelerations, directions, gaps
from uqfold.mechanism.wing import Wings, initial_pose, wing_constants
from validation.mechanism import independent

# A contact begins at this depth (m) and ends at this distance, so that each is seen to have begun.
_HAIR = 1e-9
_MOST_RESTARTS = 2000

Reached = tuple[float, np.ndarray, list[bool]]
"""Time (s), states, and whether there was the lock, a switch of B, a switch of C."""
Segment = Callable[[float, np.ndarray, float, np.ndarray], Reached]
"""Integrates from (t, y) to the end of time given, or the first event, under given dampings."""


@njit
def _rates(t, y, w, z):  # type: ignore[no-untyped-def]
    q, v = (y[0], y[1], y[2], y[3], y[4]), (y[5], y[6], y[7], y[8], y[9])
    drive = drive_force(t, w[0].k_d)
    a = accelerations(w[0], q, v, directions(q), z[0], z[1], drive)
    return np.array([v[0], v[1], v[2], v[3], v[4], a[0], a[1], a[2], a[3], a[4]])


@njit
def _gaps(y, w):  # type: ignore[no-untyped-def]
    q, v = (y[0], y[1], y[2], y[3], y[4]), (y[5], y[6], y[7], y[8], y[9])
    return gaps(w[0], q, v, directions(q))


@njit
def _events(y, w, z):  # type: ignore[no-untyped-def]
    gap = _gaps(y, w)
    B, C = (gap[0] if z[0] < 0.0 else -gap[0]), (gap[2] if z[1] < 0.0 else -gap[2])
    return np.array([y[4] - w[0].x_lock, B - _HAIR, C - _HAIR])


@dataclass(frozen=True)
class Solver:
    """A general solver with its settings; `integrate` returns the deployment time (s) of a wing."""

    name: str
    method: str
    compiled: bool
    rtol: float
    atol: float

    def integrate(self, wing: WingParameters) -> float:
        """Return the deployment time (s) of a wing; NaN where the solver fails."""
        # a trial step that is rejected may overflow
        with np.errstate(invalid="ignore", over="ignore"):
            if self.compiled:
                return self._compiled(wing)
            tolerances = self.rtol, self.atol, math.inf
            try:
                return independent.deployment_time(wing, *tolerances, method=self.method)
            except (OverflowError, ValueError):
                # the solver went where Python's functions are not defined
                return math.nan

    def _compiled(self, wing: WingParameters) -> float:
        [row] = Wings(wing).table()
        constants = wing_constants(row)
        # in a form that compiled code takes over at no cost
        w = np.array([tuple(constants)], dtype=[(name, float) for name in constants._fields])
        start = np.array([*initial_pose(row), 0.0, 0.0, 0.0, 0.0, 0.0])
        return _deploy(w, start, self._cvode(w) if self.name == "CVODE" else self._scipy(w))

    def _scipy(self, w: np.ndarray) -> Segment:
        def segment(t: float, y: np.ndarray, end: float, z: np.ndarray) -> Reached:
            events: list[Any] = [lambda _, y, k=k: float(_events(y, w, z)[k]) for k in range(3)]
            for event in events:
                event.terminal, event.direction = True, 1
            run = solve_ivp(
                lambda t, y: _rates(t, y, w, z),
                (t, end),
                y,
                method=self.method,
                rtol=self.rtol,
                atol=self.atol,
                events=events,
            )
            return run.t[-1], run.y[:, -1], [len(times) > 0 for times in run.t_events]

        return segment

    def _cvode(self, w: np.ndarray) -> Segment:
        from sksundae.cvode import CVODE  # type: ignore[import-untyped]

        z = np.full(2, -1.0)

        def rates(t: float, y: np.ndarray, values: np.ndarray) -> None:
            values[:] = _rates(t, y, w, z)

        def events(_: float, y: np.ndarray, values: np.ndarray) -> None:
            values[:] = _events(y, w, z)

        events.direction = [1, 1, 1]  # type: ignore[attr-defined]
        solver = CVODE(
            rates,
            eventsfn=events,
            num_events=3,
            method=self.method,
            rtol=self.rtol,
            atol=self.atol,
            max_num_steps=1_000_000,
        )

        def segment(t: float, y: np.ndarray, end: float, damping: np.ndarray) -> Reached:
            z[:] = damping
            solver.init_step(t, y)
            run = solver.step(end, tstop=end)
            reached = [False] * 3
            if run.i_events is not None:
                reached = (np.asarray(run.i_events).reshape(-1, 3)[-1] != 0).tolist()
            return float(run.t), np.array(run.y).reshape(-1), reached

        return segment


def _deploy(w: np.ndarray, y: np.ndarray, segment: Segment) -> float:
    """Return the deployment time (s), restarted at events and at corners of the drive."""
    t, t_max = 0.0, float(w["t_max"][0])
    z = np.full(2, -1.0)
    corners = (DRIVE_RISE_END, DRIVE_FALL_START, DRIVE_FALL_END, t_max)
    for _ in range(_MOST_RESTARTS):
        t, y, reached = segment(t, y, min(c for c in corners if c > t), z)
        if reached[0]:
            return t
        rates = _gaps(y, w)[1::2]
        for joint in (0, 1):
            if reached[1 + joint]:
                speed = max(rates[joint], float(w["onset_velocity_floor"][0]))
                z[joint] = float(w["hysteresis"][0]) / speed if z[joint] < 0.0 else -1.0
        if t >= t_max:
            return math.inf
    return math.nan
