"""Distributions given as tables of normal scores."""

import numpy as np
import pytest
from numpy.testing import assert_allclose
from scipy import stats
from scipy.interpolate import CubicSpline

from uqfold.moments.conditional import integrable
from uqfold.moments.tabulated import TabulatedDistribution

SCORES = np.linspace(-8.0, 8.0, 97)


def gumbel_table() -> TabulatedDistribution:
    levels = np.where(
        SCORES < 0,
        stats.gumbel_r.ppf(stats.norm.cdf(SCORES)),
        stats.gumbel_r.isf(stats.norm.sf(SCORES)),
    )
    return TabulatedDistribution(levels, SCORES)


def test_it_is_integrable() -> None:
    assert integrable(gumbel_table())


def test_both_tails_of_a_normal_are_exact_between_and_beyond_the_levels() -> None:
    table = TabulatedDistribution(0.55 + 0.01 * SCORES[::6], SCORES[::6])
    y = 0.55 + 0.01 * np.array([-12.0, -7.9, -3.3, 0.05, 2.2, 6.1, 11.0])
    cdf, sf = table.tails(y)
    assert_allclose(cdf, stats.norm.cdf(y, 0.55, 0.01), rtol=1e-9)
    assert_allclose(sf, stats.norm.sf(y, 0.55, 0.01), rtol=1e-9)
    assert_allclose(table.pdf(y), stats.norm.pdf(y, 0.55, 0.01), rtol=1e-8)


def test_levels_have_their_scores_to_the_last_bit_and_need_no_curve() -> None:
    table = gumbel_table()
    assert (table.score(table.levels[::8]) == SCORES[::8]).all()
    assert table.score(table.levels[-1]) == SCORES[-1]
    assert "_curve" not in vars(table)
    # one value between levels is enough to ask for it
    mixed = table.score([table.levels[3], 0.5 * (table.levels[3] + table.levels[4])])
    assert_allclose(mixed[0], SCORES[3], rtol=1e-12)
    assert SCORES[3] < mixed[1] < SCORES[4]


def test_a_skewed_distribution_is_interpolated_in_both_tails() -> None:
    table = gumbel_table()
    z = np.array([-7.03, -4.47, -0.61, 0.02, 1.93, 5.55, 7.77])
    y = np.where(z < 0, stats.gumbel_r.ppf(stats.norm.cdf(z)), stats.gumbel_r.isf(stats.norm.sf(z)))
    assert_allclose(table.cdf(y), stats.gumbel_r.cdf(y), rtol=2e-5)
    assert_allclose(table.sf(y), stats.gumbel_r.sf(y), rtol=2e-5)
    assert_allclose(table.ppf(stats.norm.cdf(z[1:5])), y[1:5], rtol=1e-4, atol=1e-6)


def test_density_is_the_derivative_of_the_cdf() -> None:
    table = gumbel_table()
    y, step = np.linspace(-3.0, 15.0, 41), 1e-5
    slope = (table.cdf(y + step) - table.cdf(y - step)) / (2.0 * step)
    assert_allclose(table.pdf(y), slope, rtol=1e-5, atol=1e-9)


def test_mass_between_breakpoints_is_one() -> None:
    table = gumbel_table()
    edges = table.breakpoints
    nodes, weights = np.polynomial.legendre.leggauss(12)
    half = 0.5 * np.diff(edges)[:, None]
    x = 0.5 * (edges[1:] + edges[:-1])[:, None] + half * nodes
    assert_allclose(float((table.pdf(x) * half * weights).sum()), 1.0, rtol=1e-10)


@pytest.mark.parametrize("n", [4, 5, 97])
def test_the_curve_is_the_not_a_knot_spline_of_scipy(n: int) -> None:
    rng = np.random.default_rng(n)
    levels, scores = (np.cumsum(rng.uniform(0.8, 1.2, n)) for _ in range(2))
    y = np.linspace(levels[0], levels[-1], 200)
    expected = CubicSpline(levels, scores)(y)
    assert_allclose(TabulatedDistribution(levels, scores).score(y), expected, rtol=1e-12)


def test_a_spline_that_would_fall_gives_way_to_a_monotone_one() -> None:
    levels = np.array([0.0, 1.0, 1.01, 1.02, 5.0])
    table = TabulatedDistribution(levels, np.array([-2.0, -1.9, 0.0, 1.9, 2.0]))
    assert (np.diff(table.cdf(np.linspace(-1.0, 6.0, 2000))) >= 0.0).all()


def test_infinite_and_huge_responses_have_tails() -> None:
    cdf, sf = gumbel_table().tails([-np.inf, -1e300, 1e300, np.inf])
    assert cdf.tolist() == [0.0, 0.0, 1.0, 1.0]
    assert sf.tolist() == [1.0, 1.0, 0.0, 0.0]


def test_samples_follow_the_distribution() -> None:
    sample = gumbel_table().sample(np.random.default_rng(3), 4000)
    # Kolmogorov distance: 1.95 / sqrt(n) is exceeded with probability 1e-3
    assert stats.kstest(sample, stats.gumbel_r.cdf).statistic < 1.95 / np.sqrt(4000)


@pytest.mark.parametrize(
    ("levels", "scores"),
    [([0.0, 1.0], [0.0]), ([0.0, 0.0], [0.0, 1.0]), ([0.0, 1.0], [1.0, 0.0]), ([0.0], [0.0])],
)
def test_bad_tables_are_refused(levels: list[float], scores: list[float]) -> None:
    with pytest.raises(ValueError, match=r"levels|increase"):
        TabulatedDistribution(np.array(levels), np.array(scores))
