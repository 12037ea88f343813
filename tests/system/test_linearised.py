import math
from dataclasses import replace

import numpy as np
import pytest
from scipy import integrate, stats
from scipy.special import ndtr

from uqfold.problems.criterion import Binomial
from uqfold.problems.structure import KOutOfN, Parallel
from uqfold.system import linearised_units
from uqfold.system.decision_diagram import diagram
from uqfold.system.linearised import linearised_failure, linearised_failures
from uqfold.system.linearised_units import Planes, PlanesGiven, failure_of_planes
from uqfold.system.structure import SystemUnits
from uqfold.typing import FloatArray


def two_units_fail(beta: float, rho: float) -> float:
    """P(U_1 > beta or U_2 > beta), with the joint part by Plackett's integral over correlation."""

    def density(r: float) -> float:
        return math.exp(-(beta**2) / (1 + r)) / (2 * math.pi * math.sqrt(1 - r * r))

    product = float(ndtr(-beta)) ** 2
    # substituting r = sin(angle) removes the square root at r = 1
    joint = integrate.quad(
        lambda a: density(math.sin(a)) * math.cos(a), 0, math.asin(rho), epsabs=0, epsrel=1e-13
    )[0]
    return 2 * float(ndtr(-beta)) - product - float(joint)


@pytest.mark.parametrize("rho", [1e-12, 0.06, 0.5, 0.9, 0.999])
@pytest.mark.parametrize("beta", [-1.28, 0.0, 2.0, 4.0, 7.0])
def test_two_units_against_the_bivariate_normal(beta: float, rho: float) -> None:
    pf, reliability = linearised_failure(beta, rho, 2)
    assert pf == pytest.approx(two_units_fail(beta, rho), rel=2e-11, abs=0)
    assert pf + reliability == pytest.approx(1.0, rel=1e-13, abs=0)


@pytest.mark.parametrize("beta", [-1.0, 1.0, 3.0])
def test_equal_correlation_against_the_multivariate_normal(beta: float) -> None:
    """Three units over two missions are six equally correlated margins."""
    covariance = np.full((6, 6), 0.4) + 0.6 * np.eye(6)
    reference = stats.multivariate_normal.cdf(
        np.full(6, beta), cov=covariance, abseps=1e-6, releps=0, rng=np.random.default_rng(1)
    )
    assert linearised_failure(beta, 0.4, 3, 2)[1] == pytest.approx(float(reference), abs=5e-6)


@pytest.mark.parametrize("rho", [0.0, 1e-15, 0.3, 1 - 1e-13, 1.0])
@pytest.mark.parametrize("beta", [-8.0, -1.0, 1.0, 8.0])
def test_pf_lies_between_one_and_all_units_and_complements_agree(beta: float, rho: float) -> None:
    missions = [1, 3, Binomial(10, 0.7)]
    pf, reliability = linearised_failures(beta, rho, 4, missions)
    one = float(ndtr(-beta))
    assert one * (1 - 1e-12) <= pf[0] <= 4 * one * (1 + 1e-12)
    assert pf[0] <= pf[1] * (1 + 1e-12)
    np.testing.assert_allclose(pf + reliability, 1.0, rtol=1e-13)


def test_independent_limit() -> None:
    p = float(ndtr(-7.0))
    pf, reliability = linearised_failures(7.0, 0.0, 4, [1, 5])
    np.testing.assert_allclose(pf, [4 * p, 20 * p], rtol=1e-10)
    assert linearised_failure(7.0, 1e-14, 4, 5)[0] == pytest.approx(pf[1], rel=1e-6, abs=0)
    low = linearised_failures(-7.0, 0.0, 4, [1])[1]
    assert low[0] == pytest.approx(p**4, rel=1e-12, abs=0)
    assert reliability[0] == 1.0 - pf[0]


def test_fully_shared_limit() -> None:
    """One unit decides for all; a binomial number of missions may also be zero."""
    pf, reliability = linearised_failures(2.0, 1.0, 4, [1, 9, Binomial(3, 0.5)])
    one = float(ndtr(-2.0))
    np.testing.assert_allclose(pf, [one, one, one * 0.875], rtol=1e-14)
    np.testing.assert_allclose(reliability, [1 - one, 1 - one, 1 - one * 0.875], rtol=1e-14)
    near = linearised_failures(2.0, 1 - 1e-10, 4, [1, 9, Binomial(3, 0.5)])[0]
    np.testing.assert_allclose(near, pf, rtol=1e-4)
    assert (near[:2] > pf[:2]).all()


