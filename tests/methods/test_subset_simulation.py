"""Subset simulation: right far out, its error honest, and doubts where it cannot know."""

import math
from collections.abc import Generator
from typing import TypeVar

import numpy as np
import pytest
from scipy.special import ndtr, ndtri

from uqfold.evaluation import Evaluator, TimeLimitError
from uqfold.evaluation.session import EvaluationSession
from uqfold.inputs import normal
from uqfold.methods import MonteCarlo, SubsetSimulation
from uqfold.methods.rare_event import NestedCriteria
from uqfold.methods.repetitions import Repetitions
from uqfold.methods.subset_climb import Rung, climbs
from uqfold.problems import Problem
from uqfold.problems.criterion import Binomial, Criterion, criteria
from uqfold.system.event import SystemEvent
from uqfold.testing import LinearNormalSystem
from uqfold.typing import FloatArray, Model

T = TypeVar("T")
METHOD = SubsetSimulation()


def standard_normal(model: Model, dimension: int = 2) -> Problem:
    return Problem(model, individual={f"u{i}": normal(0.0, 1.0) for i in range(dimension)})


def linear(x: FloatArray) -> FloatArray:
    return x.sum(axis=1) / math.sqrt(x.shape[1])


def driven(steps: "Generator[FloatArray, FloatArray, T]", model: Model) -> T:
    """Answer what a generator asks for by a model."""
    try:
        x = next(steps)
        while True:
            x = steps.send(model(x))
    except StopIteration as stop:
        answer: T = stop.value
        return answer


@pytest.mark.parametrize(("pf", "runs"), [(0.9, 3_000), (1e-2, 6_000), (1e-6, 40_000)])
def test_right_from_frequent_to_rare(pf: float, runs: int) -> None:
    limit = Criterion(-float(ndtri(pf)))
    row = METHOD.estimate(standard_normal(linear, 10), limit, max_evals=runs, rng=1)[0]
    assert row.n_evals <= runs
    assert abs(row.pf - pf) < 4.0 * row.std_error < pf
    assert row.ci_low < pf < row.ci_high
    assert row.pf + row.reliability == pytest.approx(1.0)


def test_thresholds_share_one_climb_and_have_errors_of_their_own() -> None:
    limits = [1.0, 2.0, 3.0, 4.5, math.inf]
    method = SubsetSimulation(samples=500, repetitions=20)
    result = method.estimate(standard_normal(linear), criteria(limits), rng=2)
    alone = method.estimate(standard_normal(linear), Criterion(4.5), rng=2)
    assert result.n_evals == alone.n_evals
    for row in result.rows[:4]:
        exact = float(ndtr(-row.threshold))
        assert abs(row.pf - exact) < 4.0 * row.std_error
    errors = [row.std_error / row.pf for row in result.rows[:4]]
    assert errors == sorted(errors)
    assert result[4].pf == 0.0
    assert result[4].status == "doubtful"
    [told] = result.details.sets
    assert told.pf.shape == (20, 5)
    assert np.all(np.diff(told.heights) > 0.0)


@pytest.mark.parametrize("sigma", [1.0, 0.4, 1e-4])
def test_a_climb_has_no_bias_whatever_its_chains_do(sigma: float) -> None:
    """Even chains that never move, or always are refused, only make its spread larger."""
    problem, limit = standard_normal(lambda x: x[:, 0], 1), 3.2
    session = EvaluationSession(
        pipeline=None,  # type: ignore[arg-type]
        deadline=None,  # type: ignore[arg-type]
        dimension=1,
        max_evals=None,
    )
    event, asked = SystemEvent(problem, Criterion(0.0)), (Criterion(limit),)
    nested = NestedCriteria(event, asked, (0,), np.array([limit]), session, 10**9)
    rungs = tuple(Rung(height, sigma) for height in (1.2, 2.2))
    rng = np.random.default_rng(3)
    made = driven(climbs(nested, rungs, 3_000, 50, rng), problem.model)
    pf, error = made.high.mean(), made.high.std() / math.sqrt(3_000)
    assert abs(pf - ndtr(-limit)) < 4.0 * error < 0.6 * pf


