from fractions import Fraction

import numpy as np
import pytest

from uqfold.moments.cumulants import cumulants, moments_from_rule


def exact_moments(values: list[int], weights: list[int]) -> tuple[float, ...]:
    """Mean, variance, third and fourth central moment in rational arithmetic."""
    total = sum(weights)
    mean = Fraction(sum(w * y for y, w in zip(values, weights, strict=True)), total)
    central = [
        sum(w * (y - mean) ** p for y, w in zip(values, weights, strict=True)) / total
        for p in (2, 3, 4)
    ]
    return float(mean), *(float(c) for c in central)


VALUES, WEIGHTS = [3, 7, 8, 20, 21], [5, 1, 2, 9, 4]


def test_moments_match_rational_arithmetic() -> None:
    mean, m2, m3, m4 = exact_moments(VALUES, WEIGHTS)
    found = moments_from_rule([VALUES], WEIGHTS)
    assert found.row(0) == pytest.approx(
        (mean, m2**0.5, m3 / m2**1.5, m4 / m2**2), rel=1e-14, abs=0
    )
    assert len(found) == 1


@pytest.mark.parametrize("offset", [0.0, 1e3, 1e9])
def test_a_large_mean_costs_no_digits(offset: float) -> None:
    _, m2, m3, m4 = exact_moments(VALUES, WEIGHTS)
    found = moments_from_rule(np.array([VALUES]) + offset, WEIGHTS)
    assert found.row(0)[1:] == pytest.approx((m2**0.5, m3 / m2**1.5, m4 / m2**2), rel=1e-14, abs=0)


def test_a_constant_row_scatters_by_exactly_zero() -> None:
    weights = np.polynomial.hermite_e.hermegauss(5)[1]
    found = moments_from_rule(np.full((1, 5), 0.1), weights)
    assert found.row(0) == (0.1, 0.0, 0.0, 3.0)


def test_rows_are_independent_and_masked_nodes_renormalised() -> None:
    y = np.array([[1.0, 2.0, np.inf, 5.0], [4.0, np.nan, np.nan, np.nan], [np.nan] * 4])
    w = np.array([0.1, 0.2, 0.3, 0.4])
    found = moments_from_rule(y, w, np.isfinite(y))
    alone = moments_from_rule(y[:1, [0, 1, 3]], w[[0, 1, 3]])
    assert found.row(0) == pytest.approx(alone.row(0), rel=1e-15, abs=0)
    assert found.row(1) == (4.0, 0.0, 0.0, 3.0)
    assert np.isnan(found.row(2)).all()


def test_values_that_are_not_finite_must_be_masked() -> None:
    with pytest.raises(ValueError, match="NaN or inf"):
        moments_from_rule([[1.0, np.inf]], [0.5, 0.5])


def test_shapes_are_checked() -> None:
    with pytest.raises(ValueError, match=r"\(2,\)"):
        moments_from_rule([[1.0, 2.0, 3.0]], [0.5, 0.5])


def test_normal_rule_has_no_higher_cumulants() -> None:
    x, w = np.polynomial.hermite_e.hermegauss(5)
    k = cumulants(moments_from_rule([3.0 + 2.0 * x], w))[:, 0]
    np.testing.assert_allclose(k, [3.0, 4.0, 0.0, 0.0], atol=1e-12)


@pytest.mark.parametrize("exponent", [-1000, -700, -530, 520, 700, 1000])
def test_moments_hold_in_every_unit(exponent: int) -> None:
    """No square of a response leaves the floats: in units of 2^exponent, digit for digit."""
    y, weights = np.array([[1.0, 4.0, 2.0, 7.0]]), np.array([0.1, 0.2, 0.3, 0.4])
    plain = moments_from_rule(y, weights)
    far = moments_from_rule(np.ldexp(y, exponent), weights)
    assert far.mean == np.ldexp(plain.mean, exponent)
    assert far.std == np.ldexp(plain.std, exponent)
    assert far.skewness == plain.skewness
    assert far.kurtosis == plain.kurtosis
