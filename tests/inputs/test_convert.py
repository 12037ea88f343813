"""Distributions of scipy.stats and chaospy become OpenTURNS ones with the same law."""

import math
import pickle
from contextlib import suppress
from typing import Any

import chaospy
import numpy as np
import openturns as ot
import pytest
from scipy import stats
from scipy.special import ndtr

from uqfold.inputs import product_inputs
from uqfold.inputs.convert import as_openturns

SCIPY = {
    "Normal": stats.norm(3, 0.5),
    "Uniform": stats.uniform(-1, 3),
    "Exponential": stats.expon(1, 2),
    "Gamma": stats.gamma(2.5, loc=-1, scale=3),
    "Beta": stats.beta(2, 3, 1, 4),
    "LogNormal": stats.lognorm(0.25, loc=1, scale=2),
    "WeibullMin": stats.weibull_min(1.5, 1, 2),
    "Gumbel": stats.gumbel_r(1, 2),
    "Logistic": stats.logistic(1, 2),
    "Student": stats.t(5, 1, 2),
    "TruncatedNormal": stats.truncnorm(-2, 1.5, 2, 3),
    "Triangular": stats.triang(0.3, 1, 2),
}
WRAPPED = {
    "gumbel_l": stats.gumbel_l(1, 2),
    "invgauss": stats.invgauss(1.5),
    "laplace": stats.laplace(1, 2),
}
CHAOSPY = {
    "Normal": chaospy.Normal(1000.0, 0.01),
    "Uniform": chaospy.Uniform(-1, 2),
    "LogNormal": chaospy.LogNormal(0.5, 0.25),
}
LEVELS = (1e-12, 1e-9, 1e-6, 0.01, 0.2, 0.5, 0.8, 0.99, 1 - 1e-6)


def family(distribution: Any) -> str:
    return str(ot.Distribution(distribution).getImplementation().getClassName())


@pytest.mark.parametrize("name", list(SCIPY))
def test_common_scipy_families_keep_their_law_to_the_tails(name: str) -> None:
    frozen = SCIPY[name]
    converted = as_openturns(frozen)
    assert family(converted) == name
    for level in LEVELS:
        x = float(frozen.ppf(level))
        assert converted.computeCDF(x) == pytest.approx(frozen.cdf(x), rel=1e-6)
        assert converted.computePDF(x) == pytest.approx(frozen.pdf(x), rel=1e-6)
        x = float(frozen.isf(level))
        upper = converted.computeComplementaryCDF(x)
        assert upper == pytest.approx(frozen.sf(x), rel=1e-6)


@pytest.mark.parametrize(
    "frozen",
    [
        stats.truncnorm(-math.inf, 2, 1, 3),
        stats.truncnorm(-1, math.inf),
        stats.triang(0.0),
        stats.triang(1.0),
        stats.norm(loc=np.array(3.0), scale=np.float64(2.0)),
        stats.lognorm(s=0.3, scale=2),
        stats.beta(a=0.5, b=0.5),
        stats.norm(),
    ],
    ids=lambda frozen: f"{frozen.dist.name}{frozen.args}",
)
def test_scipy_parameters_in_every_form(frozen: Any) -> None:
    converted = as_openturns(frozen)
    for level in LEVELS[2:]:
        x = float(frozen.ppf(level))
        assert converted.computeCDF(x) == pytest.approx(level, rel=1e-9)


@pytest.mark.parametrize("name", list(WRAPPED))
def test_other_scipy_distributions_are_wrapped(name: str) -> None:
    frozen = WRAPPED[name]
    converted = as_openturns(frozen)
    assert converted.getDimension() == 1
    for level in LEVELS[2:]:
        x = float(frozen.ppf(level))
        assert converted.computeCDF(x) == pytest.approx(level, rel=1e-9)
        assert converted.computeQuantile(level)[0] == pytest.approx(x, rel=1e-9)


