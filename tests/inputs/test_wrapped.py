"""Distributions that OpenTURNS only wraps are asked directly: fast, exact in the tails, and Ctrl-C
stays Ctrl-C."""

import pickle
import threading
from typing import Any

import chaospy
import numpy as np
import openturns as ot
import pytest
from scipy import stats
from scipy.special import ndtr

from uqfold import Problem
from uqfold.inputs import joint_inputs, product_inputs
from uqfold.inputs.behind import python_object
from uqfold.methods import MonteCarlo


def wrapped(distribution: Any) -> Any:
    return ot.Distribution(ot.SciPyDistribution(distribution))


LAWS = [
    stats.gumbel_l(1, 2),
    stats.laplace(0, 3),
    stats.burr12(2.0, 3.0),
    stats.invgauss(1.5, loc=1),
    stats.genextreme(-0.2),
]
U = np.array([-9.0, -6.0, -1.0, 0.0, 1.0, 6.0, 9.0])


@pytest.mark.parametrize("law", LAWS, ids=lambda law: law.dist.name)
def test_quantiles_are_those_of_scipy_in_both_tails(law: Any) -> None:
    inputs = product_inputs(None, {"x": law})
    x = inputs.from_standard_normal(U[:, None])[:, 0]
    np.testing.assert_array_equal(x[:4], law.ppf(ndtr(U[:4])))
    np.testing.assert_array_equal(x[4:6], law.isf(ndtr(-U[4:6])))
    assert np.isfinite(x).all()
    np.testing.assert_allclose(inputs.to_standard_normal(x[1:-1, None])[:, 0], U[1:-1], atol=1e-6)
    assert inputs.means[0] == pytest.approx(law.mean())


class Counting:
    """Counts the calls of a frozen distribution."""

    def __init__(self, law: Any) -> None:
        self.law, self.calls = law, 0
        self.asked: list[int] = []

    def __call__(self, q: Any) -> Any:
        self.calls += 1
        self.asked.append(np.size(q))
        return self.law(q)


