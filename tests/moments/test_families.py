"""Distributions beyond four cumulants, against gamma and chi-square responses known exactly."""

import math

import numpy as np
import pytest
from scipy import special, stats

from uqfold.moments.conditional import AtomicDistribution, integrable
from uqfold.moments.cubic_normal import cornish_fisher
from uqfold.moments.cumulants import ResponseMoments
from uqfold.moments.families import FAMILIES
from uqfold.moments.generating import Cumulants, QuadraticForm
from uqfold.moments.maximum_entropy import maximum_entropy
from uqfold.moments.saddlepoint import SaddlepointDistribution
from uqfold.typing import FloatArray

NORMAL = ResponseMoments(10.0, 2.0, 0.0, 3.0, 0.0, 15.0)


def gamma_moments(shape: float) -> ResponseMoments:
    """Moments of a gamma variable of unit scale: its cumulants are shape (r - 1)!."""
    k3, k4, k5, k6 = (math.factorial(r - 1) * shape ** (1 - r / 2) for r in (3, 4, 5, 6))
    kurtosis = 3.0 + k4
    return ResponseMoments(
        shape,
        math.sqrt(shape),
        k3,
        kurtosis,
        k5 + 10.0 * k3,
        k6 + 15.0 * kurtosis + 10.0 * k3**2 - 30.0,
    )


def test_six_cumulants_reach_further_than_four() -> None:
    known = gamma_moments(25.0)
    exact = [2 / 5, 6 / 25, 24 / 125, 120 / 625]
    assert known.higher_cumulants == pytest.approx(exact, rel=1e-12)
    y = stats.gamma(25).isf([1e-3, 1e-6])
    four, six = (FAMILIES[name].fit(known).sf(y) for name in ("saddlepoint", "saddlepoint-6"))  # type: ignore[union-attr]
    assert np.abs(four / [1e-3, 1e-6] - 1.0) == pytest.approx([0.069, 0.45], rel=0.05)
    assert np.abs(six / [1e-3, 1e-6] - 1.0) == pytest.approx([0.0017, 0.078], rel=0.1)


def quadratic(squares: list[float], linear: list[float]) -> SaddlepointDistribution:
    """The distribution of sum (l u^2 + b u), rotated so that the matrix is not diagonal."""
    values, along = np.array(squares), np.array(linear)
    turn = np.linalg.qr(np.arange(1.0, 1.0 + values.size**2).reshape(values.size, -1) ** 0.5)[0]
    k = [
        0.5 * math.factorial(r) / r * (2.0 * values) ** r
        + 0.5 * math.factorial(r) * (2.0 * values) ** (r - 2) * along**2
        for r in (2, 3, 4)
    ]
    k2, k3, k4 = (float(one.sum()) for one in k)
    std = math.sqrt(k2)
    form = QuadraticForm.of(turn @ np.diag(values) @ turn.T, turn @ along, std)
    return SaddlepointDistribution(values.sum(), std, k3 / std**3, 3.0 + k4 / k2**2, form)


@pytest.mark.parametrize(
    ("squares", "linear", "error"),
    [([0.05], [1.0], 3e-4), ([0.3, 0.3], [0.9, 0.2], 0.015), ([0.5] * 3, [0.0] * 3, 0.02)],
)
def test_the_whole_generating_function_holds_far_out(
    squares: list[float], linear: list[float], error: float
) -> None:
    """Noncentral chi-square responses: four cumulants lose half and more of pf = 1e-6."""
    found, scale = quadratic(squares, linear), squares[0]
    shift = sum(b * b for b in linear) / (4.0 * scale)
    exact = stats.ncx2(len(squares), shift / scale) if shift else stats.chi2(len(squares))
    far = np.array([0.3, 1e-3, 1e-6, 1e-9])
    y = scale * exact.isf(far) - shift
    assert found.sf(y) == pytest.approx(far, rel=error)
    assert found.cdf(scale * exact.ppf(0.01) - shift) == pytest.approx(0.01, rel=0.05)
    four = SaddlepointDistribution(found.mean, found.std, found.skewness, found.kurtosis)
    assert abs(four.sf(y[2]) / 1e-6 - 1.0) > 0.1


