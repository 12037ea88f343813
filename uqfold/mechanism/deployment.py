"""Deployment times of a batch of wings.

Two time loops run the same time step and give the same bits on the same processor: `deploy_lanes`
advances many wings side by side, for speed; `deploy_rows` advances one after the other, as the
readable reference, and records the motion.
"""

import math
import warnings
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from typing import Any, Unpack, cast

import numpy as np
from numba import config
from numpy.typing import NDArray

from uqfold.checks import instance, real, whole
from uqfold.mechanism.compiled import entry_point, fingerprint, inlined
from uqfold.mechanism.lane_rows import LANES
from uqfold.mechanism.lanes import (
    CONSTANT_ROWS,
    CONTROL_ROWS,
    STATE_ROWS,
    TIME,
    is_marked,
    look_closer,
    move_lane,
    start_lane,
    step_lanes,
)
from uqfold.mechanism.parameters import WingParameters
from uqfold.mechanism.record import NO_RECORD, write_point
from uqfold.mechanism.stiff import deploy_stiff
from uqfold.mechanism.timestep import (
    FIRST_STEP,
    LOCKED,
    RUNNING,
    TIMED_OUT,
    advance,
    initial_state,
)
from uqfold.mechanism.wing import (
    Samples,
    Wings,
    initial_pose,
    is_possible,
    wing_constants,
)

FloatArray = NDArray[np.float64]

DEFAULT_TOLERANCE = 7e-7
"""Local error allowed per time step (m)."""

FINEST_TOLERANCE, COARSEST_TOLERANCE = 1e-16, 1e-4
"""Bounds of the local error (m): coordinates of a metre are rounded to the first; at the second the
errors are still 1 or 2 % of the scatter of deployment times, at 0.1 m as large as the times."""

MAX_STEPS = 2_000_000
"""Time steps after which a motion counts as too stiff for them; a deployment takes about 1,000."""

GIVEN_UP = -math.inf
"""What the time loops give as the deployment time of a motion that they cannot follow."""

# Samples handed to a thread at once: few enough to share the work evenly, enough to keep the lanes
# filled.
_SMALLEST_CHUNK, _LARGEST_CHUNK = 32, 512
_CHUNKS_PER_THREAD = 4


