"""Motions too stiff for explicit steps are followed to their end, in bounded time.

`stiff_wings.json` holds wings, drawn at random far from the paper's, that explicit steps give up:
friction that sticks, contacts that damp hard, tens of kN on light arms. Those under "rough" vibrate
without loss, or gain energy from `geometric` friction, until no method can follow.
"""

import json
import math
from pathlib import Path

import numpy as np
import pytest

from uqfold.mechanism import (
    DEFAULT_TOLERANCE,
    WingParameters,
    deployment,
    deployment_times,
    trajectory,
)
from uqfold.mechanism.deployment import MAX_STEPS, deploy_lanes
from uqfold.mechanism.record import NO_RECORD
from uqfold.mechanism.stiff import COARSE_STEPS, MAX_STIFF_STEPS, deploy_stiff
from uqfold.mechanism.wing import Wings

TABLE_6 = WingParameters(C_r=0.0015)
_STORED = json.loads((Path(__file__).parent / "stiff_wings.json").read_text())
STIFF = [WingParameters(**values) for values in _STORED["under control"]]
ROUGH = [WingParameters(**values) for values in _STORED["rough"]]
LOCKING = STIFF[1]


def explicit_time(wing, tolerance=DEFAULT_TOLERANCE, max_steps=MAX_STEPS):
    times = np.empty(1)
    deploy_lanes(Wings(wing).table(), tolerance, max_steps, times)
    return times[0]


def stiff_time(wing, tolerance=DEFAULT_TOLERANCE):
    time, rough, steps = deploy_stiff(Wings(wing).table(), tolerance, NO_RECORD)
    return time, rough, steps


@pytest.fixture
def implicit(monkeypatch):
    """What implicit steps answer (time, whether rough, number of steps) while a test runs."""
    answers = []

    def deploy_stiff_seen(*arguments):
        answers.append(deploy_stiff(*arguments))
        return answers[-1]

    monkeypatch.setattr(deployment, "deploy_stiff", deploy_stiff_seen)
    return answers


# those of the default tests: one without and one with a motion that locks
@pytest.mark.parametrize(
    "wing", [*STIFF[:2], *(pytest.param(one, marks=pytest.mark.thorough) for one in STIFF[2:])]
)
def test_a_motion_that_explicit_steps_give_up_comes_to_its_end(wing, implicit):
    t = deployment_times(wing)[0]
    # explicit steps gave it up, and implicit ones kept its error under control
    [(time, rough, _)] = implicit
    assert (time, rough) == (t, False)
    assert t == math.inf or 0 < t <= wing.t_max


def test_a_motion_that_none_can_follow_is_cut_short_with_a_warning(implicit):
    wing = ROUGH[0]
    with pytest.warns(RuntimeWarning, match="1 of 2 motions vibrate .* are rough"):
        times = deployment_times(wing, V_q=[wing.V_q, math.nan])
    assert times[0] == math.inf or 0 < times[0] <= wing.t_max
    assert math.isnan(times[1])
    [(time, rough, steps)] = implicit
    assert (time, rough) == (times[0], True)
    # and as many as the drive has corners
    assert steps <= MAX_STIFF_STEPS + COARSE_STEPS + 3


@pytest.mark.thorough
def test_times_are_those_of_explicit_steps_with_more_patience():
    patient = explicit_time(LOCKING, tolerance=1e-7, max_steps=20 * MAX_STEPS)
    assert 0 < patient < LOCKING.t_max
    assert stiff_time(LOCKING)[0] == pytest.approx(patient, abs=5e-5)
    assert stiff_time(LOCKING, tolerance=1e-8)[0] == pytest.approx(patient, abs=5e-6)


@pytest.mark.parametrize("velocity", ["geometric", "material"])
def test_ordinary_wings_get_the_same_times(velocity):
    wing = TABLE_6.replace(tangential_velocity=velocity)
    rng = np.random.default_rng(20)
    draws = {"k_d": rng.normal(550, 10, 40), "b": rng.normal(0.007, 0.00025, 40)}
    table = Wings(wing, draws).table()
    results = [
        deploy_stiff(table[i : i + 1], DEFAULT_TOLERANCE, NO_RECORD) for i in range(len(table))
    ]
    assert not any(rough for _, rough, _ in results)
    error = np.array([time for time, _, _ in results])
    error -= deployment_times(wing, tolerance=1e-11, **draws)
    assert np.median(np.abs(error)) <= 2e-5
    assert np.max(np.abs(error)) <= 3e-4


def test_a_wing_that_never_locks_does_not():
    assert stiff_time(TABLE_6.replace(k_d=150))[0] == math.inf


def test_the_motion_of_a_stiff_wing_balances_its_energies():
    # the power of friction that sticks is far stiffer than the motion: it asks for short steps
    motion = trajectory(LOCKING, tolerance=1e-7)
    assert motion.deployment_time == deployment_times(LOCKING, tolerance=1e-7)[0]
    assert motion.time[-1] == motion.deployment_time
    assert motion.coordinates[-1, 4] == pytest.approx(LOCKING.x_lock, abs=1e-12)
    turned_over = np.abs(motion.work_drive).max()
    assert np.abs(motion.energy_residual).max() < 0.01 * turned_over
    assert motion.contact_loss[-1].sum() + motion.friction_loss[-1].sum() > 0.03 * turned_over


@pytest.mark.thorough
def test_a_rough_motion_is_recorded_with_a_warning():
    with pytest.warns(RuntimeWarning, match="1 of 1 motions vibrate"):
        motion = trajectory(ROUGH[1])
    assert np.all(np.isfinite(motion.coordinates))
    assert motion.time[-1] <= ROUGH[1].t_max
