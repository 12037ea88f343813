"""An input is checked before it is let in: replaced where OpenTURNS is wrong, or refused."""

import math
from typing import Any

import chaospy
import numpy as np
import openturns as ot
import pytest
from scipy import integrate, stats
from scipy.special import log_ndtr, ndtr

from uqfold import Problem
from uqfold.inputs import joint_inputs, product_inputs
from uqfold.inputs.door import checked_marginal
from uqfold.inputs.laws import ClosedMarginal, TruncatedMarginal
from uqfold.inputs.marginal import OpenTURNSMarginal
from uqfold.methods import FFNIPearson, MonteCarlo

U = np.array([-8.0, -6.0, -3.0, -1.0, 0.0, 1.0, 3.0, 6.0, 8.0])


def truncated_probability(low: float, high: float, x: float) -> float:
    """P(X > x) of a standard normal between two positive bounds, in logarithms."""
    a, b, t = (float(log_ndtr(-value)) for value in (low, high, x))
    return math.exp(t - a) * math.expm1(b - t) / math.expm1(b - a)


def test_far_truncated_normal_is_right_in_every_method() -> None:
    # OpenTURNS draws 8 % outside, and mc said 0.376, converged
    right = truncated_probability(8.0, 10.0, 8.1)
    assert right == pytest.approx(0.4417, abs=2e-4)
    problem = Problem.from_limit_state(
        lambda x: 8.1 - x[:, 0], {"x": ot.TruncatedNormal(0.0, 1.0, 8.0, 10.0)}
    )
    inputs = problem.inputs
    x = inputs.sample(np.random.default_rng(0), 20_000)
    assert x.min() >= 8.0
    assert x.max() <= 10.0
    row = MonteCarlo(systems=20_000).estimate(problem, rng=1)[0]
    assert abs(row.pf - right) < 4.5 * math.sqrt(right * (1 - right) / 20_000)
    # moments and Gauss rule belong to the same distribution
    mean = integrate.quad(lambda t: truncated_probability(8.0, 10.0, t), 8.0, 10.0)[0] + 8.0
    assert inputs.means[0] == pytest.approx(mean, rel=1e-9)
    nodes, weights = inputs.gauss_rule(0, 5)
    assert weights @ nodes == pytest.approx(mean, rel=1e-12)
    assert math.sqrt(weights @ (nodes - mean) ** 2) == pytest.approx(
        inputs.standard_deviations[0], rel=1e-9
    )
    assert abs(FFNIPearson().estimate(problem, rng=1)[0].pf - right) < 0.02


FAR = {
    "upper": (ot.TruncatedNormal(0, 1, 8, 10), stats.truncnorm(8, 10)),
    "very far": (ot.TruncatedNormal(1, 2, 41, 61), stats.truncnorm(20, 30, 1, 2)),
    "just off": (ot.TruncatedNormal(0, 1, 5, 6), stats.truncnorm(5, 6)),
    "lower": (ot.TruncatedNormal(0, 1, -40, -39), stats.truncnorm(-40, -39)),
    "open": (
        ot.TruncatedDistribution(ot.Normal(), 6.0, ot.TruncatedDistribution.LOWER),
        stats.truncnorm(6, math.inf),
    ),
    "by SciPy": (stats.truncnorm(30, 32, 1, 2), stats.truncnorm(30, 32, 1, 2)),
}


def _name(value: Any) -> str:
    """Name of a test that is the same in every process: no address of an object."""
    return getattr(getattr(value, "dist", None), "name", str(value)[:60])