def deployment_times(
    parameters: WingParameters,
    *,
    tolerance: float = DEFAULT_TOLERANCE,
    threads: int | None = None,
    **samples: Unpack[Samples],
) -> FloatArray:
    """Deployment times of a batch of wings: the response of Eq. (21).

    Parameters
    ----------
    parameters : WingParameters
        Values of all parameters that are not given per sample.
    tolerance : float, optional
        Local error allowed per time step (m), in the position of the joints, from 1e-16 to 1e-4.
    threads : int, optional
        Number of threads; by default the cores at hand, or NUMBA_NUM_THREADS. The result of a
        sample depends neither on it nor on the place of the sample in the batch.
    **samples : array_like, shape (n,) or scalar
        Values per sample, by the names of `uqfold.mechanism.wing.Samples`, in place of those in
        `parameters`: V_q, delta, k_d, b_1, b_2 or b, C_r_B, C_r_C or C_r, l_1, l_2 (SI units).

    Returns
    -------
    ndarray, shape (n,)
        Deployment times (s); (1,) when only scalars are given. +inf where the wing has not locked
        within `parameters.t_max`, also because its arms do not reach the lock. NaN, and no
        exception, where a sample is impossible (a value that is not finite; V_q < 0; a thickness,
        clearance or length not positive; a clearance not below R_b; lengths that do not assemble
        or that start beyond the lock; scales that `WingParameters` refuses). Motions too stiff for
        explicit steps are followed by implicit ones, see `uqfold.mechanism.stiff`.

    Raises
    ------
    ValueError
        If the shapes do not fit, `b` or `C_r` is given beside one of its parts, the tolerance is
        out of its bounds, or `threads` is below 1.
    TypeError
        If a name is none of those, or a value is not a number.

    Warns
    -----
    RuntimeWarning
        If even implicit steps could not follow a motion with its error under control.

    Examples
    --------
    >>> from uqfold.mechanism import WingParameters, deployment_times
    >>> times = deployment_times(WingParameters(C_r=0.0015), k_d=[200.0, 550.0])
    >>> [f"{t:.3f}" for t in times]
    ['inf', '0.536']
    """
    check_wing(parameters)
    tolerance = checked_tolerance(tolerance)
    if threads is None:
        threads = int(cast(Any, config).NUMBA_NUM_THREADS)
    else:
        threads = whole("threads", threads, at_least=1)
    wings = Wings(parameters, samples)
    times = np.empty(len(wings))
    even = -(-len(wings) // (_CHUNKS_PER_THREAD * threads))
    chunk = min(max(even, _SMALLEST_CHUNK), _LARGEST_CHUNK)
    starts = range(0, len(wings), chunk)

    def run(start: int) -> int:
        table = wings.table(start, start + chunk)
        found = times[start : start + chunk]
        deploy_lanes(table, tolerance, MAX_STEPS, found)
        n_rough = 0
        for i in np.flatnonzero(found == GIVEN_UP):
            found[i], rough, _ = deploy_stiff(table[i : i + 1], tolerance, NO_RECORD)
            n_rough += rough
        return n_rough

    if threads == 1 or len(starts) <= 1:
        n_rough = sum(map(run, starts))
    else:
        # The kernel gives up the interpreter's lock. A pool of plain threads keeps uneven samples
        # balanced and, unlike numba's own threads, may be entered by many callers and forked.
        with ThreadPoolExecutor(min(threads, len(starts))) as pool:
            n_rough = sum(pool.map(run, starts))
    if n_rough:
        warn_of_rough(n_rough, len(times))
    return times


def warn_of_rough(n_rough: int, n: int) -> None:
    """Warn of `n_rough` motions among `n` whose errors are not under control."""
    warnings.warn(
        f"{n_rough} of {n} motions vibrate too hard and fast to be followed: their deployment "
        "times are rough, without an error under control",
        RuntimeWarning,
        stacklevel=3,
    )


def checked_tolerance(tolerance: float) -> float:
    """Return the tolerance if time steps that keep to it follow the motion."""
    return real(
        "tolerance",
        tolerance,
        at_least=FINEST_TOLERANCE,
        at_most=COARSEST_TOLERANCE,
        what="number of metres",
    )


def check_wing(parameters: WingParameters) -> None:
    """Raise TypeError unless the parameters are those of a wing."""
    instance("parameters", parameters, WingParameters, "give WingParameters(...)")


@inlined
def _response(status: int, t: float) -> float:
    """Deployment time (s) of a wing whose motion has come to its end at time `t`."""
    if status == LOCKED:
        return t
    return math.inf if status == TIMED_OUT else GIVEN_UP


def _build_lanes(source: int) -> Callable[..., Any]:
    @entry_point
    def deploy_lanes(wings, tolerance, max_steps, times):  # type: ignore[no-untyped-def]
        """Fill `times` (n,) for the table of `wings` (n,), a lane per wing.

        A lane whose wing has come to its end takes the next one; when there is none, it takes
        over the last lane, so that the lanes in use are always the first ones.
        """
        limit = float(max_steps + 0 * source)  # source matters as a part of the cache key only
        constants = np.zeros(CONSTANT_ROWS * LANES)
        states = np.zeros(STATE_ROWS * LANES)
        ends = np.zeros(STATE_ROWS * LANES)
        control = np.zeros(CONTROL_ROWS * LANES)
        rows = np.zeros(LANES, np.int64)
        # numba would compile what is called with a literal 0 for it alone
        none: Any = np.int64(0)
        taken = none
        active = none
        while True:
            while active < LANES and taken < len(wings):
                p = wings[taken]
                if is_possible(p):
                    start_lane(p, constants, states, control, active)
                    rows[active] = taken
                    active += 1
                else:
                    times[taken] = math.nan
                taken += 1
            if active == 0:
                return
            step_lanes(constants, states, ends, control, active, limit, tolerance)
            i = none
            while i < active:
                status = RUNNING
                if is_marked(control, i):
                    status = look_closer(constants, states, ends, control, i, limit)
                if status == RUNNING:
                    i += 1
                else:
                    times[rows[i]] = _response(status, ends[TIME * LANES + i])
                    active -= 1
                    rows[i] = rows[active]
                    for array in (constants, states, ends, control):
                        move_lane(array, active, i)
            states, ends = ends, states

    return deploy_lanes


def _build_rows(source: int) -> Callable[..., Any]:
    @entry_point
    def deploy_rows(wings, tolerance, times, record):  # type: ignore[no-untyped-def]
        """Fill `times` (n,) for the table of `wings` (n,), and `record` with the last one's steps.

        Returns the number of time steps of the last wing; `record` (m, RECORD_WIDTH) takes the
        first m points of the motion, from the initial one on.
        """
        steps = 0 * source  # source matters as a part of the cache key only
        for i in range(len(wings)):
            p = wings[i]
            if not is_possible(p):
                times[i] = math.nan
                continue
            w = wing_constants(p)
            state = initial_state(w, initial_pose(p))
            h = FIRST_STEP
            status = RUNNING
            steps = 0
            while True:
                write_point(record, steps, state)
                if status != RUNNING or steps == MAX_STEPS:
                    break
                state, h, status = advance(w, state, h, tolerance)
                steps += 1
            times[i] = _response(status, state.t)
        return steps

    return deploy_rows


deploy_lanes = _build_lanes(fingerprint())
deploy_rows = _build_rows(fingerprint())
