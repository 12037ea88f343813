"""Quasi-Monte Carlo: points that are spread evenly, and an error that holds all the same."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.special import ndtri
from scipy.stats import binom

from uqfold.evaluation import Evaluator
from uqfold.inputs import normal
from uqfold.methods import QuasiMonteCarlo
from uqfold.methods.quasi_monte_carlo import Numbers, dimension_of
from uqfold.methods.scrambled_counts import ScrambledCounts
from uqfold.problems import Problem
from uqfold.problems.criterion import Binomial, Criterion
from uqfold.problems.structure import Parallel
from uqfold.testing import LinearNormalSystem
from uqfold.typing import FloatArray


def total(x: FloatArray) -> FloatArray:
    return x.sum(axis=1)


def standard_normal(dimension: int, model: object = total) -> Problem:
    named = {f"u{i}": normal(0.0, 1.0) for i in range(dimension)}
    return Problem(model, individual=named)  # type: ignore[arg-type]


def test_intervals_hold_and_are_narrower_than_those_of_monte_carlo() -> None:
    pf = 0.02
    asked, problem = Criterion(float(-ndtri(pf)) * np.sqrt(2.0)), standard_normal(2)
    method = QuasiMonteCarlo(points=256)
    rows = [method.estimate(problem, asked, rng=seed)[0] for seed in range(40)]
    held = sum(row.ci_low <= pf <= row.ci_high for row in rows)
    assert binom.cdf(held, len(rows), 0.95) > 1e-3
    error = np.sqrt(np.mean([(row.pf - pf) ** 2 for row in rows]))
    assert error < 0.7 * np.sqrt(pf * (1.0 - pf) / 4_096)


def test_missions_tau_and_structures_are_those_of_the_system() -> None:
    system = LinearNormalSystem(units=2, shared_std=0.5)
    asked = [Criterion(12.0, missions=Binomial(2, 0.4)), Criterion(13.0, tau=3.0), Criterion(9.0)]
    result = QuasiMonteCarlo().estimate(system.problem(), asked, max_evals=40_000, rng=5)
    for criterion, row in zip(asked, result, strict=True):
        assert abs(row.pf - system.pf(criterion)) < 4.0 * row.std_error < row.pf
    assert result.details.dimension == dimension_of(system.problem(), asked) == 1 + 2 * 2 * 2 + 2
    both = Problem(total, individual={"u": normal(0.0, 1.0)}, units=2, structure=Parallel())
    [row] = QuasiMonteCarlo().estimate(both, 1.0, max_evals=20_000, rng=1).rows
    assert abs(row.pf - 0.15865525**2) < 4.0 * row.std_error < 0.2 * row.pf


def test_few_failures_and_wild_spreads_are_doubtful() -> None:
    [row] = QuasiMonteCarlo().estimate(standard_normal(3), 8.0, max_evals=3_000, rng=1).rows
    assert (row.status, row.ci_kind) == ("doubtful", "clopper-pearson 95 % one-sided")
    even = np.array([40.0, 41, 39, 42, 38, 40, 43, 37, 41, 39, 40, 42, 38, 44, 36, 40])
    assert ScrambledCounts(1_000, even, even).estimate(0.1, []).status == "converged"
    wild = np.where(np.arange(16) == 3, 300.0, even)
    doubted = ScrambledCounts(1_000, wild, wild).estimate(1.0, [])
    assert doubted.status == "doubtful"
    assert "do not scatter like normal numbers" in doubted.message
    seen = np.where(np.arange(16) < 8, 9.0 + np.arange(16), 0.0)
    assert (
        "8 of 16 randomisations saw failures"
        in ScrambledCounts(1_000, seen, seen).estimate(1.0, []).message
    )
    # seven in eight randomisations are known to be as sure only where the target is far
    wide = even + np.linspace(-25.0, 25.0, 16)
    cov = ScrambledCounts(1_000, wide, wide).rarer(wide).cov
    assert "may be above" in ScrambledCounts(1_000, wide, wide).estimate(1.1 * cov, []).message


def test_equal_counts_are_no_exact_answer() -> None:
    """One input: every randomisation counts the same, and knows pf to one point in so many."""
    limit = float(-ndtri(0.3))
    [row] = QuasiMonteCarlo(points=64).estimate(standard_normal(1), limit, rng=1).rows
    assert row.ci_low < 0.3 < row.ci_high
    assert row.ci_high - row.ci_low > 0.3 / 64
    [often] = QuasiMonteCarlo(points=64).estimate(standard_normal(1), -limit, rng=1).rows
    assert often.ci_low < 0.7 < often.ci_high
    assert often.ci_kind == "t 95 % of log reliability"
    assert often.pf + often.reliability == pytest.approx(1.0, abs=1e-12)


def test_failed_runs_are_bounded() -> None:
    def failing(x: FloatArray) -> FloatArray:
        return np.where(x[:, 1] > 1.0, np.nan, x[:, 0])

    [row] = (
        QuasiMonteCarlo().estimate(standard_normal(2, failing), 1.0, max_evals=9_000, rng=1).rows
    )
    low, lost = 0.15865525 * 0.84134475, 0.15865525
    assert row.status == "doubtful"
    assert abs(row.pf_low - low) < 0.01
    assert abs(row.pf_high - (low + lost)) < 0.01
    assert row.ci_low < low < low + lost < row.ci_high


def test_budget_target_and_time_end_it() -> None:
    problem, asked = standard_normal(2), Criterion(2.5)
    method = QuasiMonteCarlo()
    spent = method.estimate(problem, asked, max_evals=5_000, rng=2)
    assert (spent.n_evals, spent.details.points, spent.details.pf.shape) == (
        19 * 256,
        256,
        (19, 1),
    )
    early = replace(method, target_cov=0.2).estimate(problem, asked, max_evals=10**6, rng=2)
    assert early[0].status == "converged"
    assert early.n_evals < 20_000
    short = replace(method, points=1_000).estimate(problem, asked, max_evals=9_000, rng=2)
    assert short.details.points == 512
    assert "512 of 1024 points" in short[0].message
    none = method.estimate(problem, asked, max_evals=15, rng=2)[0]
    assert none.status == "failed"
    assert "cost 16 runs, max_evals = 15" in none.message


def test_a_limit_on_time_leaves_the_points_that_all_randomisations_have(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    clock = [0.0]
    monkeypatch.setattr("uqfold.evaluation.deadline.time.monotonic", lambda: clock[0])

    def slow(x: FloatArray) -> FloatArray:
        clock[0] += 1e-4 * len(x)
        return total(x)

    [row] = QuasiMonteCarlo(points=1_024).estimate(
        standard_normal(2, slow), 2.5, rng=2, evaluator=Evaluator(max_seconds=0.5)
    )
    assert row.message.startswith("256 of 1024 points of each randomisation; the wall-clock limit")
    assert 4_096 < row.n_evals < 2 * 4_096
    first = QuasiMonteCarlo(points=256).estimate(standard_normal(2), 2.5, rng=2)[0]
    assert (row.pf, row.ci_low) == (first.pf, first.ci_low)


def test_doubled_points_are_those_of_one_go() -> None:
    problem = standard_normal(2)
    doubled = QuasiMonteCarlo(points=1_024, target_cov=1e-9).estimate(problem, 2.5, rng=3)
    at_once = QuasiMonteCarlo(points=1_024).estimate(problem, 2.5, rng=3)
    np.testing.assert_array_equal(doubled.details.pf, at_once.details.pf)


def test_numbers_of_points_stay_off_the_ends_and_run_out_as_zeros() -> None:
    ends = np.array([[0.5**41, 1.0 - 0.5**41, 0.5]])
    numbers = Numbers(ends)
    assert np.isfinite(numbers.standard_normal((1, 1, 1, 2))).all()
    assert numbers.random((1, 1)) == 0.5
    assert numbers.random((1, 4)).tolist() == [[0.0] * 4]


def test_more_numbers_than_dimensions_are_unsupported() -> None:
    [row] = QuasiMonteCarlo().estimate(standard_normal(1), Criterion(1.0, missions=22_000)).rows
    assert row.status == "unsupported"
    assert "22,000 numbers, a Sobol' point has 21,201" in row.message
