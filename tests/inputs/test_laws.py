"""Closed forms of common families: OpenTURNS' numbers, both tails, and no call of OpenTURNS."""

import math
import sys
from typing import Any

import numpy as np
import openturns as ot
import pytest
from scipy.special import log_ndtr, ndtr

from uqfold.inputs import joint_inputs, product_inputs
from uqfold.inputs.door import checked_marginal
from uqfold.inputs.laws import ClosedMarginal

FAMILIES = [
    ot.Beta(2.3, 3.1, 0, 1),
    ot.Exponential(0.7),
    ot.Frechet(2.0, 3.0),
    ot.Gamma(2.3, 0.5),
    ot.Gumbel(2.0, 1.0),
    ot.Laplace(1.0, 2.0),
    ot.LogNormal(0.3, 0.5),
    ot.Logistic(1.0, 2.0),
    ot.Normal(5.0, 2.0),
    ot.Pareto(1.0, 3.0),
    ot.Rayleigh(2.0),
    ot.Student(4.5, 1.0, 2.0),
    ot.Triangular(-1.0, 0.5, 2.0),
    ot.Uniform(-1.0, 1.0),
    ot.WeibullMax(2.0, 1.7),
    ot.WeibullMin(2.0, 1.7),
]


def _name(distribution: Any) -> str:
    return str(distribution.getClassName())


def closed(distribution: Any) -> ClosedMarginal:
    marginal = checked_marginal(ot.Distribution(distribution), "x")
    assert isinstance(marginal, ClosedMarginal)
    return marginal


@pytest.mark.parametrize("distribution", FAMILIES, ids=_name)
def test_quantiles_are_those_of_openturns(distribution: Any) -> None:
    # within the levels where OpenTURNS does not lose digits by forming 1 - p
    u = np.linspace(-1.5, 1.5, 31)
    right = [distribution.computeQuantile(float(p))[0] for p in ndtr(u)]
    np.testing.assert_allclose(closed(distribution).from_normal(u), right, rtol=1e-13, atol=1e-15)


@pytest.mark.parametrize("distribution", FAMILIES, ids=_name)
def test_values_lead_back_in_both_tails(distribution: Any) -> None:
    marginal = closed(distribution)
    u = np.linspace(-37.0, 37.0, 149)
    x = marginal.from_normal(u)
    assert (np.diff(x) >= 0.0).all()
    low, high = marginal.bounds
    # at a bound other than zero, double precision ends: many levels are one number
    room = 1e8 * np.spacing(np.abs(x))
    inner = ((x - low > room) | (low == 0.0)) & ((high - x > room) | (high == 0.0))
    assert inner.sum() > 20
    np.testing.assert_allclose(marginal.to_normal(x[inner]), u[inner], rtol=1e-6, atol=1e-9)


SURVIVAL = {
    "Exponential": lambda x: -0.7 * x,
    "LogNormal": lambda x: log_ndtr(-(np.log(x) - 0.3) / 0.5),
    "Normal": lambda x: log_ndtr(-(x - 5.0) / 2.0),
    "Pareto": lambda x: -3.0 * np.log(x),
    "Rayleigh": lambda x: -0.5 * (x / 2.0) ** 2,
    "WeibullMin": lambda x: -((x / 2.0) ** 1.7),
    "Logistic": lambda x: -np.logaddexp(0.0, (x - 1.0) / 2.0),
    "Gumbel": lambda x: np.log(-np.expm1(-np.exp(-(x - 1.0) / 2.0))),
}


@pytest.mark.parametrize("distribution", [d for d in FAMILIES if _name(d) in SURVIVAL], ids=_name)
def test_upper_tail_to_probabilities_of_1e_300(distribution: Any) -> None:
    # OpenTURNS' own quantile of the Pareto distribution is 2 % off at 8 standard deviations
    log_survival = SURVIVAL[_name(distribution)]
    u = np.linspace(0.5, 37.0, 74)
    x = closed(distribution).from_normal(u)
    np.testing.assert_allclose(log_survival(x), log_ndtr(-u), rtol=1e-13)


@pytest.mark.parametrize("shapes", [(2.3, 3.1), (5.0, 2.0), (20.0, 2.0), (300.0, 2.0)])
def test_far_quantiles_of_beta_distributions(shapes: tuple[float, float]) -> None:
    # SciPy's search gives up there: not a number, or wrong
    u = np.linspace(-36.0, -5.0, 32)
    distribution = ot.Beta(*shapes, 0.0, 1.0)
    x = closed(distribution).from_normal(u)
    levels = np.array(distribution.computeCDF(ot.Sample(x[:, None]))).ravel()
    np.testing.assert_allclose(levels, ndtr(u), rtol=1e-11)


def test_truncated_values_lead_back_and_have_the_moments_of_the_density() -> None:
    cut = ot.TruncatedDistribution(ot.Gumbel(1.0, 0.0), 1.0, 3.0)
    marginal = checked_marginal(ot.Distribution(cut), "x")
    u = np.linspace(-5.0, 5.0, 41)
    x = marginal.from_normal(u)
    np.testing.assert_allclose(marginal.to_normal(x), u, atol=1e-8)
    levels = np.array(cut.computeCDF(ot.Sample(x[:, None]))).ravel()
    np.testing.assert_allclose(levels, ndtr(u), atol=1e-13)
    node, weight = np.polynomial.legendre.leggauss(40)
    at, mass = 2.0 + node, weight * marginal.pdf(2.0 + node)
    mean = mass @ at
    assert mass.sum() == pytest.approx(1.0, rel=1e-12)
    std = math.sqrt(mass @ (at - mean) ** 2)
    assert marginal.moments == pytest.approx((mean, std), rel=1e-10)


def test_moments_that_do_not_exist_are_refused() -> None:
    cut = ot.TruncatedDistribution(ot.Pareto(1.0, 1.5), 2.0, ot.TruncatedDistribution.LOWER)
    marginal = checked_marginal(ot.Distribution(cut), "x")
    with pytest.raises(ValueError, match="no finite mean"):
        marginal.moments  # noqa: B018


def test_common_inputs_are_mapped_without_openturns() -> None:
    # Ctrl-C within OpenTURNS could end the process, and it takes 20 times as long
    correlation = ot.CorrelationMatrix(2, [1.0, 0.5, 0.5, 1.0])
    linked = ot.JointDistribution([ot.Normal(), ot.Gumbel()], ot.NormalCopula(correlation))
    inputs = [product_inputs(None, FAMILIES), joint_inputs(linked)]
    u = np.random.default_rng(0).standard_normal((50, len(FAMILIES)))
    called: list[str] = []

    def note(frame: Any, event: str, what: Any) -> None:
        module = getattr(what, "__module__", None) if event == "c_call" else None
        for name in (module, frame.f_globals.get("__name__")):
            if str(name).startswith("openturns"):
                called.append(str(name))

    for one in inputs:
        one.to_standard_normal(one.from_standard_normal(u[:, : one.dimension]))  # bounds are kept
        sys.setprofile(note)
        try:
            one.to_standard_normal(one.from_standard_normal(u[:, : one.dimension]))
        finally:
            sys.setprofile(None)
    assert called == []
    sys.setprofile(note)
    try:
        ot.Normal().computeCDF(0.0)
    finally:
        sys.setprofile(None)
    assert called  # the check can fail
