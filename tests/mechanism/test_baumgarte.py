"""The paper's own form against the compiled reduced form."""

import math

import numpy as np
import pytest
from scipy.interpolate import CubicHermiteSpline

from uqfold.mechanism import (
    WingParameters,
    baumgarte_trajectory,
    deployment_times,
    trajectory,
)

TABLE_6 = WingParameters(C_r=0.0015)
CASES = {
    "table 6": TABLE_6,
    "table 1": WingParameters(),
    "table 10": TABLE_6.replace(V_q=200, k_d=1100, b=0.006),
    "material": TABLE_6.replace(tangential_velocity="material", C_f=0.2),
    "split": TABLE_6.replace(
        C_r_B=0.001, b_2=0.006, E_j_C=200e9, nu_b_B=0.2, contact_law="flores-2011", C_e=0.7
    ),
    "other pose": TABLE_6.replace(
        theta_1_initial=0.1, x_lock=0.97, l_1=1.504, delta=-0.3, k_d=700, contact_law="gonthier"
    ),
    "after the drive": TABLE_6.replace(k_d=300, C_e=0.6, contact_law="hunt-crossley"),
}
ALL_CASES = pytest.mark.parametrize("wing", CASES.values(), ids=CASES.keys())


@ALL_CASES
def test_locks_when_the_reduced_form_does(wing):
    # what 1e-6 of the clearances does to the time bounds what agreement can mean
    shifts = 1 + 1e-6 * np.arange(-2, 3)
    times = deployment_times(
        wing, C_r_B=wing.C_r_B * shifts, C_r_C=wing.C_r_C * shifts, tolerance=1e-12
    )
    assert np.ptp(times) < 1e-6
    motion = baumgarte_trajectory(wing, tolerance=1e-11)
    assert motion.deployment_time == pytest.approx(times[2], abs=1e-6)
    assert motion.time[-1] == motion.deployment_time
    assert 0 <= motion.coordinates[-1, 6] - wing.x_lock < 1e-12


@pytest.mark.parametrize("name", ["table 6", "split"])
def test_follows_the_trajectory_of_the_reduced_form(name):
    wing = CASES[name]
    motion = baumgarte_trajectory(wing, tolerance=1e-12)
    reduced = trajectory(wing, tolerance=1e-12)
    # theta_1, x_2, y_2, theta_2, x_3 of the nine
    own = [2, 3, 4, 5, 6]
    later = np.flatnonzero(np.diff(motion.time, prepend=-1.0) > 0)
    curve = CubicHermiteSpline(
        motion.time[later], motion.coordinates[later][:, own], motion.velocities[later][:, own]
    )
    inside = reduced.time <= motion.time[-1]
    difference = np.abs(curve(reduced.time[inside]) - reduced.coordinates[inside])
    # the rod's last swing across the clearance of B magnifies what came before
    early = reduced.time[inside] < 0.4
    assert early.any()
    assert difference[early].max() < 2e-8
    assert difference.max() < 2e-6
    rates = np.abs(curve(reduced.time[inside], 1) - reduced.velocities[inside])
    # contacts vibrate at some kHz, so that a position 1e-7 m off is a velocity 1e-3 m/s off
    assert np.median(rates) < 1e-6
    assert rates.max() < 2e-3


@pytest.mark.parametrize("name", ["table 6", "material"])
def test_alpha_and_beta_do_not_matter(name):
    pairs = [(0, 0), (1, 1), (10, 10), (50, 50), (100, 200), (1000, 1000)]
    motions = [
        baumgarte_trajectory(CASES[name], alpha=alpha, beta=beta, tolerance=1e-11)
        for alpha, beta in pairs
    ]
    times = [motion.deployment_time for motion in motions]
    assert len(set(times)) > 1
    assert np.ptp(times) < 1e-6


@ALL_CASES
def test_constraints_hold(wing):
    motion = baumgarte_trajectory(wing)
    x_1, y_1, theta_1 = motion.coordinates[:, :3].T
    y_3, theta_3 = motion.coordinates[:, 7:].T
    half = wing.l_1 / 2
    phi = [x_1 - half * np.cos(theta_1), y_1 - half * np.sin(theta_1), y_3 + wing.c, theta_3]
    assert motion.position_drift == pytest.approx(np.abs(phi).max(axis=0), abs=1e-15)
    assert motion.position_drift.max() < 1e-11
    assert motion.velocity_drift.max() < 1e-9


def test_stabilization_holds_a_drift_down():
    # with a coarse tolerance the unstabilized constraints drift apart
    drifts = [
        baumgarte_trajectory(TABLE_6, alpha=c, beta=c, tolerance=1e-6).position_drift[-1]
        for c in (0.0, 50.0)
    ]
    assert drifts[1] < 0.1 * drifts[0]


def test_multipliers_are_the_reactions():
    """Momentum of the whole wing changes by the loads and by the reactions, and nothing else."""
    wing = TABLE_6.replace(delta=0.2)
    motion = baumgarte_trajectory(wing, tolerance=1e-11)
    masses = np.array([2700 * 1.5 * 0.3 * 0.007, 2700 * 1.3 * 0.2 * 0.007, 7.87])
    t, q, v = motion.time, motion.coordinates, motion.velocities
    drag = 0.5 * 1.293 * 0.007 * 140**2
    loads = (
        drag * (1.5 * np.abs(np.sin(q[:, 2])) + 1.3 * np.abs(np.sin(q[:, 5])))
        + masses.sum() * 9.81 * math.sin(0.2)
        + 550 * np.clip(100 * t, 0, 1)
    )
    along = np.trapezoid(loads - motion.multipliers[:, 0], t)
    across = np.trapezoid(-motion.multipliers[:, 1] - motion.multipliers[:, 2], t)
    assert along == pytest.approx(v[-1, [0, 3, 6]] @ masses, rel=1e-3)
    assert across == pytest.approx(v[-1, [1, 4, 7]] @ masses, rel=1e-3)


def test_runs_to_the_time_limit_without_a_lock():
    motion = baumgarte_trajectory(TABLE_6.replace(k_d=150, t_max=0.7))
    assert motion.deployment_time == math.inf
    assert motion.time[-1] == 0.7
    corners = baumgarte_trajectory(TABLE_6.replace(t_max=0.005))
    assert corners.time[-1] == 0.005


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ({"tolerance": 0.0}, "tolerance = 0.0"),
        ({"alpha": -1.0}, "alpha = -1.0"),
        ({"beta": math.nan}, "beta = nan"),
        ({"beta": 1e300}, r"beta = 1e\+300"),
        ({"tolerance": 1e-3}, r"tolerance = 0.001: give a number in \(0, 1e-05\]"),
    ],
)
def test_bad_calls_are_refused(arguments, message):
    with pytest.raises(ValueError, match=message):
        baumgarte_trajectory(TABLE_6, **arguments)


def test_a_motion_that_cannot_be_followed_is_an_error():
    with pytest.raises(RuntimeError, match=r"came to a halt at .* s after"):
        baumgarte_trajectory(TABLE_6, tolerance=1e-30)
