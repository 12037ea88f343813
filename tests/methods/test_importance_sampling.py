"""Importance sampling: densities that are ones, right far out, and doubts where it cannot know."""

import math
from dataclasses import replace

import numpy as np
import pytest
from scipy.special import ndtr, ndtri

from uqfold.comparison import named_problem
from uqfold.inputs import normal
from uqfold.methods import ImportanceSampling
from uqfold.methods.importance_search import WeightedSamples, part_unseen, samples_for
from uqfold.methods.polar_mixture import FitError, PolarMixture
from uqfold.methods.repetitions import Repetitions
from uqfold.methods.result import Estimate
from uqfold.methods.weighted_sums import WeightedSums
from uqfold.problems import Problem
from uqfold.problems.criterion import Binomial, Criterion, criteria
from uqfold.testing import LinearNormalSystem
from uqfold.typing import FloatArray, Model

METHOD = ImportanceSampling()


def standard_normal(model: Model, dimension: int = 2) -> Problem:
    return Problem(model, individual={f"u{i}": normal(0.0, 1.0) for i in range(dimension)})


def linear(x: FloatArray) -> FloatArray:
    return x.sum(axis=1) / math.sqrt(x.shape[1])


@pytest.mark.parametrize("d", [2, 3, 40, 200])
def test_mixture_is_drawn_from_its_own_density(d: int) -> None:
    """Weighted samples of it have the mass and the second moment of the standard normal law."""
    mixture = PolarMixture(
        shares=np.array([0.6, 0.4]),
        directions=np.eye(2, d),
        kappa=np.array([0.3 * d, 1e-3]),
        shape=np.array([0.55, 0.45]) * d,
        spread=np.array([1.05, 1.0]) * d,
    )
    u = mixture.draw(10_000, np.random.default_rng(1))
    weights = np.exp(-mixture.log_ratio(u))
    for value, mean in ((weights, 1.0), (weights * u[:, 0] ** 2, 1.0), (weights * u[:, 1], 0.0)):
        assert abs(value.mean() - mean) < 4.5 * value.std() / 100.0


def test_fit_finds_as_many_directions_as_there_are() -> None:
    rng = np.random.default_rng(2)
    centres = np.array([[5.0, 0.0, 0.0], [0.0, -5.0, 0.0]])
    u = centres[rng.integers(0, 2, 600)] + 0.4 * rng.standard_normal((600, 3))
    fitted = PolarMixture.fitted(u, np.ones(600), np.arange(600) % 2 == 0, rng)
    towards = fitted.directions @ (centres.T / 5.0)
    assert towards.max(axis=0).min() > 0.99
    in_many = rng.standard_normal((300, 50)) + 4.0 * np.eye(1, 50)
    alone = PolarMixture.fitted(in_many, np.ones(300), np.arange(300) % 2 == 0, rng)
    assert alone.shares.size == 1
    with pytest.raises(FitError, match="3 failures are too few"):
        PolarMixture.fitted(u[:3], np.ones(3), np.array([True, False, True]), rng)


@pytest.mark.parametrize(
    ("pf", "dimension", "runs"),
    [(0.9, 2, 2_000), (1e-4, 1, 6_000), (1e-9, 2, 12_000), (1e-6, 60, 15_000)],
)
def test_right_from_frequent_to_rare(pf: float, dimension: int, runs: int) -> None:
    limit = Criterion(-float(ndtri(pf)))
    row = METHOD.estimate(standard_normal(linear, dimension), limit, max_evals=runs, rng=1)[0]
    assert row.n_evals <= runs
    assert abs(row.pf - pf) < min(4.0 * row.std_error, 0.2 * pf)
    assert row.pf + row.reliability == pytest.approx(1.0)


def test_two_regions_are_both_found() -> None:
    def height(x: FloatArray) -> FloatArray:
        return np.maximum(x[:, 0] - 0.5, -x[:, 1])

    row = METHOD.estimate(standard_normal(height), Criterion(3.5), max_evals=10_000, rng=3)[0]
    exact = -math.expm1(math.log1p(-ndtr(-4.0)) + math.log1p(-ndtr(-3.5)))
    assert abs(row.pf - exact) < 4.0 * row.std_error < 0.4 * exact


def test_jump_is_answered_and_step_is_doubtful_with_an_upper_bound() -> None:
    def jumping(x: FloatArray) -> FloatArray:
        rising = x[:, 0] / (8.0 + np.abs(x[:, 0]))
        return np.where(x[:, 0] > -ndtri(1e-7), 10.0, rising)

    row = METHOD.estimate(standard_normal(jumping), Criterion(1.0), max_evals=12_000, rng=4)[0]
    assert abs(row.pf - 1e-7) < 4.0 * row.std_error
    step = standard_normal(lambda x: (x[:, 0] > 5.0).astype(float))
    row = METHOD.estimate(step, Criterion(0.5), max_evals=5_000, rng=4)[0]
    assert (row.pf, row.ci_low, row.status) == (0.0, 0.0, "doubtful")
    assert ndtr(-5.0) < row.ci_high < 1e-3
    assert "rises no further" in row.message


