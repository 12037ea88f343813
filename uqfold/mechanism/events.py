"""Motion within a time step, and the instants at which a contact begins or ends or the wing locks.

A step is computed as if nothing happened in it; what did happen is found afterwards on the
polynomial through both ends of the step, and the step is cut there.
"""

from typing import NamedTuple, cast

import numpy as np

from uqfold.mechanism.compiled import inlined, kernel
from uqfold.mechanism.motion import Five, Four, gaps, turned
from uqfold.mechanism.wing import WingConstants

# Of numpy's type, since numba compiles a function anew for every literal number it is called with.
JOINT_B, JOINT_C, LOCK = cast("list[int]", np.arange(3))

NOT_IN_STEP = 2.0
"""Fraction returned for an event that the step does not contain."""

# Events are located to this distance (m), far below the micrometres of a real penetration.
_LOCATED = 1e-13
# A contact that begins and ends within a step, or opens for a moment, counts from this depth (m).
_GRAZING = 1e-10
_MAX_ITERATIONS = 60
_GUESS_ITERATIONS = 4


class State(NamedTuple):
    """Where the motion stands.

    Time (s), coordinates, velocities, accelerations, directions, contact functions of both joints
    (see `gaps`), and the damping of each contact (s/m), negative while there is none.
    """

    t: float
    q: Five
    v: Five
    a: Five
    d: Four
    gaps: Four
    damping_B: float
    damping_C: float


class Step(NamedTuple):
    """A time step `h` (s) from `start`: coordinates, velocities, accelerations, gaps at its end."""

    start: State
    h: float
    q: Five
    v: Five
    a: Five
    gaps: Four


@inlined
def quintic(
    q: float, v: float, a: float, q_1: float, v_1: float, a_1: float, h: float, s: float
) -> tuple[float, float]:
    """Value and rate at fraction `s` of the quintic with these values and two rates at the ends."""
    d_0 = q_1 - q - h * (v + 0.5 * h * a)
    d_1 = h * (v_1 - v - h * a)
    d_2 = 0.5 * h * h * (a_1 - a)
    c_3 = 10.0 * d_0 - 4.0 * d_1 + d_2
    c_4 = -15.0 * d_0 + 7.0 * d_1 - 2.0 * d_2
    c_5 = 6.0 * d_0 - 3.0 * d_1 + d_2
    value = q + s * (h * v + s * (0.5 * h * h * a + s * (c_3 + s * (c_4 + s * c_5))))
    rate = v + s * (h * a + s * (3.0 * c_3 + s * (4.0 * c_4 + s * 5.0 * c_5)) / h)
    return value, rate


@kernel
def within(step: Step, s: float) -> tuple[Five, Five]:
    """Coordinates and velocities at the fraction `s` of a step."""
    _, q, v, a, _, _, _, _ = step.start
    x_0, v_0 = quintic(q[0], v[0], a[0], step.q[0], step.v[0], step.a[0], step.h, s)
    x_1, v_1 = quintic(q[1], v[1], a[1], step.q[1], step.v[1], step.a[1], step.h, s)
    x_2, v_2 = quintic(q[2], v[2], a[2], step.q[2], step.v[2], step.a[2], step.h, s)
    x_3, v_3 = quintic(q[3], v[3], a[3], step.q[3], step.v[3], step.a[3], step.h, s)
    x_4, v_4 = quintic(q[4], v[4], a[4], step.q[4], step.v[4], step.a[4], step.h, s)
    return (x_0, x_1, x_2, x_3, x_4), (v_0, v_1, v_2, v_3, v_4)


@kernel
def _distance(w: WingConstants, step: Step, s: float, event: int) -> tuple[float, float]:
    """Distance (m) beyond the event at the fraction `s` of a step, and its rate (m/s)."""
    q, v = within(step, s)
    if event == LOCK:
        return q[4] - w.x_lock, v[4]
    gap_B, rate_B, gap_C, rate_C = gaps(w, q, v, turned(step.start.d, step.start.q, q))
    if event == JOINT_B:
        return gap_B, rate_B
    return gap_C, rate_C


