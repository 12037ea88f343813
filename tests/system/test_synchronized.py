"""One mission under a synchronization threshold, against closed forms and other integrals."""

import itertools
import math
import tracemalloc
from decimal import Decimal, getcontext
from fractions import Fraction

import numpy as np
import pytest
from scipy import integrate, stats
from scipy.special import ndtr

from uqfold.moments.conditional import AtomicDistribution, ConditionalDistribution
from uqfold.moments.normal import NormalDistribution
from uqfold.moments.pearson import PearsonDistribution
from uqfold.moments.saddlepoint import SaddlepointDistribution
from uqfold.system.conditional import ConditionalResponse
from uqfold.system.conditional_unit import UnitResponse
from uqfold.system.structure import SystemUnits
from uqfold.system.synchronized import mission_probability

getcontext().prec = 80


def mission(
    distribution: ConditionalDistribution, units: int, threshold: float, tau: float | None
) -> tuple[float, float]:
    unit = UnitResponse([ConditionalResponse(distribution)], np.ones(1))
    found = mission_probability(unit, units, np.array([threshold]), tau)
    return float(found.failure[0]), float(found.success[0])


EXPONENTIAL = PearsonDistribution(1.0, 1.0, 2.0, 9.0)


def exponential(units: int, threshold: float, tau: float) -> tuple[float, float]:
    """Failure and success of exponential responses in 80 digits; order statistics are exact."""
    n, big_t, t = units, Decimal(threshold), Decimal(tau)
    if t >= big_t:
        works = (1 - (-big_t).exp()) ** n
    else:
        start = big_t - t
        works = (1 - (-t).exp()) ** (n - 1) * (1 - (-n * start).exp())
        works += ((-start).exp() - (-big_t).exp()) ** n
    return float(1 - works), float(works)


@pytest.mark.parametrize("units", [2, 4, 30])
@pytest.mark.parametrize(
    ("threshold", "tau"),
    [(0.01, 0.001), (1.0, 0.3), (1.0, 2.0), (5.0, 4.0), (14.0, 13.0), (28.0, 27.0), (40.0, 28.0)],
)
def test_exponential_responses(units: int, threshold: float, tau: float) -> None:
    failure, success = mission(EXPONENTIAL, units, threshold, tau)
    expected = exponential(units, threshold, tau)
    # T itself is known to a rounding error, which moves the probability of T <= 0.01 by 1e-13.
    assert failure == pytest.approx(expected[0], rel=1e-11, abs=0)
    assert success == pytest.approx(expected[1], rel=1e-10, abs=0)
    if threshold == 28.0:
        assert failure < 1e-10


@pytest.mark.parametrize("units", [2, 3, 10])
@pytest.mark.parametrize(("threshold", "tau"), [(0.9, 0.3), (1.5, 0.999), (2.0, 0.5), (0.2, 0.5)])
def test_uniform_responses_with_kinks_at_both_ends(
    units: int, threshold: float, tau: float
) -> None:
    d = PearsonDistribution(0.5, math.sqrt(1 / 12), 0.0, 1.8)
    failure, success = mission(d, units, threshold, tau)
    top = min(Fraction(threshold), Fraction(1))
    window = min(Fraction(tau), top)
    works = units * window ** (units - 1) * (top - window) + window**units
    assert success == pytest.approx(float(works), rel=1e-11, abs=0)
    assert failure == pytest.approx(float(1 - works), rel=1e-11, abs=0)


def test_uniform_responses_that_almost_always_agree() -> None:
    """tau = 1 - e: 1 - (n (1 - e)^(n-1) e + (1 - e)^n) = n (n - 1) e^2 / 2 to first order."""
    e = 2.0**-18
    d = PearsonDistribution(0.5, math.sqrt(1 / 12), 0.0, 1.8)
    assert mission(d, 4, 5.0, 1 - e)[0] == pytest.approx(
        6 * e**2 * (1 - 4 * e / 3), rel=1e-9, abs=0
    )