def test_the_parts_of_both_generating_functions_fit_together() -> None:
    """C = (B - A) / s, B = K'' and the given slopes, across s = 0 and where series end."""
    form = QuadraticForm.of(np.diag([0.3, -0.2]), np.array([0.5, 0.6]), 0.9)
    assert form is not None
    s = np.array([-0.9, -0.31, -1e-3, 1e-3, 0.2, 0.9])
    step = 1e-6
    for k in (form, Cumulants((0.4, 0.3, 0.2, 0.1))):
        a, b, c = k.parts(s)
        np.testing.assert_allclose(b - a, c * s, rtol=1e-9, atol=1e-14)
        np.testing.assert_allclose((k.slope(s + step) - k.slope(s - step)) / (2 * step), b, 1e-7)
        before, after = k.parts(s - step), k.parts(s + step)
        for low, high, slope in zip(before, after, k.slopes(s), strict=True):
            np.testing.assert_allclose((high - low) / (2 * step), slope, rtol=1e-6, atol=1e-8)


def test_a_response_that_is_not_of_degree_two_has_no_such_function() -> None:
    assert QuadraticForm.of(np.eye(1) * 0.1, np.ones(1), 1.1) is None
    assert FAMILIES["saddlepoint-quadratic"].fit(NORMAL) is None


def moments_of(density: FloatArray, z: FloatArray, weights: FloatArray) -> list[float]:
    return [float(weights @ (density * z**order)) for order in range(7)]


def test_largest_entropy_has_the_moments_that_were_asked() -> None:
    known = gamma_moments(25.0)
    found = maximum_entropy(known)
    assert found is not None
    x, w = np.polynomial.legendre.leggauss(200)
    z, weights = 10.0 * x, 10.0 * w
    density = known.std * found.pdf(known.mean + known.std * z)
    wanted = [1.0, 0.0, 1.0, known.skewness, known.kurtosis, known.fifth, known.sixth]
    assert moments_of(density, z, weights) == pytest.approx(wanted, abs=2e-4)
    assert found.sf(stats.gamma(25).isf(0.01)) == pytest.approx(0.01, rel=0.01)


def test_largest_entropy_of_normal_moments_is_the_normal() -> None:
    found = maximum_entropy(NORMAL)
    assert found is not None
    assert found.sf(10.0 + 2.0 * 6.0) == pytest.approx(special.ndtr(-6.0), rel=1e-6)
    assert found.cdf(10.0 - 2.0 * 6.0) == pytest.approx(special.ndtr(-6.0), rel=1e-6)


def test_a_density_that_rises_at_its_ends_is_refused() -> None:
    """Kurtosis 4 with the sixth moment of no falling density, and moments that nothing has."""
    assert maximum_entropy(ResponseMoments(0.0, 1.0, 0.0, 4.0, 0.0, 60.0)) is None
    assert maximum_entropy(ResponseMoments(0.0, 1.0, 1.0, 1.5, 0.0, 15.0)) is None


def test_cornish_fisher_is_its_expansion() -> None:
    skewness, excess = 0.3, 0.2
    found = cornish_fisher(5.0, 2.0, skewness, 3.0 + excess)
    assert found is not None
    u = np.array([-3.0, 0.5, 4.0])
    cubic = u + skewness / 6.0 * (u**2 - 1.0) + excess / 24.0 * (u**3 - 3.0 * u)
    cubic -= skewness**2 / 36.0 * (2.0 * u**3 - 5.0 * u)
    assert found.sf(5.0 + 2.0 * cubic) == pytest.approx(special.ndtr(-u), rel=1e-5)
    assert cornish_fisher(0.0, 1.0, 0.0, 1.5) is None


@pytest.mark.parametrize("name", FAMILIES)
def test_every_family_answers_normal_moments_and_steps(name: str) -> None:
    family = FAMILIES[name]
    flat = family.fit(ResponseMoments(4.0, 0.0, 0.0, 3.0, 0.0, 15.0))
    assert flat is not None
    assert (float(flat.sf(3.9)), float(flat.sf(4.1))) == (1.0, 0.0)
    found = family.fit(NORMAL)
    if name != "saddlepoint-quadratic":
        assert found is not None
        assert found.sf(16.0) == pytest.approx(special.ndtr(-3.0), rel=1e-6)
        assert integrable(found) == family.dense
    assert isinstance(flat, AtomicDistribution) == family.dense
