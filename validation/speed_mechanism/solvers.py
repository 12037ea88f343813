"""General solvers on the wing's equations, restarted wherever a contact begins or ends.

SciPy's integrate `validation.mechanism.independent`, in Python; CVODE the kernels of uqfold, in
compiled code of its own.
"""

from __future__ import annotations

import math

import numpy as np
from numba import njit

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


def scipy_time(wing: WingParameters, method: str) -> float:
    """Return the deployment time (s) by SciPy; NaN if it went where no function is defined."""
    # a trial step that is rejected may overflow
    with np.errstate(invalid="ignore", over="ignore"):
        try:
            return independent.deployment_time(wing, 1e-4, 1e-6, math.inf, method=method)
        except (OverflowError, ValueError):
            return math.nan


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
    """Lock, and switches of both joints, where they rise through zero."""
    gap = _gaps(y, w)
    B, C = (gap[0] if z[0] < 0.0 else -gap[0]), (gap[2] if z[1] < 0.0 else -gap[2])
    return np.array([y[4] - w[0].x_lock, B - _HAIR, C - _HAIR])


def cvode_time(wing: WingParameters, method: str) -> float:
    """Return the deployment time (s) by CVODE; NaN if it needs too many restarts."""
    from sksundae.cvode import CVODE  # type: ignore[import-untyped]

    [row] = Wings(wing).table()
    constants = wing_constants(row)
    # in a form that compiled code takes over at no cost
    w = np.array([tuple(constants)], dtype=[(name, float) for name in constants._fields])
    z = np.full(2, -1.0)

    def rates(t: float, y: np.ndarray, values: np.ndarray) -> None:
        values[:] = _rates(t, y, w, z)

    def events(_: float, y: np.ndarray, values: np.ndarray) -> None:
        values[:] = _events(y, w, z)

    events.direction = [1, 1, 1]  # type: ignore[attr-defined]
    solver = CVODE(
        rates, eventsfn=events, num_events=3, method=method, rtol=1e-5, atol=1e-7,
        max_num_steps=1_000_000,
    )  # fmt: skip
    t, y = 0.0, np.array([*initial_pose(row), 0.0, 0.0, 0.0, 0.0, 0.0])
    corners = (DRIVE_RISE_END, DRIVE_FALL_START, DRIVE_FALL_END, wing.t_max)
    for _ in range(_MOST_RESTARTS):
        end = min(corner for corner in corners if corner > t)
        solver.init_step(t, y)
        run = solver.step(end, tstop=end)
        t, y = float(run.t), np.array(run.y).reshape(-1)
        if run.i_events is not None:
            lock, *switches = np.asarray(run.i_events).reshape(-1, 3)[-1] != 0
            if lock:
                return t
            for joint in np.flatnonzero(switches):
                speed = max(_gaps(y, w)[2 * joint + 1], constants.onset_velocity_floor)
                z[joint] = constants.hysteresis / speed if z[joint] < 0.0 else -1.0
        if t >= wing.t_max:
            return math.inf
    return math.nan
