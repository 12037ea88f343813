"""Line sampling and directional sampling: crossings, regions, answers without bias, doubts."""

import math
from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest
from scipy.special import chdtrc, chdtri, ndtr, ndtri

from uqfold.evaluation import Evaluator
from uqfold.inputs import normal
from uqfold.methods import (
    DirectionalSampling,
    LineSampling,
    ReliabilityMethod,
    SequentialMethod,
)
from uqfold.methods.directional_sampling import not_negative
from uqfold.methods.line_laws import LineLaw, chi_law, normal_law
from uqfold.methods.line_planes import PlanePoints
from uqfold.problems import Problem
from uqfold.problems.catalogue import entry
from uqfold.problems.catalogue import problem as limit_state
from uqfold.problems.criterion import Binomial, Criterion, criteria
from uqfold.testing import LinearNormalSystem
from uqfold.typing import FloatArray, Model

LINES, RAYS = LineSampling(), DirectionalSampling()
BOTH = pytest.mark.parametrize("method", [LINES, RAYS], ids=lambda one: one.name)


def standard_normal(model: Model, dimension: int = 2) -> Problem:
    return Problem(model, individual={f"u{i}": normal(0.0, 1.0) for i in range(dimension)})


def linear(x: FloatArray) -> FloatArray:
    return np.asarray(x.sum(axis=1) / math.sqrt(x.shape[1]))


@pytest.mark.parametrize(
    ("law", "tail"),
    [(normal_law(), lambda r: ndtr(-r)), (chi_law(3), lambda r: chdtrc(3, r * r))],
    ids=["normal", "chi"],
)
def test_laws_keep_their_digits_in_both_tails(law: LineLaw, tail: Callable[[float], float]) -> None:
    """Far out as well as near zero; the density is the derivative."""
    at, far = np.array([0.3, 2.0, 9.0]), np.array([0.5, 7.0, np.inf])
    exact = [tail(a) - tail(b) for a, b in zip(at, far, strict=True)]
    assert law.between(at, far) == pytest.approx(exact, rel=1e-9)
    step = 1e-5
    assert law.between(at - step, at + step) / (2.0 * step) == pytest.approx(
        law.density(at), rel=1e-4
    )


@pytest.mark.parametrize(("pf", "dimension"), [(0.9, 2), (0.01, 1), (1e-4, 3), (1e-9, 60)])
def test_a_plane_is_as_good_as_exact(pf: float, dimension: int) -> None:
    limit = Criterion(-float(ndtri(pf)))
    row = LINES.estimate(standard_normal(linear, dimension), limit, max_evals=700, rng=1)[0]
    assert row.n_evals <= 700
    assert row.status == "converged"
    assert abs(row.pf - pf) < 4.0 * row.std_error < 0.1 * pf
    assert row.pf + row.reliability == pytest.approx(1.0)


def test_two_hundred_inputs_at_1e_9_with_less_than_500_runs() -> None:
    exact = entry("linear-200").pf
    row = LINES.estimate(limit_state("linear-200"), max_evals=500, rng=2)[0]
    assert (row.status, row.n_evals <= 500) == ("converged", True)
    assert row.pf == pytest.approx(exact, rel=0.003)


@pytest.mark.parametrize("name", ["outside-a-circle", "rp28"])
def test_rays_see_failure_all_around(name: str) -> None:
    exact = entry(name).pf
    row = RAYS.estimate(limit_state(name), max_evals=2_000, rng=1)[0]
    assert row.status == "converged"
    assert abs(row.pf - exact) < 4.0 * row.std_error < 0.2 * exact


@BOTH
@pytest.mark.parametrize(
    ("height", "exact"),
    [
        # two regions on one line, on two lines, and a band that a line enters and leaves
        (lambda x: np.abs(x[:, 0]), 2.0 * ndtr(-3.5)),
        (
            lambda x: np.maximum(x[:, 0] - 0.5, -x[:, 1]),
            -math.expm1(math.log1p(-ndtr(-4.0)) + math.log1p(-ndtr(-3.5))),
        ),
        (lambda x: 4.0 - np.abs(x[:, 0] - 3.5), ndtr(-3.0) - ndtr(-4.0)),
        # a response that rises towards its limit and jumps there
        (lambda x: np.where(x[:, 0] > 3.5, 10.0, x[:, 0] / (9.0 + np.abs(x[:, 0]))), ndtr(-3.5)),
    ],
    ids=["opposite", "beside", "band", "jump"],
)
def test_all_crossings_are_found(method: ReliabilityMethod, height: Model, exact: float) -> None:
    row = method.estimate(standard_normal(height), Criterion(3.5), max_evals=2_500, rng=4)[0]
    assert abs(row.pf - exact) < 4.0 * row.std_error < 0.5 * exact


