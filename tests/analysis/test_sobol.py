"""Sobol' indices by both routes, against functions whose indices are known."""

import math
from typing import Any

import numpy as np
import openturns as ot
import pytest

from uqfold import Problem
from uqfold.analysis import SobolIndices, chaos_sobol, pick_freeze
from uqfold.analysis.sobol_rows import ALL_SHARED
from uqfold.evaluation import BudgetExceededError
from uqfold.inputs import normal
from uqfold.methods import PolynomialChaos
from uqfold.system.conditional_response import ConditionalResponse
from uqfold.system.lines import LineRule
from uqfold.typing import FloatArray

LIMIT = 4.5  # standard errors


def product(x: FloatArray) -> FloatArray:
    """Response v + 2 a + v a + 0.5 (w^2 - 1) + v w.

    Variances: v 1, a 4, w 0.5, v with a 1, v with w 1.
    """
    v, w, a = x.T
    return v + 2.0 * a + v * a + 0.5 * (w**2 - 1.0) + v * w


PRODUCT = Problem(
    product, shared={"v": normal(0, 1), "w": normal(0, 1)}, individual={"a": normal(0, 1)}, units=2
)
WHOLE = 7.5
MAIN = {"v": 1.0 / WHOLE, "a": 4.0 / WHOLE, "w": 0.5 / WHOLE, ALL_SHARED: 2.5 / WHOLE}
TOTAL = {"v": 3.0 / WHOLE, "a": 5.0 / WHOLE, "w": 1.5 / WHOLE}


def exact(found: SobolIndices) -> FloatArray:
    return np.array([(MAIN if row.order == "main" else TOTAL)[row.input] for row in found])


def test_pick_freeze_agrees_within_its_errors() -> None:
    found = pick_freeze(PRODUCT, 256, 8, rng=1)
    index = np.array([row.index for row in found])
    error = np.array([row.std_error for row in found])
    # Student's 99.9 % quantile with 7 degrees of freedom is 5.4
    assert np.abs((index - exact(found)) / error).max() < 5.4
    assert error.max() < 0.04
    assert found.n_evals == 8 * 256 * 6
    assert found.std == pytest.approx(math.sqrt(WHOLE), rel=0.05)
    assert [row.input for row in found] == ["v", "w", "a", ALL_SHARED, "v", "w", "a"]


def test_the_comparison_can_fail() -> None:
    wrong = Problem(product, inputs=PRODUCT.inputs.distribution, names=["a", "v", "w"])
    found = pick_freeze(wrong, 256, 8, rng=1)
    z = [(row.index - MAIN[row.input]) / row.std_error for row in found if row.order == "main"]
    assert np.abs(z).max() > 20.0


def test_stated_errors_are_those_of_repetition() -> None:
    runs = [pick_freeze(PRODUCT, 64, 4, rng=seed) for seed in range(60)]
    index = np.array([[row.index for row in run] for run in runs])
    stated = np.array([[row.std_error for row in run] for run in runs])
    ratio = index.std(axis=0, ddof=1) / np.sqrt((stated**2).mean(axis=0))
    # relative errors: 1 / sqrt(118) of the spread, 1 / sqrt(360) of the pooled stated errors
    assert np.abs(ratio - 1.0).max() < LIMIT * math.hypot(1 / math.sqrt(118), 1 / math.sqrt(360))


def test_an_expansion_has_the_exact_indices_of_a_polynomial(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """And spends no time on the pf of the system: 8,000 conditional responses were asked for it."""
    asked, response = [], LineRule.response

    def counted(self: LineRule, *given: Any) -> ConditionalResponse:
        asked.append(1)
        return response(self, *given)

    monkeypatch.setattr(LineRule, "response", counted)
    found = chaos_sobol(PRODUCT, PolynomialChaos(runs=40), rng=1)
    assert len(asked) < 100
    np.testing.assert_allclose([row.index for row in found], exact(found), atol=1e-6)
    assert found.n_evals == 40
    assert {row.method for row in found} == {"pce"}
    assert {row.error_kind for row in found} == {"surrogate"}


def test_errors_of_an_expansion_cover_what_it_cannot_say() -> None:
    """An expansion of degree 1 leaves a third of the variance out, and says so."""
    found = chaos_sobol(PRODUCT, PolynomialChaos(runs=40, max_degree=1), rng=1)
    z = np.array([row.index for row in found]) - exact(found)
    assert np.abs(z).max() > 0.05
    assert np.abs(z / [row.std_error for row in found]).max() < LIMIT


def test_fewer_than_two_shared_inputs_make_no_group() -> None:
    problem = Problem(lambda x: x.sum(axis=1), individual={"a": normal(0, 1), "b": normal(0, 2)})
    found = pick_freeze(problem, 64, 3, rng=0)
    assert [row.input for row in found] == ["a", "b", "a", "b"]
    assert found.n_evals == 3 * 64 * 4


def test_seed_decides() -> None:
    one, again, other = (pick_freeze(PRODUCT, 16, 3, rng=seed) for seed in (5, 5, 6))
    assert one.rows == again.rows
    assert one.rows != other.rows


def test_refusals() -> None:
    with pytest.raises(ValueError, match="samples = 100: give a power of two"):
        pick_freeze(PRODUCT, 100)
    with pytest.raises(ValueError, match="repetitions = 2"):
        pick_freeze(PRODUCT, 64, 2)
    with pytest.raises(BudgetExceededError):
        pick_freeze(PRODUCT, 64, 8, max_evals=100)
    never = Problem(lambda x: np.where(x[:, 0] > 1.0, np.inf, 1.0), individual=ot.Normal())
    with pytest.raises(ValueError, match="are infinite or failed"):
        pick_freeze(never, 64)
