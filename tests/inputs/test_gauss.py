"""Gauss rules fit every marginal: exact to degree 2 n - 1, to the far tails, or refused."""

import math
from collections.abc import Callable
from typing import Any

import chaospy
import numpy as np
import openturns as ot
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy import special, stats

from uqfold.inputs import gauss
from uqfold.inputs.convert import as_openturns
from uqfold.inputs.gauss import MAX_GAUSS_NODES, gauss_rule


def moments_of_gumbel(k: int) -> float:
    """Raw moments of the standard Gumbel distribution, from its cumulants."""
    cumulants = [0.0, np.euler_gamma] + [
        special.zeta(j) * math.factorial(j - 1) for j in range(2, k + 1)
    ]
    raw = [1.0]
    for j in range(1, k + 1):
        raw.append(
            sum(math.comb(j - 1, i - 1) * cumulants[i] * raw[j - i] for i in range(1, j + 1))
        )
    return raw[k]


def moments_of_normal(k: int) -> float:
    return 0.0 if k % 2 else float(special.factorial2(k - 1)) if k else 1.0


def moments_of_triangular(k: int) -> float:
    # on [0, 1] with mode c: 2 [c^(k+1) (1/(k+2)) + ...] written out
    c = 0.3
    rising = 2 * c ** (k + 1) / (k + 2)
    falling = 2 / (1 - c) * ((1 - c ** (k + 1)) / (k + 1) - (1 - c ** (k + 2)) / (k + 2))
    return rising + falling


def moments_of_truncated_normal(k: int) -> float:
    # on [-1, 2], by the recursion of its moments
    a, b = -1.0, 2.0
    mass = stats.norm.cdf(b) - stats.norm.cdf(a)
    m = [1.0, (stats.norm.pdf(a) - stats.norm.pdf(b)) / mass]
    for j in range(2, k + 1):
        ends = b ** (j - 1) * stats.norm.pdf(b) - a ** (j - 1) * stats.norm.pdf(a)
        m.append((j - 1) * m[j - 2] - ends / mass)
    return float(m[k])


# Every marginal with its raw moments in closed form
EXACT: dict[str, tuple[Any, Callable[[int], float]]] = {
    "normal": (ot.Normal(0, 1), moments_of_normal),
    "uniform": (ot.Uniform(0, 1), lambda k: 1 / (k + 1)),
    "exponential": (ot.Exponential(1.0), lambda k: float(math.factorial(k))),
    "gamma": (ot.Gamma(2.5, 1.0), lambda k: math.gamma(2.5 + k) / math.gamma(2.5)),
    "beta": (
        ot.Beta(2.0, 3.0, 0.0, 1.0),
        lambda k: math.gamma(2 + k) * math.gamma(5) / (math.gamma(5 + k) * math.gamma(2)),
    ),
    "lognormal": (ot.LogNormal(0, 0.25), lambda k: math.exp(k * k * 0.25**2 / 2)),
    "wide lognormal": (ot.LogNormal(0, 1.0), lambda k: math.exp(k * k / 2)),
    "gumbel": (ot.Gumbel(1, 0), moments_of_gumbel),
    "weibull": (ot.WeibullMin(1.0, 1.5, 0.0), lambda k: math.gamma(1 + k / 1.5)),
    "rayleigh": (ot.Rayleigh(1.0), lambda k: 2 ** (k / 2) * math.gamma(1 + k / 2)),
    "triangular": (ot.Triangular(0.0, 0.3, 1.0), moments_of_triangular),
    "truncated normal": (ot.TruncatedNormal(0, 1, -1, 2), moments_of_truncated_normal),
    "laplace": (ot.Laplace(0, 1.0), lambda k: 0.0 if k % 2 else float(math.factorial(k))),
    "logistic": (
        ot.Logistic(0, 1.0),
        lambda k: (
            0.0
            if k % 2
            else 2 * (1 - 2.0 ** (1 - k)) * math.factorial(k) * special.zeta(k)
            if k
            else 1.0
        ),
    ),
    "student": (
        ot.Student(30.0),
        lambda k: (
            0.0
            if k % 2
            else 30 ** (k / 2)
            * math.gamma((k + 1) / 2)
            * math.gamma(15 - k / 2)
            / (math.sqrt(math.pi) * math.gamma(15))
        ),
    ),
    "scipy wrapped": (
        as_openturns(stats.gumbel_l()),
        lambda k: (-1) ** k * moments_of_gumbel(k),
    ),
}


@pytest.mark.parametrize("n", [1, 2, 3, 5, 8])
@pytest.mark.parametrize("name", list(EXACT))
def test_exact_to_degree_2n_minus_1(name: str, n: int) -> None:
    marginal, moment = EXACT[name]
    nodes, weights = gauss_rule(marginal, n)
    for k in range(2 * n):
        scale = weights @ np.abs(nodes) ** k
        assert abs(weights @ nodes**k - moment(k)) <= 2e-11 * max(scale, 1e-3), k


@pytest.mark.parametrize("name", list(EXACT))
def test_the_moments_above_are_not_what_any_rule_gives(name: str) -> None:
    # degree 2 n is the first that a rule of n nodes misses: the check can fail
    marginal, moment = EXACT[name]
    nodes, weights = gauss_rule(marginal, 2)
    assert abs(weights @ nodes**4 - moment(4)) > 1e-4 * weights @ nodes**4


