"""The estimators behind the reference by simulation are unbiased; a biased one is caught."""

import itertools
import math
from collections.abc import Callable
from functools import partial
from types import ModuleType

import numpy as np
import pytest
from scipy import stats

import uqfold
from uqfold.inputs import normal
from uqfold.problems import Problem
from uqfold.problems.criterion import Binomial, Criterion, Missions

Script = Callable[[str], ModuleType]

PROFILES: list[Missions] = [1, 2, 5, 10, Binomial(10, 0.7), Binomial(4, 0.5)]


def plug_in(failures: np.ndarray) -> np.ndarray:
    """The planted wrong estimator: powers of the estimated probability."""
    works = 1 - failures.mean(axis=0)
    return np.array([1 - works**r for r in range(len(failures) + 1)])


@pytest.mark.parametrize("size", [1, 2, 5, 6])
def test_failure_of_any_is_the_mean_over_all_choices(script: Script, size: int) -> None:
    f = np.random.default_rng(size).random((size, 3))
    f[0] = [0.0, 1.0, 1e-9]
    found = script("mission_estimators").failure_of_any(f)
    assert (found[0] == 0.0).all()
    for r in range(1, size + 1):
        choices = [
            1 - np.prod(1 - f[list(c)], axis=0) for c in itertools.combinations(range(size), r)
        ]
        np.testing.assert_allclose(found[r], np.mean(choices, axis=0), atol=1e-15)


def test_powers_of_the_mean_are_something_else() -> None:
    f = np.array([[0.1], [0.5]])
    assert abs(plug_in(f)[2, 0] - (1 - 0.9 * 0.5)) > 0.01


def test_small_estimates_are_not_lost_to_rounding(script: Script) -> None:
    f = np.zeros((40, 1))
    f[7] = 1e-30
    np.testing.assert_allclose(
        script("mission_estimators").failure_of_any(f)[:, 0], np.arange(41) / 40 * 1e-30, rtol=1e-13
    )


WEIGHTS = np.array([0.5, 0.3, 0.2])
THRESHOLDS, TAUS = (0.5, 1.0, 2.0, 5.0, 10.0), (0.0, 0.25, 1.0, 3.0, 100.0)


def enumerated(units: np.ndarray, threshold: float, tau: float) -> float:
    """Weighted share of failing missions among all ways to take one response of each unit."""
    failed = 0.0
    for ways in itertools.product(range(units.shape[1]), repeat=len(units)):
        chosen = [unit[way] for unit, way in zip(units, ways, strict=True)]
        last = max(chosen)
        with np.errstate(invalid="ignore"):
            works = last <= threshold and np.subtract(last, min(chosen)) <= tau
        failed += 0.0 if works else float(np.prod(WEIGHTS[list(ways)]))
    return failed


@pytest.mark.parametrize(
    "mission",
    [
        [[1.0, 2.0, 3.0], [4.0, 5.0, 6.0]],
        [[1.0, 1.0, 2.0], [2.0, 1.0, 2.0]],  # ties, and differences equal to tau
        [[1.0, 1.5, np.inf], [np.inf, 1.25, 2.0]],
        [[np.inf] * 3] * 2,
        [[0.75, 0.5, 0.25], [0.5, 1.5, 2.5], [3.0, 2.0, 1.0], [1.25, 0.25, np.inf]],
    ],
)
def test_one_mission_equals_enumeration(script: Script, mission: list[list[float]]) -> None:
    units = np.array(mission)
    found = script("mission_estimators").mission_failures(
        units[None, None], WEIGHTS, np.array(THRESHOLDS), np.array(TAUS)
    )[0, 0]
    expected = [[enumerated(units, threshold, tau) for threshold in THRESHOLDS] for tau in TAUS]
    np.testing.assert_allclose(found, expected, atol=1e-15)


def test_a_rare_early_response_is_not_lost_to_rounding(script: Script) -> None:
    # both units work but for a way of weight 1e-25 in which one of them is too early
    weights = np.array([1e-25, 1.0])
    units = np.array([[0.0, 1.0], [0.9, 1.0]])
    found = script("mission_estimators").mission_failures(
        units[None, None], weights, np.array([2.0]), np.array([0.5])
    )
    assert found.item() == pytest.approx(1e-25, rel=1e-12)


def test_missions_of_one_unit_are_weighted_counts_of_late_responses(script: Script) -> None:
    times = np.array([[[[3.0, 1.0, 2.0]], [[np.inf, 2.0, 2.0]]]])
    found = script("mission_estimators").mission_failures(
        times, WEIGHTS, np.array([0.0, 1.0, 2.0, 3.0]), np.array([np.inf])
    )
    expected = [[[[1.0, 0.7, 0.5, 0.0]], [[1.0, 1.0, 0.5, 0.5]]]]
    np.testing.assert_allclose(found, expected, rtol=1e-15)


