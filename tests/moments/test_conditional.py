import math

import numpy as np
import pytest
from scipy import stats

from uqfold.moments.conditional import AtomicDistribution, integrable
from uqfold.moments.normal import NormalDistribution
from uqfold.moments.pearson import PearsonDistribution
from uqfold.moments.saddlepoint import SaddlepointDistribution


def test_step() -> None:
    step = AtomicDistribution((2.0,))
    y = [-math.inf, 1.9, 2.0, 2.1, math.inf, math.nan]
    np.testing.assert_array_equal(step.cdf(y), [0, 0, 1, 1, 1, math.nan])
    np.testing.assert_array_equal(step.sf(y), [1, 1, 0, 0, 0, math.nan])
    assert step.support == (2.0, 2.0)
    assert float(step.ppf(0.3)) == 2.0
    np.testing.assert_array_equal(step.sample(np.random.default_rng(1), 3), [2.0] * 3)


def test_several_atoms() -> None:
    atoms = AtomicDistribution((0.0, 1.0, 4.0), (0.2, 0.5, 0.3))
    np.testing.assert_allclose(atoms.cdf([-1, 0, 0.5, 1, 4]), [0, 0.2, 0.2, 0.7, 1], rtol=1e-15)
    np.testing.assert_allclose(atoms.sf([-1, 0, 0.5, 1, 4]), [1, 0.8, 0.8, 0.3, 0], rtol=1e-15)
    np.testing.assert_array_equal(atoms.ppf([0.1, 0.2, 0.69, 0.99, 1.0]), [0, 0, 1, 4, 4])
    counts = np.unique(atoms.sample(np.random.default_rng(3), 4000), return_counts=True)[1] / 4000
    standard_error = np.sqrt(np.array([0.16, 0.25, 0.21]) / 4000)
    assert (np.abs(counts - [0.2, 0.5, 0.3]) < 4 * standard_error).all()


@pytest.mark.parametrize(
    ("values", "probabilities", "match"),
    [
        ((), (), "pair up"),
        ((1.0, 2.0), (1.0,), "pair up"),
        ((2.0, 1.0), (0.5, 0.5), "increasing"),
        ((math.inf,), (1.0,), "finite"),
        ((1.0, 2.0), (0.5, 0.6), "sum to 1"),
        ((1.0, 2.0), (0.0, 1.0), "positive"),
    ],
)
def test_impossible_atoms(
    values: tuple[float, ...], probabilities: tuple[float, ...], match: str
) -> None:
    with pytest.raises(ValueError, match=match):
        AtomicDistribution(values, probabilities)


def test_normal_against_scipy() -> None:
    d, exact = NormalDistribution(3.0, 2.0), stats.norm(3.0, 2.0)
    y = np.array([-60.0, -10.0, 2.0, 3.0, 9.0, 17.0, 70.0])
    np.testing.assert_allclose(d.cdf(y), exact.cdf(y), rtol=1e-13)
    np.testing.assert_allclose(d.sf(y), exact.sf(y), rtol=1e-13)
    np.testing.assert_allclose(d.pdf(y), exact.pdf(y), rtol=1e-13)
    np.testing.assert_allclose(d.ppf([1e-12, 0.3]), exact.ppf([1e-12, 0.3]), rtol=1e-13)
    assert d.support == (-math.inf, math.inf)
    draws = d.sample(np.random.default_rng(5), 4000)
    assert abs(draws.mean() - 3.0) < 4 * 2.0 / math.sqrt(4000)


def test_normal_without_scatter_is_a_step() -> None:
    assert NormalDistribution.from_moments(1.0, 0.0) == AtomicDistribution((1.0,))
    assert NormalDistribution.from_moments(1.0, 2.0) == NormalDistribution(1.0, 2.0)


@pytest.mark.parametrize("std", [0.0, -1.0, math.nan, math.inf])
def test_normal_refuses_a_bad_std(std: float) -> None:
    with pytest.raises(ValueError, match="std"):
        NormalDistribution(0.0, std)


def test_which_distributions_can_be_integrated_over() -> None:
    assert integrable(NormalDistribution(0, 1))
    assert integrable(PearsonDistribution(0, 1, 0.1, 3.1))
    assert integrable(AtomicDistribution((0.0,)))
    assert not integrable(SaddlepointDistribution(0, 1, 0.1, 3.1))