@pytest.mark.parametrize("tau", [0.1, 2.0, 6.0, 9.5, 12.0])
def test_difference_of_two_normals(tau: float) -> None:
    """Without T, two units fail with 2 Phi(-tau / sqrt 2): down to 1e-17."""
    failure, success = mission(NormalDistribution(5.0, 1.0), 2, math.inf, tau)
    assert failure == pytest.approx(2 * float(ndtr(-tau / math.sqrt(2))), rel=1e-11, abs=0)
    assert success == pytest.approx(math.erf(tau / 2), rel=1e-11, abs=0)


@pytest.mark.parametrize("units", [3, 4, 8])
def test_range_of_normals(units: int) -> None:
    for tau in (1.0, 3.0, 5.0):
        reference = float(stats.studentized_range.cdf(tau, units, np.inf))
        found = mission(NormalDistribution(0.0, 1.0), units, math.inf, tau)[1]
        assert found == pytest.approx(reference, rel=1e-8, abs=0)


def brute_force(exact: stats.rv_continuous, units: int, threshold: float, tau: float) -> float:
    """Success by integration over u = H(t) of the smallest response, with SciPy."""

    cdf = exact.cdf

    def integrand(u: float) -> float:
        return units * (float(cdf(min(exact.ppf(u) + tau, threshold))) - u) ** (units - 1)

    cuts = [threshold - tau, 1.0 - tau, 1e-9, 1e-4, 0.5]
    edges = sorted({0.0, cdf(threshold), *(min(cdf(c), cdf(threshold)) for c in cuts)})
    return sum(
        float(integrate.quad(integrand, a, b, epsabs=1e-13, epsrel=1e-11, limit=400)[0])
        for a, b in itertools.pairwise(edges)
        if b > a
    )


SHAPES = {
    "J": stats.beta(0.5, 5),
    "U": stats.beta(0.3, 0.2),
    "nearly two points": stats.beta(0.01, 0.02),
    "bell": stats.beta(2.5, 1.5),
    "gamma": stats.gamma(0.3),
    "heavy": stats.t(5),
}


@pytest.mark.parametrize("name", SHAPES)
def test_singular_and_heavy_densities(name: str) -> None:
    exact = SHAPES[name]
    mean, variance, skewness, excess = (float(m) for m in exact.stats("mvsk"))
    d = PearsonDistribution(mean, math.sqrt(variance), skewness, 3 + excess)
    for units, threshold, tau in [(4, 0.7, 0.3), (2, 0.95, 0.5), (3, 1.5, 0.98), (4, 3.0, 0.01)]:
        failure, success = mission(d, units, threshold, tau)
        expected = brute_force(exact, units, threshold, tau)
        assert success == pytest.approx(expected, rel=2e-8, abs=1e-11)
        assert failure + success == pytest.approx(1.0, rel=1e-12, abs=0)


@pytest.mark.parametrize("skewness", [-0.3, 0.0, 0.3])
def test_failure_with_both_thresholds_in_the_tail(skewness: float) -> None:
    """Two units, T and tau both far out: 1 - H(T)^2 + 2 int h [S(t + tau) - S(T)] dt by SciPy."""
    d = PearsonDistribution(0.0, 1.0, skewness, 3.25)

    def integrand(t: float) -> float:
        return 2 * float(d.pdf(t)) * float(d.sf(t + 9.0) - d.sf(8.0))

    late = float(d.sf(8.0)) * (2 - float(d.sf(8.0)))
    apart = sum(
        integrate.quad(integrand, a, a + 1, epsabs=0, epsrel=1e-12)[0] for a in range(-40, -1)
    )
    failure, _ = mission(d, 2, 8.0, 9.0)
    assert failure == pytest.approx(late + apart, rel=1e-10, abs=0)
    assert failure < 1e-7


def test_limits() -> None:
    d = NormalDistribution(0.0, 1.0)
    plain = mission(d, 4, 1.0, None)
    assert plain[1] == pytest.approx(float(ndtr(1.0)) ** 4, rel=1e-14, abs=0)
    assert mission(d, 4, 1.0, math.inf) == pytest.approx(plain, rel=1e-14, abs=0)
    assert mission(d, 4, 1.0, 60.0) == pytest.approx(plain, rel=1e-13, abs=0)
    assert mission(d, 4, 1.0, 0.0) == pytest.approx((1.0, 0.0), abs=1e-15)
    assert mission(d, 4, -math.inf, 1.0) == (1.0, 0.0)
    assert mission(d, 1, 1.0, 0.1) == pytest.approx(mission(d, 1, 1.0, None), rel=1e-15, abs=0)
    assert mission(d, 4, math.inf, None) == (0.0, 1.0)