def test_interval_of_few_repetitions_with_a_long_tail_holds() -> None:
    """Student's t for the mean itself holds the mean of 20 of these in 90 %."""
    rng = np.random.default_rng(4)
    sets = 0.01 * np.exp(0.8 * rng.standard_normal((2_000, 20)) - 0.32)
    ends = np.array([Repetitions(values).ends() for values in sets])
    covered = np.mean((ends[:, 0] < 0.01) & (ends[:, 1] > 0.01))
    assert 0.935 < covered < 0.975


def test_few_repetitions_state_the_error_that_their_interval_stands_for() -> None:
    """Of 14, one answer in a hundred was more than three stated errors off."""
    rng = np.random.default_rng(1)
    sets = [Repetitions(0.01 * rng.gamma(25.0, 0.04, 14)) for _ in range(4_000)]
    apart = np.array([abs(one.mean - 0.01) / (one.mean * one.stated_cov) for one in sets])
    assert np.mean(apart > 3.0) < 0.0075
    low, high = sets[0].ends()
    assert sets[0].stated_cov == pytest.approx(math.log(high / low) / (2.0 * 1.96), rel=1e-4)
    # what they have in common does not hang on their number
    exact = Repetitions(np.full(3, 0.1), least=0.02)
    assert exact.stated_cov == exact.most_cov == exact.cov == 0.02


def test_repetitions_without_a_failure_know_nothing() -> None:
    assert Repetitions(np.zeros(5)).ends() == (0.0, 1.0)
    assert Repetitions(np.zeros(5)).cov == math.inf
    low, high = Repetitions(np.array([1e-200, 3e-200, 0.0])).ends()
    assert 0.0 < low < 1.4e-200 < high


def test_step_is_doubtful_with_an_upper_bound() -> None:
    def step(x: FloatArray) -> FloatArray:
        return np.where(x[:, 0] > 5.0, 1.0, 0.0)

    row = METHOD.estimate(standard_normal(step), Criterion(0.5), max_evals=10_000, rng=5)[0]
    assert (row.pf, row.ci_low, row.status) == (0.0, 0.0, "doubtful")
    assert ndtr(-5.0) < row.ci_high < 1e-3
    assert "rises no further" in row.message


def test_plateau_on_the_way_is_doubtful_with_an_upper_bound() -> None:
    """Beyond the plateau nothing is known; what lies below it is."""

    def flat(x: FloatArray) -> FloatArray:
        return np.where(x[:, 0] > 7.0, 9.0, np.minimum(x[:, 0], 3.0))

    rows = METHOD.estimate(standard_normal(flat), criteria([2.0, 3.5]), max_evals=20_000, rng=6)
    assert abs(rows[0].pf - ndtr(-2.0)) < 4.0 * rows[0].std_error
    assert (rows[1].pf, rows[1].status) == (0.0, "doubtful")
    assert ndtr(-7.0) < rows[1].ci_high < 1e-2


def test_jump_at_the_limit_is_answered() -> None:
    def jumping(x: FloatArray) -> FloatArray:
        rising = x[:, 0] / (8.0 + np.abs(x[:, 0]))
        return np.where(x[:, 0] > -ndtri(1e-7), 10.0, rising)

    row = METHOD.estimate(standard_normal(jumping), Criterion(1.0), max_evals=40_000, rng=7)[0]
    assert abs(row.pf - 1e-7) < 4.0 * row.std_error < 2e-7


def test_failed_runs_far_out_are_bounded() -> None:
    def lost(x: FloatArray) -> FloatArray:
        return np.where(x[:, 1] > 1.0, np.nan, x[:, 0])

    inputs = {"u0": normal(0.0, 1.0), "u1": normal(0.0, 1.0)}
    row = METHOD.estimate(
        Problem(lost, individual=inputs), Criterion(3.0), max_evals=20_000, rng=8
    )[0]
    assert row.status == "doubtful"
    assert row.pf_low == pytest.approx(ndtr(-3.0) * ndtr(1.0), rel=0.5)
    assert row.pf_high == row.pf == pytest.approx(ndtr(-1.0), rel=0.1)


@pytest.mark.parametrize(
    "criterion", [Criterion(15.0, tau=5.0), Criterion(13.8, missions=Binomial(4, 0.4))]
)
def test_systems_with_tau_and_missions(criterion: Criterion) -> None:
    system = LinearNormalSystem(units=2, shared_std=0.5)
    row = METHOD.estimate(system.problem(), criterion, max_evals=60_000, rng=9)[0]
    exact = system.pf(criterion)
    assert exact < 2e-3
    assert row.n_evals <= 60_000
    assert abs(row.pf - exact) < 4.0 * row.std_error < 2.0 * exact