def test_four_units_have_a_direction_each() -> None:
    """Each of them fails along inputs of its own, at 1e-5: one direction would see a quarter."""
    system, criterion = LinearNormalSystem(units=4), Criterion(14.6)
    exact = system.pf(criterion)
    result = LINES.estimate(system.problem(), criterion, max_evals=6_000, rng=1)
    assert len(result.details.sets[0].directions) >= 4
    assert result[0].status == "converged"
    assert abs(result[0].pf - exact) < 4.0 * result[0].std_error < 0.4 * exact


@pytest.mark.parametrize("seed", [1, 3])
def test_missions_that_are_seldom_flown_have_a_direction_each(seed: int) -> None:
    """The median flies one of three: `converged` at 0.58 of pf, when the others were overlooked."""
    system, criterion = LinearNormalSystem(units=1), Criterion(13.0, missions=Binomial(3, 0.5))
    result = LINES.estimate(system.problem(), criterion, max_evals=3_000, rng=seed)
    assert len(result.details.sets[0].directions) == 3
    assert abs(result[0].pf - system.pf(criterion)) < 4.0 * result[0].std_error


def test_directions_that_nothing_leads_to_are_a_doubt() -> None:
    """32 units times missions have more directions than are followed: failures are counted."""
    system, criterion = LinearNormalSystem(units=4), Criterion(14.5, missions=8)
    row = LINES.estimate(system.problem(), criterion, max_evals=40_000, rng=1)[0]
    assert row.status == "doubtful"
    assert "failures found lie where none of" in row.message
    assert row.ci_low <= system.pf(criterion) <= row.ci_high


def test_what_lies_between_crossings_leaves_no_bias() -> None:
    """A narrow strip that no line is run in is met by the random run of some lines."""

    def strip(x: FloatArray) -> FloatArray:
        return np.where(np.abs(x[:, 0] - 1.2) < 0.02, 5.0, x[:, 0])

    exact = ndtr(-3.0) + ndtr(-1.18) - ndtr(-1.22)
    row = LINES.estimate(standard_normal(strip), Criterion(3.0), max_evals=12_000, rng=3)[0]
    assert abs(row.pf - exact) < 4.0 * row.std_error < 4.0 * exact
    assert row.pf > 2.0 * ndtr(-3.0)
    assert row.status == "doubtful"


@BOTH
def test_a_step_is_doubtful_with_a_bound(method: ReliabilityMethod) -> None:
    def step(x: FloatArray) -> FloatArray:
        return np.where(x.max(axis=1) > 6.0, 1.0, 0.0)

    row = method.estimate(standard_normal(step, 30), Criterion(0.5), max_evals=1_000, rng=4)[0]
    assert row.status == "doubtful"
    assert row.pf < 0.01


@BOTH
def test_failed_runs_are_bounded(method: ReliabilityMethod) -> None:
    def lost(x: FloatArray) -> FloatArray:
        return np.where(x[:, 1] > 2.5, np.nan, x[:, 0])

    row = method.estimate(standard_normal(lost), Criterion(2.5), max_evals=6_000, rng=6)[0]
    assert row.status == "doubtful"
    assert row.pf_low == pytest.approx(ndtr(-2.5) * ndtr(2.5), rel=0.15)
    assert row.pf == pytest.approx(1.0 - ndtr(2.5) ** 2, rel=0.15)


@BOTH
def test_missions_and_tau(method: ReliabilityMethod) -> None:
    system = LinearNormalSystem(units=2, shared_std=0.5)
    asked = [Criterion(13.5, missions=Binomial(2, 0.4)), Criterion(15.0, tau=5.0)]
    result = method.estimate(system.problem(), asked, max_evals=16_000, rng=5)
    assert result.n_evals <= 16_000
    for criterion, row in zip(asked, result, strict=True):
        assert abs(row.pf - system.pf(criterion)) < 4.0 * row.std_error < 3.0 * row.pf


@BOTH
def test_asked_and_told_gives_the_same_answer(method: SequentialMethod) -> None:
    problem, asked = standard_normal(linear), Criterion(3.0)
    session = method.start(problem, asked, max_evals=900, rng=9)
    while not session.done:
        x = session.ask()
        session.tell(x, linear(x))
    told, own = session.result(), method.estimate(problem, asked, max_evals=900, rng=9)
    assert (told[0].pf, told[0].ci_high) == (own[0].pf, own[0].ci_high)