def test_a_family_whose_law_differs_is_not_taken(monkeypatch: pytest.MonkeyPatch) -> None:
    from uqfold.inputs import convert

    wrong = {"norm": lambda ot, _, loc, scale: ot.Normal(loc, scale * (1 + 1e-6))}
    monkeypatch.setattr(convert, "_SCIPY_FAMILIES", wrong)
    converted = as_openturns(stats.norm(3, 2))
    assert converted.computeCDF(5.0) == pytest.approx(stats.norm(3, 2).cdf(5.0), rel=1e-12)


NORMAL = stats.Normal(mu=1.0, sigma=2.0)


@pytest.mark.parametrize(
    ("variable", "law", "shown"),
    [
        (NORMAL, stats.norm(1, 2), "Normal(mu = 1, sigma = 2)"),
        (2.0 * NORMAL + 1.0, stats.norm(3, 4), "Normal(mu = 3, sigma = 4)"),
        (stats.Uniform(a=0.0, b=2.0), stats.uniform(0, 2), "Uniform(a = 0, b = 2)"),
        (stats.truncate(NORMAL, 0.0, 4.0), stats.truncnorm(-0.5, 1.5, 1, 2), "Truncated"),
        (
            stats.exp(stats.Normal(mu=0.1, sigma=0.2)),
            stats.lognorm(0.2, scale=math.exp(0.1)),
            "scipy.stats.exp(Normal(mu=0.1, sigma=0.2))",
        ),
        (stats.make_distribution(stats.gamma)(a=2.0), stats.gamma(2), "scipy.stats.Gamma(a=2.0)"),
    ],
)
def test_random_variables_of_scipy_keep_their_law_to_the_tails(
    variable: Any, law: Any, shown: str
) -> None:
    inputs = product_inputs(None, {"x": variable})
    u = np.array([-6.0, -3.0, 0.0, 3.0, 6.0])
    x = inputs.from_standard_normal(u[:, None])[:, 0]
    np.testing.assert_allclose(x, np.where(u < 0, law.ppf(ndtr(u)), law.isf(ndtr(-u))), rtol=1e-9)
    assert inputs.means[0] == pytest.approx(law.mean(), rel=1e-9)
    assert inputs.standard_deviations[0] == pytest.approx(law.std(), rel=1e-6)
    assert str(inputs.columns[0]).startswith(shown)


def test_a_mixture_of_scipy_is_tabulated_and_never_pickled_wrongly() -> None:
    """SciPy's pickle of a normal variable forgets its mean, which must not go unnoticed."""
    mixture = stats.Mixture([NORMAL, stats.Normal(mu=5.0, sigma=1.0)], weights=[0.3, 0.7])
    inputs = product_inputs(None, {"x": mixture})
    x = inputs.from_standard_normal(np.array([[-3.0], [1.0], [5.0]]))
    np.testing.assert_allclose(mixture.cdf(x[:2, 0]), ndtr([-3.0, 1.0]), rtol=1e-6)
    assert mixture.ccdf(x[2, 0]) == pytest.approx(ndtr(-5.0), rel=1e-3)
    with suppress(ValueError):  # it is refused, or right
        again = pickle.loads(pickle.dumps(inputs))
        np.testing.assert_array_equal(again.from_standard_normal(np.array([[-3.0]])), x[:1])


def test_multivariate_normal_of_scipy() -> None:
    covariance = [[1.0, 0.5, 0.0], [0.5, 2.0, -0.3], [0.0, -0.3, 0.5]]
    frozen = stats.multivariate_normal([1, 2, 3], covariance)
    converted = as_openturns(frozen)
    np.testing.assert_allclose(np.array(converted.getCovariance()), covariance, rtol=1e-12)
    np.testing.assert_allclose(np.array(converted.getMean()), [1, 2, 3])
    x = [0.3, 2.5, 3.1]
    assert converted.computePDF(x) == pytest.approx(frozen.pdf(x), rel=1e-12)
    assert as_openturns(stats.multivariate_normal(1.0, 4.0)).getDimension() == 1