def test_small_tau_is_a_power_of_tau() -> None:
    """For tau -> 0 success tends to n tau^(n-1) int h^n: 1e-20 is a number too."""
    integral = 1 / math.sqrt(2) / math.sqrt(2 * math.pi) ** 3 / math.sqrt(2)
    found = mission(NormalDistribution(0.0, 1.0), 4, math.inf, 1e-6)[1]
    assert found == pytest.approx(4 * 1e-18 * integral, rel=1e-5, abs=0)


def test_thresholds_share_one_integration_without_disturbing_each_other() -> None:
    unit = UnitResponse([ConditionalResponse(PearsonDistribution(0, 1, 0.4, 3.4))], np.ones(1))
    thresholds = np.linspace(-2, 9, 23)
    together = mission_probability(unit, 4, thresholds, 3.0)
    alone = [mission_probability(unit, 4, np.array([t]), 3.0) for t in thresholds]
    np.testing.assert_allclose(together.failure, [a.failure[0] for a in alone], rtol=1e-11)
    np.testing.assert_allclose(together.success, [a.success[0] for a in alone], rtol=1e-10)
    np.testing.assert_allclose(together.failure + together.success, 1.0, rtol=1e-12)
    assert (np.diff(together.failure) < 1e-15).all()


def test_saddlepoint_has_no_density_to_integrate() -> None:
    with pytest.raises(TypeError, match="SaddlepointDistribution has no density"):
        mission(SaddlepointDistribution(0, 1, 0.1, 3.1), 4, 1.0, 1.0)


@pytest.mark.parametrize(
    ("units", "threshold", "tau", "match"),
    [
        (0, 1.0, 1.0, "units"),
        (2, math.nan, 1.0, "NaN"),
        (2, 1.0, -0.1, "tau"),
        (2, 1.0, math.nan, "tau"),
    ],
)
def test_bad_input(units: int, threshold: float, tau: float, match: str) -> None:
    with pytest.raises(ValueError, match=match):
        mission(NormalDistribution(0, 1), units, threshold, tau)


@pytest.mark.parametrize("units", [2, 4, 30])
@pytest.mark.parametrize("tau", [1e-3, 1e-6, 1e-12, 1e-15, 1e-60])
def test_tiny_tau_costs_little_and_is_asymptotically_right(units: int, tau: float) -> None:
    """tau of 1e-12: works = n tau^(n-1) int h^n, which for exponential responses below T is
    tau^(n-1) (1 - exp(-n T)) to first order in tau."""
    failure, success = mission(EXPONENTIAL, units, 5.0, tau)
    expected = tau ** (units - 1) * -math.expm1(-units * 5.0)
    slack = max(1e-9, units * tau)
    assert success == pytest.approx(expected, rel=slack, abs=1e-300)
    assert failure == pytest.approx(1.0 - success, rel=1e-15, abs=0)


@pytest.mark.parametrize("distribution", [EXPONENTIAL, NormalDistribution(2.0, 1.0)])
def test_tau_zero_asks_for_equal_responses(distribution: ConditionalDistribution) -> None:
    """tau = 0 answers 1 for two or more units with continuous responses, and not for one unit."""
    assert mission(distribution, 2, 5.0, 0.0) == (1.0, 0.0)
    assert mission(distribution, 1000, math.inf, 0.0) == (1.0, 0.0)
    assert mission(distribution, 1, 3.0, 0.0) == mission(distribution, 1, 3.0, None)