@pytest.mark.parametrize("name", list(FAR))
def test_far_truncated_normals_follow_their_law_in_both_tails(name: str) -> None:
    given, law = FAR[name]
    inputs = product_inputs(None, {"x": given})
    x = inputs.from_standard_normal(U[:, None])[:, 0]
    right = np.where(U <= 0, law.ppf(ndtr(U)), law.isf(ndtr(-U)))
    # SciPy's own quantiles are off by 1e-6 of the probability in the longer tail
    np.testing.assert_allclose(x[1:-1], right[1:-1], rtol=1e-7)
    if name not in ("lower", "just off"):  # double precision ends at these upper bounds
        low, high, loc, scale = (*law.args, 0.0, 1.0)[:4]
        found = [truncated_probability(low, high, (v - loc) / scale) for v in x[5:-1]]
        np.testing.assert_allclose(found, ndtr(-U[5:-1]), rtol=1e-9)
    assert ((x >= law.support()[0]) & (x <= law.support()[1])).all()
    assert (np.diff(x) >= 0).all()
    back = inputs.to_standard_normal(x[1:-1, None])[:, 0]
    np.testing.assert_allclose(back, U[1:-1], atol=2e-2)
    np.testing.assert_allclose(back[1:-1], U[2:-2], atol=1e-5)


def test_any_truncated_tail_is_computed_from_its_own_tail() -> None:
    # P(X > x) of an exponential tail is exp(-x), whatever lies below the cut
    cut = ot.TruncatedDistribution(ot.Gumbel(1.0, 0.0), 32.0, 34.0)
    marginal = checked_marginal(ot.Distribution(cut), "x")
    x = marginal.from_normal(U)
    below = np.expm1(32.0 - x) / np.expm1(-2.0)
    np.testing.assert_allclose(below[1:-1], ndtr(U[1:-1]), rtol=1e-3)
    assert marginal.moments[0] == pytest.approx(32.0 + 1.0 - 2.0 / math.expm1(2.0), rel=1e-7)


@pytest.mark.parametrize(
    "distribution",
    [
        ot.LogNormal(0, 50.0),
        ot.Beta(1e-3, 1e-3, 0, 1),
        ot.Gamma(1e-3, 1.0),
        ot.WeibullMin(1.0, 0.05, 0.0),
        ot.Pareto(1.0, 0.1, 0.0),
        ot.Student(0.1),
        ot.Mixture([ot.Normal(0, 1), ot.Normal(100, 1e-3)]),
        ot.Mixture([ot.Uniform(0, 1), ot.Uniform(5, 6)]),
        ot.Histogram(0.0, [1.0, 1.0, 1.0], [0.2, 0.0, 0.8]),
        ot.KernelSmoothing().build(ot.Sample([[0.1], [0.5], [0.7], [2.0], [2.5]])),
        ot.Uniform(1e9, 1e9 + 1e-5),
        ot.CompositeDistribution(ot.SymbolicFunction("x", "x^2"), ot.Normal()),
        ot.TruncatedNormal(0, 1, -1, 2),
        chaospy.Triangle(-1, 0, 2),
        stats.levy(),
        stats.johnsonsu(2.55, 2.25),
        stats.genextreme(-0.3),
    ],
    ids=_name,
)
def test_what_is_odd_but_right_is_let_in(distribution: Any) -> None:
    inputs = product_inputs(None, {"x": distribution})
    x = inputs.sample(np.random.default_rng(0), 2000)[:, 0]
    low, high = (bound[0] for bound in inputs.bounds)
    assert ((x >= low) & (x <= high)).all()
    # values at the ends of double precision stand for all probabilities beyond
    end = high if math.isinf(high) else high - 1e-9 * abs(high)
    inner = (x > low + 1e-300) & (x < end) & (np.ptp(x) > 1e-4)
    level = inputs.columns[0].cdf(x)
    expected = ndtr(np.random.default_rng(0).standard_normal(2000))
    np.testing.assert_allclose(level[inner], expected[inner], atol=1e-8)


def test_openturns_keeps_what_has_no_closed_form() -> None:
    kinds = [
        (ot.Normal(0, 1), ClosedMarginal),
        (ot.Beta(2, 3, 0, 1), ClosedMarginal),
        (ot.TruncatedNormal(0, 1, -1, 2), TruncatedMarginal),
        (ot.Mixture([ot.Normal(0, 1), ot.Normal(3, 1)]), OpenTURNSMarginal),
    ]
    for distribution, kind in kinds:
        assert type(checked_marginal(ot.Distribution(distribution), "x")) is kind


