"""Contact laws: what one impact returns, and that no law ever pulls."""

import math
from typing import get_args

import pytest
from scipy.integrate import solve_ivp
from scipy.optimize import brentq

from uqfold.mechanism import ContactLaw, WingParameters, trajectory
from uqfold.mechanism.contact import contact_forces, hysteresis_factor

LAWS = get_args(ContactLaw)
PLAIN_FORCES = getattr(contact_forces, "py_func", contact_forces)


def force(depth, rate, stiffness, h, onset):
    return PLAIN_FORCES(max(depth, 0.0), rate, 0.0, stiffness, h / onset, 0.1, 1e-3, 1 / 9e-3)[0]


def measured_restitution(h, onset, mass=2.0, stiffness=3e9):
    """Speed after over speed before, of a mass that flies against a wall."""

    def rates(_, y):
        return [y[1], -force(y[0], y[1], stiffness, h, onset) / mass]

    def free(_, y):
        return y[0]

    free.terminal, free.direction = True, -1
    depth = (mass * onset**2 / stiffness) ** 0.4
    scale = depth / onset
    run = solve_ivp(
        rates, (0, 50 * scale), [0.0, onset], "DOP853", events=free, rtol=1e-11, atol=1e-13 * depth
    )
    assert run.status == 1
    return -run.y_events[0][0, 1] / onset


def exact_restitution(h):
    """Root e of h (1 + e) = ln((1 + h) / (1 - h e)): the equation of motion, integrated once."""
    if h == 0:
        return 1.0

    def balance(e):
        return math.log1p(h) - math.log1p(-h * e) - h * (1 + e)

    return brentq(balance, 0.0, min(1.0, (1 - 1e-12) / h), xtol=1e-15)


@pytest.mark.parametrize("law", LAWS)
@pytest.mark.parametrize("C_e", [1.0, 0.9, 0.5])
def test_an_impact_returns_what_the_hysteresis_factor_says(law, C_e):
    h = hysteresis_factor(law, C_e)
    expected = exact_restitution(h)
    assert measured_restitution(h, onset=0.01) == pytest.approx(expected, abs=1e-8)
    # neither speed, nor mass, nor stiffness matters
    other = measured_restitution(h, onset=2.0, mass=0.1, stiffness=1e7)
    assert other == pytest.approx(expected, abs=1e-8)


@pytest.mark.parametrize(
    ("law", "at_0_9", "at_0_5"),
    [
        ("lankarani-nikravesh", 0.913, 0.725),
        ("hunt-crossley", 0.909, 0.663),
        ("flores-2011", 0.894, 0.470),
        ("gonthier", 0.876, 0.488),
    ],
)
def test_what_each_law_makes_of_its_coefficient_of_restitution(law, at_0_9, at_0_5):
    assert exact_restitution(hysteresis_factor(law, 0.9)) == pytest.approx(at_0_9, abs=5e-4)
    assert exact_restitution(hysteresis_factor(law, 0.5)) == pytest.approx(at_0_5, abs=5e-4)


def test_factors_by_hand():
    factors = [hysteresis_factor(law, 0.8) for law in LAWS]
    assert LAWS[0] == WingParameters().contact_law == "lankarani-nikravesh"
    assert factors == pytest.approx([0.27, 0.3, 0.4, 0.45], rel=1e-15)
    assert all(hysteresis_factor(law, 1.0) == 0.0 for law in LAWS)


@pytest.mark.parametrize("law", LAWS)
def test_no_law_pulls_and_each_loses_energy(law):
    h = hysteresis_factor(law, 0.6)
    for rate in (-50.0, -1.0, -0.1, 0.0, 0.1, 1.0):
        elastic = 3e9 * 1e-5**1.5
        normal = force(1e-5, rate, 3e9, h, 0.1)
        assert normal >= 0.0
        assert (normal - elastic) * rate >= 0.0
    motion = trajectory(WingParameters(C_r=0.0015, C_e=0.6, contact_law=law))
    assert motion.normal_force.min() >= 0.0
    assert motion.contact_loss[-1].min() > 0.0


def test_a_law_that_returns_less_loses_more():
    C_e = 0.5
    by_restitution = sorted(LAWS, key=lambda law: exact_restitution(hysteresis_factor(law, C_e)))
    lost = [
        trajectory(WingParameters(C_e=C_e, contact_law=law, C_f=0.0), tolerance=1e-8)
        for law in (by_restitution[0], by_restitution[-1])
    ]
    # of the energy of the first impact, before histories part
    first = [motion.contact_loss[_end_of_first_contact(motion), 0] for motion in lost]
    assert first[0] > 1.2 * first[1]


def _end_of_first_contact(motion):
    touching = motion.penetration[:, 0] > 0
    begins = touching.argmax()
    return begins + (~touching[begins:]).argmax()