@pytest.mark.parametrize("tau", [None, 1.0])
def test_all_missions_of_the_pool_count_exactly(script: Script, tau: float | None) -> None:
    # with as many missions as there are, one failed mission fails the profile in any arrangement
    grid = script("tables").Grid(thresholds=(2.0,), taus=(tau,), profiles=(2,), units=2)
    estimate = partial(script("mission_estimators").estimate, grid)
    rng = np.random.default_rng(0)
    alone = np.ones(1)
    assert estimate(np.ones((1, 4, 1)), alone, rng)[0, 0, 0] == 0.0
    assert estimate(np.array([[[1.0], [1.0], [1.0], [3.0]]]), alone, rng)[0, 0, 0] == 1.0


def test_failed_runs_are_refused(script: Script) -> None:
    grid = script("tables").Grid(thresholds=(1.0,), taus=(None,), profiles=(1,))
    times = np.ones((3, 4, 3))
    times[1, 2, 1] = np.nan
    with pytest.raises(ValueError, match="NaN"):
        script("mission_estimators").estimate(grid, times, WEIGHTS, np.random.default_rng(0))


# A linear-normal system, y = 0.6 v + 0.8 e with e made of two inputs; the strata lie askew
SHARED, OWN = 0.6, 0.8
LIMIT = 5.0  # standard errors, for some hundred rows of means over 40 blocks


def stand_in() -> Problem:
    return Problem(
        lambda x: SHARED * x[:, 0] + OWN * (0.96 * x[:, 1] + 0.28 * x[:, 2]),
        shared={"v": normal(0, 1)},
        individual={"e": normal(0, 1), "f": normal(0, 1)},
        units=4,
        low_fidelity=lambda x: x[:, 1],
    )


def linear_normal(t, u, rules):
    e = stats.norm(SHARED * u, OWN)
    return e.cdf(t), e.sf(t), e.pdf(t)


def in_standard_errors(estimates: np.ndarray, exact: np.ndarray) -> np.ndarray:
    """Differences of the means over blocks from the exact answers."""
    error = estimates.std(axis=0, ddof=1) / math.sqrt(len(estimates))
    with np.errstate(divide="ignore", invalid="ignore"):
        return (estimates.mean(axis=0) - exact) / error


def linear_normal_scores(script: Script, edges: tuple[float, ...]) -> np.ndarray:
    """Differences from the exact answers, in standard errors."""
    s = script("order_statistics")
    grid = script("tables").Grid(
        thresholds=(0.5, 1.5, 2.5), taus=(None, 2.0, 3.0), profiles=PROFILES
    )
    rules = s.Rules(start=-14.0, width=0.5, panel_nodes=8, reach=9.0, shared_step=0.25)
    exact = s.integrate(linear_normal, grid, rules)
    estimates = script("folding_wing").simulate(
        stand_in(), grid, blocks=40, seed=7, draws=64 if not edges else 16, strata=edges
    )
    return in_standard_errors(estimates, exact).ravel()


def series_scores(script: Script, edges: tuple[float, ...]) -> np.ndarray:
    """The same for Example 1, whose answers are known down to 3e-7."""
    problem = uqfold.problems.series()
    grid = script("tables").Grid(
        thresholds=(-1.0, 2.0, 4.0, 6.0, 8.0), taus=(None, 12.0, 20.0), profiles=PROFILES
    )
    estimates = script("folding_wing").simulate(
        problem, grid, blocks=40, seed=7, draws=16, strata=edges
    )
    assert problem.references is not None
    entries = [
        problem.references.lookup(Criterion(threshold, tau, profile))
        for tau in grid.taus
        for profile in grid.profiles
        for threshold in grid.thresholds
    ]
    known = np.array([math.nan if entry is None else entry.pf for entry in entries])
    scores = in_standard_errors(estimates, known.reshape(estimates.shape[1:])).ravel()
    assert np.nanmin(known) < 5e-7
    assert np.isfinite(scores).sum() > 60
    return scores[np.isfinite(scores)]


ONE = ()
STRATA = tuple(float(edge) for edge in range(-3, 6))
Scores = Callable[[Script, tuple[float, ...]], np.ndarray]


@pytest.mark.thorough
@pytest.mark.parametrize(
    ("scores", "edges"),
    [(linear_normal_scores, ONE), (linear_normal_scores, STRATA), (series_scores, STRATA)],
)
def test_simulation_agrees_with_exact_systems(
    script: Script, scores: Scores, edges: tuple[float, ...]
) -> None:
    z = scores(script, edges)
    assert np.abs(z).max() < LIMIT
    # the standard errors are not too large either
    assert np.sqrt(np.mean(z**2)) > 0.3


def test_the_same_check_catches_powers_of_estimated_probabilities(
    script: Script, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(script("mission_estimators"), "failure_of_any", plug_in)
    assert np.abs(linear_normal_scores(script, ONE)).max() > 2 * LIMIT


def test_the_same_check_catches_weights_of_other_strata(
    script: Script, monkeypatch: pytest.MonkeyPatch
) -> None:
    wing = script("folding_wing")
    right = wing.probabilities

    def shifted(edges: tuple[float, ...]) -> np.ndarray:
        return right([edge + 0.05 for edge in edges])

    monkeypatch.setattr(wing, "probabilities", shifted)
    assert np.abs(series_scores(script, STRATA)).max() > 2 * LIMIT
