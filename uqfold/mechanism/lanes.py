"""Time steps of many wings side by side, in packed instructions.

Structure of arrays: an array holds rows of `LANES` numbers, one row per quantity and one lane per
wing; row k of lane i is element k * LANES + i. With that layout known when `step` is compiled, the
compiler packs the lanes of one loop, which runs the very time step of the scalar form. Additions
and multiplications stay separate and in order, so a lane computes the same bits as the scalar form,
wherever it lies and however wide the machine's instructions are.

What happens in few time steps only (rejection, contact onset and loss, corners of the drive, lock)
is marked in the loop and then seen to lane by lane in scalar code.
"""

import numpy as np
from numpy.typing import NDArray

from uqfold.mechanism.compiled import inlined, kernel
from uqfold.mechanism.events import State, may_switch
from uqfold.mechanism.loads import next_drive_corner
from uqfold.mechanism.motion import Five, Four
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
from uqfold.mechanism.wing import (
    SampleParameters,
    SharedParameters,
    WingConstants,
    initial_pose,
    wing_constants,
)

FloatArray = NDArray[np.float64]

LANES = 32
"""Wings that advance side by side; two sets of states and the constants fit a level 1 cache."""

GROUP = 4
"""Lanes advance in groups of this size, which fill packed instructions of 256 bits."""

CONSTANT_ROWS = len(WingConstants._fields)

# Rows of the states, in the order of State.
TIME, _Q, _V, _A, _D, _GAPS, _DAMPING_B, _DAMPING_C = 0, 1, 6, 11, 16, 20, 24, 25
STATE_ROWS = 26

# Rows of the control of the time step: step to try (s), its largest growth, next corner of the
# drive (s); and of the last step its length (s), error, mark (1 needs a closer look), count.
_H, _GROWTH, _CORNER, _TAKEN, _ERROR, _MARK, _COUNT = range(7)
CONTROL_ROWS = 7


# Elements are passed as sums, not as row and lane: numba compiles a function anew for every literal
# number that it is called with.


@inlined
def _four(x: FloatArray, j: int) -> Four:
    """Element j and those of the same lane in the next three rows."""
    return x[j], x[j + LANES], x[j + 2 * LANES], x[j + 3 * LANES]


@inlined
def _five(x: FloatArray, j: int) -> Five:
    """Element j and those of the same lane in the next four rows."""
    return x[j], x[j + LANES], x[j + 2 * LANES], x[j + 3 * LANES], x[j + 4 * LANES]


@inlined
def _put_four(x: FloatArray, j: int, values: Four) -> None:
    """Set element j and those of the same lane in the next three rows."""
    x[j] = values[0]
    x[j + LANES] = values[1]
    x[j + 2 * LANES] = values[2]
    x[j + 3 * LANES] = values[3]


@inlined
def _put_five(x: FloatArray, j: int, values: Five) -> None:
    """Set element j and those of the same lane in the next four rows."""
    x[j] = values[0]
    x[j + LANES] = values[1]
    x[j + 2 * LANES] = values[2]
    x[j + 3 * LANES] = values[3]
    x[j + 4 * LANES] = values[4]


@inlined
def _wing(constants: FloatArray, i: int) -> WingConstants:
    """Wing of lane i; the rows are in the order of the fields."""
    c_0, c_1, c_2, c_3, c_4 = _five(constants, i)
    c_5, c_6, c_7, c_8, c_9 = _five(constants, 5 * LANES + i)
    c_10, c_11, c_12, c_13, c_14 = _five(constants, 10 * LANES + i)
    c_15, c_16, c_17, c_18, c_19 = _five(constants, 15 * LANES + i)
    c_20, c_21, material, c_23, c_24 = _five(constants, 20 * LANES + i)
    c_25, c_26, c_27, c_28, c_29 = _five(constants, 25 * LANES + i)
    return WingConstants(
        c_0, c_1, c_2, c_3, c_4, c_5, c_6, c_7, c_8, c_9, c_10,
        c_11, c_12, c_13, c_14, c_15, c_16, c_17, c_18, c_19, c_20,
        c_21, material != 0.0, c_23, c_24, c_25, c_26, c_27, c_28, c_29, constants[30 * LANES + i],
    )  # fmt: skip


@inlined
def _put_wing(constants: FloatArray, i: int, w: WingConstants) -> None:
    """Put a wing in lane i."""
    _put_five(constants, i, w[0:5])
    _put_five(constants, 5 * LANES + i, w[5:10])
    _put_five(constants, 10 * LANES + i, w[10:15])
    _put_five(constants, 15 * LANES + i, w[15:20])
    _put_five(constants, 20 * LANES + i, (w[20], w[21], 1.0 if w.material else 0.0, w[23], w[24]))
    _put_five(constants, 25 * LANES + i, w[25:30])
    constants[30 * LANES + i] = w[30]


@inlined
def _state(states: FloatArray, i: int) -> State:
    """State of lane i."""
    return State(
        states[TIME * LANES + i],
        _five(states, _Q * LANES + i),
        _five(states, _V * LANES + i),
        _five(states, _A * LANES + i),
        _four(states, _D * LANES + i),
        _four(states, _GAPS * LANES + i),
        states[_DAMPING_B * LANES + i],
        states[_DAMPING_C * LANES + i],
    )


@inlined
def _put_state(states: FloatArray, i: int, state: State) -> None:
    """Put a state in lane i."""
    states[TIME * LANES + i] = state.t
    _put_five(states, _Q * LANES + i, state.q)
    _put_five(states, _V * LANES + i, state.v)
    _put_five(states, _A * LANES + i, state.a)
    _put_four(states, _D * LANES + i, state.d)
    _put_four(states, _GAPS * LANES + i, state.gaps)
    states[_DAMPING_B * LANES + i] = state.damping_B
    states[_DAMPING_C * LANES + i] = state.damping_C


@kernel
def start_lane(
    shared: SharedParameters,
    sample: SampleParameters,
    constants: FloatArray,
    states: FloatArray,
    control: FloatArray,
    i: int,
) -> None:
    """Put a wing at rest in lane i."""
    w = wing_constants(shared, sample)
    _put_wing(constants, i, w)
    _put_state(states, i, initial_state(w, initial_pose(shared, sample)))
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
    """Whether the last time step of lane i needs a closer look."""
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
