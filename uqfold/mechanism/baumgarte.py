"""Motion of the wing in the paper's own form, Eq. (20): a slow second path that checks the first.

The time steps are those of J. R. Dormand and P. J. Prince, J. Comput. Appl. Math. 6 (1980) 19-26,
of order 5(4). A step within which a contact begins or ends or the wing locks is repeated with the
length that ends just beyond that instant, so no interpolation enters.
"""

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np

from uqfold.mechanism.compiled import entry_point, fingerprint, kernel
from uqfold.mechanism.multibody import (
    FloatArray,
    Joint,
    Multibody,
    constraints,
    initial_coordinates,
    multibody,
    penetration,
    rates,
)
from uqfold.mechanism.parameters import WingParameters

BAUMGARTE_TOLERANCE = 1e-10
"""Local error allowed per time step (m, rad)."""

MAX_STEPS = 200_000
"""Time steps after which an integration counts as failed; a deployment takes about 4,000."""

_CORNERS = np.array([0.01, 0.61, 0.62])
_FIRST_STEP = 1e-5
_LARGEST_STEP = 1e-3
_SMALLEST_STEP = 1e-14
# An error of a velocity counts as one of a position over this time (s).
_VELOCITY_TIME = 1e-3
# An event is passed by less than this (m).
_PASSED = 1e-13

_A = np.array(
    [
        [0, 0, 0, 0, 0, 0],
        [1 / 5, 0, 0, 0, 0, 0],
        [3 / 40, 9 / 40, 0, 0, 0, 0],
        [44 / 45, -56 / 15, 32 / 9, 0, 0, 0],
        [19372 / 6561, -25360 / 2187, 64448 / 6561, -212 / 729, 0, 0],
        [9017 / 3168, -355 / 33, 46732 / 5247, 49 / 176, -5103 / 18656, 0],
        [35 / 384, 0, 500 / 1113, 125 / 192, -2187 / 6784, 11 / 84],
    ]
)
_C = _A.sum(axis=1)
_ERROR = np.append(_A[6], 0) - [
    5179 / 57600,
    0,
    7571 / 16695,
    393 / 640,
    -92097 / 339200,
    187 / 2100,
    1 / 40,
]


@dataclass(frozen=True, slots=True, eq=False)
class BaumgarteTrajectory:
    """Motion of one wing in the paper's coordinates, at the n points that the steps ended on.

    Attributes
    ----------
    time : ndarray, shape (n,)
        Time (s).
    coordinates, velocities : ndarray, shape (n, 9)
        x_i, y_i (m) and theta_i (rad) of crank, rod and slider, and their rates.
    multipliers : ndarray, shape (n, 4)
        Lagrange multipliers of the constraints (10), in their order (N, N, N, N m).
    position_drift, velocity_drift : ndarray, shape (n,)
        Largest violation of a constraint, max |Phi| (m, rad), and of its rate, max |Phi_q q'|
        (m/s, rad/s).
    deployment_time : float
        Time of the lock (s), the last in `time`; +inf where `time` ends at t_max without a lock.
    """

    time: FloatArray
    coordinates: FloatArray
    velocities: FloatArray
    multipliers: FloatArray
    position_drift: FloatArray
    velocity_drift: FloatArray
    deployment_time: float


