"""Inputs that take single values: quantiles with steps, in both tails, and what is refused."""

from __future__ import annotations

import math
from typing import Any

import chaospy
import numpy as np
import openturns as ot
import pytest
from scipy import stats
from scipy.special import ndtr

from uqfold import Problem
from uqfold.inputs import JointInputs, bernoulli, censored, discrete, from_data, normal, poisson
from uqfold.inputs.convert import as_openturns
from uqfold.inputs.door import checked_marginal
from uqfold.inputs.gauss import gauss_rule
from uqfold.inputs.marginal import Marginal

LOADED_DIE = ([1, 2, 6], [0.25, 0.25, 0.5])


def _name(distribution: Any) -> str:
    own = getattr(distribution, "dist", None)
    return type(distribution).__name__ if own is None else f"scipy-{own.name}"


def _marginal(distribution: Any) -> Marginal:
    return checked_marginal(as_openturns(distribution), "x")


def _joint(**individual: Any) -> JointInputs:
    return Problem(lambda x: x[:, 0], individual=individual).inputs


@pytest.mark.parametrize(
    ("distribution", "same"),
    [
        (poisson(3.0), stats.poisson(3)),
        (ot.Poisson(2000.0), stats.poisson(2000)),
        (bernoulli(1e-4), stats.bernoulli(1e-4)),
        (ot.Binomial(12, 0.3), stats.binom(12, 0.3)),
        (ot.Geometric(0.2), stats.geom(0.2)),
        (ot.Skellam(2.0, 3.0), stats.skellam(2, 3)),
        (stats.poisson(3, loc=2), stats.poisson(3, loc=2)),
        (stats.nbinom(3, 0.4), stats.nbinom(3, 0.4)),
        (stats.Binomial(n=7, p=0.3), stats.binom(7, 0.3)),
        (chaospy.Binomial(7, 0.3), stats.binom(7, 0.3)),
        (discrete(*LOADED_DIE), stats.rv_discrete(values=LOADED_DIE)),
        (stats.rv_discrete(values=LOADED_DIE), stats.rv_discrete(values=LOADED_DIE)),
    ],
    ids=_name,
)
def test_quantiles_of_any_origin_are_right_to_probabilities_of_1e_9(
    distribution: Any, same: Any
) -> None:
    marginal = _marginal(distribution)
    u = np.linspace(-6.0, 6.0, 241) + 1e-3
    x = marginal.from_normal(u)
    # the quantile is the first value whose lower probability is at least Phi(u)
    less, more = 1.0 - 1e-6, 1.0 + 1e-6
    wrong = np.where(u < 0.0, same.cdf(x) < ndtr(u) * less, same.sf(x) > ndtr(-u) * more)
    below = x - 1.0
    early = np.where(u < 0.0, same.cdf(below) > ndtr(u) * more, same.sf(below) < ndtr(-u) * less)
    assert not wrong.any()
    assert not early.any()
    np.testing.assert_array_equal(marginal.from_normal(marginal.to_normal(x)), x)
    np.testing.assert_allclose(marginal.moments, (same.mean(), same.std()), rtol=1e-9)
    # SciPy's own of a Skellam variable have lost digits by then
    np.testing.assert_allclose(marginal.sf(x), same.sf(x), rtol=1e-6, atol=1e-300)
    np.testing.assert_allclose(marginal.cdf(x), same.cdf(x), rtol=1e-9)


def test_what_is_cut_off_is_the_larger_of_zero_and_the_whole() -> None:
    marginal = _marginal(censored(normal(0.5, 1.0), low=0.0))
    u = np.linspace(-8.0, 8.0, 801)
    np.testing.assert_allclose(marginal.from_normal(u), np.maximum(0.0, u + 0.5), atol=1e-12)
    assert not marginal.steps
    both = _marginal(censored(stats.norm(0.5, 1.0), low=0.0, high=2.0))
    np.testing.assert_allclose(both.from_normal(u), np.clip(u + 0.5, 0.0, 2.0), atol=1e-12)
    # a bound need not be a whole number
    either = _marginal(censored(stats.norm(), low=-1.5, high=0.25))
    np.testing.assert_allclose(either.from_normal(u), np.clip(u, -1.5, 0.25), atol=1e-12)
    own = stats.truncnorm(-0.5, math.inf, 0.5, 1.0)
    mean = own.mean() * ndtr(0.5)
    square = (own.var() + own.mean() ** 2) * ndtr(0.5)
    assert marginal.moments == pytest.approx((mean, math.sqrt(square - mean**2)), rel=1e-9)


