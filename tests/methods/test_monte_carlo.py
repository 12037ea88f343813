"""Crude Monte Carlo: counts, sharing of inputs, stopping, intervals."""

import math

import numpy as np
import pytest

from uqfold.inputs import normal
from uqfold.methods import MonteCarlo
from uqfold.problems import Problem
from uqfold.problems.criterion import Binomial, Criterion, criteria
from uqfold.testing import LinearNormalSystem
from uqfold.testing.counting import RowCount
from uqfold.typing import FloatArray


def test_agrees_with_the_exact_answer_on_a_full_grid() -> None:
    system = LinearNormalSystem(units=4, shared_std=0.7)
    grid = criteria([10.5, 12.0], tau=[None, 2.5], missions=[1, 3, Binomial(4, 0.3)])
    result = MonteCarlo(systems=20_000).estimate(system.problem(), grid, rng=31)
    for criterion, row in zip(grid, result, strict=True):
        assert abs(row.pf - system.pf(criterion)) < 4.0 * row.std_error, str(criterion)
        assert row.ci_low < row.pf < row.ci_high
        assert row.status == "converged"


def test_shared_inputs_are_one_draw_per_system() -> None:
    seen: list[FloatArray] = []
    count = RowCount()

    def model(x: FloatArray) -> FloatArray:
        if count.add(x):
            seen.append(x)
        return x[:, 0]

    problem = Problem(
        model,
        shared={"v": normal(0.0, 1.0)},
        individual={"u": normal(0.0, 1.0)},
        units=3,
    )
    MonteCarlo(systems=50).estimate(problem, criteria(1.0, missions=2), rng=1)
    x = np.concatenate(seen).reshape(50, 6, 2)
    assert np.ptp(x[:, :, 0], axis=1).max() == 0.0
    assert len(np.unique(x[:, 0, 0])) == 50
    assert len(np.unique(x[:, :, 1])) == 300


def test_missions_that_are_not_flown_are_not_run() -> None:
    system = LinearNormalSystem(units=2)
    full = MonteCarlo(systems=1000).estimate(system.problem(), criteria(11.0, missions=5), rng=2)
    some = MonteCarlo(systems=1000).estimate(
        system.problem(), criteria(11.0, missions=Binomial(5, 0.2)), rng=2
    )
    assert full.n_evals == 10_000
    # 1000 systems x 2 units x a binomial(5, 0.2) number of missions: mean 2000, std 57
    assert abs(some.n_evals - 2000) < 4 * 57


def test_a_smaller_budget_is_the_beginning_of_a_larger_one() -> None:
    problem = LinearNormalSystem().problem()
    small = MonteCarlo(systems=5000).estimate(problem, criteria(11.0), rng=3).details
    large = MonteCarlo(systems=9000).estimate(problem, criteria(11.0), rng=3).details
    assert small.history_failures[0] == large.history_failures[0]
    assert small.history_systems[0] == 4096


def test_budget_is_spent_in_whole_systems() -> None:
    problem = LinearNormalSystem(units=3).problem()
    question = criteria(10.0, missions=2)
    result = MonteCarlo(systems=900).estimate(problem, question, max_evals=5000, rng=4)
    assert result.n_evals == 4998
    assert result[0].status == "budget_exhausted"
    assert "833 of 900 systems" in result[0].message
    enough = MonteCarlo().estimate(problem, question, max_evals=5000, rng=4)
    assert enough.n_evals == 4998
    assert enough[0].status == "converged"
    none = MonteCarlo().estimate(problem, criteria(11.0, missions=2), max_evals=5, rng=4)
    assert none[0].status == "failed"
    assert "one system costs 6 runs" in none[0].message


def test_no_failure_gives_an_upper_bound() -> None:
    problem = LinearNormalSystem().problem()
    row = MonteCarlo(systems=1000).estimate(problem, criteria(100.0), rng=5)[0]
    assert row.pf == 0.0
    assert row.status == "doubtful"
    assert math.isnan(row.std_error)
    assert row.ci_low == 0.0
    assert row.ci_high == pytest.approx(1.0 - 0.05 ** (1 / 1000))
    assert "one-sided" in row.ci_kind


def test_few_failures_are_doubtful() -> None:
    problem = LinearNormalSystem().problem()
    row = MonteCarlo(systems=1000).estimate(problem, criteria(12.8), rng=5)[0]
    assert 0 < round(row.pf * 1000) < 10
    assert row.status == "doubtful"
    assert row.std_error > 0.3 * row.pf


def test_target_cov_stops_early_or_says_that_it_was_missed() -> None:
    problem = LinearNormalSystem().problem()
    grid = criteria([10.0, 11.0])
    early = MonteCarlo(systems=1_000_000, target_cov=0.05).estimate(problem, grid, rng=6)
    assert early.n_evals < 100_000
    assert all(row.status == "converged" for row in early)
    assert all(row.std_error / row.pf <= 0.05 for row in early)
    late = MonteCarlo(systems=2000, target_cov=0.001).estimate(problem, grid, rng=6)
    assert all(row.status == "doubtful" for row in late)


def test_failed_runs_are_bounded_from_both_sides() -> None:
    system = LinearNormalSystem(units=2)

    def sometimes(x: FloatArray) -> FloatArray:
        return np.where(x[:, 1] > 1.5, np.nan, system.response(x))

    inputs = system.problem().inputs
    problem = Problem(
        sometimes,
        shared=inputs.distribution.getMarginal([0]),
        individual=inputs.distribution.getMarginal([1, 2]),
        names=inputs.names,
        units=2,
    )
    row = MonteCarlo(systems=20_000).estimate(problem, criteria(11.0), rng=7)[0]
    assert row.status == "doubtful"
    assert row.n_failed > 0
    assert row.pf_low < system.pf(Criterion(11.0)) < row.pf_high == row.pf
    assert row.ci_low < row.pf_low


def test_settings_are_checked() -> None:
    with pytest.raises(ValueError, match="systems = 0"):
        MonteCarlo(systems=0)
    with pytest.raises(ValueError, match="target_cov"):
        MonteCarlo(target_cov=0.0)


def test_one_failure_is_told_in_the_singular() -> None:
    """It was told as "1 failures among"."""
    seen: list[FloatArray] = []

    def model(x: FloatArray) -> FloatArray:
        seen.append(x[:, 0])
        return x[:, 0]

    problem = Problem(model, individual={"a": normal(0.0, 1.0)}, units=1)
    MonteCarlo(systems=100).estimate(problem, criteria(0.0), rng=1)
    one_above = float(np.sort(seen[0])[-2])
    row = MonteCarlo(systems=100).estimate(problem, criteria(one_above), rng=1)[0]
    assert "1 failure among 100 systems" in row.message