def test_target_cov_stops_early() -> None:
    method = SubsetSimulation(samples=200, target_cov=0.2)
    row = method.estimate(standard_normal(linear), Criterion(3.5), max_evals=10**6, rng=10)[0]
    assert row.status == "converged"
    assert row.std_error <= 0.2 * row.pf
    assert row.n_evals < 100_000


def test_samples_are_kept_with_their_levels() -> None:
    problem, limit = standard_normal(linear), Criterion(3.5)
    method = SubsetSimulation(samples=100, repetitions=12)
    result = method.estimate(problem, limit, rng=14, evaluator=Evaluator(samples=True))
    [told] = result.details.sets
    frame, top = result.samples, len(told.heights)
    assert frame is not None
    assert np.array_equal(frame["response"], linear(frame[["u0", "u1"]].to_numpy()))
    made = frame[frame["phase"] == "climb"]
    assert sorted(made["level"].unique()) == list(range(top + 1))
    # of all space, the share above the first level is what the climbs have counted
    lowest = made[made["level"] == 0]["response"]
    assert (lowest > told.heights[0]).mean() == pytest.approx(told.probabilities[0])
    for level in range(1, top + 1):
        own = made[made["level"] == level]["response"]
        assert (own > told.heights[level - 1]).mean() == pytest.approx(told.acceptance[level - 1])
    assert method.estimate(problem, limit, rng=14).pf == result.pf


def test_asked_and_told_gives_the_same_answer() -> None:
    problem, method = standard_normal(linear), SubsetSimulation(samples=100)
    session = method.start(problem, Criterion(3.0), max_evals=3_000, rng=11)
    while not session.done:
        x = session.ask()
        session.tell(x, linear(x))
    told, own = session.result(), method.estimate(problem, Criterion(3.0), max_evals=3_000, rng=11)
    assert (told[0].pf, told[0].ci_high) == (own[0].pf, own[0].ci_high)


def test_rounds_before_the_end_of_time_are_an_answer(monkeypatch: pytest.MonkeyPatch) -> None:
    whole, calls = EvaluationSession.evaluate, 0

    def evaluate(self: EvaluationSession, x: FloatArray) -> FloatArray:
        nonlocal calls
        calls += 1
        if calls > 150:
            raise TimeLimitError("the time is over")
        return whole(self, x)

    monkeypatch.setattr(EvaluationSession, "evaluate", evaluate)
    method = SubsetSimulation(samples=100, target_cov=1e-3)
    asked = [Criterion(3.0), Criterion(3.0, missions=2)]
    rows = method.estimate(standard_normal(linear), asked, rng=12, evaluator=Evaluator())
    assert "the time is over" in rows[0].message
    assert abs(rows[0].pf - ndtr(-3.0)) < 4.0 * rows[0].std_error
    assert rows[1].status == "failed"


def test_small_budgets_leave_out_levels() -> None:
    """Too few runs for the levels give an upper bound, and far too few are crude Monte Carlo."""
    problem = standard_normal(linear)
    for runs in (150, 1_500):
        row = METHOD.estimate(problem, Criterion(6.0), max_evals=runs, rng=13)[0]
        assert row.status == "doubtful"
        assert row.n_evals <= runs
        assert ndtr(-6.0) < row.ci_high
    same = MonteCarlo().estimate(problem, Criterion(6.0), max_evals=150, rng=13)[0]
    first = METHOD.estimate(problem, Criterion(6.0), max_evals=150, rng=13)[0]
    assert (first.pf, first.ci_high) == (same.pf, same.ci_high)


@pytest.mark.slow
def test_intervals_hold_in_1000_seeds() -> None:
    """95 % within what a one-sided binomial test at 0.1 % lets pass."""
    from scipy.stats import binom

    problem, pf = standard_normal(linear, 10), 1e-4
    method = SubsetSimulation(samples=200, repetitions=40)
    rows = [
        method.estimate(problem, Criterion(-float(ndtri(pf))), rng=seed)[0] for seed in range(1_000)
    ]
    usable = [row for row in rows if row.std_error < 0.2 * row.pf]
    covered = sum(row.ci_low <= pf <= row.ci_high for row in usable)
    assert len(usable) > 500
    assert binom.cdf(covered, len(usable), 0.95) > 1e-3