def test_tau_zero_holds_where_units_share_an_atom() -> None:
    """Half of the responses are 1, half are normal: n units agree only if all of them are 1."""
    parts = [
        ConditionalResponse(AtomicDistribution((1.0,))),
        ConditionalResponse(NormalDistribution(1.0, 1.0)),
    ]
    unit = UnitResponse(parts, np.array([0.5, 0.5]))
    found = mission_probability(unit, 3, np.array([0.9, 1.0, 7.0]), 0.0)
    np.testing.assert_allclose(found.success, [0.0, 0.125, 0.125], rtol=1e-14)
    np.testing.assert_allclose(found.failure, [1.0, 0.875, 0.875], rtol=1e-14)
    alike = UnitResponse(parts[:1], np.ones(1))
    assert mission_probability(alike, 9, np.array([1.0]), 0.0).failure.tolist() == [0.0]


def calls_of_density(monkeypatch: pytest.MonkeyPatch, units: int) -> int:
    counted = []
    plain = NormalDistribution.logpdf

    def logpdf(self: NormalDistribution, y: np.ndarray) -> np.ndarray:
        counted.append(np.size(y))
        return plain(self, y)

    monkeypatch.setattr(NormalDistribution, "logpdf", logpdf)
    unit = UnitResponse([ConditionalResponse(NormalDistribution(0.0, 1.0))], np.ones(1))
    mission_probability(unit, units, np.array([-3.0, 3.0]), 3.0)
    return sum(counted)


def test_many_thresholds_share_their_panels() -> None:
    """Many thresholds with tau: 2.1 GB at 1,000, the square of their number."""
    unit = UnitResponse([ConditionalResponse(PearsonDistribution(0, 1, 0.4, 3.4))], np.ones(1))
    thresholds = np.linspace(-3.0, 3.0, 1_000)
    tracemalloc.start()
    try:
        together = mission_probability(unit, 4, thresholds, 2.0)
        peak = tracemalloc.get_traced_memory()[1]
    finally:
        tracemalloc.stop()
    assert peak < 60e6
    for row in (0, 321, 999):
        alone = mission_probability(unit, 4, thresholds[row : row + 1], 2.0)
        assert together.failure[row] == pytest.approx(alone.failure[0], rel=1e-11, abs=0)
        assert together.success[row] == pytest.approx(alone.success[0], rel=1e-11, abs=0)


def test_the_number_of_units_costs_nothing(monkeypatch: pytest.MonkeyPatch) -> None:
    """1e5 units: no sum over units, and still the right tails of their largest response."""
    assert calls_of_density(monkeypatch, 100_000) < 5 * calls_of_density(monkeypatch, 2)
    failure, success = mission(NormalDistribution(0.0, 1.0), 100_000, 8.0, 40.0)
    assert failure == pytest.approx(100_000 * float(ndtr(-8.0)), rel=1e-9, abs=0)
    failure, success = mission(NormalDistribution(0.0, 1.0), 100_000, 4.0, 40.0)
    assert success == pytest.approx(math.exp(1e5 * math.log1p(-float(ndtr(-4.0)))), rel=1e-9)


def test_failed_runs_under_tau_cost_nothing_for_many_units() -> None:
    """The number of units with an answer is random; the sum over it has a closed form."""
    response = ConditionalResponse(NormalDistribution(0.0, 1.0), p_missing=0.25)
    unit = UnitResponse([response], np.ones(1))
    found = mission_probability(unit, 5, np.array([1.5]), 2.0)
    known = [mission(NormalDistribution(0.0, 1.0), n, 1.5, 2.0)[0] for n in range(1, 6)]
    shares = [math.comb(5, n) * 0.75**n * 0.25 ** (5 - n) for n in range(1, 6)]
    assert found.failure_low[0] == pytest.approx(np.dot(shares, known), rel=1e-12)
    assert found.failure[0] == pytest.approx(1.0 - 0.75**5 * (1.0 - known[-1]), rel=1e-12)
    assert found.success_low[0] == pytest.approx(1.0 - found.failure_low[0], rel=1e-12)


def sorts_of(*sorts: tuple[int, float, int]) -> SystemUnits:
    """Units in series from the kind, offset and number of each sort."""
    kinds, offsets, counts = (np.array(one) for one in zip(*sorts, strict=True))
    return SystemUnits(
        int(counts.sum()), None, offsets, kinds, np.repeat(np.arange(len(sorts)), counts)
    )


