"""Motion, contact forces and the energy audit."""

import math

import numpy as np
import pytest

from uqfold.mechanism import WingParameters, deployment_times, trajectory

WING = WingParameters(C_r=0.0015, delta=0.2)


@pytest.fixture(scope="module", params=["geometric", "material"])
def motion(request):
    return trajectory(WING.replace(tangential_velocity=request.param), tolerance=1e-9)


def test_takes_the_steps_of_the_batch():
    for tolerance in (1e-6, 1e-8):
        motion = trajectory(WING, tolerance=tolerance)
        assert motion.deployment_time == deployment_times(WING, tolerance=tolerance)[0]
        assert motion.time[-1] == motion.deployment_time
        assert np.all(np.diff(motion.time) >= 0)


def test_starts_at_rest_centred_and_ends_at_the_lock(motion):
    assert motion.coordinates[0] == pytest.approx(
        [0, 1.5 - 0.5 * 1.29614814, -0.05, math.asin(0.1 / 1.3), WING.x_3_initial]
    )
    assert not motion.velocities[0].any()
    assert motion.penetration[0] == pytest.approx([-WING.C_r, -WING.C_r])
    assert motion.coordinates[-1, 4] == pytest.approx(WING.x_lock, abs=1e-12)
    assert np.all(motion.coordinates[:-1, 4] < WING.x_lock)
    assert motion.velocities[-1, 4] > 0
    assert math.radians(45) < motion.coordinates[:, 0].max() < math.radians(60)


def test_velocities_are_the_rates_of_the_coordinates(motion):
    h = np.diff(motion.time)[:, None]
    trapezium = 0.5 * h * (motion.velocities[1:] + motion.velocities[:-1])
    short = h[:, 0] < 1e-4
    assert short.mean() > 0.3
    assert np.diff(motion.coordinates, axis=0)[short] == pytest.approx(trapezium[short], abs=1e-7)


def test_forces_act_where_there_is_penetration(motion):
    apart = motion.penetration <= 0
    assert apart.any()
    assert not motion.normal_force[apart].any()
    assert not motion.tangential_force[apart].any()
    assert np.all(motion.normal_force >= 0)
    assert np.all(np.abs(motion.tangential_force) <= WING.C_f * motion.normal_force + 1e-12)
    assert np.mean(motion.normal_force[motion.penetration > 1e-7] > 0) > 0.99
    assert motion.penetration.max() < 1e-3


def test_energy_balance_closes(motion):
    scale = motion.work_drive[-1]
    assert np.abs(motion.energy_residual).max() < 1e-6 * scale
    # the balance would show either loss missing
    assert motion.contact_loss[-1].sum() > 1e-3 * scale
    assert motion.friction_loss[-1].sum() > 1e-3 * scale


def test_work_of_constant_forces(motion):
    m_1, m_2, m_3 = 2700 * 1.5 * 0.3 * 0.007, 2700 * 1.3 * 0.2 * 0.007, 7.87
    x = motion.coordinates
    rise = (
        m_1 * 0.75 * (np.cos(x[:, 0]) - 1) + m_2 * (x[:, 1] - x[0, 1]) + m_3 * (x[:, 4] - x[0, 4])
    )
    assert motion.work_gravity == pytest.approx(9.81 * math.sin(0.2) * rise, abs=1e-7)
    # from 0.01 s on the drive is constant
    full = motion.time >= 0.01
    path = motion.coordinates[full, 4] - motion.coordinates[full, 4][0]
    work = motion.work_drive[full] - motion.work_drive[full][0]
    assert work == pytest.approx(550 * path, abs=1e-7)


def test_contacts_never_add_energy():
    rng = np.random.default_rng(11)
    for velocity in ("geometric", "material"):
        for _ in range(10):
            p = random_wing(rng).replace(tangential_velocity=velocity)
            motion = trajectory(p, tolerance=1e-9)
            assert np.abs(motion.energy_residual).max() < 2e-6 * motion.work_drive[-1]
            assert np.diff(motion.contact_loss, axis=0).min() >= 0
            lost = motion.contact_loss.sum(axis=1) + motion.friction_loss.sum(axis=1)
            assert lost.min() >= 0
            if velocity == "material":
                assert np.diff(motion.friction_loss, axis=0).min() >= 0


def random_wing(rng):
    return WingParameters(
        C_r=rng.uniform(0.0005, 0.003),
        V_q=rng.normal(140, 20),
        delta=rng.normal(0, 0.4),
        k_d=rng.uniform(400, 1200),
    )


def test_elastic_frictionless_joints_lose_nothing():
    motion = trajectory(WING.replace(C_e=1.0, C_f=0.0), tolerance=1e-9)
    assert motion.contact_loss == pytest.approx(np.zeros_like(motion.contact_loss), abs=1e-12)
    assert not motion.friction_loss.any()
    assert np.abs(motion.energy_residual).max() < 1e-6 * motion.work_drive[-1]


def test_without_a_lock_the_motion_runs_to_the_time_limit():
    motion = trajectory(WING.replace(k_d=150, delta=0.0))
    assert motion.deployment_time == math.inf
    assert motion.time[-1] == WING.t_max


def test_tolerance_is_checked():
    with pytest.raises(ValueError, match="tolerance = -1"):
        trajectory(WING, tolerance=-1.0)
