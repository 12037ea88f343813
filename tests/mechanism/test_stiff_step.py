"""The implicit time step: its order, and steps far beyond those that explicit ones could take."""

import math
from itertools import pairwise

import numpy as np
import pytest

from uqfold.mechanism import WingParameters, trajectory
from uqfold.mechanism.events import State
from uqfold.mechanism.loads import drive_force
from uqfold.mechanism.motion import accelerations, directions, gaps
from uqfold.mechanism.stiff_step import differentiate, stiff_step
from uqfold.mechanism.wing import Wings, wing_constants

TABLE_6 = WingParameters(C_r=0.0015)


def constants(wing):
    return wing_constants(Wings(wing).table()[0])


def state_at(w, t, q, v, z_B, z_C):
    q, v = tuple(map(float, q)), tuple(map(float, v))
    d = directions(q)
    a = accelerations(w, q, v, d, z_B, z_C, drive_force(t, w.k_d))
    return State(t, q, v, a, d, gaps(w, q, v, d), z_B, z_C)


def follow(w, state, t_end, steps):
    """State and largest local error after equal steps."""
    derivatives = np.empty((5, 10))
    largest = 0.0
    for t in np.linspace(state.t, t_end, steps + 1)[1:]:
        differentiate(w, state, derivatives)
        state, error = stiff_step(w, state, derivatives, float(t), 1.0)
        largest = max(largest, error)
    return state, largest


@pytest.fixture(scope="module")
def in_contact():
    """A wing, and a state from which both joints stay in contact for a while."""
    wing = TABLE_6.replace(tangential_velocity="material")
    motion = trajectory(wing, tolerance=1e-9)
    i = int(np.searchsorted(motion.time, 0.3))
    assert (motion.penetration[i : i + 200] > 0).all()
    w = constants(wing)
    z = w.hysteresis / 0.05
    return w, state_at(w, motion.time[i], motion.coordinates[i], motion.velocities[i], z, z)


def position(state):
    return np.array(state.q)


def test_order_three_in_contact(in_contact):
    w, start = in_contact
    t_end = start.t + 1e-3
    reference = position(follow(w, start, t_end, 1024)[0])
    counts = [32, 64, 128]
    errors = [np.abs(position(follow(w, start, t_end, n)[0]) - reference).max() for n in counts]
    orders = [math.log2(a / b) for a, b in pairwise(errors)]
    assert min(orders) > 2.6
    assert errors[-1] < 1e-8


def test_the_estimate_is_of_order_three_and_tells_the_local_error(in_contact):
    w, start = in_contact
    estimates, errors = [], []
    for h in (4e-6, 2e-6):
        end, estimate = follow(w, start, start.t + h, 1)
        fine, _ = follow(w, start, start.t + h, 64)
        estimates.append(estimate)
        errors.append(np.abs(position(end) - position(fine)).max())
    assert 2.5 < math.log2(estimates[0] / estimates[1]) < 4.5
    assert errors[0] < estimates[0]


def test_the_slope_of_the_drive_is_taken_up():
    w = constants(TABLE_6)
    start = state_at(w, 0.0, *_rest(TABLE_6), -1.0, -1.0)
    end, _ = follow(w, start, 0.002, 4)
    # nothing touches yet: m_3 x_3'' = 100 k_d t, and its integrals
    rate = 100 * w.k_d * w.inverse_m_3
    assert end.v[4] == pytest.approx(rate * 0.002**2 / 2, rel=1e-9)
    assert end.q[4] - start.q[4] == pytest.approx(rate * 0.002**3 / 6, rel=1e-6)


def _rest(wing):
    motion = trajectory(wing.replace(t_max=1e-4))
    return motion.coordinates[0], motion.velocities[0]


def test_steps_are_bounded_by_what_moves_not_by_what_sticks(in_contact):
    # friction as of a very thick oil: its rate is a thousand times those of the other forces
    w, start = in_contact
    sticky = w._replace(C_f=1e4, v_0=0.0, ramp_slope=1.0)
    start = start._replace(a=_accelerations(sticky, start))
    derivatives = np.empty((5, 10))
    differentiate(sticky, start, derivatives)
    fastest = np.abs(np.linalg.eigvals(derivatives[:, 5:])).max()
    assert 5e-6 * fastest > 3  # where explicit steps of order 4 lose stability
    coarse = follow(sticky, start, start.t + 1e-4, 20)[0]
    fine = follow(sticky, start, start.t + 1e-4, 640)[0]
    assert position(coarse) == pytest.approx(position(fine), abs=1e-8)


def _accelerations(w, state):
    return state_at(w, state.t, state.q, state.v, state.damping_B, state.damping_C).a


def test_no_number_is_an_infinite_error(in_contact):
    w, start = in_contact
    derivatives = np.full((5, 10), np.nan)
    _, error = stiff_step(w, start, derivatives, start.t + 1e-5, 1.0)
    assert error == math.inf
    differentiate(w, start, derivatives)
    far = start._replace(v=(1e200, *start.v[1:]))
    assert stiff_step(w, far, derivatives, start.t + 1e-5, 1.0)[1] == math.inf