@pytest.mark.parametrize("dependent", [False, True])
def test_wrapped_inputs_are_drawn_all_rows_at_once(
    dependent: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    # a call for each value is 440 times slower
    joint = [wrapped(stats.gumbel_l(1, 2)), ot.Normal()]
    copula = ot.ClaytonCopula(2.0) if dependent else ot.IndependentCopula(2)
    inputs = joint_inputs(ot.JointDistribution(joint, copula))
    law = inputs.columns[0].law  # type: ignore[attr-defined]
    counted = Counting(law.ppf)
    monkeypatch.setattr(law, "ppf", counted)
    monkeypatch.setattr(law, "isf", Counting(law.isf))
    x = inputs.sample(np.random.default_rng(0), 20_000)
    assert counted.calls < 100
    assert stats.kstest(x[:, 0], law.cdf).pvalue > 1e-4


def test_the_original_is_found_again_wherever_openturns_keeps_it() -> None:
    law = stats.johnsonsu(2.55, 2.25)
    joint = ot.JointDistribution([ot.Normal(), wrapped(law)], ot.FrankCopula(3.0))
    for place in (wrapped(law), joint.getMarginal(1), pickle.loads(pickle.dumps(wrapped(law)))):
        found = python_object(ot.Distribution(place))
        assert isinstance(found, ot.SciPyDistribution)
        assert found._dist.args == law.args
    assert python_object(ot.Distribution(ot.Normal())) is None
    problem = Problem(lambda x: x[:, 0], inputs=joint)
    again = Problem(lambda x: x[:, 0], inputs=problem.inputs.distribution)
    u = np.random.default_rng(0).standard_normal((50, 2))
    np.testing.assert_array_equal(
        again.inputs.from_standard_normal(u), problem.inputs.from_standard_normal(u)
    )


def test_dependence_of_wrapped_inputs_is_that_of_the_copula() -> None:
    marginals = [stats.gumbel_l(1, 2), stats.laplace(0, 3)]
    copula = ot.GumbelCopula(2.0)
    own = joint_inputs(ot.JointDistribution([wrapped(m) for m in marginals], copula))
    plain = joint_inputs(ot.JointDistribution([ot.Uniform(0, 1)] * 2, copula))
    u = np.random.default_rng(1).standard_normal((500, 2))
    levels = plain.from_standard_normal(u)
    for column, law in enumerate(marginals):
        np.testing.assert_allclose(
            own.from_standard_normal(u)[:, column], law.ppf(levels[:, column]), rtol=1e-9
        )
    np.testing.assert_allclose(own.to_standard_normal(own.from_standard_normal(u)), u, atol=1e-6)


@pytest.mark.parametrize("law", [LAWS[0], chaospy.Triangle(-1, 0, 2)], ids=["scipy", "chaospy"])
def test_wrapped_inputs_can_be_moved_and_pickled(law: Any) -> None:
    inputs = product_inputs(None, {"x": law})
    moved = inputs.with_moments(means={"x": 7.0}, standard_deviations={"x": 0.1})
    assert moved.means[0] == pytest.approx(7.0)
    assert moved.standard_deviations[0] == pytest.approx(0.1)
    u = U[1:-1, None]
    scaled = (inputs.from_standard_normal(u) - inputs.means) / inputs.standard_deviations
    np.testing.assert_allclose(
        (moved.from_standard_normal(u) - 7.0) / 0.1, scaled, rtol=1e-6, atol=1e-9
    )
    again = pickle.loads(pickle.dumps(moved))
    np.testing.assert_array_equal(again.from_standard_normal(u), moved.from_standard_normal(u))


def test_drawing_from_other_threads() -> None:
    # it crashed when OpenTURNS called back from a thread of its own
    problem = Problem.from_limit_state(lambda x: x[:, 0], {"x": LAWS[0], "y": LAWS[1]})
    found: list[float] = []

    def run() -> None:
        found.append(MonteCarlo(systems=2000).estimate(problem, rng=1)[0].pf)

    threads = [threading.Thread(target=run) for _ in range(4)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert len(found) == 4
    assert len(set(found)) == 1


SOLVED = [
    pytest.param(stats.genhyperbolic(0.5, 1.5, -0.5), marks=pytest.mark.thorough),
    stats.argus(1.0),
]
"""One without bounds, one between two."""


@pytest.mark.parametrize("law", SOLVED, ids=lambda law: law.dist.name)
def test_laws_without_quantiles_are_tabulated_once(law: Any) -> None:
    """SciPy solves for each of their quantiles, a millisecond each: few are asked for."""
    inputs = product_inputs(None, {"x": law})
    original = inputs.columns[0].law  # type: ignore[attr-defined]
    lower, upper = Counting(original.ppf), Counting(original.isf)
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(original, "ppf", lower)
        patch.setattr(original, "isf", upper)
        x = inputs.sample(np.random.default_rng(0), 20_000)
        assert sum(lower.asked + upper.asked) == 0
        # the tails are the law's own
        far = inputs.from_standard_normal(np.array([[-7.0], [7.0]]))[:, 0]
        assert sum(lower.asked + upper.asked) == 2
    np.testing.assert_allclose(far, [law.ppf(ndtr(-7.0)), law.isf(ndtr(-7.0))], rtol=1e-9)
    assert stats.kstest(x[:200, 0], law.cdf).pvalue > 1e-4
    u = np.linspace(-5.01, 5.01, 23)  # further out SciPy's own solution is rough
    found = inputs.from_standard_normal(u[:, None])[:, 0]
    right = np.where(u < 0, law.ppf(ndtr(u)), law.isf(ndtr(-u)))
    np.testing.assert_allclose(found, right, rtol=0, atol=1e-6 * law.std())
    assert (np.diff(found) > 0).all()


def test_what_no_table_can_follow_stays_exact() -> None:
    """Two humps with nothing between: interpolation would fill the gap."""

    class Humps(stats.rv_continuous):
        def _pdf(self, x: Any) -> Any:
            return np.where((x < 1.0) | (x > 2.0), 0.5, 0.0)

        def _cdf(self, x: Any) -> Any:
            return 0.5 * (np.minimum(x, 1.0) + np.maximum(x - 2.0, 0.0))

    marginal = product_inputs(None, {"x": Humps(a=0.0, b=3.0, name="humps")()}).columns[0]
    u = np.array([-0.003, -0.001, 0.001, 0.003])
    x = marginal.from_normal(u)
    assert ((x < 1.0) | (x > 2.0)).all()
    np.testing.assert_allclose(marginal.cdf(x), ndtr(u), atol=1e-12)
