"""The system algebra: expectation over shared nodes, missions, atoms and failed runs."""

import itertools
import math
import time
from collections.abc import Sequence

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy import integrate, stats

from uqfold.moments.conditional import AtomicDistribution
from uqfold.moments.normal import NormalDistribution
from uqfold.moments.pearson import PearsonDistribution
from uqfold.moments.saddlepoint import SaddlepointDistribution
from uqfold.problems.criterion import Binomial, Criterion, Missions, criteria
from uqfold.system.conditional import (
    ConditionalResponse,
    independent_failure,
    independent_failures,
    system_failure,
    system_failures,
)
from uqfold.system.event import mission_fails
from uqfold.system.linearised import linearised_failures

ALL_MISSIONS: list[Missions] = [1, 3, Binomial(10, 0.7)]


def linear_normal(rho: float, nodes: int) -> tuple[list[ConditionalResponse], np.ndarray]:
    """y = sqrt(rho) v + sqrt(1 - rho) e with v on a Gauss-Hermite rule."""
    v, weights = np.polynomial.hermite_e.hermegauss(nodes)
    scatter = math.sqrt(1 - rho)
    return [
        ConditionalResponse(NormalDistribution(math.sqrt(rho) * x, scatter)) for x in v
    ], weights


@pytest.mark.parametrize("threshold", [-1.0, 1.0, 3.0, 6.0])
def test_linear_normal_system_equals_the_one_factor_integral(threshold: float) -> None:
    responses, weights = linear_normal(0.3, 120)
    exact = linearised_failures(threshold, 0.3, 4, ALL_MISSIONS)
    for index, missions in enumerate(ALL_MISSIONS):
        found = system_failure(responses, weights, 4, threshold, missions=missions)
        assert found.pf == pytest.approx(exact[0][index], rel=1e-8, abs=0)
        assert found.reliability == pytest.approx(exact[1][index], rel=1e-8, abs=0)
        assert found.pf_low == found.pf == found.pf_high


def test_linear_normal_system_with_tau_by_scipy() -> None:
    """The expectation over v by SciPy, of an order-statistics integral by SciPy."""
    rho, units, threshold, tau, missions = 0.3, 4, 2.0, 3.0, 2
    scatter = math.sqrt(1 - rho)

    def given_v(v: float) -> float:
        h = stats.norm(math.sqrt(rho) * v, scatter)

        def smallest(t: np.ndarray) -> np.ndarray:
            together = h.cdf(np.minimum(t + tau, threshold)) - h.cdf(t)
            return np.asarray(units * h.pdf(t) * together ** (units - 1))

        edges = [-9.0, -4.0, threshold - tau, threshold]
        parts = [
            integrate.fixed_quad(smallest, a, b, n=60)[0] for a, b in itertools.pairwise(edges)
        ]
        return sum(parts) ** missions * math.exp(-v * v / 2) / math.sqrt(2 * math.pi)

    expected = integrate.quad(given_v, -9, 9, epsabs=1e-10, limit=100)[0]
    responses, weights = linear_normal(rho, 60)
    found = system_failure(responses, weights, units, threshold, tau, missions)
    assert found.reliability == pytest.approx(expected, rel=1e-7, abs=0)
    assert found.pf == pytest.approx(1 - expected, rel=1e-7, abs=0)


def test_pearson_and_saddlepoint_agree_with_the_normal_they_contain() -> None:
    normal = [ConditionalResponse(NormalDistribution(m, 2.0)) for m in (0.0, 1.0)]
    pearson = [ConditionalResponse(PearsonDistribution(m, 2.0, 0.0, 3.0)) for m in (0.0, 1.0)]
    saddle = [ConditionalResponse(SaddlepointDistribution(m, 2.0, 0.0, 3.0)) for m in (0.0, 1.0)]
    for tau in (None, 9.0, 16.0):
        expected = system_failure(normal, [1, 3], 4, 13.0, tau, 5).pf
        assert system_failure(pearson, [1, 3], 4, 13.0, tau, 5).pf == pytest.approx(
            expected, rel=1e-10, abs=0
        )
    expected = system_failure(normal, [1, 3], 4, 13.0, None, 5).pf
    assert system_failure(saddle, [1, 3], 4, 13.0, None, 5).pf == pytest.approx(
        expected, rel=1e-10, abs=0
    )


def test_a_pf_of_1e_minus_12_is_a_number() -> None:
    found = system_failure([ConditionalResponse(NormalDistribution(0, 1))], [1], 4, 7.5, 20.0, 3)
    assert found.pf == pytest.approx(12 * stats.norm.sf(7.5), rel=1e-9, abs=0)
    assert found.pf < 4e-13
    # what 1 - R would have given: rounded to the spacing of floats below 1
    assert 1.0 - found.reliability != pytest.approx(found.pf, rel=1e-9, abs=0)


