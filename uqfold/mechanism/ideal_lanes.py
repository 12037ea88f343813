"""Time loop of wings with ideal joints, side by side in lanes.

Each lane has its own time steps. The loop over the lanes has no branch, so that the compiler turns
it into vector instructions; what happens in few time steps only is seen to lane by lane.
"""

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from uqfold.mechanism.closed_loop import Five, IdealWing, rates, slider, step
from uqfold.mechanism.compiled import inlined, kernel
from uqfold.mechanism.events import NOT_IN_STEP, quintic
from uqfold.mechanism.lane_rows import LANES, lane_access, row_count
from uqfold.mechanism.loads import next_drive_corner
from uqfold.mechanism.wing import Wing, wing_constants

_STEP_AFTER_CORNER = 0.04
_LARGEST_STEP = 0.1
_SMALLEST_STEP = 1e-12
_MAX_STEPS = 100_000


class Motion(NamedTuple):
    """State of a wing and its rates."""

    state: Five
    rates: Five


# Rows of the table of lanes: the wing; time, next step, next corner of the drive, step taken and
# whether to look closer; motion now and before the step taken.
_T, _H, _CORNER, _TAKEN, _LOOK = range(row_count(IdealWing), row_count(IdealWing) + 5)
_NOW = _LOOK + 1
_BEFORE = _NOW + row_count(Motion)
_ROWS = _BEFORE + row_count(Motion)

_wing, _put_wing = lane_access(IdealWing)
_motion, _put_motion = lane_access(Motion)


@kernel
def resting_lanes() -> NDArray[np.float64]:
    """Table of lanes (ROWS * LANES,) in which no wing moves."""
    lanes = np.ones(_ROWS * LANES)
    for j in range(LANES):
        lanes[_H * LANES + j] = 0.0
    return lanes


@kernel
def start_lane(p: Wing, lanes: NDArray[np.float64], j: int) -> None:
    """Fill lane `j` with a wing at rest."""
    w = wing_constants(p)
    wing = IdealWing(
        l_1=w.l_1,
        l_2=2.0 * w.half_l_2,
        J_A=1.0 / w.inverse_J_A,
        J_2=1.0 / w.inverse_J_2,
        m_2=1.0 / w.inverse_m_2,
        m_3=1.0 / w.inverse_m_3,
        D_1=w.D_1,
        D_2=w.D_2,
        G_1=w.G_1,
        G_2=w.G_2,
        G_3=w.G_3,
        k_d=w.k_d,
    )
    _put_wing(lanes, j, wing)
    lanes[_T * LANES + j] = 0.0
    corner = next_drive_corner(0.0, p.t_max)
    lanes[_CORNER * LANES + j] = corner
    lanes[_H * LANES + j] = corner
    # the slider on the side nearer to A, as in `initial_pose`
    s_1 = math.sin(p.theta_1_initial)
    s_2 = (p.l_1 * s_1 + p.c) / p.l_2
    y = (math.cos(p.theta_1_initial), s_1, math.sqrt(1.0 - s_2 * s_2), s_2, 0.0)
    _put_motion(lanes, _NOW * LANES + j, Motion(y, rates(wing, y, 0.0)))


@kernel
def _slider(lanes: NDArray[np.float64], motion: int, j: int) -> tuple[float, float, float]:
    """Return position, velocity and acceleration of the slider; `motion` is _NOW or _BEFORE."""
    m = _motion(lanes, motion * LANES + j)
    return slider(_wing(lanes, j), m.state, m.rates[4])


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
        start = _motion(lanes, _NOW * LANES + j)
        t = lanes[_T * LANES + j]
        h = lanes[_H * LANES + j]
        end, end_rates, error = step(wing, start.state, start.rates, t, h, c)
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
        now = Motion(_chosen(kept, end, start.state), _chosen(kept, end_rates, start.rates))
        _put_motion(lanes, _BEFORE * LANES + j, start)
        _put_motion(lanes, _NOW * LANES + j, now)
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
    end = _slider(lanes, _NOW, j)
    if end[0] >= x_lock or end[1] < 0.0:
        s = _lock_fraction(_slider(lanes, _BEFORE, j), end, taken, x_lock)
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
