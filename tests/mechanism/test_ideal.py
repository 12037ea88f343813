"""The wing with ideal joints: against multipliers and SciPy, energy, and small clearances."""

import math

import numpy as np
import pytest
from scipy.integrate import quad, solve_ivp
from scipy.optimize import brentq

from uqfold.mechanism import WingParameters, deployment_times, ideal_deployment_times
from uqfold.problems import folding_wing

TABLE_6 = WingParameters(C_r=0.0015)


def multiplier_time(p):
    """Deployment time with (theta_1, theta_2, x_3), two loop constraints, and SciPy."""
    m_1, m_2 = p.rho_1 * p.l_1 * p.w_1 * p.b_1, p.rho_2 * p.l_2 * p.w_2 * p.b_2
    m_3 = p.rho_3 * p.V_3
    J_A = m_1 * (p.l_1**2 / 3 + p.w_1**2 / 12)
    J_2 = m_2 * (p.l_2**2 + p.w_2**2) / 12
    q_inf = 0.5 * p.rho_a * p.C_0 * p.V_q**2
    g_x = p.g * math.sin(p.delta)

    def rates(t, y):
        a, b, _, a_1, b_1, _ = y
        # centroid of the rod: x_3 + l_2/2 cos(b), -c + l_2/2 sin(b)
        half = p.l_2 / 2
        mass = np.array(
            [
                [J_A, 0, 0],
                [0, J_2 + m_2 * half**2, -m_2 * half * math.sin(b)],
                [0, -m_2 * half * math.sin(b), m_2 + m_3],
            ]
        )
        drive = p.k_d * float(np.interp(t, [0, 0.01, 0.61, 0.62], [0, 1, 1, 0]))
        F_1 = m_1 * g_x + q_inf * p.b_1 * p.l_1 * abs(math.sin(a))
        F_2 = m_2 * g_x + q_inf * p.b_2 * p.l_2 * abs(math.sin(b))
        forces = [
            -F_1 * p.l_1 / 2 * math.sin(a),
            -F_2 * half * math.sin(b),
            F_2 + m_2 * half * math.cos(b) * b_1**2 + m_3 * g_x + drive,
        ]
        # l_1 cos(a) - l_2 cos(b) = x_3 and l_1 sin(a) - l_2 sin(b) = -c
        jacobian = np.array(
            [
                [-p.l_1 * math.sin(a), p.l_2 * math.sin(b), -1],
                [p.l_1 * math.cos(a), -p.l_2 * math.cos(b), 0],
            ]
        )
        gamma = [
            p.l_1 * math.cos(a) * a_1**2 - p.l_2 * math.cos(b) * b_1**2,
            p.l_1 * math.sin(a) * a_1**2 - p.l_2 * math.sin(b) * b_1**2,
        ]
        system = np.block([[mass, jacobian.T], [jacobian, np.zeros((2, 2))]])
        return [*y[3:], *np.linalg.solve(system, [*forces, *gamma])[:3]]

    def lock(_, y):
        return y[2] - p.x_lock

    lock.terminal, lock.direction = True, 1
    a = p.theta_1_initial
    y = [a, math.asin((p.l_1 * math.sin(a) + p.c) / p.l_2), p.x_3_initial, 0, 0, 0]
    t = 0.0
    for corner in [corner for corner in (0.01, 0.61, 0.62) if corner < p.t_max] + [p.t_max]:
        run = solve_ivp(rates, (t, corner), y, "DOP853", events=lock, rtol=1e-10, atol=1e-12)
        t, y = corner, run.y[:, -1]
        if len(run.t_events[0]):
            return run.t_events[0][0]
    return math.inf


CASES = {
    "table 6": TABLE_6,
    "split": TABLE_6.replace(b_1=0.0062, b_2=0.0078, delta=0.4, V_q=170),
    "table 10": TABLE_6.replace(V_q=200, k_d=1100, b=0.006, delta=-0.5),
    "after the drive": TABLE_6.replace(k_d=300),
    "never": TABLE_6.replace(k_d=150),
    "too late": TABLE_6.replace(t_max=0.536),
    "first half of the drive's rise": TABLE_6.replace(k_d=1e6, b=0.003),
    "from below": TABLE_6.replace(theta_1_initial=-0.3, x_lock=1.4, k_d=900),
    "through the dead point": TABLE_6.replace(theta_1_initial=-0.9, x_lock=1.4, k_d=900),
    "long rod": TABLE_6.replace(l_2=1.9, x_lock=1.9, k_d=1500),
    "falls into the lock": TABLE_6.replace(k_d=-50, delta=1.2),
    "back and forth": TABLE_6.replace(theta_1_initial=0.2, k_d=-250, delta=0.9, t_max=3.0),
}