def test_lines_sets_and_target_say_when_to_stop() -> None:
    problem, asked = standard_normal(linear), Criterion(3.0)
    few = replace(LINES, lines=12).estimate(problem, asked, rng=8)
    assert few.details.sets[0].pf.size == 12
    rays = replace(RAYS, rays=30, sets=11).estimate(problem, asked, rng=8).details.sets[0]
    assert (rays.rays, rays.pf.size) == (32, 11)
    assert rays.nearest == pytest.approx(3.0, abs=0.1)
    for method in (LINES, RAYS):
        early = replace(method, target_cov=0.1).estimate(problem, asked, max_evals=10**6, rng=8)
        assert (early[0].status, early.n_evals < 60_000) == ("converged", True)
    short = replace(LINES, lines=10**6).estimate(problem, asked, max_evals=900, rng=8)[0]
    assert short.status == "budget_exhausted"
    assert "of 1000000 repetitions" in short.message


@BOTH
@pytest.mark.parametrize("budget", [1, 30, 90, 200])
def test_a_budget_too_small_is_kept_and_doubtful(method: ReliabilityMethod, budget: int) -> None:
    problem = standard_normal(linear, 5)
    rows = method.estimate(problem, criteria([4.0]), max_evals=budget, rng=1)
    assert rows.n_evals <= budget
    assert rows[0].status == "doubtful"
    assert rows[0].ci_low <= ndtr(-4.0) <= rows[0].ci_high


def test_a_run_that_fails_at_the_median_and_a_pole_are_no_error() -> None:
    """Both were `failed`, with an error of our own."""

    def lost(x: FloatArray) -> FloatArray:
        return np.where(np.abs(x[:, 0]) < 0.02, np.nan, x[:, 0])

    row = LINES.estimate(standard_normal(lost), Criterion(3.0), max_evals=1_500, rng=1)[0]
    assert (row.status, row.ci_low <= ndtr(-3.0) <= row.ci_high) == ("doubtful", True)
    pole = standard_normal(lambda x: 1.0 / (3.0 - x[:, 0]))
    row = LINES.estimate(pole, Criterion(1.5), max_evals=400, rng=1)[0]
    assert row.status == "doubtful"
    assert row.ci_low <= ndtr(3.0) - ndtr(7.0 / 3.0) <= row.ci_high


@pytest.mark.slow
@BOTH
def test_intervals_hold_in_1000_seeds(method: ReliabilityMethod) -> None:
    """95 % within what a one-sided binomial test at 0.1 % lets pass, on a curved limit state."""
    from scipy.stats import binom

    problem, pf = limit_state("rp22"), entry("rp22").pf
    rows = [method.estimate(problem, max_evals=1_500, rng=seed)[0] for seed in range(1_000)]
    usable = [row for row in rows if row.std_error < 0.2 * row.pf]
    covered = sum(row.ci_low <= pf <= row.ci_high for row in usable)
    assert len(usable) > 500
    assert binom.cdf(covered, len(usable), 0.95) > 1e-3


@pytest.mark.parametrize("seed", [0, 1, 18])
def test_a_ridge_between_the_places_of_rays_is_a_doubt(seed: int) -> None:
    """Rays step over it: a third of pf was missing, for sure, unless they tell one another."""

    def ridge(x: FloatArray) -> FloatArray:
        return np.asarray(x[:, 0] - 3.2 + 2.0 * np.exp(-(((x[:, 1] - 2.0) / 0.1) ** 2)))

    row = RAYS.estimate(standard_normal(ridge, 2), Criterion(0.0), max_evals=5_000, rng=seed)[0]
    exact = 1.3032032091e-3
    assert row.status == "doubtful" or abs(row.pf - exact) < 3.0 * row.std_error
    assert row.pf == pytest.approx(exact, rel=0.25)


def test_a_small_disc_of_failure_is_as_exact_as_what_lies_far_out() -> None:
    """Its radius is 0.014, and the response is infinite in its centre."""

    def depth(x: FloatArray) -> FloatArray:
        with np.errstate(divide="ignore"):
            return np.asarray(-np.log((x**2).sum(axis=1)))

    limit = Criterion(-math.log(float(chdtri(2, 1.0 - 1e-4))))
    row = RAYS.estimate(standard_normal(depth, 2), limit, max_evals=5_000, rng=1)[0]
    assert row.pf == pytest.approx(1e-4, rel=3e-3)
    assert abs(row.pf - 1e-4) < 3.0 * row.std_error < 0.03 * row.pf