def baumgarte_trajectory(
    parameters: WingParameters,
    *,
    alpha: float = 50.0,
    beta: float = 50.0,
    tolerance: float = BAUMGARTE_TOLERANCE,
) -> BaumgarteTrajectory:
    """Motion of one wing by Eq. (20).

    Parameters
    ----------
    parameters : WingParameters
        The wing.
    alpha, beta : float, optional
        Stabilization coefficients (1/s). The motion does not depend on them beyond the tolerance,
        only the drift does.
    tolerance : float, optional
        Local error allowed per time step (m, rad).

    Returns
    -------
    BaumgarteTrajectory
        The motion up to the lock, or to t_max without one.

    Raises
    ------
    ValueError
        If the tolerance is not positive, or alpha or beta is negative.
    RuntimeError
        If the integration fails or takes more than `MAX_STEPS` time steps.
    """
    if not 0 < tolerance < math.inf:
        raise ValueError(
            f"tolerance = {tolerance} is no local error: give a positive number of metres"
        )
    for name, value in (("alpha", alpha), ("beta", beta)):
        if not 0 <= value < math.inf:
            raise ValueError(f"{name} = {value} stabilizes nothing: give 0 or a positive value")
    limits = np.append(_CORNERS[parameters.t_max > _CORNERS], parameters.t_max)
    rows, locked = _integrate(
        multibody(parameters), initial_coordinates(parameters), limits, alpha, beta, tolerance
    )
    if not locked and rows[-1, 0] < parameters.t_max:
        raise RuntimeError(
            f"the integration of {parameters} with tolerance = {tolerance} came to a halt at "
            f"{rows[-1, 0]} s after {len(rows) - 1} of {MAX_STEPS} time steps: try another "
            "tolerance, or smaller alpha and beta"
        )
    return BaumgarteTrajectory(
        time=rows[:, 0],
        coordinates=rows[:, 1:10],
        velocities=rows[:, 10:19],
        multipliers=rows[:, 19:23],
        position_drift=rows[:, 23],
        velocity_drift=rows[:, 24],
        deployment_time=float(rows[-1, 0]) if locked else math.inf,
    )


@kernel
def _step(
    b: Multibody,
    alpha: float,
    beta: float,
    t: float,
    y: FloatArray,
    first: FloatArray,
    h: float,
    onset: FloatArray,
) -> tuple[FloatArray, float]:
    """State after one step of length `h`, and its local error; `first` are the rates at `y`."""
    stages = np.empty((18, 7))
    end = np.empty(18)
    for k in range(18):
        stages[k, 0] = first[k]
    for i in range(1, 7):
        for k in range(18):
            total = 0.0
            for j in range(i):
                total += _A[i, j] * stages[k, j]
            end[k] = y[k] + h * total
        stage = rates(b, alpha, beta, t + _C[i] * h, end, onset)[0]
        for k in range(18):
            stages[k, i] = stage[k]
    error = 0.0
    for k in range(18):
        part = 0.0
        for i in range(7):
            part += _ERROR[i] * stages[k, i]
        part = abs(h * part) * (1.0 if k < 9 else _VELOCITY_TIME)
        # written so that NaN is kept
        error = error if error >= part else part
    return end, error


@kernel
def _passed(b: Multibody, y: FloatArray, onset: FloatArray) -> tuple[float, float, float]:
    """How far (m) each switch of B and C and the lock lie behind, negative while ahead."""
    gap_B = penetration(b.joint_B, y[:9], y[9:])[0]
    gap_C = penetration(b.joint_C, y[:9], y[9:])[0]
    return (
        -gap_B if onset[0] > 0.0 else gap_B,
        -gap_C if onset[1] > 0.0 else gap_C,
        y[6] - b.x_lock,
    )


@kernel
def _turning(joint: Joint, start: FloatArray, end: FloatArray, onset: float, h: float) -> float:
    """Fraction of a step at which a switch is passed that is undone at its end; 1 if none is."""
    sign = -1.0 if onset > 0.0 else 1.0
    gap, rate = penetration(joint, start[:9], start[9:])
    rate_end = penetration(joint, end[:9], end[9:])[1]
    if not sign * rate > 0.0 > sign * rate_end:
        return 1.0
    s = rate / (rate - rate_end)
    return s if sign * (gap + 0.5 * s * h * rate) > 0.0 else 1.0


@kernel
def _switched(b: Multibody, joint: Joint, y: FloatArray, onset: float) -> float:
    """Onset velocity after a contact has begun, 0 after it has ended."""
    if onset > 0.0:
        return 0.0
    return max(penetration(joint, y[:9], y[9:])[1], b.onset_floor)


