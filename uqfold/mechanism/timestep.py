"""One adaptive time step, cut at contact onset and loss, at corners of the drive and at the lock.

The method is the classical Runge-Kutta formula of order 4; the embedded formula of order 3 uses the
first stage of the next step (S. Balac and F. Mahe, Comput. Phys. Commun. 184 (2013) 1211-1219). Low
orders win here: contact vibration holds the step near the stability limit, and the error is
governed by how sharply the onset of a contact, and its velocity, are taken.
"""

import math
from typing import NamedTuple

from uqfold.mechanism.compiled import inlined, kernel
from uqfold.mechanism.events import (
    JOINT_B,
    JOINT_C,
    NOT_IN_STEP,
    State,
    Step,
    lock_fraction,
    switch_fraction,
    within,
)
from uqfold.mechanism.loads import drive_force, next_drive_corner
from uqfold.mechanism.motion import (
    LARGEST_TURN,
    Five,
    Four,
    accelerations,
    directions,
    gaps,
    turned,
)
from uqfold.mechanism.wing import WingConstants

RUNNING, LOCKED, TIMED_OUT, FAILED = 0, 1, 2, 3

FIRST_STEP = 1e-4
"""First time step tried (s)."""

LARGEST_STEP = 5e-3
"""Largest time step (s)."""

SMALLEST_STEP = 1e-13
"""Time step (s) below which an integration has failed."""

VIBRATION_TIME = 1 / 3000
"""Errors of velocities count as errors of positions over this time (s), about that in which
contact vibration turns the one into the other."""

SAFETY = 0.85
"""Next time step over the one that the error estimate would just allow."""

NO_ERROR = 1e-12
"""A smaller local error (in units of the tolerance) lets the time step grow no further."""

LARGEST_GROWTH = 5.0
"""Largest growth from one time step to the next, unless the latter is a repetition."""

_LARGEST_CUT = 0.1


@inlined
def _shift(x: Five, h: float, y: Five) -> Five:
    """Return x + h y."""
    return (
        x[0] + h * y[0],
        x[1] + h * y[1],
        x[2] + h * y[2],
        x[3] + h * y[3],
        x[4] + h * y[4],
    )


@inlined
def _weighted(k_1: Five, k_2: Five, k_3: Five, k_4: Five) -> Five:
    """Return (k_1 + 2 k_2 + 2 k_3 + k_4) / 6."""
    return (
        (k_1[0] + 2.0 * (k_2[0] + k_3[0]) + k_4[0]) * (1 / 6),
        (k_1[1] + 2.0 * (k_2[1] + k_3[1]) + k_4[1]) * (1 / 6),
        (k_1[2] + 2.0 * (k_2[2] + k_3[2]) + k_4[2]) * (1 / 6),
        (k_1[3] + 2.0 * (k_2[3] + k_3[3]) + k_4[3]) * (1 / 6),
        (k_1[4] + 2.0 * (k_2[4] + k_3[4]) + k_4[4]) * (1 / 6),
    )


@inlined
def size(w: WingConstants, x: Five, y: Five) -> float:
    """Difference of two rates of the coordinates, angles taken at the joints; keeps NaN."""
    return (
        w.l_1 * abs(x[0] - y[0])
        + abs(x[1] - y[1])
        + abs(x[2] - y[2])
        + w.half_l_2 * abs(x[3] - y[3])
        + abs(x[4] - y[4])
    )


@inlined
def _largest(x: float, y: float) -> float:
    """Return the larger one; `x` if it is NaN."""
    return y if y > x else x


@inlined
def largest_turn(q: Five, q_new: Five) -> float:
    """Return the larger turn of crank and rod between two poses (rad)."""
    return _largest(abs(q_new[0] - q[0]), abs(q_new[3] - q[3]))


@inlined
def _runge_kutta(
    w: WingConstants, start: State, h: float, tolerance: float
) -> tuple[Five, Five, Five, Four, float]:
    """Take one step without events.

    Parameters
    ----------
    w : WingConstants
        The wing.
    start : State
        State at the beginning of the step.
    h : float
        Length of the step (s); the drive has no corner within it.
    tolerance : float
        Local error allowed (m).

    Returns
    -------
    tuple
        Coordinates, velocities, accelerations and directions at the end, and the local error over
        the tolerance; a turn beyond `LARGEST_TURN`, up to which directions are followed, counts as
        such an error too.
    """
    _, q, v, a, d, _, z_B, z_C = start
    drive = drive_force(start.t + 0.5 * h, w.k_d)
    q_2 = _shift(q, 0.5 * h, v)
    v_2 = _shift(v, 0.5 * h, a)
    a_2 = accelerations(w, q_2, v_2, turned(d, q, q_2), z_B, z_C, drive)
    q_3 = _shift(q, 0.5 * h, v_2)
    v_3 = _shift(v, 0.5 * h, a_2)
    a_3 = accelerations(w, q_3, v_3, turned(d, q, q_3), z_B, z_C, drive)
    drive = drive_force(start.t + h, w.k_d)
    q_4 = _shift(q, h, v_3)
    v_4 = _shift(v, h, a_3)
    a_4 = accelerations(w, q_4, v_4, turned(d, q, q_4), z_B, z_C, drive)
    q_1 = _shift(q, h, _weighted(v, v_2, v_3, v_4))
    v_1 = _shift(v, h, _weighted(a, a_2, a_3, a_4))
    d_1 = turned(d, q, q_1)
    a_1 = accelerations(w, q_1, v_1, d_1, z_B, z_C, drive)
    error = 0.1 * h * (size(w, v_4, v_1) + VIBRATION_TIME * size(w, a_4, a_1)) / tolerance
    turn = _largest(largest_turn(q, q_4), largest_turn(q, q_1)) * (1 / LARGEST_TURN)
    return q_1, v_1, a_1, d_1, _largest(error, turn * turn * turn * turn)


