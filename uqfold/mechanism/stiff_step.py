"""Time steps for motions that are too stiff for explicit ones.

The Rosenbrock method RODAS3 (A. Sandu, J. G. Verwer, J. G. Blom, E. J. Spee, G. R. Carmichael and
F. A. Potra, Atmos. Environ. 31 (1997) 3459-3472) has order 3, an embedded formula of order 2, and
is L-stable: friction that sticks and contacts that damp hard, whose rates may exceed those of the
motion a millionfold, do not bound its step. It solves linear equations only, with the derivatives
of the accelerations by differences.
"""

import math

import numpy as np
from numpy.typing import NDArray

from uqfold.mechanism.compiled import kernel
from uqfold.mechanism.events import State
from uqfold.mechanism.loads import drive_force
from uqfold.mechanism.motion import (
    LARGEST_TURN,
    Five,
    accelerations,
    directions,
    gaps,
    turned,
)
from uqfold.mechanism.timestep import VIBRATION_TIME, largest_turn, size
from uqfold.mechanism.wing import WingConstants

FloatArray = NDArray[np.float64]

# Coefficients in the form that needs no product with the derivatives: stage i starts from the sum
# of _A[i, j] u_j, takes up the sum of _C[i, j] u_j / h, and the drive's slope with _SLOPE[i].
_GAMMA = 0.5
_A = np.array([[0, 0, 0], [0, 0, 0], [2, 0, 0], [2, 0, 1]], dtype=float)
_C = np.array([[0, 0, 0], [4, 0, 0], [1, -1, 0], [1, -1, -8 / 3]])
_SLOPE = np.array([0.5, 1.5, 0, 0])
_END = np.array([2.0, 0, 1, 1])

# Changes of coordinates (m, rad) and velocities (m/s, rad/s) for the derivatives: far below a
# penetration and a ramp of friction, far above rounding. They go to both sides, since an error of
# the derivatives as small as 1e-5 would already show in the order.
_SHIFT_Q = 1e-8
_SHIFT_V = 1e-6


@kernel
def _as_five(x: FloatArray) -> Five:
    """Five numbers as a tuple."""
    return x[0], x[1], x[2], x[3], x[4]


@kernel
def _accelerations(w: WingConstants, start: State, q: Five, v: Five, drive: float) -> Five:
    """Accelerations at a pose near that of `start`, with its contacts."""
    d = turned(start.d, start.q, q)
    return accelerations(w, q, v, d, start.damping_B, start.damping_C, drive)


@kernel
def differentiate(w: WingConstants, start: State, derivatives: FloatArray) -> None:
    """Fill `derivatives` (5, 10) of the accelerations by coordinates, then by velocities."""
    drive = drive_force(start.t, w.k_d)
    x = np.empty(10)
    for k in range(5):
        x[k] = start.q[k]
        x[5 + k] = start.v[k]
    for j in range(10):
        before = x[j]
        shift = _SHIFT_Q if j < 5 else _SHIFT_V
        x[j] = before + shift
        above = _accelerations(w, start, _as_five(x[:5]), _as_five(x[5:]), drive)
        width = x[j]
        x[j] = before - shift
        below = _accelerations(w, start, _as_five(x[:5]), _as_five(x[5:]), drive)
        width -= x[j]
        x[j] = before
        for i in range(5):
            derivatives[i, j] = (above[i] - below[i]) / width


@kernel
def _factorize(matrix: FloatArray, pivots: NDArray[np.int64]) -> None:
    """Overwrite `matrix` (5, 5) by its factors, rows exchanged as noted in `pivots` (5,)."""
    for k in range(5):
        p = k
        for i in range(k + 1, 5):
            if abs(matrix[i, k]) > abs(matrix[p, k]):
                p = i
        pivots[k] = p
        for j in range(5):
            matrix[k, j], matrix[p, j] = matrix[p, j], matrix[k, j]
        for i in range(k + 1, 5):
            matrix[i, k] /= matrix[k, k]
            for j in range(k + 1, 5):
                matrix[i, j] -= matrix[i, k] * matrix[k, j]