def test_a_mixture_of_both_is_taken_apart() -> None:
    parts = [ot.Normal(), poisson(2.0), ot.Exponential(1.0), ot.Dirac(0.0)]
    marginal = _marginal(ot.Mixture(parts, [0.4, 0.2, 0.2, 0.2]))
    x = np.array([-4.0, -0.5, 0.0, 0.5, 1.0, 7.5, 15.0])
    expected = 0.4 * ndtr(-x) + 0.2 * stats.poisson(2).sf(x) + 0.2 * stats.expon.sf(x)
    np.testing.assert_allclose(marginal.sf(x), expected + 0.2 * (x < 0.0), rtol=1e-9)
    u = np.linspace(-6.0, 6.0, 2_001)
    value = marginal.from_normal(u)
    assert (np.diff(value) >= 0.0).all()
    for score, found in zip(u, value, strict=True):
        at, just_below = np.array([found]), np.array([found - 1e-6 * max(1.0, abs(found))])
        assert marginal.cdf(just_below)[0] <= ndtr(score) + 1e-12
        # OpenTURNS' quantiles of the continuous part are exact to about 1e-12
        assert marginal.sf(at)[0] <= ndtr(-score) * (1.0 + 1e-3)
    assert not marginal.steps
    gap = ot.Mixture([ot.Dirac(0.0), ot.Uniform(1.0, 2.0)], [0.5, 0.5])
    assert _marginal(gap).steps


def test_listed_values_lie_where_they_like() -> None:
    apart = _marginal(discrete([-1e6, 1e6, 4e9], [0.3, 0.6, 0.1]))
    assert apart.from_normal(np.array([-3.0, 0.0, 3.0])).tolist() == [-1e6, 1e6, 4e9]
    points = ot.Mixture([ot.Dirac(1.5), ot.Bernoulli(0.5), ot.Dirac(1.0)], [0.2, 0.4, 0.4])
    assert _marginal(points).cdf(np.array([0.0, 1.0, 1.4, 1.5])) == pytest.approx(
        [0.2, 0.8, 0.8, 1.0]
    )


def test_draws_and_descriptions() -> None:
    problem = Problem(
        lambda x: x[:, 0],
        shared={"gust": bernoulli(0.1)},
        individual={"cracks": poisson(2.0), "grade": discrete(*LOADED_DIE)},
    )
    x = problem.inputs.sample(np.random.default_rng(1), 20_000)
    assert set(np.unique(x[:, 0])) == {0.0, 1.0}
    assert set(np.unique(x[:, 2])) == {1.0, 2.0, 6.0}
    np.testing.assert_allclose(x.mean(axis=0), problem.inputs.means, atol=0.06)
    assert problem.inputs.with_steps == ("gust", "cracks", "grade")
    shown = str(problem)
    assert "Bernoulli(p = 0.1)" in shown
    assert "discrete(1: 0.25, 2: 0.25, 6: 0.5)" in shown
    many = str(_marginal(discrete(np.arange(20.0), np.full(20, 0.05))))
    assert many == "discrete(20 values from 0 to 19)"
    assert str(_marginal(stats.randint(1, 7))) == "scipy.stats.randint(1, 7)"


def test_a_copula_joins_discrete_inputs_by_the_normals_behind_them() -> None:
    copula = ot.NormalCopula(ot.CorrelationMatrix([[1.0, 0.8], [0.8, 1.0]]))
    joint = _inputs(ot.JointDistribution([bernoulli(0.5), ot.Normal()], copula))
    x = joint.sample(np.random.default_rng(1), 50_000)
    # E[X B] of a normal X and the sign of another one, correlated by 0.8
    assert np.mean(x[:, 1] * x[:, 0]) == pytest.approx(0.8 / math.sqrt(2 * math.pi), abs=0.01)
    with pytest.raises(ValueError, match="no joint density with X0"):
        joint.log_density(x[:3])
    clayton = _inputs(ot.JointDistribution([poisson(2.0), ot.Normal()], ot.ClaytonCopula(2.0)))
    drawn = clayton.sample(np.random.default_rng(1), 5_000)
    rank = stats.kendalltau(stats.poisson(2).cdf(drawn[:, 0]), drawn[:, 1])
    assert 0.4 < rank.statistic < 0.6


