"""Moments at the borders of the Pearson plane: where types meet, and where they end."""

import math
import warnings

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from uqfold.moments.conditional import AtomicDistribution
from uqfold.moments.panels import integrate
from uqfold.moments.pearson import PearsonDistribution
from uqfold.moments.pearson_types import ImpossibleMomentsError, PearsonEquation


def moments_by_integration(d: PearsonDistribution) -> np.ndarray:
    """Total mass, mean, variance and third moment of the standardised variable."""

    def integrand(x: np.ndarray) -> np.ndarray:
        y, density, _, _ = d.at_coordinate(x)
        up, down = np.maximum(y, 0.0), np.maximum(-y, 0.0)
        return density * np.stack([np.ones_like(y), up, down, up**2, down**2, up**3, down**3])

    m = integrate(integrand, d.breakpoints, np.ones(7))
    return np.array([m[0], m[1] - m[2], m[3] + m[4], m[5] - m[6]])


@settings(deadline=None, max_examples=80)
@given(
    skewness=st.floats(-4, 4),
    gap=st.floats(-6, 2).map(lambda exponent: 10.0**exponent),
)
def test_all_possible_moments_are_reproduced(skewness: float, gap: float) -> None:
    d = PearsonDistribution(0.0, 1.0, skewness, skewness**2 + 1.0 + gap)
    found = moments_by_integration(d)
    expected = [1.0, 0.0, 1.0, skewness]
    np.testing.assert_allclose(found, expected, rtol=0, atol=1e-11 * (1 + abs(skewness) ** 3))
    y = np.linspace(-6, 6, 241)
    cdf, sf = d.tails(y)
    np.testing.assert_allclose(cdf + sf, 1.0, rtol=1e-13)
    assert (np.diff(cdf) >= -1e-15).all()
    assert (np.diff(sf) <= 1e-15).all()


def test_kurtosis_is_reproduced_where_the_sixth_moment_exists() -> None:
    for skewness, kurtosis in [(0.0, 1.8), (0.5, 3.2), (-1.0, 4.0), (0.2, 3.3)]:
        d = PearsonDistribution(0, 1, skewness, kurtosis)
        fourth = integrate(
            lambda x, d=d: (d.at_coordinate(x)[1] * d.at_coordinate(x)[0] ** 4)[None],
            d.breakpoints,
            np.zeros(1),
        )
        assert fourth[0] == pytest.approx(kurtosis, rel=1e-11, abs=0)


def test_the_wrong_density_would_not_pass() -> None:
    """Swapping two coefficients of Eq. (42), a likely slip, is seen by the moments."""

    class Slipped(PearsonEquation):
        @property
        def b(self) -> float:
            return 1.1 * super().b

    from uqfold.moments.pearson_table import PearsonTable

    d = PearsonDistribution(0, 1, 0.5, 3.6)
    d._table = PearsonTable(Slipped(0.5, 3.6))
    assert abs(moments_by_integration(d)[3] - 0.5) > 1e-3


@pytest.mark.parametrize("nudge", [-1e-7, -1e-11, 0.0, 1e-11, 1e-7])
@pytest.mark.parametrize("skewness", [0.0, 1e-3, 0.7, 2.0])
def test_nothing_jumps_across_type_three(skewness: float, nudge: float) -> None:
    y = np.array([-1.0, 0.0, 1.0, 3.0, 6.0])
    at = PearsonDistribution(0, 1, skewness, 3 + 1.5 * skewness**2)
    near = PearsonDistribution(0, 1, skewness, 3 + 1.5 * skewness**2 + nudge)
    np.testing.assert_allclose(near.sf(y), at.sf(y), rtol=200 * abs(nudge) + 1e-11, atol=0)


def kurtosis_of_type_five(skewness: float) -> float:
    """Where the denominator of Eq. (42) has a double root, by bisection."""
    low, high = 3 + 1.5 * skewness**2 + 1e-9, 1e4
    while high - low > 1e-15 * high and 0.5 * (low + high) not in (low, high):
        middle = 0.5 * (low + high)
        if PearsonEquation(skewness, middle).discriminant > 0:
            low = middle
        else:
            high = middle
    return high


def test_nothing_jumps_across_type_five() -> None:
    kurtosis = kurtosis_of_type_five(0.8)
    at = PearsonDistribution(0, 1, 0.8, kurtosis)
    assert at.type == "V"
    y = np.array([-1.5, 0.0, 1.0, 3.0, 8.0])
    for nudge, name in ((-1e-7, "VI"), (1e-7, "IV")):
        near = PearsonDistribution(0, 1, 0.8, kurtosis + nudge)
        assert near.type == name
        np.testing.assert_allclose(near.sf(y), at.sf(y), rtol=1e-4)