class Halved(ot.PythonDistribution):
    """A uniform distribution whose quantiles are half of what they should be."""

    def __init__(self) -> None:
        super().__init__(1)

    def getRange(self) -> Any:
        return ot.Interval(0.0, 1.0)

    def computeCDF(self, x: Any) -> float:
        return min(max(x[0], 0.0), 1.0)

    def computeScalarQuantile(self, p: float, tail: bool = False) -> float:
        return 0.5 * (1.0 - p if tail else p)


@pytest.mark.parametrize(
    ("distribution", "message"),
    [
        (Halved(), "its quantile of .*, where its probability is 1.4"),
        (ot.Pareto(1.0, 0.01, 0.0), "its quantile of the upper probability .* is infinite"),
        (ot.Uniform(1.0, 2.0) + ot.Exponential(0.5), "jumps by 6"),
        (ot.Normal(0.0, 0.0), "its quantiles do not increase"),
        (ot.Uniform(0.0, math.inf), "its quantiles are not numbers"),
        (ot.Normal(math.nan, 1.0), "quantiles fail"),
        (stats.norm(0, 0), r"scipy.stats.norm: scale = 0: give a positive number"),
        (stats.norm(0, -1), "scale = -1"),
        (stats.norm(math.nan, 1), "loc = nan: give a finite number"),
        (stats.uniform(0, math.inf), "scale = inf"),
        (stats.gumbel_l(0, math.nan), "scale = nan"),
        (stats.gamma(-1), r"scipy.stats.gamma\(-1\): the parameters make no distribution"),
        (stats.truncnorm(3, 1), "the parameters make no distribution"),
        (chaospy.Normal(0, 0), r"chaospy's Normal\(mu=0, sigma=0\): its parameters make no"),
        (chaospy.Normal(0, -1), "make no distribution"),
        (chaospy.Uniform(0, math.inf), "make no distribution"),
        (chaospy.Uniform(1, 0), "make no distribution"),
        (ot.Dirac(1.0), "it takes the value 1 only"),
    ],
    ids=_name,
)
def test_impossible_inputs_are_refused_by_name_when_the_problem_is_built(
    distribution: Any, message: str
) -> None:
    with pytest.raises(ValueError, match=f"input 'load'.*{message}"):
        Problem(lambda x: x[:, 0], individual={"load": distribution})


@pytest.mark.parametrize(
    "distribution", [stats.norm, stats.multivariate_t([0, 0]), stats.dirichlet([1, 2]), "norm", 3]
)
def test_what_is_no_distribution_is_refused_by_name(distribution: Any) -> None:
    with pytest.raises(TypeError, match="input 'load': "):
        Problem(lambda x: x[:, 0], individual={"load": distribution})


@pytest.mark.parametrize(
    ("distribution", "message"),
    [
        (
            stats.rv_histogram(np.histogram(np.arange(9.0))),
            "scipy.stats.rv_histogram is not a frozen distribution: call it, as in "
            "scipy.stats.rv_histogram(histogram)()",
        ),
        (
            stats.gaussian_kde([1.0, 2.0, 4.0]),
            "scipy.stats.gaussian_kde is not a frozen distribution: give "
            "openturns.KernelSmoothing().build(sample)",
        ),
        (
            stats.norm,
            "scipy.stats.norm is not a frozen distribution: call it with its parameters, as in "
            "scipy.stats.norm(0, 1)",
        ),
    ],
    ids=["rv_histogram", "gaussian_kde", "norm"],
)
def test_messages_on_distributions_of_scipy_say_what_to_do(distribution: Any, message: str) -> None:
    with pytest.raises(TypeError) as caught:
        Problem(lambda x: x[:, 0], individual={"load": distribution})
    assert str(caught.value) == f"individual: input 'load': {message}"
    with pytest.raises(TypeError) as caught:
        Problem(lambda x: x[:, 0], individual=distribution)
    assert str(caught.value) == f"individual: {message}"
    assert product_inputs(None, stats.rv_histogram(np.histogram(np.arange(9.0)))()).dimension == 1