@pytest.mark.parametrize(("threshold", "tau"), [(1.5, 0.8), (2.0, 0.3), (3.0, 2.5), (6.0, 6.0)])
def test_units_that_differ_come_first_each_in_its_turn(threshold: float, tau: float) -> None:
    """Normal and gamma responses with offsets in series under tau: only simulation knew them."""
    laws = [NormalDistribution(1.0, 0.4), PearsonDistribution(1.0, 0.5, 1.0, 4.5)]
    kinds = [UnitResponse([ConditionalResponse(one)], np.ones(1)) for one in laws]
    units = sorts_of((0, 0.0, 1), (0, 0.3, 1), (1, -0.2, 2))
    found = mission_probability(kinds, units, np.array([threshold]), tau)
    normal, gamma = stats.norm(1.0, 0.4), stats.gamma(4.0, scale=0.25)
    each = [(normal, 0.0), (normal, 0.3), (gamma, -0.2), (gamma, -0.2)]

    edges = np.array([-4.0, -0.2, tau - 0.2, 0.6, 1.0, 1.4, 2.0, 4.0, threshold])
    edges = np.unique(edges[edges <= threshold])
    fine = np.interp(np.arange(0, edges.size - 0.9, 0.1), np.arange(edges.size), edges)
    nodes, weights = np.polynomial.legendre.leggauss(30)
    half = 0.5 * np.diff(fine)[:, None]
    s, ds = (0.5 * (fine[:-1] + fine[1:]))[:, None] + half * nodes, half * weights
    works = apart = 0.0
    for i, (law, offset) in enumerate(each):
        others = [one for j, one in enumerate(each) if j != i]
        near = math.prod(o.cdf(s - p) - o.cdf(s - p - tau) for o, p in others)
        below = math.prod(o.cdf(s - p) for o, p in others)
        works += float((ds * law.pdf(s - offset) * near).sum())
        apart += float((ds * law.pdf(s - offset) * (below - near)).sum())
    # the largest is above T: a sum over which of the units is the first to be so
    late, before = 0.0, 1.0
    for law, offset in each:
        late += before * law.sf(threshold - offset)
        before *= law.cdf(threshold - offset)
    assert found.success[0] == pytest.approx(works, rel=1e-9)
    assert found.failure[0] == pytest.approx(late + apart, rel=1e-7, abs=0)


def test_steps_and_lost_runs_of_units_that_differ() -> None:
    """Atoms, infinite responses and failed runs under tau, against all combinations of values."""
    atoms = ((np.array([1.0, 2.0, 4.0]), [0.5, 0.3, 0.2]), (np.array([1.5, 3.0]), [0.6, 0.4]))
    masses = ((0.1, 0.05, 0.08), (0.02, 0.1, 0.0))
    kinds = [
        UnitResponse([ConditionalResponse(AtomicDistribution(values, shares), *p)], np.ones(1))
        for (values, shares), p in zip(atoms, masses, strict=True)
    ]
    units = sorts_of((0, 0.5, 2), (1, 0.0, 1), (1, 1.0, 1))
    found = mission_probability(kinds, units, np.array([4.5, 3.9]), 2.0)
    each = []
    for kind, offset in ((0, 0.5), (0, 0.5), (1, 0.0), (1, 1.0)):
        (values, shares), (never, always, missing) = atoms[kind], masses[kind]
        finite = 1.0 - never - always - missing
        known = [(v + offset, finite * s) for v, s in zip(values, shares, strict=True)]
        each.append([*known, (math.inf, never), (-math.inf, always), (math.nan, missing)])
    failure = np.zeros((2, 2))
    for one in itertools.product(*each):
        y, chance = np.array([v for v, _ in one]), math.prod(p for _, p in one)
        known = y[~np.isnan(y)]
        for column, threshold in enumerate((4.5, 3.9)):
            fails = known.size > 0 and (
                not np.isfinite(known).all() or known.max() > threshold or np.ptp(known) > 2.0
            )
            failure[1, column] += chance * fails
            failure[0, column] += chance * (fails or known.size < 4)
    assert found.failure == pytest.approx(failure[0], rel=1e-12)
    assert found.failure_low == pytest.approx(failure[1], rel=1e-12)