def test_rays_that_meet_no_failure_bound_it() -> None:
    """The bound was 1, however many directions had been looked at."""
    nothing = standard_normal(lambda x: x[:, 0], 10)
    row = RAYS.estimate(nothing, Criterion(12.0), max_evals=2_500, rng=1)[0]
    assert (row.pf, row.status) == (0.0, "doubtful")
    assert 0.002 < row.ci_high < 0.2


@BOTH
@pytest.mark.parametrize("limit", [3.0, 3.2], ids=["at a step", "between steps"])
def test_steps_are_found_where_they_are(method: ReliabilityMethod, limit: float) -> None:
    """A response that equals its limit over a stretch: 15 to 50 % off, `converged`."""
    problem = standard_normal(lambda x: np.round(2.0 * x.sum(axis=1)) / 2.0)
    exact = ndtr(-3.25 / math.sqrt(2.0))
    rows = [method.estimate(problem, Criterion(limit), max_evals=2_000, rng=i)[0] for i in (2, 3)]
    assert "converged" in {row.status for row in rows}
    for row in rows:
        assert abs(row.pf - exact) < 4.0 * row.std_error < 0.5 * exact


@pytest.mark.parametrize("seed", [1, 3])
def test_rays_tell_one_another_of_thin_failures(seed: int) -> None:
    """A ring 0.2 wide, which most rays step over, and one in three meets."""
    problem = standard_normal(lambda x: 0.1 - np.abs(np.hypot(x[:, 0], x[:, 1]) - 3.5))
    exact = math.exp(-0.5 * 3.4**2) - math.exp(-0.5 * 3.6**2)
    row = RAYS.estimate(problem, Criterion(0.0), max_evals=5_000, rng=seed)[0]
    assert row.status == "converged"
    assert abs(row.pf - exact) < 0.01 * exact


def test_what_rays_may_have_stepped_over_is_a_part_of_their_error() -> None:
    """A ridge that one ray in thirty crosses: 20 % low, 5 % stated, called `converged`."""

    def ridge(x: FloatArray) -> FloatArray:
        return x[:, 0] + 2.0 * np.exp(-(((x[:, 1] - 2.0) / 0.1) ** 2))

    exact = 1.3031e-3
    for seed in (2, 44):
        row = RAYS.estimate(standard_normal(ridge), Criterion(3.2), max_evals=5_000, rng=seed)[0]
        assert row.status == "doubtful" or abs(row.pf - exact) < 3.0 * row.std_error


def test_what_is_not_negative_and_not_well_known() -> None:
    """The root mean square of a normal law from which what is below zero has been cut off."""
    assert not_negative(0.0, 0.1) == pytest.approx(0.1)
    assert not_negative(0.5, 0.01) == pytest.approx(math.hypot(0.5, 0.01))
    assert not_negative(-4.0, 0.1) == pytest.approx(math.sqrt(2.0) * 0.1**2 / 4.0, rel=0.01)
    assert not_negative(0.3, 0.0) == 0.3


def test_lines_that_see_no_failure_bound_it() -> None:
    """A ball that none of 300 rays meets; the bound was 1."""
    problem = standard_normal(lambda x: 0.05 - np.linalg.norm(x - 5.0, axis=1), 3)
    row = RAYS.estimate(problem, Criterion(0.0), max_evals=3_000, rng=1)[0]
    assert (row.status, row.pf) == ("doubtful", 0.0)
    assert row.ci_high < 0.1


def test_rays_go_round_a_model_that_fails_at_the_median() -> None:
    """log(0): the run at the origin fails, and every ray had it as its first."""

    def logarithm(x: FloatArray) -> FloatArray:
        square = (x**2).sum(axis=1)
        return np.where(square > 0.0, np.log(np.maximum(square, 1e-300)), np.nan)

    row = RAYS.estimate(standard_normal(logarithm), Criterion(2.5), max_evals=3_000, rng=1)[0]
    assert row.pf == pytest.approx(math.exp(-0.5 * math.exp(2.5)), rel=0.01)
    assert row.ci_high < 1.1 * row.pf


@pytest.mark.parametrize(
    ("method", "budget"), [(RAYS, 250), (RAYS, 2_000), (LINES, 4_000)], ids=["250", "2000", "lines"]
)
def test_watching_changes_no_answer(method: ReliabilityMethod, budget: int) -> None:
    """One repetition alone has no spread to show: to be watched made the row `failed`."""
    problem = LinearNormalSystem(units=4).problem() if budget > 250 else standard_normal(linear)
    asked = criteria([12.0, 14.0] if budget > 250 else [3.5])
    alone = method.estimate(problem, asked, max_evals=budget, rng=1)
    watched = method.estimate(
        problem, asked, max_evals=budget, rng=1, evaluator=Evaluator(watch=lambda _: None)
    )
    assert [(row.pf, row.status, row.message) for row in watched] == [
        (row.pf, row.status, row.message) for row in alone
    ]


