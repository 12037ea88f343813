"""Derivatives of pf by simulation, against exact ones; other distributions and dependence."""

import math
from dataclasses import replace

import numpy as np
import openturns as ot
import pytest

from tests.analysis.exact_derivatives import exact_derivative
from uqfold import Binomial, Criterion, Evaluator, Problem, criteria
from uqfold.analysis import PfDerivatives, score_derivatives
from uqfold.evaluation import BudgetExceededError
from uqfold.inputs import normal
from uqfold.methods import MonteCarlo
from uqfold.testing import LinearNormalSystem

SYSTEM = LinearNormalSystem(units=3, shared_std=0.7)
GRID = [Criterion(12.0), Criterion(12.0, 3.0, Binomial(4, 0.3))]
LIMIT = 4.5  # standard errors


@pytest.fixture(scope="module")
def found() -> PfDerivatives:
    return score_derivatives(SYSTEM.problem(), GRID, 30_000, rng=3)


def errors(found: PfDerivatives, system: LinearNormalSystem) -> np.ndarray:
    return np.array(
        [
            (row.derivative - exact_derivative(system, GRID[i // 6], row.input, row.moment))
            / row.std_error
            for i, row in enumerate(found)
        ]
    )


def test_unbiased_on_a_linear_system(found: PfDerivatives) -> None:
    assert np.abs(errors(found, SYSTEM)).max() < LIMIT


@pytest.mark.parametrize("wrong", [{"shared_std": 1.0}], ids=str)
def test_the_comparison_can_fail(found: PfDerivatives, wrong: dict[str, float]) -> None:
    assert np.abs(errors(found, replace(SYSTEM, **wrong))).max() > 2.0 * LIMIT


def test_the_relative_error_knows_that_pf_errs_too(found: PfDerivatives) -> None:
    for i, row in enumerate(found):
        criterion = GRID[i // 6]
        exact = exact_derivative(SYSTEM, criterion, row.input, row.moment) / SYSTEM.pf(criterion)
        assert abs(row.per_std - row.std * exact) < LIMIT * row.per_std_error


def test_the_systems_are_those_of_monte_carlo(found: PfDerivatives) -> None:
    result = MonteCarlo(systems=30_000).estimate(SYSTEM.problem(), GRID, rng=3)
    assert [row.pf for row in found][::6] == result.pf.tolist()
    assert found.n_evals == result.n_evals


@pytest.mark.thorough
def test_stated_errors_are_those_of_repetition() -> None:
    grid = criteria(12.0, tau=3.0)
    runs = [score_derivatives(SYSTEM.problem(), grid, 1_000, rng=seed).rows for seed in range(60)]
    derivative = np.array([[row.derivative for row in rows] for rows in runs])
    stated = np.array([[row.std_error for row in rows] for rows in runs])
    ratio = derivative.std(axis=0, ddof=1) / np.sqrt((stated**2).mean(axis=0))
    # a standard deviation from 60 repetitions has a relative error of 1 / sqrt(118)
    assert np.abs(ratio - 1.0).max() < LIMIT / math.sqrt(118)
    exact = [exact_derivative(SYSTEM, grid[0], row.input, row.moment) for row in runs[0]]
    mean_error = (derivative.mean(axis=0) - exact) / (stated.mean(axis=0) / math.sqrt(60))
    assert np.abs(mean_error).max() < LIMIT


def test_lognormal_and_dependent_inputs() -> None:
    """One unit that is its shared input: pf is known, and so are its derivatives."""
    lognormal = ot.LogNormalMuSigma(2.0, 0.5, 0.0).getDistribution()
    joint = ot.JointDistribution(
        [lognormal, ot.Normal(1.0, 2.0)],
        ot.NormalCopula(ot.CorrelationMatrix(2, [1.0, 0.6, 0.6, 1.0])),
    )
    joint.setDescription(["a", "b"])

    def pf(mean: float, std: float) -> float:
        return ot.LogNormalMuSigma(mean, std, 0.0).getDistribution().computeComplementaryCDF(3.0)

    h = 1e-3
    exact = {
        ("a", "mean"): (pf(2.0 + h, 0.5) - pf(2.0 - h, 0.5)) / (2 * h),
        ("a", "standard deviation"): (pf(2.0, 0.5 + h) - pf(2.0, 0.5 - h)) / (2 * h),
        ("b", "mean"): 0.0,
        ("b", "standard deviation"): 0.0,
    }
    for shared, column in ((["a"], 0), (["b"], 1), (["a", "b"], 0), ([], 0)):
        problem = Problem(lambda x, k=column: x[:, k], inputs=joint, shared=shared)
        found = score_derivatives(problem, criteria(3.0), 20_000, rng=5)
        for row in found:
            assert abs(row.derivative - exact[row.input, row.moment]) < LIMIT * row.std_error


def test_few_failures_state_no_error() -> None:
    found = score_derivatives(SYSTEM.problem(), criteria(14.0), 2_000, rng=0)
    assert {row.status for row in found} == {"doubtful"}
    assert all(math.isnan(row.std_error) for row in found)
    assert "failure among 2000 systems" in found.rows[0].message


def test_failed_runs_count_as_failures() -> None:
    def fails(x: np.ndarray) -> np.ndarray:
        return np.where(x[:, 1] > 1.0, np.nan, x[:, 1])

    problem = Problem(fails, shared={"v": normal(0, 1)}, individual={"u": normal(0, 1)})
    found = score_derivatives(problem, criteria(1.0), 20_000, rng=0)
    exact = math.exp(-0.5) / math.sqrt(2.0 * math.pi)
    row = next(row for row in found if (row.input, row.moment) == ("u", "mean"))
    assert abs(row.derivative - exact) < LIMIT * row.std_error
    assert found.n_failed > 0


def test_refusals_before_any_run() -> None:
    problem = SYSTEM.problem()
    with pytest.raises(ValueError, match="systems = 1"):
        score_derivatives(problem, GRID, 1)
    with pytest.raises(BudgetExceededError, match="only 100"):
        score_derivatives(problem, GRID, 1_000, max_evals=100)
    moving = Problem(lambda x: x[:, 0], shared={"v": ot.Uniform(0, 1)})
    with pytest.raises(ValueError, match=r"a bound of v = .* moves with its mean"):
        score_derivatives(moving, criteria(0.5))
    with pytest.raises(ValueError, match="exchangeable units in series"):
        score_derivatives(replace_structure(problem), GRID)


def replace_structure(problem: Problem) -> Problem:
    from uqfold import Parallel

    return Problem(
        problem.model,
        inputs=problem.inputs.distribution,
        shared=(),
        units=3,
        structure=Parallel(),
        names=problem.inputs.names,
    )


def test_the_answer_does_not_depend_on_batches(found: PfDerivatives) -> None:
    other = score_derivatives(
        SYSTEM.problem(), GRID, 30_000, rng=3, evaluator=Evaluator(batch_rows=777)
    )
    assert other.rows == found.rows
