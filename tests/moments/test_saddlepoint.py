import math
from decimal import Decimal, getcontext

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy import stats

from uqfold.moments.conditional import AtomicDistribution
from uqfold.moments.pearson import PearsonDistribution
from uqfold.moments.pearson_types import ImpossibleMomentsError
from uqfold.moments.saddlepoint import SaddlepointDistribution

getcontext().prec = 60
PI = Decimal("3.14159265358979323846264338327950288419716939937510582097494459")


def normal_cdf(w: Decimal) -> Decimal:
    """Phi(w) by its Maclaurin series in 60 digits."""
    term, total, k = w, w, 0
    while abs(term) > Decimal(10) ** -58:
        k += 1
        term *= -w * w / (2 * k)
        total += term / (2 * k + 1)
    return Decimal("0.5") + total / (2 * PI).sqrt()


def as_printed(x: float, skewness: float, excess: float) -> tuple[float, float]:
    """(cdf, sf) from Eqs. (34)-(36) as printed, at a standardised x, in 60 digits."""
    target, l3, l4 = Decimal(x), Decimal(skewness), Decimal(excess)
    s = target
    for _ in range(200):
        error = s + l3 * s**2 / 2 + l4 * s**3 / 6 - target
        s -= error / (1 + l3 * s + l4 * s**2 / 2)
    k = s**2 / 2 + l3 * s**3 / 6 + l4 * s**4 / 24
    w = (2 * (s * target - k)).sqrt().copy_sign(s)
    v = s * (1 + l3 * s + l4 * s**2 / 2).sqrt()
    phi = (-w * w / 2).exp() / (2 * PI).sqrt()
    cdf = normal_cdf(w) + phi * (1 / w - 1 / v)
    return float(cdf), float(1 - cdf)


@pytest.mark.parametrize(("skewness", "excess"), [(0.6, 0.5), (-0.6, 0.5), (0.1, -0.05), (0, 0.3)])
@pytest.mark.parametrize("x", [-2.5, -0.7, -1e-3, -1e-9, 1e-12, 1e-6, 0.02, 1.0, 2.5, 7.0])
def test_equals_the_printed_formulas(x: float, skewness: float, excess: float) -> None:
    d = SaddlepointDistribution(0.0, 1.0, skewness, 3.0 + excess)
    if not d.window[0] < x < d.window[1]:
        return
    cdf, sf = as_printed(x, skewness, excess)
    assert float(d.cdf(x)) == pytest.approx(cdf, rel=2e-13, abs=0)
    assert float(d.sf(x)) == pytest.approx(sf, rel=2e-13, abs=0)


def test_at_the_mean() -> None:
    """F(kappa_1) = 1/2 + skewness / (6 sqrt(2 pi)), not 1/2."""
    d = SaddlepointDistribution(2.0, 3.0, 0.6, 3.5)
    expected = 0.5 + 0.6 / (6 * math.sqrt(2 * math.pi))
    assert float(d.cdf(2.0)) == pytest.approx(expected, rel=1e-15, abs=0)
    assert float(d.sf(2.0)) == pytest.approx(1 - expected, rel=1e-15, abs=0)
    assert abs(expected - 0.5) > 0.03


def test_normal_cumulants_give_the_normal_to_the_last_tail() -> None:
    d = SaddlepointDistribution(1.0, 2.0, 0.0, 3.0)
    y = 1.0 + 2.0 * np.array([-37.0, -8.0, -1.0, 0.0, 2.0, 7.03, 37.0])
    np.testing.assert_allclose(d.cdf(y), stats.norm(1, 2).cdf(y), rtol=1e-12)
    np.testing.assert_allclose(d.sf(y), stats.norm(1, 2).sf(y), rtol=1e-12)


@pytest.mark.parametrize("shape", [9.0, 100.0])
def test_gamma_in_the_body(shape: float) -> None:
    """Four cumulants of a gamma variable: right within a few per cent in the body."""
    d = SaddlepointDistribution(shape, shape**0.5, 2 / shape**0.5, 3 + 6 / shape)
    y = stats.gamma(shape).isf([0.9, 0.5, 0.1, 0.01])
    np.testing.assert_allclose(d.sf(y), [0.9, 0.5, 0.1, 0.01], rtol=0.3 / shape**0.5)