@pytest.mark.parametrize("wing", CASES.values(), ids=CASES.keys())
def test_agrees_with_multipliers_integrated_by_scipy(wing):
    expected = multiplier_time(wing)
    assert ideal_deployment_times(wing, tolerance=1e-11)[0] == pytest.approx(expected, abs=1e-7)
    assert ideal_deployment_times(wing)[0] == pytest.approx(expected, abs=2e-5)


def test_some_cases_lock_and_some_do_not():
    finite = [math.isfinite(ideal_deployment_times(wing)[0]) for wing in CASES.values()]
    assert finite[:4] == [True] * 4
    assert 2 <= finite.count(False) <= 5


def test_time_by_conservation_of_energy():
    """Under a constant drive, dt = sqrt(inertia / (2 energy)) d theta_2."""
    p = TABLE_6.replace(delta=0.3)
    m_1, m_2, m_3 = 2700 * 1.5 * 0.3 * 0.007, 2700 * 1.3 * 0.2 * 0.007, 7.87
    J_A, J_2 = m_1 * (1.5**2 / 3 + 0.09 / 12), m_2 * (1.3**2 + 0.04) / 12
    weight = 9.81 * math.sin(0.3)
    drag = 0.5 * 1.293 * 0.007 * 140**2

    def pose(b):
        s = (1.3 * math.sin(b) - 0.1) / 1.5
        return math.asin(s), 1.5 * math.sqrt(1 - s * s) - 1.3 * math.cos(b)

    def energies(b, b_0, at_first):
        """Kinetic energy, given that at b_0, and the inertia that d theta_2 / dt meets."""
        (a, x), (a_0, x_0) = pose(b), pose(b_0)
        # drag of the crank: - int D sin^2 l_1/2; of the rod: int D |sin| d(x_3 + l_2/2 cos)
        crank = (
            -drag * 1.5 * 0.75 * (0.5 * (a - a_0) - 0.25 * (math.sin(2 * a) - math.sin(2 * a_0)))
        )
        rod = quad(lambda z: drag * 1.3 * math.sin(z) * x_2_rate(z), b_0, b, epsabs=1e-13)[0]
        fall = (
            m_1 * 0.75 * (math.cos(a) - math.cos(a_0))
            + m_2 * (x - x_0 + 0.65 * (math.cos(b) - math.cos(b_0)))
            + m_3 * (x - x_0)
        )
        energy = at_first + crank + rod + weight * fall + 550 * (x - x_0)
        turn = a_rate(b)
        inertia = (
            J_A * turn**2
            + J_2
            + m_2 * (x_2_rate(b) ** 2 + (0.65 * math.cos(b)) ** 2)
            + m_3 * x_3_rate(b) ** 2
        )
        return energy, inertia

    def a_rate(b):
        return 1.3 * math.cos(b) / (1.5 * math.cos(pose(b)[0]))

    def x_3_rate(b):
        return -1.5 * math.sin(pose(b)[0]) * a_rate(b) + 1.3 * math.sin(b)

    def x_2_rate(b):
        return x_3_rate(b) - 0.65 * math.sin(b)

    b_0 = math.asin(0.1 / 1.3)

    def ramp(t, y):
        b, w = y
        h = 1e-6
        inertia = energies(b, b_0, 0)[1]
        growth = (energies(b + h, b_0, 0)[1] - energies(b - h, b_0, 0)[1]) / (2 * h)
        push = (energies(b + h, b_0, 0)[0] - energies(b - h, b_0, 0)[0]) / (2 * h)
        push += (100 * t - 1) * 550 * x_3_rate(b)
        return [w, (push - 0.5 * growth * w * w) / inertia]

    # the drive rises until 0.01 s, and energy is conserved from there on
    start = solve_ivp(ramp, (0, 0.01), [b_0, 0.0], rtol=1e-9, atol=1e-13).y[:, -1]
    b_1, w_1 = start
    kinetic = 0.5 * energies(b_1, b_0, 0)[1] * w_1**2
    b_lock = brentq(lambda b: pose(b)[1] - p.x_lock, b_1, 2.0, xtol=1e-14)

    def slowness(u):
        # b = b_1 + u^2 takes the steep start out
        energy, inertia = energies(b_1 + u * u, b_1, kinetic)
        return 2 * u * math.sqrt(inertia / (2 * energy))

    expected = 0.01 + quad(slowness, 0, math.sqrt(b_lock - b_1), epsabs=1e-9, limit=200)[0]
    assert ideal_deployment_times(p, tolerance=1e-11)[0] == pytest.approx(expected, abs=1e-7)


def draws(n, seed=17):
    rng = np.random.default_rng(seed)
    return {
        "V_q": rng.normal(140, 10, n),
        "delta": np.radians(rng.normal(0, 5, n)),
        "k_d": rng.normal(550, 10, n),
        "b": rng.normal(0.007, 0.00025, n),
    }


