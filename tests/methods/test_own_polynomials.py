"""Polynomial chaos in the inputs' own orthogonal polynomials."""

import numpy as np
import openturns as ot
import pytest
from scipy import stats

import uqfold
from uqfold.methods import PolynomialChaos
from uqfold.typing import FloatArray


def answer(method: PolynomialChaos, limit, inputs) -> uqfold.methods.Estimate:
    problem = uqfold.Problem.from_limit_state(limit, inputs)
    return method.estimate(problem, rng=0)[0]


def sum_of_exponentials(count: int, pf: float):
    limit = stats.gamma.isf(pf, count)
    inputs = {f"x{i}": ot.Exponential(1.0) for i in range(count)}
    return (lambda x: limit - x.sum(axis=1)), inputs


@pytest.mark.parametrize(
    ("limit", "inputs", "pf"),
    [
        (*sum_of_exponentials(3, 1e-6), 1e-6),
        (
            lambda x: x.sum(axis=1) - 0.05,
            {f"x{i}": ot.Uniform(0.0, 1.0) for i in range(2)},
            0.05**2 / 2.0,
        ),
        (
            lambda x: x.sum(axis=1) - 0.2,
            {f"x{i}": ot.Triangular(0.0, 1.0, 2.0) for i in range(2)},
            0.2**4 / 24.0,
        ),
    ],
    ids=["exponential", "uniform", "triangular"],
)
def test_a_polynomial_of_the_inputs_is_answered_exactly(limit, inputs, pf: float) -> None:
    found = answer(PolynomialChaos(), limit, inputs)
    assert found.status == "converged"
    # integration over two inputs is right to 3e-4 of the reliability index
    assert found.pf == pytest.approx(pf, rel=2e-3)
    # and Hermite polynomials of the scores say how little they know
    scores = answer(PolynomialChaos(basis="hermite"), limit, inputs)
    assert scores.status == "doubtful"
    assert abs(scores.pf / pf - 1.0) > 0.03


def test_what_is_a_polynomial_of_the_scores_keeps_those_of_hermite() -> None:
    inputs = {f"x{i}": ot.LogNormal(0.0, 0.7) for i in range(2)}

    def limit(x: FloatArray) -> FloatArray:
        return 3.0 - np.log(x).sum(axis=1)

    best = answer(PolynomialChaos(), limit, inputs)
    assert best.pf == answer(PolynomialChaos(basis="hermite"), limit, inputs).pf
    assert best.pf == pytest.approx(stats.norm.sf(3.0 / 0.7 / np.sqrt(2.0)), rel=1e-6)
    assert answer(PolynomialChaos(basis="own"), limit, inputs).status == "doubtful"


def test_sobol_indices_and_chaospy_know_the_polynomials() -> None:
    chaospy = pytest.importorskip("chaospy")
    inputs = {"a": ot.Uniform(0.0, 1.0), "b": ot.Exponential(1.0), "c": ot.Normal(0.0, 1.0)}

    def response(x: FloatArray) -> FloatArray:
        return 3.0 * x[:, 0] * x[:, 1] + x[:, 2] ** 2

    problem = uqfold.Problem(response, individual=inputs)
    found = PolynomialChaos(basis="own").estimate(problem, uqfold.criteria(4.0), rng=0).details
    # variances: E[9 a^2 b^2] - E[3 a b]^2 = 9 * 2 / 3 - 9 / 4, and 2
    total = 3.75 + 2.0
    main = [9.0 / 12.0 / total, 9.0 / 4.0 / total, 2.0 / total]
    np.testing.assert_allclose(found.sobol_indices.main, main, rtol=1e-6)
    exported = found.surface.to_chaospy()
    law = chaospy.J(chaospy.Uniform(0.0, 1.0), chaospy.Exponential(1.0), chaospy.Normal(0.0, 1.0))
    assert float(chaospy.E(exported, law)) == pytest.approx(2.5)
    assert float(chaospy.Var(exported, law)) == pytest.approx(total)