def test_under_tau() -> None:
    system, criterion = LinearNormalSystem(units=2, shared_std=0.5), Criterion(15.0, tau=5.0)
    row = METHOD.estimate(system.problem(), criterion, max_evals=20_000, rng=5)[0]
    assert abs(row.pf - system.pf(criterion)) < 4.0 * row.std_error < row.pf


def test_directions_that_were_lost_are_a_doubt() -> None:
    """Eight units fail in eight directions; a density of fewer was sure of a third of pf.

    However many missions are flown, the budget pays for an answer.
    """
    system, criterion = LinearNormalSystem(units=2), Criterion(14.0, missions=Binomial(4, 0.4))
    for seed in (1, 5):
        row = METHOD.estimate(system.problem(), criterion, max_evals=15_000, rng=seed)[0]
        assert row.n_evals <= 15_000
        assert row.status == "doubtful"
    lost = sums(np.where(np.arange(4_000) % 2 == 0, 1e-6, 0.0))
    alone = judged(lost, np.full(8, 5e-7), overlooked=0.25)
    assert alone.status == "doubtful"
    assert "25 % of the failures that the climbs found" in alone.message


def test_what_the_search_finds_leaves_runs_for_the_answer() -> None:
    """Chains that led lost failures apart asked for more runs than were left: no answer."""
    problem = LinearNormalSystem(units=2).problem()
    for seed in (0, 1):
        row = METHOD.estimate(problem, Criterion(13.0, missions=5), max_evals=8_000, rng=seed)[0]
        assert row.status == "doubtful"
        assert row.n_evals <= 8_000


def test_failed_runs_far_out_are_bounded() -> None:
    def lost(x: FloatArray) -> FloatArray:
        return np.where(x[:, 1] > 2.0, np.nan, x[:, 0])

    problem = standard_normal(lost)
    row = METHOD.estimate(problem, Criterion(3.0), max_evals=20_000, rng=6)[0]
    assert row.status == "doubtful"
    assert row.pf_low == pytest.approx(ndtr(-3.0) * ndtr(2.0), rel=0.4)
    assert row.pf_high == row.pf
    assert row.pf == pytest.approx(ndtr(-2.0) + ndtr(-3.0), rel=0.2)


def test_each_criterion_has_runs_of_its_own() -> None:
    problem = standard_normal(linear)
    rows = METHOD.estimate(problem, criteria([3.0, 4.0, math.inf]), max_evals=15_000, rng=7)
    assert rows.n_evals <= 15_000
    for row in rows.rows[:2]:
        assert abs(row.pf - ndtr(-row.threshold)) < 4.0 * row.std_error < 0.6 * row.pf
    assert (rows[2].pf, rows[2].status) == (0.0, "doubtful")
    told = rows.details.sets[0]
    assert told.components >= 1
    assert told.alike > 100.0


def test_samples_and_target_say_when_to_stop() -> None:
    problem, asked = standard_normal(linear), Criterion(3.5)
    few = replace(METHOD, samples=500).estimate(problem, asked, rng=8)
    assert few.details.sets[0].samples == 500
    early = replace(METHOD, target_cov=0.1).estimate(problem, asked, max_evals=10**6, rng=8)[0]
    assert early.status == "converged"
    assert early.n_evals < 50_000
    short = replace(METHOD, samples=10**6).estimate(problem, asked, max_evals=8_000, rng=8)[0]
    assert short.status == "budget_exhausted"
    assert "of 1000000 samples" in short.message


def test_asked_and_told_gives_the_same_answer() -> None:
    problem, asked = standard_normal(linear), Criterion(3.0)
    session = METHOD.start(problem, asked, max_evals=3_000, rng=9)
    while not session.done:
        x = session.ask()
        session.tell(x, linear(x))
    told, own = session.result(), METHOD.estimate(problem, asked, max_evals=3_000, rng=9)
    assert (told[0].pf, told[0].ci_high) == (own[0].pf, own[0].ci_high)


def sums(weights: FloatArray) -> WeightedSums:
    own, fails = WeightedSums(), weights > 0.0
    own.add(WeightedSamples(np.zeros((len(weights), 2)), weights, fails, fails))
    return own


def judged(
    own: WeightedSums, climbs: FloatArray, overlooked: float = 0.0, unseen: float = 0.0
) -> Estimate:
    return own.estimate(0.1, Repetitions(climbs), overlooked=overlooked, unseen=unseen, short=[])


def test_error_and_interval_contain_what_the_climbs_may_have_missed() -> None:
    """A tenth of pf could be lost, `converged`, where less than 1 % was stated."""
    even = sums(np.where(np.arange(4_000) % 2 == 0, 1e-6, 0.0))
    climbs = np.full(8, 5e-7)
    certain, unsure, blind = (judged(even, climbs, unseen=t) for t in (0.0, 0.03, 0.2))
    assert certain.std_error < 0.02 * certain.pf
    assert unsure.std_error == pytest.approx(math.hypot(certain.std_error, 0.03 * unsure.pf))
    # one region in twenty that has 9 % of pf is missed
    assert unsure.ci_high >= unsure.pf / (1.0 - 0.0899)
    assert (unsure.status, blind.status) == ("converged", "doubtful")
    assert "a region elsewhere with 60 % of pf might be missed" in blind.message