def test_small_clearances_tend_to_it():
    """The difference shrinks about linearly in C_r, down to what the contacts give way."""
    samples = draws(20)
    ideal = ideal_deployment_times(TABLE_6, tolerance=1e-10, **samples)
    stiff = TABLE_6.replace(E_1=70e12, E_2=200e12)
    gaps = [
        np.mean(ideal - deployment_times(wing, C_r=C_r, tolerance=1e-8, **samples))
        for wing, C_r in ((TABLE_6, 1e-3), (TABLE_6, 5e-4), (stiff, 1e-4), (stiff, 5e-5))
    ]
    assert all(gap > 0 for gap in gaps)
    assert gaps[0] / gaps[1] == pytest.approx(2.0, rel=0.15)
    assert gaps[2] / gaps[3] == pytest.approx(2.0, rel=0.15)
    assert gaps[3] < 3e-5


def test_clearances_and_contact_do_not_matter():
    time = ideal_deployment_times(TABLE_6)[0]
    other = TABLE_6.replace(C_r=0.003, C_f=0.3, C_e=0.2, E_1=1e9, tangential_velocity="material")
    assert ideal_deployment_times(other)[0] == time
    assert (ideal_deployment_times(TABLE_6, C_r=[0.0005, 0.002]) == time).all()


@pytest.mark.parametrize(
    "bad",
    [
        {"V_q": math.inf},
        {"V_q": -1.0},
        {"delta": math.nan},
        {"b_2": 0.0},
        {"C_r": 0.01},
        {"C_r_C": math.nan},
        {"l_1": -1.5},
        {"l_2": 0.09},
        {"l_2": 0.505},
    ],
)
def test_an_impossible_sample_is_nan_as_in_the_full_model(bad):
    ((name, value),) = bad.items()
    good = getattr(TABLE_6, name)
    values = {name: [good, value, good]}
    times = ideal_deployment_times(TABLE_6, **values)
    assert np.isnan(times[1])
    assert times[0] == times[2] == ideal_deployment_times(TABLE_6)[0]
    assert (np.isnan(times) == np.isnan(deployment_times(TABLE_6, **values))).all()


def test_never_locks_where_the_full_model_does_not():
    k_d = [-300.0, 0.0, 150.0, 200.0, 300.0, 550.0]
    expected = np.isfinite(deployment_times(TABLE_6, k_d=k_d))
    assert (np.isfinite(ideal_deployment_times(TABLE_6, k_d=k_d)) == expected).all()
    assert ideal_deployment_times(TABLE_6, l_1=0.5, l_2=0.4)[0] == math.inf


def test_a_sample_does_not_see_its_batch():
    samples = draws(101)
    samples["k_d"][7] = 150.0
    samples["k_d"][11] = math.nan
    times = ideal_deployment_times(TABLE_6, **samples)
    assert times[7] == math.inf
    for i in (0, 6, 7, 8, 33, 64, 100):
        alone = ideal_deployment_times(TABLE_6, **{name: v[i] for name, v in samples.items()})
        assert alone[0] == times[i]
    backwards = ideal_deployment_times(TABLE_6, **{name: v[::-1] for name, v in samples.items()})
    np.testing.assert_array_equal(backwards[::-1], times)
    assert ideal_deployment_times(TABLE_6, V_q=[]).shape == (0,)


def test_error_at_the_default_tolerance():
    samples = draws(500)
    reference = ideal_deployment_times(TABLE_6, tolerance=1e-12, **samples)
    error = ideal_deployment_times(TABLE_6, **samples) - reference
    assert 0 < np.max(np.abs(error)) < 1e-6


def test_is_the_low_fidelity_partner_of_the_wing_problem():
    problem = folding_wing()
    rng = np.random.default_rng(4)
    table = ((140, 10), (0, 5), (550, 10), (7, 0.25), (1.5, 0.05))
    x = np.column_stack([rng.normal(*row, 300) for row in table])
    cheap, full = problem.low_fidelity(x), problem.model(x)
    assert cheap[0] == ideal_deployment_times(
        WingParameters(), V_q=x[0, 0], delta=math.radians(x[0, 1]), k_d=x[0, 2], b=x[0, 3] * 1e-3
    )
    assert np.corrcoef(cheap, full)[0, 1] > 0.999
    # ideal joints are late by about 0.6 ms
    assert 4e-4 < np.mean(cheap - full) < 9e-4


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ({"tolerance": -1.0}, "tolerance = -1.0"),
        ({"tolerance": 0.01}, r"tolerance = 0.01: give a number in \[1e-16, 0.001\]"),
        ({"V_q": [[1.0]]}, r"V_q has shape \(1, 1\)"),
        ({"V_q": [1.0, 2.0], "k_d": [1.0, 2.0, 3.0]}, "lengths differ"),
        ({"C_r": 0.001, "C_r_B": 0.001}, "C_r already sets C_r_B"),
    ],
)
def test_bad_calls_are_refused(arguments, message):
    with pytest.raises(ValueError, match=message):
        ideal_deployment_times(TABLE_6, **arguments)
