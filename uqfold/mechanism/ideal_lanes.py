"""Time loop of wings with ideal joints, side by side in lanes.

Each lane has its own time steps. The loop over the lanes has no branch, so that the compiler turns
it into vector instructions; what happens in few time steps only is seen to lane by lane.
"""

import math

import numpy as np
from numpy.typing import NDArray

from uqfold.mechanism.closed_loop import Five, Wing, rates, slider, step
from uqfold.mechanism.compiled import inlined, kernel
from uqfold.mechanism.events import NOT_IN_STEP, quintic
from uqfold.mechanism.loads import next_drive_corner
from uqfold.mechanism.wing import SampleParameters, SharedParameters, wing_constants

LANES = 32
"""Wings that advance side by side."""

_STEP_AFTER_CORNER = 0.04
_LARGEST_STEP = 0.1
_SMALLEST_STEP = 1e-12
_MAX_STEPS = 100_000

# Rows of the table of lanes: the wing; time, next step, next corner of the drive, step taken and
# whether to look closer; state and rates, now and before the step taken.
_L_1, _L_2, _J_A, _J_2, _M_2, _M_3, _D_1, _D_2, _G_1, _G_2, _G_3, _K_D = range(12)
_T, _H, _CORNER, _TAKEN, _LOOK = 12, 13, 14, 15, 16
_STATE, _RATE, _OLD_STATE, _OLD_RATE = 17, 22, 27, 32
_ROWS = 37


@inlined
def _five(lanes: NDArray[np.float64], row: int, j: int) -> Five:
    """Five numbers of lane `j`."""
    k = row * LANES + j
    return (
        lanes[k],
        lanes[k + LANES],
        lanes[k + 2 * LANES],
        lanes[k + 3 * LANES],
        lanes[k + 4 * LANES],
    )


@inlined
def _set_five(lanes: NDArray[np.float64], row: int, j: int, x: Five) -> None:
    """Set five numbers of lane `j`."""
    k = row * LANES + j
    lanes[k] = x[0]
    lanes[k + LANES] = x[1]
    lanes[k + 2 * LANES] = x[2]
    lanes[k + 3 * LANES] = x[3]
    lanes[k + 4 * LANES] = x[4]


@inlined
def _wing(lanes: NDArray[np.float64], j: int) -> Wing:
    """The wing of lane `j`."""
    return (
        lanes[_L_1 * LANES + j],
        lanes[_L_2 * LANES + j],
        lanes[_J_A * LANES + j],
        lanes[_J_2 * LANES + j],
        lanes[_M_2 * LANES + j],
        lanes[_M_3 * LANES + j],
        lanes[_D_1 * LANES + j],
        lanes[_D_2 * LANES + j],
        lanes[_G_1 * LANES + j],
        lanes[_G_2 * LANES + j],
        lanes[_G_3 * LANES + j],
        lanes[_K_D * LANES + j],
    )


@kernel
def resting_lanes() -> NDArray[np.float64]:
    """Table of lanes (ROWS * LANES,) in which no wing moves."""
    lanes = np.ones(_ROWS * LANES)
    for j in range(LANES):
        lanes[_H * LANES + j] = 0.0
    return lanes


@kernel
def start_lane(
    f: SharedParameters, p: SampleParameters, lanes: NDArray[np.float64], j: int
) -> None:
    """Fill lane `j` with a wing at rest."""
    w = wing_constants(f, p)
    lanes[_L_1 * LANES + j] = w.l_1
    lanes[_L_2 * LANES + j] = 2.0 * w.half_l_2
    lanes[_J_A * LANES + j] = 1.0 / w.inverse_J_A
    lanes[_J_2 * LANES + j] = 1.0 / w.inverse_J_2
    lanes[_M_2 * LANES + j] = 1.0 / w.inverse_m_2
    lanes[_M_3 * LANES + j] = 1.0 / w.inverse_m_3
    lanes[_D_1 * LANES + j] = w.D_1
    lanes[_D_2 * LANES + j] = w.D_2
    lanes[_G_1 * LANES + j] = w.G_1
    lanes[_G_2 * LANES + j] = w.G_2
    lanes[_G_3 * LANES + j] = w.G_3
    lanes[_K_D * LANES + j] = w.k_d
    lanes[_T * LANES + j] = 0.0
    corner = next_drive_corner(0.0, f.t_max)
    lanes[_CORNER * LANES + j] = corner
    lanes[_H * LANES + j] = corner
    # the slider on the side nearer to A, as in `initial_pose`
    s_1 = math.sin(f.theta_1_initial)
    s_2 = (p.l_1 * s_1 + f.c) / p.l_2
    y = (math.cos(f.theta_1_initial), s_1, math.sqrt(1.0 - s_2 * s_2), s_2, 0.0)
    _set_five(lanes, _STATE, j, y)
    _set_five(lanes, _RATE, j, rates(_wing(lanes, j), y, 0.0))


@kernel
def _slider(lanes: NDArray[np.float64], state: int, j: int) -> tuple[float, float, float]:
    """Position, velocity and acceleration of the slider; `state` is _STATE or _OLD_STATE."""
    w_rate = lanes[(state + 9) * LANES + j]
    return slider(_wing(lanes, j), _five(lanes, state, j), w_rate)