@kernel
def _to_event(
    b: Multibody,
    alpha: float,
    beta: float,
    t: float,
    y: FloatArray,
    first: FloatArray,
    h: float,
    end: FloatArray,
    onset: FloatArray,
) -> tuple[FloatArray, float]:
    """Shorten a step of length `h` to `end` so that it ends just beyond its first event.

    Returns the state there and the length (Illinois method).
    """
    low, high = 0.0, h
    beyond = max(_passed(b, end, onset))
    weight_low, weight_high = max(_passed(b, y, onset)), beyond
    for _ in range(200):
        if beyond <= _PASSED:
            break
        middle = (low * weight_high - high * weight_low) / (weight_high - weight_low)
        if not low < middle < high:
            middle = 0.5 * (low + high)
        if not low < middle < high:
            break
        state, _ = _step(b, alpha, beta, t, y, first, middle, onset)
        at = max(_passed(b, state, onset))
        if at > 0.0:
            high, beyond, weight_high = middle, at, at
            weight_low *= 0.5
            end = state
        else:
            low, weight_low = middle, at
            weight_high *= 0.5
    return end, high


@kernel
def _write(b: Multibody, row: FloatArray, t: float, y: FloatArray, multipliers: FloatArray) -> None:
    """Fill one row of the record (25,)."""
    row[0] = t
    for k in range(18):
        row[1 + k] = y[k]
    phi, jacobian = constraints(b, y[:9])
    row[23] = 0.0
    row[24] = 0.0
    for k in range(4):
        row[19 + k] = multipliers[k]
        rate = 0.0
        for column in range(9):
            rate += jacobian[k, column] * y[9 + column]
        row[23] = max(row[23], abs(phi[k]))
        row[24] = max(row[24], abs(rate))


def _build(source: int) -> Callable[..., Any]:
    @entry_point
    def integrate(b, q, limits, alpha, beta, tolerance):  # type: ignore[no-untyped-def]
        """Record of the motion (n, 25) from rest at `q` up to the lock or the last of `limits`.

        Also returns whether the wing has locked. No step spans one of `limits`.
        """
        t = 0.0 * source  # source matters as a part of the cache key only
        y = np.zeros(18)
        for k in range(9):
            y[k] = q[k]
        onset = np.zeros(2)
        rows = np.empty((1024, 25))
        n = 0
        h = _FIRST_STEP
        part = 0
        locked = False
        first, multipliers = rates(b, alpha, beta, t, y, onset)
        while True:
            if n == rows.shape[0]:
                longer = np.empty((2 * n, 25))
                for i in range(n):
                    for k in range(25):
                        longer[i, k] = rows[i, k]
                rows = longer
            _write(b, rows[n], t, y, multipliers)
            n += 1
            if locked or part == limits.shape[0] or n > MAX_STEPS:
                return rows[:n], locked
            h = min(h, _LARGEST_STEP)
            lands = t + 1.01 * h >= limits[part]
            taken = limits[part] - t if lands else h
            turned = False
            while True:
                end, error = _step(b, alpha, beta, t, y, first, taken, onset)
                factor = 0.9 * (tolerance / max(error, 1e-30)) ** 0.2
                if not error <= tolerance:
                    taken *= max(0.1, factor) if error < math.inf else 0.1
                    lands = False
                    if taken < _SMALLEST_STEP:
                        return rows[:n], locked
                    continue
                passed = _passed(b, end, onset)
                if turned or max(passed) > 0.0:
                    break
                s = min(
                    _turning(b.joint_B, y, end, onset[0], taken),
                    _turning(b.joint_C, y, end, onset[1], taken),
                )
                if s >= 1.0:
                    break
                taken *= s
                lands = False
                turned = True
            h = taken * min(4.0, factor)
            if max(passed) > 0.0:
                end, taken = _to_event(b, alpha, beta, t, y, first, taken, end, onset)
                lands = False
                passed = _passed(b, end, onset)
            t = limits[part] if lands else t + taken
            part += 1 if lands else 0
            y = end
            if passed[0] > 0.0:
                onset[0] = _switched(b, b.joint_B, y, onset[0])
            if passed[1] > 0.0:
                onset[1] = _switched(b, b.joint_C, y, onset[1])
            locked = passed[2] > 0.0
            first, multipliers = rates(b, alpha, beta, t, y, onset)

    return integrate


_integrate = _build(fingerprint())