def test_a_moved_input_is_checked_too() -> None:
    inputs = product_inputs(None, {"x": ot.TruncatedNormal(0, 1, 8, 10)})
    moved = inputs.with_moments(means={"x": 3.0}, standard_deviations={"x": 0.5})
    assert moved.means[0] == pytest.approx(3.0, rel=1e-9)
    assert moved.standard_deviations[0] == pytest.approx(0.5, rel=1e-6)
    before, after = (one.from_standard_normal(U[:, None])[:, 0] for one in (inputs, moved))
    ratio = 0.5 / inputs.standard_deviations[0]
    np.testing.assert_allclose((after - 3.0), (before - inputs.means[0]) * ratio, atol=1e-6)


def test_scores_use_the_replaced_law() -> None:
    x = ot.TruncatedNormal(0, 1, 8, 10)
    inputs = joint_inputs(ot.JointDistribution([x, ot.Normal()], ot.ClaytonCopula(2.0)))
    rows = np.array([[8.05, 0.3], [8.4, -1.0]])
    shared, joint = inputs.log_density(rows)
    law = stats.truncnorm(8, 10)
    levels = np.column_stack([law.cdf(rows[:, 0]), ndtr(rows[:, 1])])
    expected = law.logpdf(rows[:, 0]) + stats.norm.logpdf(rows[:, 1])
    expected += np.array(ot.ClaytonCopula(2.0).computeLogPDF(levels)).ravel()
    np.testing.assert_allclose(joint, expected, rtol=1e-9)
    assert (shared == 0.0).all()


def test_a_tail_that_openturns_gets_wrong_inside_another_distribution_is_refused() -> None:
    tail = ot.TruncatedNormal(0, 1, 8, 10)
    for hidden in (
        ot.Mixture([tail, ot.Normal()]),
        ot.Distribution(tail) * 2.0 + 1.0,
        ot.CompositeDistribution(ot.SymbolicFunction("x", "exp(x)"), tail),
    ):
        with pytest.raises(ValueError, match="input 'x' = "):
            product_inputs(None, {"x": hidden})


def of_density(density: float, *, bounded: bool) -> Any:
    """A SciPy law whose density is so many times that of a uniform or normal one."""

    class Scaled(stats.rv_continuous):
        def _pdf(self, x: Any) -> Any:
            return density * (np.ones_like(x) if bounded else np.exp(-0.5 * x**2) / 2.5066282746)

    return (Scaled(a=0.0, b=1.0, name="own") if bounded else Scaled(name="own"))()


@pytest.mark.parametrize(("density", "bounded"), [(0.999, True), (1.001, True), (0.5, False)])
def test_a_density_that_does_not_integrate_to_one_is_refused(density: float, bounded: bool) -> None:
    """A law whose probabilities pass one, or end below it, draws something else than it says."""
    with pytest.raises(ValueError, match=r"input 'load'.*scipy.stats.own\(\)"):
        product_inputs(None, {"load": of_density(density, bounded=bounded)})


def test_a_density_that_integrates_to_one_is_taken() -> None:
    assert product_inputs(None, of_density(1.0, bounded=True)).dimension == 1


def test_a_law_that_scipy_fails_on_is_named_with_a_remedy() -> None:
    law = stats.levy_stable(1.5, 0.5)
    with pytest.raises(ValueError, match=rf"input 'load': scipy.stats.{law.dist.name}\(") as caught:
        Problem(lambda x: x[:, 0], individual={"load": law})
    assert "give another family, or openturns.KernelSmoothing().build(sample)" in str(caught.value)


@pytest.mark.parametrize("name", ["a ", " a", "a\nb", "a\tb", "a\x07", "a\u2028b"])
def test_names_with_blanks_around_or_control_signs_are_refused(name: str) -> None:
    with pytest.raises(ValueError, match=r"names of inputs = .*: name without"):
        product_inputs(None, {"a": stats.norm(0, 1), name: stats.norm(0, 1)})
    described = ot.Normal(2)
    described.setDescription(["a", name])
    with pytest.raises(ValueError, match=r"names of inputs = .*: name without"):
        joint_inputs(described)