def test_the_coefficient_a_may_vanish() -> None:
    """10 k = 12 s^2 + 18; with s = 0 that is the uniform distribution."""
    assert PearsonEquation(0.0, 1.8).a == 0.0
    d = PearsonDistribution(0.0, 1.0, 0.0, 1.8)
    y = np.linspace(-1.7, 1.7, 7)
    np.testing.assert_allclose(d.pdf(y), 1 / math.sqrt(12), rtol=1e-13)
    skewed = PearsonDistribution(0.0, 1.0, 0.5, 2.1)
    assert abs(PearsonEquation(0.5, 2.1).a) < 1e-14
    np.testing.assert_allclose(moments_by_integration(skewed), [1, 0, 1, 0.5], atol=1e-12)


def test_beyond_the_end_pf_is_zero_and_the_end_is_known() -> None:
    d = PearsonDistribution(10.0, 2.0, 0.0, 1.8)
    end = 10.0 + 2.0 * math.sqrt(3.0)
    assert d.support[1] == pytest.approx(end, rel=1e-14, abs=0)
    np.testing.assert_array_equal(d.sf([end + 1e-9, 100.0, math.inf]), 0.0)
    assert float(d.sf(end - 1e-9)) == pytest.approx(1e-9 / (4 * math.sqrt(3)), rel=1e-5, abs=0)
    np.testing.assert_array_equal(d.pdf([end + 1e-9, 6.0]), 0.0)


def test_heavy_tails_never_underflow_to_zero_early() -> None:
    d = PearsonDistribution(0, 1, 0.0, 9.0)  # Student's t with 5 degrees of freedom
    far = 1e40
    scale = math.sqrt(3 / 5)
    leading = 2 / math.pi / math.sqrt(5) * 4 / 3 * 5**3 / 5 * (far / scale) ** -5.0
    assert float(d.sf(far)) == pytest.approx(leading, rel=1e-9, abs=0)


def test_infinite_values_and_nan() -> None:
    for skewness in (0.3, -0.3):
        d = PearsonDistribution(0, 1, skewness, 3.2)
        cdf, sf = d.tails([-math.inf, math.inf, math.nan])
        np.testing.assert_array_equal(cdf, [0, 1, math.nan])
        np.testing.assert_array_equal(sf, [1, 0, math.nan])
        np.testing.assert_array_equal(d.pdf([-math.inf, math.inf]), 0.0)
    assert d.cdf(0.3).shape == ()
    assert d.cdf(np.zeros((2, 3))).shape == (2, 3)


@pytest.mark.parametrize(
    ("moments", "match"),
    [
        ((0, 1, 1.0, 1.9), r"skewness\^2 \+ 1 = 2.0"),
        ((0, 1, 0.0, 0.2), "excess"),
        ((0, -1, 0, 3), "std must not be negative"),
        ((0, 1, math.nan, 3), "finite"),
        ((0, 1, 0, math.inf), "finite"),
        ((math.inf, 1, 0, 3), "finite"),
    ],
)
def test_impossible_moments_are_refused(
    moments: tuple[float, float, float, float], match: str
) -> None:
    with pytest.raises(ImpossibleMomentsError, match=match):
        PearsonDistribution.from_moments(*moments)


@pytest.mark.parametrize("skewness", [0.0, 1.5, -1.5, 8.0])
def test_two_point_distribution(skewness: float) -> None:
    d = PearsonDistribution.from_moments(5.0, 2.0, skewness, skewness**2 + 1.0)
    assert isinstance(d, AtomicDistribution)
    values, p = d.atoms
    z = (values - 5.0) / 2.0
    found = [p @ z**power for power in (0, 1, 2, 3, 4)]
    np.testing.assert_allclose(found, [1, 0, 1, skewness, skewness**2 + 1], atol=1e-12, rtol=1e-12)


def test_no_scatter_is_a_step_whatever_the_other_moments() -> None:
    assert PearsonDistribution.from_moments(5.0, 0.0, 0.0, 3.0) == AtomicDistribution((5.0,))
    with pytest.raises(ValueError, match="from_moments"):
        PearsonDistribution(5.0, 0.0, 0.0, 3.0)


@pytest.mark.parametrize("p", [-0.1, 1.1, math.nan])
def test_quantiles_want_probabilities(p: float) -> None:
    with pytest.raises(ValueError, match=r"outside \[0, 1\]"):
        PearsonDistribution(0, 1, 0.1, 3.0).ppf(p)


def test_no_warning_is_raised_anywhere_in_the_plane() -> None:
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        for skewness in (0.0, 1e-9, 0.4, 3.0, -20.0):
            for gap in (1e-9, 1e-3, 0.8, 2.0, 3.0, 100.0, 1e6):
                d = PearsonDistribution(0, 1, skewness, skewness**2 + 1 + gap)
                d.tails(np.linspace(-40, 40, 101))
                d.logpdf(np.linspace(-40, 40, 101))
                d.ppf(np.linspace(0, 1, 101))
                d.at_coordinate(d.coordinate(np.linspace(-3, 3, 11)))
