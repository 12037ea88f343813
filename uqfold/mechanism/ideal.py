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
from uqfold.mechanism.ideal_lanes import LANES, follow, resting_lanes, start_lane
from uqfold.mechanism.parameters import WingParameters
from uqfold.mechanism.wing import (
    Samples,
    as_sample,
    is_possible,
    sample_table,
    shared_parameters,
)

IDEAL_TOLERANCE = 1e-5
"""Local error allowed per time step, relative to the speed of the motion; see `step`."""

FINEST_TOLERANCE, COARSEST_TOLERANCE = 1e-16, 1e-3
"""Bounds of the local error: the first is rounding, beyond the second times are off by 0.1 %."""


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
        If a name is none of `Samples`, or a value is no number.

    Examples
    --------
    >>> from uqfold.mechanism import WingParameters, ideal_deployment_times
    >>> times = ideal_deployment_times(WingParameters(), k_d=[200.0, 550.0])
    >>> [f"{t:.3f}" for t in times]
    ['inf', '0.536']
    """
    instance("parameters", parameters, WingParameters, "give WingParameters(...)")
    tolerance = real("tolerance", tolerance, at_least=FINEST_TOLERANCE, at_most=COARSEST_TOLERANCE)
    rows = sample_table(parameters, samples)
    times = np.empty(len(rows))
    _deploy(shared_parameters(parameters), rows, tolerance, times)
    return times


def _build(source: int) -> Callable[..., Any]:
    @entry_point
    def deploy(f, samples, tolerance, times):  # type: ignore[no-untyped-def]
        """Fill `times` (n,) for the `samples` (n, 9)."""
        lanes = resting_lanes()
        reach = math.hypot(f.x_lock, f.c)
        # source matters as a part of the cache key only
        for first in range(0 * source, samples.shape[0], LANES):
            chunk = times[first : first + LANES]
            moving = 0
            for j in range(chunk.shape[0]):
                p = as_sample(samples[first + j])
                chunk[j] = math.nan
                if not is_possible(f, p):
                    continue
                if abs(p.l_1 - p.l_2) <= reach <= p.l_1 + p.l_2:
                    start_lane(f, p, lanes, j)
                    moving += 1
                else:
                    chunk[j] = math.inf
            follow(lanes, chunk, moving, f.c, f.x_lock, f.t_max, tolerance)

    return deploy


_deploy = _build(fingerprint())