@pytest.mark.parametrize("name", list(CHAOSPY))
def test_chaospy_families_keep_their_law(name: str) -> None:
    distribution = CHAOSPY[name]
    converted = as_openturns(distribution)
    assert family(converted) == name
    for level in LEVELS[2:]:
        x = float(np.ravel(distribution.inv(level))[0])
        assert converted.computeCDF(x) == pytest.approx(level, rel=1e-6)


@pytest.mark.parametrize(
    "distribution",
    [
        chaospy.Gamma(2, 1.5),
        chaospy.LogNormal(0.5, 0.25, shift=1.0),
        chaospy.LogNormal(0.5, 0.25, shift=-9.0),
        chaospy.Trunc(chaospy.Normal(0, 1), -1, 2),
    ],
    ids=str,
)
def test_other_chaospy_distributions_are_wrapped(distribution: Any) -> None:
    converted = as_openturns(distribution)
    for level in LEVELS[3:-1]:
        x = float(np.ravel(distribution.inv(level))[0])
        assert converted.computeCDF(x) == pytest.approx(level, abs=1e-9)


def test_independent_chaospy_joint() -> None:
    joint = as_openturns(chaospy.J(chaospy.Normal(1, 2), chaospy.Uniform(3, 4)))
    assert joint.getDimension() == 2
    assert joint.hasIndependentCopula()
    np.testing.assert_allclose(np.array(joint.getMean()), [1.0, 3.5], rtol=1e-12)


def test_openturns_passes_unchanged() -> None:
    copula = ot.JointDistribution([ot.Normal(), ot.Uniform()], ot.ClaytonCopula(2.0))
    converted = as_openturns(copula)
    assert converted == copula
    assert not converted.hasIndependentCopula()
    assert as_openturns(ot.Normal(1, 2)).computeCDF(1.0) == 0.5


def test_mappings_and_sequences() -> None:
    mapped = as_openturns({"speed": ot.Normal(3, 1), "width": stats.uniform(1, 1)})
    assert list(mapped.getDescription()) == ["speed", "width"]
    listed = as_openturns([chaospy.Normal(3, 1), stats.uniform(1, 1)])
    for joint in (mapped, listed):
        assert joint.hasIndependentCopula()
        np.testing.assert_allclose(np.array(joint.getMean()), [3.0, 1.5], rtol=1e-12)


@pytest.mark.parametrize(
    ("distribution", "error", "message"),
    [
        (
            chaospy.MvNormal([0, 0], [[1, 0.5], [0.5, 1]]),
            ValueError,
            "state the dependence with an OpenTURNS copula",
        ),
        (stats.norm, TypeError, "is not a frozen distribution"),
        (stats.Normal(mu=[0, 1]), ValueError, "scipy.stats.Normal with arrays of parameters"),
        (stats.Normal(sigma=-1.0), ValueError, "scipy.stats.Normal: the parameters make no"),
        (stats.norm([0, 1], 1), ValueError, "scipy.stats.norm with arrays of parameters"),
        (stats.gaussian_kde([1.0, 2.0, 3.0]), TypeError, "is not a frozen distribution"),
        ([], ValueError, "an empty list of distributions"),
        ({}, ValueError, "an empty list of distributions"),
        ([ot.Normal(2)], ValueError, "has dimension 2: pass a joint distribution by itself"),
        ("normal", TypeError, "'normal' is not a distribution"),
        (3.0, TypeError, r"3\.0 is not a distribution"),
        (None, TypeError, "None is not a distribution"),
        ([ot.Normal(), 3.0], TypeError, r"3\.0 is not a distribution"),
    ],
    ids=lambda value: str(value)[:30],
)
def test_what_is_no_distribution_is_refused(
    distribution: Any, error: type[Exception], message: str
) -> None:
    with pytest.raises(error, match=message):
        as_openturns(distribution)