@inlined
def _first_guess(
    w: WingConstants, step: Step, event: int, sign: float, low: float, high: float
) -> float:
    """Rough fraction of a crossing, strictly between `low` and `high`."""
    if event == LOCK:
        x_0, rate_0 = step.start.q[4] - w.x_lock, step.start.v[4]
        x_1, rate_1 = step.q[4] - w.x_lock, step.v[4]
    else:
        k = 0 if event == JOINT_B else 2
        x_0, rate_0 = step.start.gaps[k], step.start.gaps[k + 1]
        x_1, rate_1 = step.gaps[k], step.gaps[k + 1]
    c_1 = step.h * rate_0
    c_3 = c_1 + step.h * rate_1 - 2.0 * (x_1 - x_0)
    c_2 = x_1 - x_0 - c_1 - c_3
    s = 0.5 * (low + high)
    for _ in range(_GUESS_ITERATIONS):
        x = x_0 + s * (c_1 + s * (c_2 + s * c_3))
        slope = c_1 + s * (2.0 * c_2 + s * 3.0 * c_3)
        if sign * x < 0.0:
            low = s
        else:
            high = s
        if slope != 0.0:
            s -= x / slope
        if slope == 0.0 or not low < s < high:
            s = 0.5 * (low + high)
    return s


@kernel
def _crossing(
    w: WingConstants, step: Step, event: int, sign: float, low: float, high: float
) -> float:
    """Fraction between `low` and `high` at which `sign` times the distance turns positive.

    Newton's method, with bisection where it would leave the bracket, from a first guess that comes
    from the cubic through the distances and their rates at the ends of the step.
    """
    s = _first_guess(w, step, event, sign, low, high)
    for _ in range(_MAX_ITERATIONS):
        distance, rate = _distance(w, step, s, event)
        if abs(distance) <= _LOCATED:
            break
        if sign * distance < 0.0:
            low = s
        else:
            high = s
        slope = rate * step.h
        if slope != 0.0:
            s -= distance / slope
        if slope == 0.0 or not low < s < high:
            s = 0.5 * (low + high)
    return s


@kernel
def lock_fraction(w: WingConstants, step: Step) -> float:
    """Fraction of the step, at whose end the slider is beyond the lock, where it reaches it."""
    return _crossing(w, step, LOCK, 1.0, 0.0, 1.0)


@kernel
def _passing_fraction(w: WingConstants, step: Step, joint: int, sign: float) -> float:
    """Fraction at which a change begins that is undone within the step.

    `sign` times the gap rises at the start of the step and falls at its end, where it is negative.
    """
    gap = sign * step.start.gaps[2 * joint]
    rate = sign * step.start.gaps[2 * joint + 1]
    rate_end = sign * step.gaps[2 * joint + 1]
    peak = rate / (rate - rate_end)
    if sign * _distance(w, step, peak, joint)[0] <= _GRAZING:
        return NOT_IN_STEP
    if gap >= 0.0:
        return 0.0 if sign > 0.0 else NOT_IN_STEP
    return _crossing(w, step, joint, sign, 0.0, peak)


@inlined
def may_switch(
    gap: float, rate: float, gap_end: float, rate_end: float, h: float, damping: float
) -> bool:
    """Whether the contact of a joint may begin, or end if there is one, within a step.

    Without a branch, so that lanes find out at once which few of them need a closer look.

    Parameters
    ----------
    gap, rate, gap_end, rate_end : float
        Contact function (m) and its rate (m/s) at both ends of the step; see `gaps`.
    h : float
        Length of the step (s).
    damping : float
        Damping of the contact (s/m), negative while there is none.
    """
    begins = damping < 0.0
    sign = 1.0 if begins else -1.0
    g = sign * gap
    r = sign * rate
    g_end = sign * gap_end
    r_end = sign * rate_end
    turns_up = (r < 0.0) & (r_end > 0.0)
    ends_beyond = (g_end > 0.0) & (begins | (g < 0.0) | turns_up)
    highest = g if g > g_end else g_end
    steepest = r if r > -r_end else -r_end
    turns_down = (r > 0.0) & (r_end < 0.0)
    passes = (g_end <= 0.0) & turns_down & (highest + h * steepest > 0.0)
    return ends_beyond | passes


@inlined
def switch_fraction(w: WingConstants, step: Step, joint: int, damping: float) -> float:
    """Fraction of the step at which the contact of `joint` begins, or ends if there is one.

    Right after a switch the gap is 0 to rounding. Its sign then says nothing, and the rate tells
    whether the gap has yet to turn round; so no switch is followed by another at the same instant.
    """
    k = 2 * joint
    before = step.start.gaps
    if not may_switch(before[k], before[k + 1], step.gaps[k], step.gaps[k + 1], step.h, damping):
        return NOT_IN_STEP
    sign = 1.0 if damping < 0.0 else -1.0
    gap = sign * before[k]
    rate = sign * before[k + 1]
    rate_end = sign * step.gaps[k + 1]
    if sign * step.gaps[k] > 0.0:
        if rate < 0.0 < rate_end:
            return _crossing(w, step, joint, sign, rate / (rate - rate_end), 1.0)
        if gap >= 0.0:
            return 0.0
        return _crossing(w, step, joint, sign, 0.0, 1.0)
    return _passing_fraction(w, step, joint, sign)