@pytest.mark.parametrize("n", [1, 2, 3, 5, 10, 30, 64])
def test_normal_rule_is_that_of_gauss_and_hermite(n: int) -> None:
    nodes, weights = gauss_rule(ot.Normal(3.0, 0.5), n)
    x, w = np.polynomial.hermite_e.hermegauss(n)
    np.testing.assert_allclose(nodes, 3.0 + 0.5 * x, rtol=1e-13)
    np.testing.assert_allclose(weights, w / w.sum(), rtol=1e-9)


@pytest.mark.parametrize("family", ["Normal", "Uniform", "Exponential", "Gamma", "Beta"])
@pytest.mark.parametrize("n", [2, 5, 20, 64])
def test_the_general_way_meets_the_classical_rules(
    family: str, n: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    marginal = {
        "Normal": ot.Normal(3, 0.5),
        "Uniform": ot.Uniform(-1, 2),
        "Exponential": ot.Exponential(0.5, 1),
        "Gamma": ot.Gamma(2.5, 1 / 3),
        "Beta": ot.Beta(2, 3, 1, 5),
    }[family]
    classical = gauss_rule(marginal, n)
    monkeypatch.setattr(gauss, "_CLASSICAL", frozenset())
    general = gauss_rule(marginal, n)
    np.testing.assert_allclose(general[0], classical[0], rtol=1e-9)
    np.testing.assert_allclose(general[1], classical[1], rtol=1e-7)


@pytest.mark.parametrize("name", list(EXACT))
def test_rules_follow_location_and_scale(name: str) -> None:
    base = as_openturns([EXACT[name][0]]).getMarginal(0)
    moved = ot.Distribution(base) * 1e-3 + 5.0
    nodes, weights = gauss_rule(base, 5)
    try:
        moved_nodes, moved_weights = gauss_rule(moved, 5)
    except ValueError:
        pytest.fail("a moved marginal lost its rule")
    np.testing.assert_allclose((moved_nodes - 5.0) * 1e3, nodes, rtol=1e-5, atol=1e-7)
    np.testing.assert_allclose(moved_weights, weights, rtol=1e-5)


@settings(deadline=None, max_examples=40)  # a wrapped distribution takes a second
@given(st.sampled_from(sorted(EXACT)), st.integers(1, 12))
def test_rules_are_probabilities_inside_the_support(name: str, n: int) -> None:
    marginal = EXACT[name][0]
    if (name, n > 10) in {("wide lognormal", True), ("student", True)}:
        return
    nodes, weights = gauss_rule(marginal, n)
    assert nodes.shape == weights.shape == (n,)
    assert np.all(np.diff(nodes) > 0)
    assert np.all(weights > 0)
    assert weights.sum() == pytest.approx(1.0, abs=1e-14)
    bounds = marginal.getRange()
    if bounds.getFiniteLowerBound()[0]:
        assert nodes[0] > bounds.getLowerBound()[0]
    if bounds.getFiniteUpperBound()[0]:
        assert nodes[-1] < bounds.getUpperBound()[0]


@pytest.mark.parametrize(
    ("marginal", "n"),
    [
        (ot.Student(3.0, 0, 1), 2),  # the third moment is the first that is missing
        (ot.Student(10.0, 0, 1), 6),
        (ot.Pareto(1.0, 3.0, 0.0), 2),
        (ot.Frechet(1.0, 5.0, 0.0), 3),
        (as_openturns(stats.cauchy()), 1),
        (ot.LogNormal(0, 1.0), 40),  # the moments exist but leave double precision
    ],
    ids=str,
)
def test_missing_moments_are_refused(marginal: Any, n: int) -> None:
    with pytest.raises(ValueError, match=f"no Gauss rule with {n} nodes for .*use fewer nodes"):
        gauss_rule(marginal, n)


@pytest.mark.parametrize(
    ("marginal", "n"), [(ot.Student(3.0, 0, 1), 1), (ot.Student(10.0, 0, 1), 5)], ids=str
)
def test_moments_that_just_exist_suffice(marginal: Any, n: int) -> None:
    nodes, weights = gauss_rule(marginal, n)
    assert weights @ nodes == pytest.approx(0.0, abs=1e-9)


@pytest.mark.parametrize("n", [0, -1, MAX_GAUSS_NODES + 1, 2.5])
def test_number_of_nodes_is_checked(n: Any) -> None:
    with pytest.raises(ValueError, match="give a whole number from 1 to 64"):
        gauss_rule(ot.Normal(), n)


def test_density_and_quantiles_that_contradict_each_other_are_refused() -> None:
    class Torn(ot.PythonDistribution):
        """A normal distribution whose density is too large by half in its tails."""

        def __init__(self) -> None:
            super().__init__(1)

        def computeCDF(self, x: Any) -> float:
            return float(special.ndtr(x[0]))

        def computePDF(self, x: Any) -> float:
            return 0.1

        def getRange(self) -> Any:
            return ot.Interval([-9.0], [9.0], [False], [False])

    with pytest.raises(ValueError, match="density and its quantiles do not fit together"):
        gauss_rule(ot.Distribution(Torn()), 3)


@pytest.mark.parametrize("n", [3, 5])
def test_wrapped_distributions_have_rules(n: int) -> None:
    nodes, weights = gauss_rule(as_openturns(chaospy.Gamma(2, 1.5)), n)
    expected = gauss_rule(ot.Gamma(2.0, 1 / 1.5), n)
    # chaospy cuts the tail where 1e-14 is left
    np.testing.assert_allclose(nodes, expected[0], rtol=1e-5)
    np.testing.assert_allclose(weights, expected[1], rtol=1e-3)
