"""Contact law and equations of motion, as plain Python and compiled."""

import math

import numpy as np
import pytest

from uqfold.mechanism import WingParameters
from uqfold.mechanism.contact import contact_forces, hertz_stiffness
from uqfold.mechanism.loads import drive_force, next_drive_corner
from uqfold.mechanism.motion import LARGEST_TURN, accelerations, directions, gaps, turned
from uqfold.mechanism.wing import Wings, wing_constants
from validation.mechanism.independent import FiveCoordinateWing


def plain(kernel):
    """The Python function under a kernel; the kernel itself where numba is switched off."""
    return getattr(kernel, "py_func", kernel)


def constants(p):
    return wing_constants(Wings(p).table()[0])


def test_stiffness_of_equation_6():
    # by hand: h = (1 - 0.33^2) / 70e9 twice, R = 10 and 8 mm
    h = (1 - 0.33**2) / 70e9
    expected = 4 / (3 * 2 * h) * math.sqrt(0.010 * 0.008 / 0.018)
    assert plain(hertz_stiffness)(0.010, 0.008, 70e9, 0.33, 70e9, 0.33) == pytest.approx(expected)
    assert 3.4e9 < expected < 3.6e9


@pytest.mark.parametrize("force", [plain(contact_forces), contact_forces])
def test_normal_force_of_equation_5(force):
    K, damping = 3e9, 0.75 * (1 - 0.9**2) / 0.2
    elastic = K * 1e-5**1.5
    for rate, factor in ((0.0, 1.0), (0.2, 1 + 0.75 * 0.19), (-0.2, 1 - 0.75 * 0.19)):
        normal, tangential = force(1e-5, rate, 0.0, K, damping, 0.1, 1e-3, 1 / 9e-3)
        assert normal == pytest.approx(elastic * factor, rel=1e-12)
        assert tangential == 0.0
    # a journal that is torn away does not pull
    assert force(1e-5, -100.0, 0.5, K, damping, 0.1, 1e-3, 1 / 9e-3) == (0.0, 0.0)


@pytest.mark.parametrize("force", [plain(contact_forces), contact_forces])
def test_friction_ramp_of_equation_7_follows_the_journal(force):
    for sliding, share in ((0.0, 0), (0.9e-3, 0), (5.5e-3, 0.5), (0.010, 1), (3.0, 1)):
        for sign in (1, -1):
            normal, tangential = force(1e-5, 0.0, sign * sliding, 3e9, 1.0, 0.1, 1e-3, 1 / 9e-3)
            assert tangential == pytest.approx(sign * 0.1 * share * normal)


def test_drive_of_equation_13_and_its_corners():
    times = [0.0, 0.005, 0.01, 0.3, 0.61, 0.615, 0.62, 1.0]
    forces = [plain(drive_force)(t, 500.0) for t in times]
    assert forces == pytest.approx([0, 250, 500, 500, 500, 250, 0, 0], abs=1e-9)
    corners = [plain(next_drive_corner)(t, 2.0) for t in times]
    assert corners == [0.01, 0.01, 0.61, 0.61, 0.62, 0.62, 2.0, 2.0]
    assert plain(next_drive_corner)(0.3, 0.4) == 0.4


@pytest.mark.parametrize("turn", [0.0, 1e-9, 1e-3, -0.01, 0.0199999, -LARGEST_TURN])
def test_directions_turned_on_equal_directions_anew(turn):
    q = (0.7, 0.0, 0.0, -1.1, 0.0)
    q_new = (0.7 + turn, 0.0, 0.0, -1.1 - turn, 0.0)
    got = plain(turned)(plain(directions)(q), q, q_new)
    assert got == pytest.approx(plain(directions)(q_new), abs=1e-13, rel=0)


@pytest.mark.parametrize("split", [{}, {"C_r_B": 0.001, "b_2": 0.006, "E_j_C": 200e9}])
@pytest.mark.parametrize("velocity", ["geometric", "material"])
def test_accelerations_equal_those_by_virtual_power(velocity, split):
    rng = np.random.default_rng(7)
    p = WingParameters(C_r=0.0015, delta=0.3, tangential_velocity=velocity).replace(**split)
    w, independent = constants(p), FiveCoordinateWing(p)
    touched = 0
    for _ in range(40):
        e_B, e_C = (
            (C_r + rng.uniform(-1, 2) * 1e-4) * np.exp(1j * rng.uniform(0, 7))
            for C_r in (p.C_r_B, p.C_r_C)
        )
        theta_1 = rng.uniform(-0.8, 0.8)
        journal = p.l_1 * np.exp(1j * theta_1) + e_B
        theta_2 = math.asin((journal.imag - e_C.imag + p.c) / p.l_2)
        if rng.random() < 0.5:
            theta_2 = math.pi - theta_2
        rod = p.l_2 * np.exp(1j * theta_2)
        middle = journal - rod / 2
        x_3 = (journal - rod - e_C).real
        y = np.array([theta_1, middle.real, middle.imag, theta_2, x_3, *rng.normal(0, 1, 5)])
        onset = 0.3
        expected = independent.rates(0.3, y, [onset, onset])[5:]
        q, v = tuple(y[:5]), tuple(y[5:])
        z = independent.bodies.hysteresis / onset
        d = directions(q)
        got = plain(accelerations)(w, q, v, d, z, z, p.k_d)
        assert got == pytest.approx(expected, rel=1e-8, abs=1e-8)
        gap_B, _, gap_C, _ = plain(gaps)(w, q, v, d)
        for which, gap in enumerate((gap_B, gap_C)):
            assert math.copysign(1, gap) == math.copysign(1, independent.penetration(y, which)[0])
            touched += gap > 0
    assert touched > 20