def _inputs(joint: Any) -> JointInputs:
    return Problem(lambda x: x[:, 0], inputs=joint).inputs


@pytest.mark.parametrize(
    ("distribution", "message"),
    [
        (stats.zipf(2.5), "has no finite mean"),
        (stats.randint(0, 2_000_000), "takes 2,000,000 values"),
        (ot.MaximumDistribution([ot.Dirac(0.0), ot.Normal()]), "add up to"),
        (stats.poisson(-1), "the parameters make no distribution"),
        (stats.poisson(2, loc=0.5), "it takes no whole numbers: list its values"),
        (ot.Mixture([ot.Dirac(0.0), ot.Dirac(1.0)], [1.0, 0.0]), "the value 0 only"),
    ],
    ids=_name,
)
def test_what_cannot_be_a_table_is_refused_by_name(distribution: Any, message: str) -> None:
    with pytest.raises(ValueError, match=f"input 'load'.*{message}"):
        Problem(lambda x: x[:, 0], individual={"load": distribution})


def test_a_discrete_joint_distribution_is_refused_with_the_remedy() -> None:
    table = ot.FiniteDiscreteDistribution([[0.0, 1.0], [1.0, 0.0]])
    with pytest.raises(ValueError, match="let one discrete input choose among rows"):
        Problem(lambda x: x[:, 0], inputs=table)


def test_what_has_no_meaning_for_single_values_is_refused() -> None:
    joint = _joint(cracks=poisson(2.0), load=normal(1.0, 0.1))
    with pytest.raises(ValueError, match="takes single values: it has no other mean"):
        joint.with_moments(means={"cracks": 3.0})
    moved = joint.with_moments(means={"load": 2.0})
    assert moved.means.tolist() == pytest.approx([2.0, 2.0])
    with pytest.raises(ValueError, match="no Gauss rule"):
        gauss_rule(poisson(2.0), 3)


@pytest.mark.parametrize(
    ("values", "probabilities", "message"),
    [
        ([0, 1], [0.5, 0.6], "they add up to 1.1"),
        ([0, 1], [1.5, -0.5], "none below zero"),
        ([0, 0], [0.5, 0.5], "each of them once"),
        ([0, 1, 2], [0.5, 0.5], "one for each of the 3 values"),
    ],
)
def test_wrong_probabilities_are_refused(values: Any, probabilities: Any, message: str) -> None:
    with pytest.raises(ValueError, match=message):
        discrete(values, probabilities)


def test_bounds_that_cut_off_nothing_are_refused() -> None:
    with pytest.raises(ValueError, match="give bounds within the distribution"):
        censored(ot.Uniform(1.0, 2.0), low=0.0)
    with pytest.raises(ValueError, match="give a continuous one"):
        censored(poisson(1.0), low=1.0)


def test_counted_data_become_an_input() -> None:
    counts = [0, 0, 0, 1, 1, 0, 2, 1, 0, 0]
    marginal = _marginal(from_data(counts, "discrete"))
    assert str(marginal) == "discrete(0: 0.6, 1: 0.3, 2: 0.1)"
    with pytest.raises(ValueError, match='give family="discrete"'):
        from_data(counts)
    with pytest.raises(ValueError, match="all are the same"):
        from_data([1] * 10, "discrete")


def test_other_probabilities_of_many_values_are_another_system() -> None:
    even, odd = np.full(20, 0.05), np.full(20, 0.05)
    odd[0], odd[1] = 0.04, 0.06
    problems = [
        Problem(lambda x: x[:, 0], individual={"a": discrete(np.arange(20.0), p)})
        for p in (even, odd)
    ]
    assert str(problems[0].inputs.columns[0]) == str(problems[1].inputs.columns[0])
    assert problems[0].system_digest != problems[1].system_digest
