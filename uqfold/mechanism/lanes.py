"""Time steps of many wings side by side, in packed instructions.

The compiler packs the lanes of one loop (see `uqfold.mechanism.lane_rows`), which runs the very
time step of the scalar form. Additions and multiplications stay separate and in order, so a lane
computes the same bits as the scalar form on the same processor, wherever it lies and however wide
the instructions are.

What happens in few time steps only (rejection, contact onset and loss, corners of the drive, lock)
is marked in the loop and then seen to lane by lane in scalar code.
"""

import numpy as np
from numpy.typing import NDArray

from uqfold.mechanism.compiled import inlined, kernel
from uqfold.mechanism.events import State, may_switch
from uqfold.mechanism.lane_rows import LANES, lane_access, row_count, rows_of
from uqfold.mechanism.loads import next_drive_corner
from uqfold.mechanism.timestep import (
    FAILED,
    FIRST_STEP,
    LARGEST_GROWTH,
    RUNNING,
    SMALLEST_STEP,
    attempt,
    initial_state,
    settle,
    shortened,
)
from uqfold.mechanism.wing import Wing, WingConstants, initial_pose, wing_constants

FloatArray = NDArray[np.float64]

GROUP = 4
"""Lanes advance in groups of this size, which fill packed instructions of 256 bits."""

CONSTANT_ROWS = row_count(WingConstants)
STATE_ROWS = row_count(State)
TIME = rows_of(State)["t"].start
"""Row of the time (s) in the states."""

# Rows of the control of the time step: step to try (s), its largest growth, next corner of the
# drive (s); and of the last step its length (s), error, mark (1 needs a closer look), count.
_H, _GROWTH, _CORNER, _TAKEN, _ERROR, _MARK, _COUNT = range(7)
CONTROL_ROWS = 7


_wing, _put_wing = lane_access(WingConstants)
_state, _put_state = lane_access(State)


@kernel
def start_lane(
    p: Wing,
    constants: FloatArray,
    states: FloatArray,
    control: FloatArray,
    i: int,
) -> None:
    """Put a wing at rest in lane i."""
    w = wing_constants(p)
    _put_wing(constants, i, w)
    _put_state(states, i, initial_state(w, initial_pose(p)))
    control[_H * LANES + i] = FIRST_STEP
    control[_GROWTH * LANES + i] = LARGEST_GROWTH
    control[_CORNER * LANES + i] = next_drive_corner(0.0, w.t_max)
    control[_COUNT * LANES + i] = 0.0


@kernel
def step_lanes(
    constants: FloatArray,
    states: FloatArray,
    ends: FloatArray,
    control: FloatArray,
    active: int,
    max_steps: float,
    tolerance: float,
) -> None:
    """Try one time step in the first `active` lanes, rounded up to whole groups.

    Lanes that need a closer look are marked: see `is_marked` and `look_closer`.

    Parameters
    ----------
    constants, states, control : ndarray
        Wings, their states, and the control of their time steps.
    ends : ndarray
        Filled with the states after the step.
    active : int
        Number of lanes in use.
    max_steps : float
        Lanes that have taken so many time steps are marked.
    tolerance : float
        Local error allowed per step (m).
    """
    for i in range((active + GROUP - 1) // GROUP * GROUP):
        w = _wing(constants, i)
        start = _state(states, i)
        tried = attempt(
            w,
            start,
            control[_H * LANES + i],
            control[_GROWTH * LANES + i],
            control[_CORNER * LANES + i],
            tolerance,
        )
        end = tried.end
        _put_state(ends, i, end)
        count = control[_COUNT * LANES + i] + 1.0
        g_0, r_0, g_1, r_1 = start.gaps
        g_2, r_2, g_3, r_3 = end.gaps
        marked = (
            (not tried.error <= 1.0)
            | may_switch(g_0, r_0, g_2, r_2, tried.taken, start.damping_B)
            | may_switch(g_1, r_1, g_3, r_3, tried.taken, start.damping_C)
            | (end.q[4] >= w.x_lock)
            | tried.lands
            | (count >= max_steps)
        )
        control[_H * LANES + i] = tried.h
        control[_GROWTH * LANES + i] = LARGEST_GROWTH
        control[_TAKEN * LANES + i] = tried.taken
        control[_ERROR * LANES + i] = tried.error
        control[_MARK * LANES + i] = 1.0 if marked else 0.0
        control[_COUNT * LANES + i] = count


@inlined
def is_marked(control: FloatArray, i: int) -> bool:
    """Return whether the last time step of lane i needs a closer look."""
    return bool(control[_MARK * LANES + i] != 0.0)


@kernel
def look_closer(
    constants: FloatArray,
    states: FloatArray,
    ends: FloatArray,
    control: FloatArray,
    i: int,
    max_steps: float,
) -> int:
    """Reject the last time step of lane i, or cut it at an event; return the lane's status.

    The arguments are those of `step_lanes`.
    """
    taken = control[_TAKEN * LANES + i]
    error = control[_ERROR * LANES + i]
    start = _state(states, i)
    if not error <= 1.0:
        h = shortened(taken, error)
        control[_H * LANES + i] = h
        control[_GROWTH * LANES + i] = 1.0
        control[_COUNT * LANES + i] -= 1.0
        _put_state(ends, i, start)
        return FAILED if h < SMALLEST_STEP else RUNNING
    w = _wing(constants, i)
    state, status = settle(w, start, _state(ends, i), taken)
    _put_state(ends, i, state)
    control[_CORNER * LANES + i] = next_drive_corner(state.t, w.t_max)
    if status == RUNNING and control[_COUNT * LANES + i] >= max_steps:
        return FAILED
    return status


@kernel
def move_lane(array: FloatArray, i: int, j: int) -> None:
    """Put in lane j what is in lane i."""
    for k in range(0, len(array), LANES):
        array[k + j] = array[k + i]