@kernel
def initial_state(w: WingConstants, q: Five) -> State:
    """State at time 0, at rest in the pose `q` with no contact."""
    v = (0.0, 0.0, 0.0, 0.0, 0.0)
    d = directions(q)
    a = accelerations(w, q, v, d, -1.0, -1.0, drive_force(0.0, w.k_d))
    return State(0.0, q, v, a, d, gaps(w, q, v, d), -1.0, -1.0)


@kernel
def switched(w: WingConstants, damping: float, onset_velocity: float) -> float:
    """Damping of a contact (s/m) after it has begun, or ended if there was one.

    The penetration velocity at onset is held as long as the contact lasts.
    """
    if damping >= 0.0:
        return -1.0
    return w.hysteresis / max(onset_velocity, w.onset_velocity_floor)


@kernel
def _cut(w: WingConstants, step: Step, s: float, switch_B: bool, switch_C: bool) -> State:
    """State at the fraction `s` of a step, where contacts begin or end."""
    t = step.start.t + s * step.h
    q, v = within(step, s)
    d = turned(step.start.d, step.start.q, q)
    g = gaps(w, q, v, d)
    z_B = step.start.damping_B
    z_C = step.start.damping_C
    if switch_B:
        z_B = switched(w, z_B, g[1])
    if switch_C:
        z_C = switched(w, z_C, g[3])
    return State(
        t, q, v, accelerations(w, q, v, d, z_B, z_C, drive_force(t, w.k_d)), d, g, z_B, z_C
    )


class Attempt(NamedTuple):
    """A time step of length `taken` (s) as if nothing happened in it, accepted or not.

    It leads to `end` with the local error `error` (in units of the tolerance), lands on the next
    corner of the drive or not, and proposes the next time step `h` (s), should it be accepted.
    """

    end: State
    taken: float
    lands: bool
    error: float
    h: float


@inlined
def attempt(
    w: WingConstants, start: State, h: float, growth: float, corner: float, tolerance: float
) -> Attempt:
    """Try one time step. No branch and no library function: lanes run it packed.

    Parameters
    ----------
    w : WingConstants
        The wing.
    start : State
        Where the motion stands.
    h : float
        Time step to try (s).
    growth : float
        Largest growth from this time step to the next.
    corner : float
        Next corner of the drive, or the end of time (s).
    tolerance : float
        Local error allowed per step (m).

    Returns
    -------
    Attempt
        The step, to be accepted if its error is at most 1.
    """
    h = h if h < LARGEST_STEP else LARGEST_STEP
    # a hair's breadth more is taken in, rather than left over as a tiny step
    lands = start.t + 1.0001 * h >= corner
    taken = corner - start.t if lands else h
    q, v, a, d, error = _runge_kutta(w, start, taken, tolerance)
    t = corner if lands else start.t + taken
    end = State(t, q, v, a, d, gaps(w, q, v, d), start.damping_B, start.damping_C)
    factor = SAFETY / math.sqrt(math.sqrt(_largest(error, NO_ERROR)))
    next_h = taken * (factor if factor < growth else growth)
    return Attempt(end, taken, lands, error, h if lands and h > next_h else next_h)


@inlined
def shortened(taken: float, error: float) -> float:
    """Time step (s) to try after one of length `taken` had too large an error, or NaN."""
    if error < math.inf:
        return taken * max(SAFETY / math.sqrt(math.sqrt(error)), _LARGEST_CUT)
    return taken * _LARGEST_CUT


@kernel
def settle(w: WingConstants, start: State, end: State, taken: float) -> tuple[State, int]:
    """Cut an accepted time step at the first event within it.

    Returns
    -------
    tuple
        New state, and status: RUNNING, LOCKED or TIMED_OUT.
    """
    step = Step(start, taken, end.q, end.v, end.a, end.gaps)
    s_B = switch_fraction(w, step, JOINT_B, start.damping_B)
    s_C = switch_fraction(w, step, JOINT_C, start.damping_C)
    s_lock = lock_fraction(w, step) if end.q[4] >= w.x_lock else NOT_IN_STEP
    s = min(s_B, s_C, s_lock)
    if s < NOT_IN_STEP:
        cut = _cut(w, step, s, s_B == s < s_lock, s_C == s < s_lock)
        return cut, LOCKED if s == s_lock else RUNNING
    return end, TIMED_OUT if end.t >= w.t_max else RUNNING


@inlined
def advance(w: WingConstants, start: State, h: float, tolerance: float) -> tuple[State, float, int]:
    """Advance to the next accepted point: the end of a step, or the first event within it.

    Parameters
    ----------
    w : WingConstants
        The wing.
    start : State
        Where the motion stands.
    h : float
        Time step to try (s).
    tolerance : float
        Local error allowed per step (m).

    Returns
    -------
    tuple
        New state, time step to try next (s), and status: RUNNING, LOCKED, TIMED_OUT or FAILED.
    """
    corner = next_drive_corner(start.t, w.t_max)
    growth = LARGEST_GROWTH
    while True:
        tried = attempt(w, start, h, growth, corner, tolerance)
        if tried.error <= 1.0:
            break
        h = shortened(tried.taken, tried.error)
        if h < SMALLEST_STEP:
            return start, h, FAILED
        growth = 1.0
    state, status = settle(w, start, tried.end, tried.taken)
    return state, tried.h, status
