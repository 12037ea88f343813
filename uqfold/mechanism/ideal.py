"""Deployment times of wings with ideal joints: no clearance, a hundred times cheaper.

Wings advance side by side in lanes; see `ideal_lanes`.
"""

import math
from collections.abc import Callable
from typing import Any, Unpack

import numpy as np
from numpy.typing import NDArray

from uqfold.checks import instance, real
from uqfold.mechanism.compiled import entry_point, fingerprint
from uqfold.mechanism.ideal_lanes import follow, resting_lanes, start_lane
from uqfold.mechanism.lane_rows import LANES
from uqfold.mechanism.parameters import WingParameters
from uqfold.mechanism.wing import (
    Samples,
    Wings,
    is_possible,
)

IDEAL_TOLERANCE = 1e-5
"""Local error allowed per time step, relative to the speed of the motion; see `step`."""

FINEST_TOLERANCE, COARSEST_TOLERANCE = 1e-16, 1e-3
"""Bounds of the local error: the first is rounding, beyond the second times are off by 0.1 %."""

_CHUNK = 4096
"""Wings whose numbers are held at once."""


def ideal_deployment_times(
    parameters: WingParameters,
    *,
    tolerance: float = IDEAL_TOLERANCE,
    **samples: Unpack[Samples],
) -> NDArray[np.float64]:
    """Deployment times of a batch of wings with ideal joints.

    It takes the samples of `uqfold.mechanism.deployment_times`, and is the limit of that model as
    the clearances go to 0.

    Parameters
    ----------
    parameters : WingParameters
        Values of all parameters that are not given per sample. Joints and contact do not matter.
    tolerance : float, optional
        Local error allowed per time step, relative to the size of the motion, from 1e-16 to 1e-3.
    **samples : array_like, shape (n,) or scalar
        Values per sample, by the names of `uqfold.mechanism.wing.Samples`, in place of those in
        `parameters`. Clearances change no time, but an impossible one makes its sample impossible.

    Returns
    -------
    ndarray, shape (n,)
        Deployment times (s); (1,) when only scalars are given. +inf where the wing has not locked
        within `parameters.t_max`; NaN, and no exception, where a sample is impossible, by the rules
        of `deployment_times`, or the integration fails.

    Raises
    ------
    ValueError
        If the shapes do not fit, a field is given twice, or the tolerance is out of its bounds.
    TypeError
        If a name is none of `Samples`, or a value is not a number.

    Examples
    --------
    >>> from uqfold.mechanism import WingParameters, ideal_deployment_times
    >>> times = ideal_deployment_times(WingParameters(), k_d=[200.0, 550.0])
    >>> [f"{t:.3f}" for t in times]
    ['inf', '0.536']
    """
    instance("parameters", parameters, WingParameters, "give WingParameters(...)")
    tolerance = real("tolerance", tolerance, at_least=FINEST_TOLERANCE, at_most=COARSEST_TOLERANCE)
    wings = Wings(parameters, samples)
    times = np.empty(len(wings))
    for start in range(0, len(wings), _CHUNK):
        _deploy(wings.table(start, start + _CHUNK), tolerance, times[start : start + _CHUNK])
    return times


def _build(source: int) -> Callable[..., Any]:
    @entry_point
    def deploy(wings, tolerance, times):  # type: ignore[no-untyped-def]
        """Fill `times` (n,) for the table of `wings` (n,)."""
        lanes = resting_lanes()
        # source matters as a part of the cache key only
        for first in range(0 * source, len(wings), LANES):
            chunk = times[first : first + LANES]
            moving = 0
            for j in range(len(chunk)):
                p = wings[first + j]
                chunk[j] = math.nan
                if not is_possible(p):
                    continue
                if abs(p.l_1 - p.l_2) <= math.hypot(p.x_lock, p.c) <= p.l_1 + p.l_2:
                    start_lane(p, lanes, j)
                    moving += 1
                else:
                    chunk[j] = math.inf
            p = wings[first]
            follow(lanes, chunk, moving, p.c, p.x_lock, p.t_max, tolerance)

    return deploy


_deploy = _build(fingerprint())
