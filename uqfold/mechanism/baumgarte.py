"""Motion of the wing in the paper's own form, Eq. (20): a slow second path that checks the first.

A step within which a contact begins or ends or the wing locks is repeated with the length that ends
just beyond that instant; see `baumgarte_step`.
"""

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np

from uqfold.checks import instance, real
from uqfold.mechanism.baumgarte_step import (
    dormand_prince_step,
    how_far_beyond,
    step_to_event,
    switched_onset,
    turning_fraction,
)
from uqfold.mechanism.compiled import entry_point, fingerprint, kernel
from uqfold.mechanism.multibody import (
    FloatArray,
    Multibody,
    constraints,
    initial_coordinates,
    multibody,
    rates,
)
from uqfold.mechanism.parameters import WingParameters

BAUMGARTE_TOLERANCE = 1e-10
"""Local error allowed per time step (m, rad)."""

COARSEST_TOLERANCE = 1e-5
"""Largest local error allowed (m, rad): deployment times are then off by some 0.1 ms."""

STRONGEST = 1e6
"""Largest stabilization coefficient (1/s): time steps have to follow what it damps."""

MAX_STEPS = 200_000
"""Time steps after which an integration counts as failed; a deployment takes about 4,000."""

_CORNERS = np.array([0.01, 0.61, 0.62])
_FIRST_STEP = 1e-5
_LARGEST_STEP = 1e-3
_SMALLEST_STEP = 1e-14


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
        only the drift does. From 0 to 1e6.
    tolerance : float, optional
        Local error allowed per time step (m, rad), at most 1e-5.

    Returns
    -------
    BaumgarteTrajectory
        The motion up to the lock, or to t_max without one.

    Raises
    ------
    ValueError
        If the tolerance, alpha or beta is out of its bounds.
    TypeError
        If an argument has another type.
    RuntimeError
        If the integration fails or takes more than `MAX_STEPS` time steps.
    """
    instance("parameters", parameters, WingParameters, "give WingParameters(...)")
    tolerance = real("tolerance", tolerance, above=0.0, at_most=COARSEST_TOLERANCE)
    alpha = real("alpha", alpha, at_least=0.0, at_most=STRONGEST)
    beta = real("beta", beta, at_least=0.0, at_most=STRONGEST)
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
                end, error = dormand_prince_step(b, alpha, beta, t, y, first, taken, onset)
                factor = 0.9 * (tolerance / max(error, 1e-30)) ** 0.2
                if not error <= tolerance:
                    taken *= max(0.1, factor) if error < math.inf else 0.1
                    lands = False
                    if taken < _SMALLEST_STEP:
                        return rows[:n], locked
                    continue
                passed = how_far_beyond(b, end, onset)
                if turned or max(passed) > 0.0:
                    break
                s = min(
                    turning_fraction(b.joint_B, y, end, onset[0], taken),
                    turning_fraction(b.joint_C, y, end, onset[1], taken),
                )
                if s >= 1.0:
                    break
                taken *= s
                lands = False
                turned = True
            h = taken * min(4.0, factor)
            if max(passed) > 0.0:
                end, taken = step_to_event(b, alpha, beta, t, y, first, taken, end, onset)
                lands = False
                passed = how_far_beyond(b, end, onset)
            t = limits[part] if lands else t + taken
            part += 1 if lands else 0
            y = end
            if passed[0] > 0.0:
                onset[0] = switched_onset(b, b.joint_B, y, onset[0])
            if passed[1] > 0.0:
                onset[1] = switched_onset(b, b.joint_C, y, onset[1])
            locked = passed[2] > 0.0
            first, multipliers = rates(b, alpha, beta, t, y, onset)

    return integrate


_integrate = _build(fingerprint())
