"""One adaptive time step, cut at contact onset and loss, at corners of the drive and at the lock.

The method is the classical Runge-Kutta formula of order 4; the embedded formula of order 3 uses the
first stage of the next step (S. Balac and F. Mahe, Comput. Phys. Commun. 184 (2013) 1211-1219). Low
orders win here: contact vibration holds the step near the stability limit, and the error is
governed by how sharply the onset of a contact, and its velocity, are taken.
"""

import math

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
from uqfold.mechanism.motion import Five, Four, accelerations, directions, gaps, turned
from uqfold.mechanism.wing import WingConstants

RUNNING, LOCKED, TIMED_OUT, FAILED = 0, 1, 2, 3

FIRST_STEP = 1e-4
"""First time step tried (s)."""

_LARGEST_STEP = 5e-3
_SMALLEST_STEP = 1e-13
# Errors of velocities count as errors of positions over this time (s), about that in which
# contact vibration turns the one into the other.
_VIBRATION_TIME = 1 / 3000
_SAFETY = 0.85
_LARGEST_GROWTH = 5.0
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
def _size(w: WingConstants, x: Five, y: Five) -> float:
    """Difference of two rates of the coordinates, angles taken at the joints; keeps NaN."""
    return (
        w.l_1 * abs(x[0] - y[0])
        + abs(x[1] - y[1])
        + abs(x[2] - y[2])
        + w.half_l_2 * abs(x[3] - y[3])
        + abs(x[4] - y[4])
    )


@inlined
def runge_kutta(w: WingConstants, start: State, h: float) -> tuple[Five, Five, Five, Four, float]:
    """Take one step without events.

    Parameters
    ----------
    w : WingConstants
        The wing.
    start : State
        State at the beginning of the step.
    h : float
        Length of the step (s); the drive has no corner within it.

    Returns
    -------
    tuple
        Coordinates, velocities, accelerations and directions at the end, and the local error (m).
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
    error = 0.1 * h * (_size(w, v_4, v_1) + _VIBRATION_TIME * _size(w, a_4, a_1))
    return q_1, v_1, a_1, d_1, error


@kernel
def initial_state(w: WingConstants, q: Five) -> State:
    """State at time 0, at rest in the pose `q` with no contact."""
    v = (0.0, 0.0, 0.0, 0.0, 0.0)
    d = directions(q)
    a = accelerations(w, q, v, d, -1.0, -1.0, drive_force(0.0, w.k_d))
    return State(0.0, q, v, a, d, gaps(w, q, v, d), -1.0, -1.0)


@kernel
def _switched(w: WingConstants, damping: float, onset_velocity: float) -> float:
    """Damping of a contact (s/m) after it has begun, or ended if there was one.

    The penetration velocity at onset is held as long as the contact lasts.
    """
    if damping >= 0.0:
        return -1.0
    return w.damping / max(onset_velocity, w.onset_velocity_floor)


@kernel
def _cut(w: WingConstants, step: Step, s: float, switch_B: bool, switch_C: bool) -> State:
    """State at the fraction `s` of a step, where contacts begin or end."""
    t = step.start.t + s * step.h
    q, v = within(step, s)
    d = directions(q)
    g = gaps(w, q, v, d)
    z_B = step.start.damping_B
    z_C = step.start.damping_C
    if switch_B:
        z_B = _switched(w, z_B, g[1])
    if switch_C:
        z_C = _switched(w, z_C, g[3])
    return State(
        t, q, v, accelerations(w, q, v, d, z_B, z_C, drive_force(t, w.k_d)), d, g, z_B, z_C
    )


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
    rejected = False
    while True:
        h = min(h, _LARGEST_STEP)
        # a hair's breadth more is taken in, rather than left over as a tiny step
        lands = start.t + 1.0001 * h >= corner
        taken = corner - start.t if lands else h
        q, v, a, d, error = runge_kutta(w, start, taken)
        factor = _LARGEST_GROWTH
        if error != 0.0:
            factor = min(factor, _SAFETY / math.sqrt(math.sqrt(error / tolerance)))
        if error <= tolerance:
            break
        rejected = True
        h = taken * max(factor, _LARGEST_CUT) if error < math.inf else taken * _LARGEST_CUT
        if h < _SMALLEST_STEP:
            return start, h, FAILED
    if rejected:
        factor = min(factor, 1.0)
    h = max(h, taken * factor) if lands else taken * factor

    step = Step(start, taken, q, v, a, gaps(w, q, v, d))
    s_B = switch_fraction(w, step, JOINT_B, start.damping_B)
    s_C = switch_fraction(w, step, JOINT_C, start.damping_C)
    s = min(s_B, s_C)
    if q[4] >= w.x_lock:
        s_lock = lock_fraction(w, step)
        if s_lock <= s:
            return _cut(w, step, s_lock, False, False), h, LOCKED
    if s < NOT_IN_STEP:
        return _cut(w, step, s, s_B == s, s_C == s), h, RUNNING
    t = corner if lands else start.t + taken
    end = State(t, q, v, a, d, step.gaps, start.damping_B, start.damping_C)
    return end, h, TIMED_OUT if t >= w.t_max else RUNNING
