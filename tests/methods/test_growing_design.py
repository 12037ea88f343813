"""Designs that grow with the inputs, and with the budget as far as the stated error asks for it."""

import math
from dataclasses import replace

import numpy as np
import pytest

from uqfold.inputs import normal
from uqfold.methods import ActiveKriging, Kriging, PolynomialChaos, ReliabilityMethod
from uqfold.methods.growing_design import Growth
from uqfold.methods.response_surface import ErrorParts
from uqfold.problems.base import Problem
from uqfold.typing import FloatArray

METHODS = (Kriging(), PolynomialChaos(), ActiveKriging())


def problem(response, dimension: int) -> Problem:
    return Problem.from_limit_state(response, {f"x{i}": normal(0.0, 1.0) for i in range(dimension)})


def smooth(x: FloatArray) -> FloatArray:
    """A limit that a hundred runs tell to 0.1 % of pf (processes) or 6 % (an expansion)."""
    grown = np.exp(0.3 * x[:, 0] + 0.2 * x[:, 1])
    return 3.2 - grown - 0.5 * np.sin(0.5 * x[:, 2]) - 0.2 * x[:, 3]


@pytest.mark.parametrize(
    "method",
    [pytest.param(Kriging(), marks=pytest.mark.thorough), PolynomialChaos()],
    ids=lambda one: one.name,
)
def test_a_default_design_has_five_runs_for_each_of_many_inputs(method: ReliabilityMethod) -> None:
    """Fifty inputs and more were `failed`: 100 runs are fewer than a surface over them needs."""
    plane = problem(lambda x: 3.0 - x.sum(axis=1) / math.sqrt(x.shape[1]), 26)
    row = method.estimate(plane, rng=1)[0]
    assert (row.n_evals, row.status) == (130, "converged")
    assert row.pf == pytest.approx(1.3498980316301035e-3, rel=2e-3)


@pytest.mark.parametrize(
    "method",
    [
        pytest.param(Kriging(target_cov=2e-3), marks=pytest.mark.thorough),
        PolynomialChaos(target_cov=0.05),
        pytest.param(ActiveKriging(target_cov=1.2e-3), marks=pytest.mark.thorough),
    ],
    ids=lambda one: one.name,
)
def test_a_budget_above_the_default_is_used_while_the_error_is_above_its_target(
    method: Kriging | PolynomialChaos | ActiveKriging,
) -> None:
    """5,900 of 6,000 runs were left unused while the row was doubtful."""
    # an error below its target asks for no runs but those that check it
    loose = replace(method, target_cov=0.5)
    easy = loose.estimate(problem(smooth, 4), rng=3, max_evals=1_000)[0]
    assert easy.n_evals <= 106
    assert easy.std_error > method.target_cov * easy.pf
    row = method.estimate(problem(smooth, 4), rng=3, max_evals=1_000)[0]
    # two times doubled, and checked each time
    assert easy.n_evals < row.n_evals <= 424
    assert row.std_error < method.target_cov * row.pf


def test_runs_that_are_asked_for_stay_as_they_are() -> None:
    assert Kriging(runs=40).estimate(problem(smooth, 4), rng=1, max_evals=6_000).n_evals == 40


@pytest.mark.parametrize("method", [Kriging, PolynomialChaos], ids=lambda one: one.name)
def test_the_stated_error_of_a_converged_row_is_a_setting(method: type[ReliabilityMethod]) -> None:
    """It was a constant: 10 %."""
    curved = problem(lambda x: 3.5 - x[:, 0] + 0.5 * np.sin(x[:, 1]), 2)
    loose, strict = (
        method(runs=60, target_cov=target).estimate(curved, rng=1)[0]  # type: ignore[call-arg]
        for target in (0.5, 1e-7)
    )
    assert loose.status == "converged"
    assert strict.status == "doubtful"
    assert "above 1e-05% of pf" in strict.message
    assert strict.pf == loose.pf


@pytest.mark.parametrize("method", METHODS, ids=lambda one: one.name)
def test_details_tell_where_the_stated_error_comes_from(method: ReliabilityMethod) -> None:
    """Training, integration and sampling add up to the stated error, each in quadrature."""
    strict = replace(method, target_cov=1e-9)  # type: ignore[call-arg]
    result = strict.estimate(problem(smooth, 4), rng=3, max_evals=50)
    parts = result.details.errors
    assert all(np.isfinite(part).all() for part in (parts.training, parts.integration))
    total = np.sqrt(parts.training**2 + parts.integration**2 + parts.sampling**2)
    assert total[0] == pytest.approx(result[0].std_error, rel=1e-12)
    assert parts.training[0] > 0.0
    assert parts.integration[0] + parts.sampling[0] > 0.0
    larger = "training" if parts.training[0] > parts.integration[0] else "integration"
    assert f"mostly of {larger}" in result[0].message


def test_growth_ends_where_doubling_brings_too_little() -> None:
    growth = Growth(2_000)
    assert growth.next_size(100, 40.0) == 200
    assert growth.next_size(200, 10.0) == 400
    assert growth.next_size(400, 0.9) is None
    hopeless = Growth(2_000)
    assert hopeless.next_size(100, 40.0) == 200
    assert hopeless.next_size(200, 38.0) is None
    assert Growth(150).next_size(100, 2.0) == 150
    assert Growth(100).next_size(100, 2.0) is None


def test_errors_of_the_smallest_probabilities_have_a_shortfall_too() -> None:
    """Their squares are zero to the computer."""
    parts = ErrorParts(*(np.array([size]) for size in (3e-200, 6e-201, 0.0)))
    assert parts.shortfall(0, 1e-200) == pytest.approx(3.0 / 0.8)
    assert parts.shortfall(0, 6e-201) == 0.0
    assert parts.shortfall(0, 0.0) == 0.0