def test_grid_equals_single_calls() -> None:
    responses = [ConditionalResponse(PearsonDistribution(m, 1.0, 0.3, 3.2)) for m in (0.0, 0.5)]
    grid = criteria(threshold=[0.5, 2.0, 4.0], tau=[None, 2.0], missions=ALL_MISSIONS)
    for many, single in (
        (system_failures, system_failure),
        (independent_failures, independent_failure),
    ):
        together = many(responses, [0.4, 0.6], 3, grid)
        for criterion, found in zip(grid, together, strict=True):
            alone = single(
                responses, [0.4, 0.6], 3, criterion.threshold, criterion.tau, criterion.missions
            )
            assert found.pf == pytest.approx(alone.pf, rel=1e-10, abs=0)
            assert found.reliability == pytest.approx(alone.reliability, rel=1e-10, abs=0)


def test_weights_are_normalised() -> None:
    responses = [ConditionalResponse(NormalDistribution(m, 1.0)) for m in (0.0, 2.0)]
    one = system_failure(responses, [1, 3], 2, 1.0)
    assert one == system_failure(responses, [0.25, 0.75], 2, 1.0)


@settings(deadline=None, max_examples=40)
@given(
    means=st.lists(st.floats(-2, 2), min_size=2, max_size=4),
    threshold=st.floats(-3, 6),
    missions=st.sampled_from(ALL_MISSIONS),
)
def test_independence_is_conservative(
    means: list[float], threshold: float, missions: Missions
) -> None:
    """Jensen, without tau: sharing inputs cannot make a series system worse (claim 6)."""
    responses = [ConditionalResponse(NormalDistribution(m, 1.0)) for m in means]
    weights = np.ones(len(means))
    shared = system_failure(responses, weights, 4, threshold, missions=missions)
    alone = independent_failure(responses, weights, 4, threshold, missions=missions)
    assert alone.pf >= shared.pf * (1 - 1e-12)
    assert alone.pf + alone.reliability == pytest.approx(1.0, rel=1e-13, abs=0)


def test_independent_units_follow_the_mixture() -> None:
    """Two units under tau, from a mixture of two normals: all four pairs, each in closed form."""
    responses = [
        ConditionalResponse(NormalDistribution(0.0, 1.0)),
        ConditionalResponse(NormalDistribution(3.0, 0.1)),
    ]
    shares, tau = [0.3, 0.7], 1.3
    agree = 0.0
    for (i, a), (j, b) in itertools.product(enumerate([(0.0, 1.0), (3.0, 0.1)]), repeat=2):
        spread = stats.norm(a[0] - b[0], math.hypot(a[1], b[1]))
        agree += shares[i] * shares[j] * (spread.cdf(tau) - spread.cdf(-tau))
    found = independent_failure(responses, shares, 2, math.inf, tau)
    assert found.reliability == pytest.approx(agree, rel=1e-11, abs=0)
    twice = independent_failure(responses, shares, 2, math.inf, tau, 2)
    assert twice.reliability == pytest.approx(agree**2, rel=1e-11, abs=0)


def test_independent_mixture_of_singular_and_smooth_components() -> None:
    u_shaped = PearsonDistribution(0.5, 0.45, 0.1, 1.3)
    both = [ConditionalResponse(u_shaped), ConditionalResponse(NormalDistribution(0.4, 0.2))]
    found = independent_failure(both, [0.5, 0.5], 3, 0.9, 0.4)
    rng = np.random.default_rng(8)
    n = 20_000
    first, second = u_shaped.sample(rng, (n, 3)), rng.normal(0.4, 0.2, (n, 3))
    y = np.where(rng.random((n, 3)) < 0.5, first, second)
    simulated = mission_fails(y, 0.9, 0.4, missing_fails=True).mean()
    error = math.sqrt(found.pf * found.reliability / n)
    assert abs(simulated - found.pf) < 4 * error
    assert found.pf + found.reliability == pytest.approx(1.0, rel=1e-12, abs=0)


def enumerate_units(
    outcomes: Sequence[tuple[float, float]], units: int, threshold: float, tau: float | None
) -> tuple[float, float]:
    """(pf with missing runs failing, ignored) of one mission, over all combinations of outcomes."""
    totals = [0.0, 0.0]
    for combination in itertools.product(outcomes, repeat=units):
        y = np.array([value for value, _ in combination])
        p = math.prod(mass for _, mass in combination)
        for index, missing_fails in enumerate((True, False)):
            if mission_fails(y, threshold, tau, missing_fails=missing_fails):
                totals[index] += p
    return totals[0], totals[1]


