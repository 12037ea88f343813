"""Deployment times of a batch of wings, and the one time loop that every result comes from."""

import math
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from typing import Any, cast

import numpy as np
from numba import config
from numpy.typing import ArrayLike, NDArray

from uqfold.mechanism.compiled import entry_point, fingerprint
from uqfold.mechanism.parameters import WingParameters
from uqfold.mechanism.timestep import (
    FIRST_STEP,
    LOCKED,
    RUNNING,
    TIMED_OUT,
    advance,
    initial_state,
)
from uqfold.mechanism.wing import (
    SampleParameters,
    initial_pose,
    is_possible,
    shared_parameters,
    wing_constants,
)

FloatArray = NDArray[np.float64]

DEFAULT_TOLERANCE = 1e-6
"""Local error allowed per time step (m)."""

MAX_STEPS = 2_000_000
"""Time steps after which an integration counts as failed; a deployment takes about 1,000."""

RECORD_WIDTH = 18
"""Numbers recorded per time step: t, q (5), v (5), a (5), damping of the contacts of B and C."""

# Few enough samples to share the work evenly, enough to hide the Python around them.
_CHUNK = 32


def deployment_times(
    parameters: WingParameters,
    *,
    V_q: ArrayLike | None = None,
    delta: ArrayLike | None = None,
    k_d: ArrayLike | None = None,
    b: ArrayLike | None = None,
    C_r: ArrayLike | None = None,
    l_1: ArrayLike | None = None,
    l_2: ArrayLike | None = None,
    tolerance: float = DEFAULT_TOLERANCE,
    threads: int | None = None,
) -> FloatArray:
    """Deployment times of a batch of wings: the response of Eq. (21).

    Parameters
    ----------
    parameters : WingParameters
        Values of all parameters that are not given per sample.
    V_q, delta, k_d, b, C_r, l_1, l_2 : array_like, shape (n,) or scalar, optional
        Values per sample in SI units (m/s, rad, N, m, m, m, m), in place of those in `parameters`.
    tolerance : float, optional
        Local error allowed per time step (m), in the position of the joints.
    threads : int, optional
        Number of threads; by default the cores at hand, or NUMBA_NUM_THREADS. The result of a
        sample depends neither on it nor on the place of the sample in the batch.

    Returns
    -------
    ndarray, shape (n,)
        Deployment times (s); (1,) when only scalars are given. +inf where the wing has not locked
        within `parameters.t_max`, also because its arms do not reach the lock. NaN, and no
        exception, where a sample is impossible (a value that is not finite; V_q < 0; b, C_r, l_1
        or l_2 not positive; C_r >= R_b; lengths that do not assemble or that start beyond the
        lock), or where the integration fails or exceeds `MAX_STEPS`.

    Raises
    ------
    ValueError
        If the shapes do not fit, the tolerance is not positive, or `threads` is below 1.

    Examples
    --------
    >>> from uqfold.mechanism import WingParameters, deployment_times
    >>> times = deployment_times(WingParameters(C_r=0.0015), k_d=[200.0, 550.0])
    >>> [f"{t:.3f}" for t in times]
    ['inf', '0.536']
    """
    check_tolerance(tolerance)
    if threads is None:
        threads = int(cast(Any, config).NUMBA_NUM_THREADS)
    if threads < 1:
        raise ValueError(f"threads = {threads} is not positive: give at least 1, or None")
    given = dict(zip(SampleParameters._fields, (V_q, delta, k_d, b, C_r, l_1, l_2), strict=True))
    samples = _table(parameters, given)
    shared = shared_parameters(parameters)
    times = np.empty(len(samples))
    starts = range(0, len(samples), _CHUNK)

    def run(start: int) -> None:
        rows = slice(start, start + _CHUNK)
        deploy_rows(shared, samples[rows], float(tolerance), times[rows], _NO_RECORD)

    if threads == 1 or len(starts) <= 1:
        for start in starts:
            run(start)
    else:
        # The kernel gives up the interpreter's lock. A pool of plain threads keeps uneven samples
        # balanced and, unlike numba's own threads, may be entered by many callers and forked.
        with ThreadPoolExecutor(min(threads, len(starts))) as pool:
            list(pool.map(run, starts))
    return times


def check_tolerance(tolerance: float) -> None:
    """Raise ValueError unless the tolerance is positive and finite."""
    if not 0 < tolerance < math.inf:
        raise ValueError(
            f"tolerance = {tolerance} is no local error: give a positive number of metres"
        )


def _table(parameters: WingParameters, given: dict[str, ArrayLike | None]) -> FloatArray:
    """Samples as rows, with the columns of `SampleParameters`."""
    columns = {}
    for name, values in given.items():
        column = np.asarray(getattr(parameters, name) if values is None else values, dtype=float)
        if column.ndim > 1:
            raise ValueError(
                f"{name} has shape {column.shape}: give a scalar or an array of shape (n,)"
            )
        columns[name] = np.atleast_1d(column)
    lengths = {name: len(column) for name, column in columns.items() if len(column) != 1}
    if len(set(lengths.values())) > 1:
        raise ValueError(f"the lengths differ, {lengths}: give scalars or arrays of one length")
    return np.column_stack(np.broadcast_arrays(*columns.values()))


def _build(source: int) -> Callable[..., Any]:
    @entry_point
    def deploy_rows(shared, samples, tolerance, times, record):  # type: ignore[no-untyped-def]
        """Fill `times` (n,) for the `samples` (n, 7), and `record` with the last one's time steps.

        Returns the number of time steps of the last sample; `record` (m, RECORD_WIDTH) takes the
        first m points of the motion, from the initial one on.
        """
        steps = 0 * source  # source matters as a part of the cache key only
        for i in range(samples.shape[0]):
            row = samples[i]
            p = SampleParameters(row[0], row[1], row[2], row[3], row[4], row[5], row[6])
            if not is_possible(shared, p):
                times[i] = math.nan
                continue
            w = wing_constants(shared, p)
            state = initial_state(w, initial_pose(shared, p))
            h = FIRST_STEP
            status = RUNNING
            steps = 0
            while True:
                if steps < record.shape[0]:
                    point = record[steps]
                    point[0] = state.t
                    for k in range(5):
                        point[1 + k] = state.q[k]
                        point[6 + k] = state.v[k]
                        point[11 + k] = state.a[k]
                    point[16] = state.damping_B
                    point[17] = state.damping_C
                if status != RUNNING or steps == MAX_STEPS:
                    break
                state, h, status = advance(w, state, h, tolerance)
                steps += 1
            if status == LOCKED:
                times[i] = state.t
            elif status == TIMED_OUT:
                times[i] = math.inf
            else:
                times[i] = math.nan
        return steps

    return deploy_rows


_NO_RECORD = np.empty((0, RECORD_WIDTH))
deploy_rows = _build(fingerprint())