@kernel
def _lock_fraction(
    start: tuple[float, float, float], end: tuple[float, float, float], h: float, x_lock: float
) -> float:
    """Fraction of a step at which the slider first reaches the lock; NOT_IN_STEP if it does not."""
    high = 1.0
    if end[0] < x_lock:
        # it may pass the lock and come back within the step
        if not start[1] > 0.0 > end[1]:
            return NOT_IN_STEP
        high = start[1] / (start[1] - end[1])
        if quintic(*start, *end, h, high)[0] < x_lock:
            return NOT_IN_STEP
    low = 0.0
    s = 0.5 * high
    for _ in range(60):
        x, v = quintic(*start, *end, h, s)
        if x < x_lock:
            low = s
        else:
            high = s
        last = s
        s = s - (x - x_lock) / (v * h) if v != 0.0 else low
        if not low <= s <= high:
            s = 0.5 * (low + high)
        # Newton's next correction would be of the order of the square
        if abs(s - last) <= 1e-7:
            break
    return s


@inlined
def _chosen(choice: bool, x: Five, y: Five) -> Five:
    """Return x if `choice`, else y."""
    return (
        x[0] if choice else y[0],
        x[1] if choice else y[1],
        x[2] if choice else y[2],
        x[3] if choice else y[3],
        x[4] if choice else y[4],
    )


@kernel
def _advance(lanes: NDArray[np.float64], c: float, x_lock: float, tolerance: float) -> None:
    """Try one step in every lane, keep it where its error is small enough, and set LOOK.

    LOOK is 1 where more may have happened than a step, else 0. A lane whose step is 0 rests. No
    branch and no call may enter this loop.
    """
    for j in range(LANES):
        wing = _wing(lanes, j)
        y = _five(lanes, _STATE, j)
        start_rates = _five(lanes, _RATE, j)
        t = lanes[_T * LANES + j]
        h = lanes[_H * LANES + j]
        end, end_rates, error = step(wing, y, start_rates, t, h, c)
        kept = error <= tolerance
        # roots on the careful side of the fifth; the motion gets faster all the time, so a step
        # that has only just passed is no reason for a longer one; NaN gives 0.1
        factor = math.sqrt(math.sqrt(tolerance / error))
        factor = 0.8 * (math.sqrt(factor) if factor > 1.0 else factor)
        factor = factor if factor > 0.1 else 0.1
        factor = factor if factor < 5.0 else 5.0
        h_next = factor * h
        h_next = h_next if h_next < _LARGEST_STEP else _LARGEST_STEP
        taken = h if kept else 0.0
        left = lanes[_CORNER * LANES + j] - (t + taken)
        # two equal steps up to a corner rather than a long and a tiny one
        h_next = h_next if left > 2.0 * h_next else (0.5 * left if left > h_next else left)
        _set_five(lanes, _OLD_STATE, j, y)
        _set_five(lanes, _OLD_RATE, j, start_rates)
        _set_five(lanes, _STATE, j, _chosen(kept, end, y))
        _set_five(lanes, _RATE, j, _chosen(kept, end_rates, start_rates))
        lanes[_T * LANES + j] = t + taken
        lanes[_TAKEN * LANES + j] = taken
        lanes[_H * LANES + j] = h_next if h > 0.0 else 0.0
        x_3, v_3, _ = slider(wing, end, end_rates[4])
        at_lock = (x_3 >= x_lock) | (v_3 < 0.0)
        look = (h > 0.0) & (at_lock | (left <= _SMALLEST_STEP) | (h_next < _SMALLEST_STEP))
        lanes[_LOOK * LANES + j] = 1.0 if look else 0.0


@kernel
def _look(lanes: NDArray[np.float64], j: int, x_lock: float, t_max: float) -> tuple[bool, float]:
    """Whether the motion of lane `j` is over after a step, and its deployment time."""
    t = lanes[_T * LANES + j]
    taken = lanes[_TAKEN * LANES + j]
    h = lanes[_H * LANES + j]
    if taken == 0.0:
        return h < _SMALLEST_STEP, math.nan
    end = _slider(lanes, _STATE, j)
    if end[0] >= x_lock or end[1] < 0.0:
        s = _lock_fraction(_slider(lanes, _OLD_STATE, j), end, taken, x_lock)
        if s < NOT_IN_STEP:
            return True, t - (1.0 - s) * taken
    corner = lanes[_CORNER * LANES + j]
    if corner - t <= _SMALLEST_STEP:
        if corner >= t_max:
            return True, math.inf
        t = corner
        corner = next_drive_corner(t, t_max)
        lanes[_T * LANES + j] = t
        lanes[_CORNER * LANES + j] = corner
        lanes[_H * LANES + j] = min(_STEP_AFTER_CORNER, corner - t)
    return False, math.nan


@kernel
def follow(
    lanes: NDArray[np.float64],
    times: NDArray[np.float64],
    moving: int,
    c: float,
    x_lock: float,
    t_max: float,
    tolerance: float,
) -> None:
    """Advance all lanes until none is `moving` any more, and note their times (NaN so far)."""
    for _ in range(_MAX_STEPS):
        if moving == 0:
            break
        _advance(lanes, c, x_lock, tolerance)
        for j in range(times.shape[0]):
            if lanes[_LOOK * LANES + j] == 0.0:
                continue
            over, time = _look(lanes, j, x_lock, t_max)
            if over:
                times[j] = time
                lanes[_H * LANES + j] = 0.0
                moving -= 1