def test_what_may_be_missed_follows_from_the_seeds_of_each_level() -> None:
    assert part_unseen([300, 300]) == pytest.approx(0.01)
    assert part_unseen([300, 30]) > part_unseen([300, 60]) > part_unseen([300, 300])
    assert part_unseen([int(0.1 * samples_for(0.02, 5))] * 5) == pytest.approx(0.02, rel=0.01)


def test_all_around_reaches_as_far_as_a_region_can_matter() -> None:
    """Failures known at distances of about 4 hid a half-space 4.5 away with most of pf."""
    rng, d = np.random.default_rng(1), 5
    directions = rng.standard_normal((500, d))
    directions /= np.linalg.norm(directions, axis=1)[:, None]
    known = directions * rng.normal(4.0, 0.1, 500)[:, None]
    everywhere = PolarMixture.everywhere(known, np.ones(500), 1e-5)
    assert everywhere.shares.sum() == pytest.approx(1.0)
    for distance, beyond in ((3.5, 0.03), (5.0, 1.4e-4), (6.0, 1.5e-6)):
        ratio = math.exp(float(everywhere.log_ratio(distance * np.eye(1, d))[0]))
        assert ratio > 0.01 / beyond


def test_a_steep_region_farther_out_is_seen() -> None:
    """The climbs stay in the ball, whose response rises slowly: 78 % lost, called `converged`."""

    def height(x: FloatArray) -> FloatArray:
        away = np.linalg.norm(x - 4.6 * np.eye(1, 5), axis=1)
        return np.maximum(5.0 * (-x[:, 1] - 4.35), 0.91 - away)

    asked = Criterion(0.0)
    row = METHOD.estimate(standard_normal(height, 5), asked, max_evals=50_000, rng=5)[0]
    assert row.ci_high > ndtr(-4.35)
    assert row.status == "doubtful" or row.pf > 0.7 * ndtr(-4.35)


def test_one_heavy_sample_is_a_doubt() -> None:
    weights = np.where(np.arange(4_000) % 2 == 0, 1e-6, 0.0)
    even = judged(sums(weights), np.full(8, 5e-7))
    assert even.status == "converged"
    weights[0] = 2e-4
    heavy = judged(sums(weights), np.full(8, 5e-7))
    assert heavy.status == "doubtful"
    assert "one sample makes 9 % of pf" in heavy.message
    assert heavy.ci_high - heavy.pf > heavy.pf - heavy.ci_low


def test_climbs_that_found_more_are_a_doubt() -> None:
    """A density that has lost one of two regions is sure of itself; the climbs are not."""
    found = sums(np.where(np.arange(4_000) % 2 == 0, 1e-6, 0.0))
    row = judged(found, 5e-6 * np.array([0.7, 0.9, 1.0, 1.1, 1.3, 0.8, 1.2, 1.0]))
    assert row.status == "doubtful"
    assert "the first climbs found 5e-06" in row.message


@pytest.mark.parametrize(("dimension", "runs"), [(10, 10_000), (5, 40_000), (2, 12_000)])
def test_a_second_region_is_found_or_doubted(dimension: int, runs: int) -> None:
    """It has 15 % of pf: of ten inputs and 10,000 runs, all `converged` rows had lost it."""

    def height(x: FloatArray) -> FloatArray:
        return np.maximum(x[:, 0], -x[:, 0] - 0.4)

    exact = float(ndtr(-4.0) + ndtr(-4.4))
    problem = standard_normal(height, dimension)
    rows = [METHOD.estimate(problem, Criterion(4.0), max_evals=runs, rng=i)[0] for i in range(4)]
    for row in rows:
        assert row.status == "doubtful" or abs(row.pf - exact) < 4.0 * row.std_error
    clean = sum(row.status == "converged" for row in rows)
    assert clean >= (0 if runs == 10_000 else 2)


@pytest.mark.slow
def test_intervals_hold_in_1000_seeds() -> None:
    """95 % within what a one-sided binomial test at 0.1 % lets pass."""
    from scipy.stats import binom

    problem, pf = standard_normal(linear, 10), 1e-6
    rows = [
        METHOD.estimate(problem, Criterion(-float(ndtri(pf))), max_evals=10_000, rng=seed)[0]
        for seed in range(1_000)
    ]
    usable = [row for row in rows if row.std_error < 0.2 * row.pf]
    covered = sum(row.ci_low <= pf <= row.ci_high for row in usable)
    assert len(usable) > 500
    assert binom.cdf(covered, len(usable), 0.95) > 1e-3


@pytest.mark.parametrize("seed", [1, 3, 5])
def test_a_budget_too_small_for_climbs_is_an_upper_bound(seed: int) -> None:
    """It was spent on the way, and the row `failed`."""
    problem = named_problem("rp28").problem()
    row = ImportanceSampling().estimate(problem, rng=seed, max_evals=2_000)[0]
    assert row.status == "doubtful"
    assert row.pf <= 1.453e-07 <= row.ci_high < 0.01
    assert "too few to look for failures" in row.message