@kernel
def _solve(factors: FloatArray, pivots: NDArray[np.int64], x: FloatArray) -> None:
    """Overwrite the right-hand side `x` (5,) by the solution."""
    for k in range(5):
        p = pivots[k]
        x[k], x[p] = x[p], x[k]
    for k in range(5):
        for j in range(k):
            x[k] -= factors[k, j] * x[j]
    for k in range(4, -1, -1):
        for j in range(k + 1, 5):
            x[k] -= factors[k, j] * x[j]
        x[k] /= factors[k, k]


@kernel
def stiff_step(
    w: WingConstants, start: State, derivatives: FloatArray, t_end: float, tolerance: float
) -> tuple[State, float]:
    """Take one step without events.

    Parameters
    ----------
    w : WingConstants
        The wing.
    start : State
        State at the beginning of the step.
    derivatives : ndarray, shape (5, 10)
        Derivatives of the accelerations at `start`, see `differentiate`.
    t_end : float
        Time at the end of the step (s); the drive has no corner before it.
    tolerance : float
        Local error allowed (m).

    Returns
    -------
    tuple
        State at the end, and the local error over the tolerance, infinite where it is NaN; a
        turn beyond `LARGEST_TURN` counts as an error, as in the explicit steps.
    """
    h = t_end - start.t
    g = _GAMMA * h
    matrix = np.empty((5, 5))
    for i in range(5):
        for j in range(5):
            matrix[i, j] = -derivatives[i, 5 + j] - g * derivatives[i, j]
        matrix[i, i] += 1.0 / g
    pivots = np.empty(5, np.int64)
    _factorize(matrix, pivots)
    drive = drive_force(start.t, w.k_d)
    drive_end = drive_force(t_end, w.k_d)
    # stages of the coordinates and of the velocities
    u_q = np.zeros((4, 5))
    u_v = np.zeros((4, 5))
    q = np.empty(5)
    v = np.empty(5)
    rate = np.empty(5)
    a = start.a
    for i in range(4):
        for k in range(5):
            q[k] = start.q[k]
            v[k] = start.v[k]
            for j in range(i):
                q[k] += _A[i, j] * u_q[j, k]
                v[k] += _A[i, j] * u_v[j, k]
        if i >= 2:
            a = _accelerations(w, start, _as_five(q), _as_five(v), drive_end)
        for k in range(5):
            rate[k] = v[k]
            u_v[i, k] = a[k]
            for j in range(i):
                rate[k] += _C[i, j] / h * u_q[j, k]
                u_v[i, k] += _C[i, j] / h * u_v[j, k]
        u_v[i, 4] += _SLOPE[i] * (drive_end - drive) * w.inverse_m_3
        for k in range(5):
            for j in range(5):
                u_v[i, k] += g * derivatives[k, j] * rate[j]
        _solve(matrix, pivots, u_v[i])
        for k in range(5):
            u_q[i, k] = g * (rate[k] + u_v[i, k])
    for k in range(5):
        q[k] = start.q[k]
        v[k] = start.v[k]
        for i in range(4):
            q[k] += _END[i] * u_q[i, k]
            v[k] += _END[i] * u_v[i, k]
    # the last stage is the difference to the embedded formula
    none = (0.0, 0.0, 0.0, 0.0, 0.0)
    error = size(w, _as_five(u_q[3]), none) + VIBRATION_TIME * size(w, _as_five(u_v[3]), none)
    error /= tolerance
    q_end = _as_five(q)
    v_end = _as_five(v)
    turn = largest_turn(start.q, q_end) / LARGEST_TURN
    error = max(error, turn * turn * turn)
    d = directions(q_end)
    z_B = start.damping_B
    z_C = start.damping_C
    a_end = accelerations(w, q_end, v_end, d, z_B, z_C, drive_end)
    end = State(t_end, q_end, v_end, a_end, d, gaps(w, q_end, v_end, d), z_B, z_C)
    return end, error if math.isfinite(error + size(w, a_end, none)) else math.inf