@pytest.mark.parametrize("units", [1, 2, 4])
@pytest.mark.parametrize("tau", [None, 0.0, 1.0, 2.5, math.inf])
@pytest.mark.parametrize("threshold", [-math.inf, -0.5, 1.0, 1.2, 3.0, math.inf])
def test_atoms_infinities_and_failed_runs_by_enumeration(
    units: int, tau: float | None, threshold: float
) -> None:
    atoms = AtomicDistribution((0.0, 1.0, 3.0), (0.5, 0.3, 0.2))
    finite = 0.7
    outcomes = [(v, finite * p) for v, p in zip(*(a.tolist() for a in atoms.atoms), strict=True)]
    outcomes += [(math.inf, 0.1), (-math.inf, 0.05), (math.nan, 0.15)]
    response = ConditionalResponse(atoms, p_never=0.1, p_always=0.05, p_missing=0.15)
    found = system_failure([response], [1.0], units, threshold, tau)
    high, low = enumerate_units(outcomes, units, threshold, tau)
    assert found.pf == found.pf_high == pytest.approx(high, rel=1e-13, abs=0)
    assert found.pf_low == pytest.approx(low, rel=1e-13, abs=0)
    assert found.pf + found.reliability == pytest.approx(1.0, rel=1e-13, abs=0)
    marginal = [
        ConditionalResponse(atoms),
        ConditionalResponse(None, p_never=1 / 3, p_always=1 / 6, p_missing=1 / 2),
    ]
    alone = independent_failure(marginal, [0.7, 0.3], units, threshold, tau)
    assert (alone.pf, alone.pf_low) == pytest.approx((high, low), rel=1e-13, abs=0)


def test_two_steps_at_the_same_place_are_one_atom() -> None:
    steps = [ConditionalResponse(AtomicDistribution((v,))) for v in (1.0, 1.0, 2.0)]
    found = independent_failure(steps, [1, 1, 2], 3, 5.0, 0.5)
    assert found.reliability == pytest.approx(0.25, rel=1e-14, abs=0)


def test_wings_that_never_lock() -> None:
    """Mass at +inf fails every criterion, even T = +inf."""
    response = ConditionalResponse(NormalDistribution(0, 1), p_never=1e-13)
    for tau in (None, 50.0):
        found = system_failure([response], [1.0], 4, math.inf, tau)
        assert found.pf == pytest.approx(4e-13, rel=1e-10, abs=0)
    nothing = ConditionalResponse(None, p_never=1.0)
    assert system_failure([nothing], [1.0], 4, math.inf).pf == 1.0


def test_all_runs_failed_bounds_nothing() -> None:
    lost = ConditionalResponse(None, p_missing=1.0)
    for tau in (None, 1.0):
        found = system_failure([lost], [1.0], 3, 1.0, tau)
        assert (found.pf_low, found.pf_high) == (0.0, 1.0)


def test_quadrature_rounding_does_not_leak() -> None:
    """Weights that sum to 1 - 1e-15 leave no finite mass behind."""
    response = ConditionalResponse(None, p_never=1.0 - 1e-15)
    found = system_failure([response], [1.0], 2, 1.0)
    assert (found.pf, found.reliability) == (1.0, 0.0)


@pytest.mark.parametrize(
    ("settings_", "match"),
    [
        ({"p_never": -0.1}, "must lie"),
        ({"p_never": 0.6, "p_missing": 0.6}, "above 1"),
        ({"p_always": math.nan}, "must lie"),
    ],
)
def test_impossible_masses(settings_: dict[str, float], match: str) -> None:
    with pytest.raises(ValueError, match=match):
        ConditionalResponse(NormalDistribution(0, 1), **settings_)


def test_finite_mass_needs_a_distribution() -> None:
    with pytest.raises(ValueError, match="no distribution"):
        ConditionalResponse(None, p_never=0.5)


@pytest.mark.parametrize("weights", [[1.0], [1.0, -0.1], [0.0, 0.0], [math.nan, 1.0]])
def test_bad_weights(weights: list[float]) -> None:
    responses = [ConditionalResponse(NormalDistribution(0, 1))] * 2
    with pytest.raises(ValueError, match="weights"):
        system_failure(responses, weights, 2, 1.0)


def test_a_whole_grid_is_fast() -> None:
    """9 shared nodes, 25 thresholds, 3 tau, 3 missions, four correlated or independent units."""
    grid = [
        Criterion(threshold, tau, missions)
        for threshold in np.linspace(0.52, 0.60, 25)
        for tau in (0.03, 0.04, 0.05)
        for missions in (1, 2, 5)
    ]
    start = time.process_time()
    responses = [
        ConditionalResponse(PearsonDistribution(0.535 + 0.002 * i, 0.01, 0.05 * i, 3.05 + 0.02 * i))
        for i in range(9)
    ]
    found = system_failures(responses, np.ones(9), 4, grid)
    assert time.process_time() - start < 1.0
    assert len(found) == 225
