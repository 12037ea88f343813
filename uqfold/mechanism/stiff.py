"""Motions that are too stiff for explicit steps: implicit steps, and a bound on their number.

Some wings that can be built are far stiffer than those of the paper: friction sticks, a resting
contact is damped by the rate of a slow onset, or tens of kN press light arms into their bearings.
Explicit steps would follow their fastest rate through all of the motion. Here they are integrated
anew, by steps whose length the fast rates do not bound, with the same events.

What vibrates fast, hard and undamped is out of reach of any step. After `MAX_STIFF_STEPS` the rest
of the motion is therefore taken in `COARSE_STEPS` equal steps, whatever their error, with contacts
that begin and end at their ends. That bounds the work on any wing and leaves a rough answer, which
is marked as such.
"""

import math
from collections.abc import Callable
from typing import Any

import numpy as np

from uqfold.mechanism.compiled import entry_point, fingerprint, kernel
from uqfold.mechanism.events import State, Step, lock_fraction
from uqfold.mechanism.loads import drive_force, next_drive_corner
from uqfold.mechanism.motion import accelerations
from uqfold.mechanism.record import write_point
from uqfold.mechanism.stiff_step import FloatArray, differentiate, stiff_step
from uqfold.mechanism.timestep import (
    FAILED,
    FIRST_STEP,
    LARGEST_GROWTH,
    LARGEST_STEP,
    LOCKED,
    NO_ERROR,
    RUNNING,
    SAFETY,
    SMALLEST_STEP,
    TIMED_OUT,
    initial_state,
    settle,
    switched,
)
from uqfold.mechanism.wing import WingConstants, initial_pose, wing_constants

# The error estimate is cruder than that of the explicit steps; with a tenth of their tolerance,
# ordinary wings get times as accurate as theirs.
_SHARE_OF_TOLERANCE = 0.1

MAX_STIFF_STEPS = 400_000
"""Implicit time steps tried with their error under control."""

COARSE_STEPS = 200_000
"""Equal time steps that the rest of a motion is then taken in."""


@kernel
def _advance(
    w: WingConstants, start: State, h: float, tolerance: float, derivatives: FloatArray
) -> tuple[State, float, int, int]:
    """Advance to the next accepted point, as the explicit `advance` does.

    Returns the new state, the time step to try next (s), the status, and the number of steps tried.
    """
    corner = next_drive_corner(start.t, w.t_max)
    differentiate(w, start, derivatives)
    growth = LARGEST_GROWTH
    tried = 0
    while True:
        h = min(h, LARGEST_STEP)
        lands = start.t + 1.0001 * h >= corner
        t_end = corner if lands else start.t + h
        end, error = stiff_step(w, start, derivatives, t_end, tolerance)
        tried += 1
        taken = t_end - start.t
        # the error estimate is of order 3
        factor = SAFETY / max(error, NO_ERROR) ** (1 / 3)
        if error <= 1.0:
            break
        h = taken * max(factor, 0.1)
        if h < SMALLEST_STEP:
            return start, h, FAILED, tried
        growth = 1.0
    state, status = settle(w, start, end, taken)
    h_next = taken * min(factor, growth)
    return state, max(h, h_next) if lands else h_next, status, tried


@kernel
def _advance_coarsely(
    w: WingConstants, start: State, h: float, derivatives: FloatArray
) -> tuple[State, int]:
    """Take a step of length `h` (s), or to the next corner of the drive, whatever its error.

    Returns the new state and the status, FAILED where the forces have left the range of numbers.
    """
    corner = next_drive_corner(start.t, w.t_max)
    differentiate(w, start, derivatives)
    t_end = min(start.t + h, corner)
    end, error = stiff_step(w, start, derivatives, t_end, 1.0)
    if not error < math.inf:
        return start, FAILED
    if end.q[4] >= w.x_lock:
        step = Step(start, t_end - start.t, end.q, end.v, end.a, end.gaps)
        t_end = start.t + lock_fraction(w, step) * (t_end - start.t)
    z_B = start.damping_B
    z_C = start.damping_C
    if (z_B < 0.0) == (end.gaps[0] > 0.0):
        z_B = switched(w, z_B, end.gaps[1])
    if (z_C < 0.0) == (end.gaps[2] > 0.0):
        z_C = switched(w, z_C, end.gaps[3])
    a = accelerations(w, end.q, end.v, end.d, z_B, z_C, drive_force(t_end, w.k_d))
    state = State(t_end, end.q, end.v, a, end.d, end.gaps, z_B, z_C)
    if end.q[4] >= w.x_lock:
        return state, LOCKED
    return state, TIMED_OUT if t_end >= w.t_max else RUNNING


def _build(source: int) -> Callable[..., Any]:
    @entry_point
    def deploy(wings, tolerance, record):  # type: ignore[no-untyped-def]
        """Follow one wing that can be built, the first in the table of `wings`, to its end.

        Returns its deployment time, +inf if it does not lock, whether that time is rough, and the
        number of time steps taken; `record` (m, RECORD_WIDTH) takes the first m points of the
        motion, from the initial one on.
        """
        p = wings[0]
        w = wing_constants(p)
        state = initial_state(w, initial_pose(p))
        derivatives = np.empty((5, 10))
        allowed = _SHARE_OF_TOLERANCE * tolerance
        h = FIRST_STEP
        status = RUNNING
        # numba would compile what is called with a literal 0 for it alone; source matters as a part
        # of the cache key only
        taken: Any = np.int64(0 * source)
        write_point(record, taken, state)
        steps = 0
        while status == RUNNING and steps < MAX_STIFF_STEPS:
            state, h, status, tried = _advance(w, state, h, allowed, derivatives)
            steps += tried
            taken += 1
            write_point(record, taken, state)
        rough = status in (RUNNING, FAILED)
        if rough:
            h = (w.t_max - state.t) / COARSE_STEPS
            status = RUNNING
            while status == RUNNING:
                state, status = _advance_coarsely(w, state, h, derivatives)
                taken += 1
                write_point(record, taken, state)
        return state.t if status == LOCKED else math.inf, rough, taken

    return deploy


deploy_stiff = _build(fingerprint())
