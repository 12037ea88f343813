"""The paper's own form of the equations, in `validation`: its equations, constraints and times."""

import math

import numpy as np
import pytest

from uqfold.mechanism import WingParameters, deployment_times
from validation.mechanism.baumgarte import Multibody
from validation.mechanism.independent import FiveCoordinateWing, follow

TABLE_6 = WingParameters(C_r=0.0015)
SPLIT = TABLE_6.replace(
    C_r_B=0.001, b_2=0.006, E_j_C=200e9, nu_b_B=0.2, contact_law="flores-2011", C_e=0.7, delta=0.3
)
MATERIAL = SPLIT.replace(tangential_velocity="material", contact_law="gonthier")


def nine(p: WingParameters, y: np.ndarray) -> np.ndarray:
    """Coordinates and velocities (18,) of the paper that belong to those of the reduced form."""
    theta_1, x_2, y_2, theta_2, x_3, turn, *others = y
    crank = p.l_1 / 2 * np.exp(1j * theta_1)
    rate = 1j * turn * crank
    u_2, v_2, turn_2, u_3 = others
    q = [crank.real, crank.imag, theta_1, x_2, y_2, theta_2, x_3, -p.c, 0.0]
    return np.array([*q, rate.real, rate.imag, turn, u_2, v_2, turn_2, u_3, 0.0, 0.0])


def near_contact(p: WingParameters, rng: np.random.Generator) -> np.ndarray:
    """A state (10,) of the reduced form in which either joint may touch."""
    e_B, e_C = (
        (C_r + rng.uniform(-1, 2) * 1e-4) * np.exp(1j * rng.uniform(0, 7))
        for C_r in (p.C_r_B, p.C_r_C)
    )
    theta_1 = rng.uniform(-0.8, 0.8)
    journal = p.l_1 * np.exp(1j * theta_1) + e_B
    theta_2 = math.asin((journal.imag - e_C.imag + p.c) / p.l_2)
    rod = p.l_2 * np.exp(1j * theta_2)
    middle = journal - rod / 2
    return np.array(
        [
            theta_1,
            middle.real,
            middle.imag,
            theta_2,
            (journal - rod - e_C).real,
            *rng.normal(size=5),
        ]
    )


@pytest.mark.parametrize("wing", [TABLE_6, SPLIT, MATERIAL], ids=["table 6", "split", "material"])
@pytest.mark.parametrize("coefficients", [(0.0, 0.0), (20.0, 200.0)])
def test_multipliers_give_the_accelerations_of_virtual_power(
    wing: WingParameters, coefficients: tuple[float, float]
) -> None:
    rng = np.random.default_rng(3)
    multibody, independent = Multibody(wing, *coefficients), FiveCoordinateWing(wing)
    own = [2, 3, 4, 5, 6]
    touched = 0
    for _ in range(40):
        y = near_contact(wing, rng)
        state = nine(wing, y)
        np.testing.assert_allclose(multibody.constraints(state.tolist()), 0.0, atol=1e-15)
        expected = np.array(independent.rates(0.3, y, [0.2, 0.3]))[5:]
        got = multibody.rates(0.3, state, [0.2, 0.3])[9:][own]
        np.testing.assert_allclose(got, expected, rtol=1e-8, atol=1e-8)
        for which in (0, 1):
            gap = multibody.penetration(state.tolist(), which)
            assert gap == pytest.approx(independent.penetration(y.tolist(), which), abs=1e-12)
            touched += gap[0] > 0
    assert touched > 20


def test_a_violated_constraint_is_driven_back() -> None:
    """Its acceleration is -2 alpha times its rate - beta^2 times itself, as Eq. (20) has it."""
    alpha, beta, h = 30.0, 70.0, 1e-6
    multibody = Multibody(TABLE_6, alpha, beta)
    state = nine(TABLE_6, near_contact(TABLE_6, np.random.default_rng(5)))
    state[[0, 1, 7, 8]] += [1e-3, -2e-3, 3e-3, 1e-3]
    state[[9, 10, 16, 17]] += [0.1, 0.2, -0.3, 0.4]
    phi, rate = multibody.constraints(state.tolist())
    derivative = multibody.rates(0.3, state, [None, None])
    above, below = (
        multibody.constraints((state + sign * h * derivative).tolist())[1] for sign in (1, -1)
    )
    got = (above - below) / (2 * h)
    np.testing.assert_allclose(got, -2 * alpha * rate - beta**2 * phi, rtol=1e-6)


@pytest.mark.parametrize(
    ("wing", "alpha", "beta"),
    [(SPLIT, 50, 50), (MATERIAL, 0, 300)],
    ids=["split", "material"],
)
def test_locks_when_the_reduced_form_does_whatever_alpha_and_beta(
    wing: WingParameters, alpha: float, beta: float
) -> None:
    """With an early lock; the case `against_other_codes` has that of the paper."""
    early = wing.replace(x_lock=wing.x_3_initial + 0.01)
    expected = deployment_times(early, tolerance=1e-12)[0]
    multibody = Multibody(early, alpha, beta)
    time, states, locked = follow(multibody)
    assert 0.03 < expected < 0.2
    assert locked == pytest.approx(expected, abs=1e-6)
    assert time[-1] == locked
    assert states[-1, 6] == pytest.approx(early.x_lock, abs=1e-9)
    assert 0 < max(np.abs(multibody.constraints(state)[0]).max() for state in states) < 1e-9
    # both joints have been struck by then
    gaps = [multibody.penetration(state, which)[0] for state in states for which in (0, 1)]
    assert max(gaps[::2]) > 0
    assert max(gaps[1::2]) > 0


def test_runs_to_the_time_limit_without_a_lock() -> None:
    time, _, locked = follow(Multibody(TABLE_6.replace(t_max=0.005)))
    assert (locked, time[-1]) == (math.inf, 0.005)