def test_mirror_image() -> None:
    y = np.linspace(-4, 4, 41)
    right = SaddlepointDistribution(0, 1, 0.8, 4.5).evaluate(y)
    left = SaddlepointDistribution(0, 1, -0.8, 4.5).evaluate(-y)
    np.testing.assert_allclose(right.sf, left.cdf, rtol=1e-13)


def test_infinite_thresholds_and_nan() -> None:
    value = SaddlepointDistribution(0, 1, 0.3, 3.2).evaluate([-math.inf, math.inf, math.nan])
    np.testing.assert_array_equal(value.cdf, [0, 1, math.nan])
    np.testing.assert_array_equal(value.sf, [1, 0, math.nan])
    assert not value.fallback.any()
    assert value.message == ""


def test_no_scatter_is_a_step() -> None:
    d = SaddlepointDistribution(2.0, 0.0, 0.0, 3.0)
    np.testing.assert_array_equal(d.sf([1.9, 2.0, 2.1]), [1, 0, 0])
    np.testing.assert_array_equal(d.cdf([1.9, 2.0, 2.1]), [0, 1, 1])


def test_planted_quartic_without_a_saddlepoint() -> None:
    """Skewness 0, excess -0.1: K' peaks at 2.98 sigma; F stops rising a little before."""
    d = SaddlepointDistribution(0.0, 1.0, 0.0, 2.9)
    peak = math.sqrt(20.0) * (1 - 0.1 * 20.0 / 6.0)
    assert peak == pytest.approx(2.98, abs=0.002)
    assert 2.9 < d.window[1] < peak
    assert d.window[0] == pytest.approx(-d.window[1], rel=1e-12, abs=0)
    y = np.array([-3.5, -2.9, 0.0, 2.9, 2.97, 3.5, 20.0])
    value = d.evaluate(y)
    np.testing.assert_array_equal(value.fallback, [True, False, False, False, True, True, True])
    pearson = PearsonDistribution(0.0, 1.0, 0.0, 2.9)
    np.testing.assert_array_equal(value.sf[[0, 5, 6]], pearson.sf(y[[0, 5, 6]]))
    assert "no admissible saddlepoint at 4 of 7" in value.message


def test_fallback_never_lets_the_curve_turn() -> None:
    d = SaddlepointDistribution(0.0, 1.0, 3.0, 10.5)
    value = d.evaluate(np.linspace(-3, 3, 6001))
    assert value.fallback.any()
    assert value.clipped.any()
    assert not (value.clipped & ~value.fallback).any()
    assert "stay monotone" in value.message


@settings(deadline=None, max_examples=60)
@given(st.floats(-6, 6), st.floats(1e-6, 50))
def test_is_a_distribution_function_for_all_possible_moments(skewness: float, gap: float) -> None:
    d = SaddlepointDistribution(0.0, 1.0, skewness, skewness**2 + 1.0 + gap)
    value = d.evaluate(np.linspace(-9, 9, 1801))
    assert ((value.cdf >= 0) & (value.cdf <= 1) & (value.sf >= 0) & (value.sf <= 1)).all()
    assert (np.diff(value.cdf) >= -1e-15).all()
    assert (np.diff(value.sf) <= 1e-15).all()
    np.testing.assert_allclose(value.cdf + value.sf, 1.0, rtol=1e-14)


def test_two_point_moments_fall_back_to_atoms() -> None:
    d = SaddlepointDistribution(0.0, 1.0, 4.0, 17.0)
    atoms = PearsonDistribution.from_moments(0.0, 1.0, 4.0, 17.0)
    assert isinstance(atoms, AtomicDistribution)
    np.testing.assert_allclose(d.sf([-0.5, 0.0, 4.0]), atoms.sf([-0.5, 0.0, 4.0]), rtol=1e-14)


@pytest.mark.parametrize(
    "moments", [(0, 1, 2, 4.9), (0, -1, 0, 3), (math.nan, 1, 0, 3), (0, 1, 0, math.inf)]
)
def test_impossible_moments(moments: tuple[float, float, float, float]) -> None:
    with pytest.raises(ImpossibleMomentsError):
        SaddlepointDistribution(*moments)