def test_binomial_missions_are_the_sum_of_equation_30() -> None:
    missions = [1, 2, 3, Binomial(3, 0.4)]
    pf = linearised_failures(2.0, 0.3, 4, missions)[0]
    weights = [math.comb(3, k) * 0.4**k * 0.6 ** (3 - k) for k in (1, 2, 3)]
    assert pf[3] == pytest.approx(float(np.dot(weights, pf[:3])), rel=1e-12, abs=0)


@pytest.mark.parametrize(("beta", "expected"), [(math.inf, 0.0), (-math.inf, 1.0)])
def test_infinite_index(beta: float, expected: float) -> None:
    assert linearised_failure(beta, 0.3, 4, 2) == (expected, 1.0 - expected)


@pytest.mark.parametrize(
    ("beta", "rho", "units", "match"),
    [(math.nan, 0.1, 2, "NaN"), (1, -0.1, 2, "rho"), (1, 1.1, 2, "rho"), (1, 0.1, 0, "units")],
)
def test_bad_input(beta: float, rho: float, units: int, match: str) -> None:
    with pytest.raises(ValueError, match=match):
        linearised_failure(beta, rho, units)


@pytest.mark.parametrize(
    ("shared", "tolerance"),
    [
        ([[0.6], [-0.3], [0.9]], 1e-9),
        ([[0.6, 0.0], [0.0, 0.6], [0.4, -0.5]], 1e-9),
        ([[0.6, 0.0, 0.1], [0.0, 0.6, 0.0], [0.4, -0.5, 0.5]], 1e-6),
    ],
)
def test_units_that_differ_share_as_many_factors_as_directions(
    shared: list[list[float]], tolerance: float
) -> None:
    """Against all states of three units and Gauss rules over one, two and three factors."""
    planes = Planes(np.array([2.0, 2.5, 3.0]), np.array(shared))
    units = SystemUnits(
        3, diagram(KOutOfN(2), ("a", "b", "c")), np.zeros(3), np.zeros(3, int), np.arange(3)
    )
    found = failure_of_planes(planes, units, 2)
    k = planes.shared.shape[1]
    nodes, weights = np.polynomial.hermite_e.hermegauss(90 if k < 3 else 45)
    z = np.stack([one.ravel() for one in np.meshgrid(*[nodes] * k)])
    w = math.prod(np.meshgrid(*[weights / weights.sum()] * k)).ravel()
    own = np.sqrt(1.0 - (planes.shared**2).sum(axis=1))[:, None]
    a, b, c = ndtr((planes.shared @ z - planes.betas[:, None]) / own)
    one = a * b + a * c + b * c - 2.0 * a * b * c
    assert found.pf == pytest.approx(float(w @ (2.0 * one - one**2)), rel=tolerance)
    assert found.pf + found.reliability == pytest.approx(1.0, abs=1e-12)
    assert found.error <= tolerance * found.pf
    # the same directions among five shared inputs
    basis = np.linalg.qr(np.ones((5, k)) + np.eye(5, k))[0]
    turned = replace(planes, shared=planes.shared @ basis.T)
    assert failure_of_planes(turned, units, 2).pf == pytest.approx(found.pf, rel=1e-6)


def test_one_place_alone_may_have_all_the_weight(monkeypatch: pytest.MonkeyPatch) -> None:
    """The spread of places was divided by zero, with a warning of NumPy."""

    class Places:
        def draw(self, count: int, rng: object) -> FloatArray:
            return np.where(np.arange(count)[:, None] == 7, [[0.0, 9.0]], 0.0)

        def log_density(self, z: FloatArray) -> FloatArray:
            return np.zeros(len(z))

    monkeypatch.setattr(linearised_units, "failure_places", lambda *_: Places())
    planes = Planes(np.array([8.0, 8.0]), np.array([[1.0, 0.0], [0.0, 1.0]]))
    units = SystemUnits(2, of_sorts=np.array([0, 1]), offsets=np.zeros(2), of_kinds=np.arange(2))
    drawn = PlanesGiven(planes, units, 1).drawn(0, 5, np.random.default_rng(1))
    np.testing.assert_allclose(np.linalg.norm(drawn, axis=1), 9.0)


def test_many_factors_are_drawn_where_the_system_fails() -> None:
    """Four independent common causes, pf = 3e-9: within three stated errors of a few percent."""
    units = SystemUnits(
        4, diagram(Parallel(), tuple("abcd")), np.zeros(4), np.zeros(4, int), np.arange(4)
    )
    found = failure_of_planes(Planes(np.full(4, 2.4), 0.7 * np.eye(4)), units, 1)
    exact = float(ndtr(-2.4)) ** 4
    assert abs(found.pf - exact) < 3.0 * found.error
    assert found.error < 0.05 * exact