@pytest.mark.parametrize("seed", range(4))
def test_in_one_input_the_ends_of_a_narrow_piece_are_known(seed: int) -> None:
    """They were known relative to all that lies beyond them: up to 5 % off, 0.2 % stated."""
    problem = standard_normal(lambda x: np.where(np.abs(x[:, 0] - 2.5) < 0.01, 1.0, -1.0), 1)
    row = LINES.estimate(problem, Criterion(0.0), max_evals=2_000, rng=seed)[0]
    assert row.pf == pytest.approx(ndtr(-2.49) - ndtr(-2.51), rel=1e-3)


@pytest.mark.parametrize(("centre", "half"), [(1.8, 0.01), (2.4, 0.03), (-1.0, 0.005)])
def test_in_one_input_a_narrow_piece_is_found(centre: float, half: float) -> None:
    """All lines are one there, and each was looked at as coarsely: 50 to 90 % low, `converged`."""
    problem = standard_normal(lambda x: np.maximum(x - 3.0, half - np.abs(x - centre))[:, 0], 1)
    exact = ndtr(-3.0) + ndtr(centre + half) - ndtr(centre - half)
    for seed in range(3):
        found = LINES.estimate(problem, Criterion(0.0), max_evals=2_000, rng=seed)
        assert found[0].status == "converged"
        assert abs(found[0].pf - exact) < 4.0 * found[0].std_error < 0.05 * exact
    sides = [3.0 if centre < 0.0 else centre - half, abs(centre) - half][: 1 + (centre < 0.0)]
    assert found.details.sets[0].distances == pytest.approx(sorted(sides), abs=1e-3)


@BOTH
@pytest.mark.parametrize("dimension", [1, 2])
def test_a_response_that_leads_nowhere_is_doubted(
    method: ReliabilityMethod, dimension: int
) -> None:
    """Most failures lie in a piece 0.003 wide that no run meets: 93 % low, `converged`."""

    def bare(x: FloatArray) -> FloatArray:
        return np.where((np.abs(x[:, 0] - 1.5) < 0.0015) | (x[:, 0] > 4.2), 1.0, -1.0)

    for seed in range(3):
        problem = standard_normal(bare, dimension)
        row = method.estimate(problem, Criterion(0.0), max_evals=2_000, rng=seed)[0]
        assert row.status == "doubtful"


@pytest.mark.parametrize(("at", "half", "seed"), [(-2.0, 0.05, 7), (2.0, 0.04, 15)])
def test_a_slab_between_lines_is_no_confident_error(at: float, half: float, seed: int) -> None:
    """Most of pf, and lines that run along it mostly miss it; it was `converged` without."""
    angle = np.array([[math.cos(1.0), math.sin(1.0)], [-math.sin(1.0), math.cos(1.0)]])

    def slab(x: FloatArray) -> FloatArray:
        ahead, aside = angle @ x.T
        return np.maximum(ahead - 2.8, half - np.abs(aside - at))

    exact = 1.0 - ndtr(2.8) * (1.0 - ndtr(at + half) + ndtr(at - half))
    row = LINES.estimate(standard_normal(slab), Criterion(0.0), max_evals=2_000, rng=seed)[0]
    assert row.status == "doubtful" or abs(row.pf - exact) < 3.0 * row.std_error


@pytest.mark.parametrize("seed", [3, 9])
def test_runs_between_lines_keep_the_budget(seed: int) -> None:
    """Those of one direction were spent by what another had found: the row was `failed`."""

    def ridge(x: FloatArray) -> FloatArray:
        return x[:, 0] + 2.0 * np.exp(-(((x[:, 1] - 2.0) / 0.1) ** 2))

    for budget in (1_000, 2_000):
        row = LINES.estimate(standard_normal(ridge), Criterion(3.2), max_evals=budget, rng=seed)[0]
        assert (row.status, row.n_evals <= budget) == ("doubtful", True)


def test_points_of_a_plane_lie_evenly_and_across() -> None:
    """Any number of them at a time; a Sobol' sequence has one in each of 64 equal shares."""
    normal_ = np.array([0.6, -0.8])
    plane = PlanePoints(normal_, np.random.default_rng(1))
    points = np.concatenate([plane.points(n) for n in (1, 10, 20, 33)])
    assert points @ normal_ == pytest.approx(np.zeros(64), abs=1e-12)
    shares = np.floor(64.0 * ndtr(points @ np.array([0.8, 0.6])))
    assert sorted(shares) == list(range(64))
