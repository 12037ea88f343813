"""The estimators behind the reference by simulation are unbiased; a biased one is caught."""

import itertools
import math
from collections.abc import Callable
from types import ModuleType

import numpy as np
import pytest
from scipy import stats

from uqfold.inputs import JointInputs, normal, product_inputs
from uqfold.problems.criterion import Binomial, Missions

Script = Callable[[str], ModuleType]

PROFILES: list[Missions] = [1, 2, 5, 10, Binomial(10, 0.7), Binomial(4, 0.5), Binomial(3, 1.0)]


def plug_in(total: int, per_mission: int, profile: Missions) -> np.ndarray:
    """The planted wrong estimator: powers of the estimated probability."""
    works = (1 - np.arange(total + 1) / total) ** per_mission
    if isinstance(profile, Binomial):
        return 1 - (1 - profile.p + profile.p * works) ** profile.planned
    return 1 - works**profile


def expected_bias(table: np.ndarray, per_mission: int, profile: Missions, p: float) -> float:
    """Exact bias of an estimator by counts when each trial fails with probability p."""
    total = len(table) - 1
    works = (1 - p) ** per_mission
    if isinstance(profile, Binomial):
        truth = 1 - (1 - profile.p * (1 - works)) ** profile.planned
    else:
        truth = 1 - works**profile
    return float(stats.binom.pmf(np.arange(total + 1), total, p) @ table - truth)


@pytest.mark.parametrize("profile", PROFILES, ids=str)
@pytest.mark.parametrize(("total", "per_mission"), [(40, 4), (10, 1)])
@pytest.mark.parametrize("p", [0.0, 1e-3, 0.1, 0.7, 1.0])
def test_expectation_over_the_counts_is_exact(
    script: Script, profile: Missions, total: int, per_mission: int, p: float
) -> None:
    table = script("mission_estimators").failure_by_count(total, per_mission, profile)
    assert table[0] == 0.0
    assert abs(expected_bias(table, per_mission, profile, p)) < 1e-12


def test_a_plug_in_estimator_is_biased() -> None:
    assert expected_bias(plug_in(40, 4, 10), 4, 10, 0.01) < -1e-3


def test_small_estimates_are_not_lost_to_rounding(script: Script) -> None:
    # one failure among 40 spoils one mission in ten of four: exactly 4 / 40
    table = script("mission_estimators").failure_by_count(40, 4, 1)
    assert table[1] == 0.1
    tiny = script("mission_estimators").failure_by_count(40, 4, Binomial(1, 1e-12))
    assert tiny[1] == pytest.approx(1e-13, rel=1e-12)


def test_too_few_trials_are_refused(script: Script) -> None:
    with pytest.raises(ValueError, match="40 trials are too few for 11 missions"):
        script("mission_estimators").failure_by_count(40, 4, 11)


def all_missions_fail_share(pool: np.ndarray, units: int, threshold: float, tau: float) -> float:
    """Share of failing missions among all ways to choose their responses, by enumeration."""
    chosen = list(itertools.combinations(pool, units))
    with np.errstate(invalid="ignore"):
        works = [max(c) <= threshold and np.subtract(max(c), min(c)) <= tau for c in chosen]
    return 1 - sum(works) / len(chosen)


@pytest.mark.parametrize(
    "times",
    [
        [[1.0, 2.0, 3.0, 4.0, 5.0, 6.0]],
        [[1.0, 1.0, 1.0, 2.0, 2.0, 2.0]],  # ties, and differences equal to tau
        [[1.0, 1.5, 2.0, np.inf, np.inf, 1.25]],
        [[np.inf] * 6],
        [[0.75, 0.5, 0.25, 0.5, 1.5, 2.5], [3.0, 2.0, 1.0, 1.25, 0.25, np.inf]],
    ],
)
def test_one_mission_equals_enumeration(script: Script, times: list[list[float]]) -> None:
    thresholds, taus = (0.5, 1.0, 2.0, 5.0, 10.0), (0.0, 0.25, 1.0, 3.0, 100.0)
    grid = script("mission_estimators").MissionGrid(
        thresholds=thresholds, taus=(None, *taus), profiles=(1,), missions=2, units=3
    )
    array = np.array(times).reshape(len(times), 2, 3)
    estimates = grid.estimate(array, np.random.default_rng(0))
    for i, tau in enumerate((math.inf, *taus)):
        for k, threshold in enumerate(thresholds):
            # without tau, a response of +inf fails by the threshold alone
            expected = [all_missions_fail_share(np.array(row), 3, threshold, tau) for row in times]
            assert estimates[i, 0, k] == pytest.approx(np.mean(expected), abs=1e-15)


def test_all_missions_of_the_pool_count_exactly(script: Script) -> None:
    # with as many missions as there are, one failed mission fails the profile in any arrangement
    grid = script("mission_estimators").MissionGrid(
        thresholds=(2.0,), taus=(1.0,), profiles=(2,), missions=2, units=2
    )
    rng = np.random.default_rng(0)
    assert grid.estimate(np.array([[[1.0, 1.0], [1.0, 1.0]]]), rng)[0, 0, 0] == 0.0
    assert grid.estimate(np.array([[[1.0, 1.0], [1.0, 3.0]]]), rng)[0, 0, 0] == 1.0


def test_bad_times_are_refused(script: Script) -> None:
    grid = script("mission_estimators").MissionGrid(thresholds=(1.0,), taus=(None,), profiles=(1,))
    rng = np.random.default_rng(0)
    with pytest.raises(ValueError, match=r"shape \(3, 4, 10\)"):
        grid.estimate(np.ones((3, 4, 10)), rng)
    times = np.ones((3, 10, 4))
    times[1, 2, 3] = np.nan
    with pytest.raises(ValueError, match="NaN"):
        grid.estimate(times, rng)


# A linear-normal system: y = 0.6 v + 0.8 e, both standard normal
SHARED, OWN = 0.6, 0.8
THRESHOLDS = (0.5, 1.5, 2.5)
TAUS = (None, 2.0, 3.0)
LIMIT = 5.0  # standard errors, for about 50 rows of blocks that are nearly normal


def stand_in() -> tuple[Callable[[np.ndarray], np.ndarray], JointInputs]:
    inputs = product_inputs({"v": normal(0, 1)}, {"e": normal(0, 1)})
    return (lambda x: SHARED * x[:, 0] + OWN * x[:, 1]), inputs


class LinearNormal:
    def distribution(self, t, u, resolution):
        e = stats.norm(SHARED * u, OWN)
        return e.cdf(t), e.sf(t), e.pdf(t)


def exact(script: Script, profiles: list[Missions]) -> np.ndarray:
    s = script("order_statistics")
    grid = s.Grid(
        start=-14.0, width=0.5, thresholds=THRESHOLDS, taus=TAUS, profiles=profiles, n_units=4
    )
    resolution = s.Resolution(reach=9.0, shared_step=0.25, individual_step=1.0, panel_nodes=8)
    return s.integrate(LinearNormal(), grid, resolution)


def z_scores(script: Script, blocks: int) -> np.ndarray:
    profiles: list[Missions] = [1, 2, 5, 10, Binomial(10, 0.7), Binomial(4, 0.5)]
    grid = script("mission_estimators").MissionGrid(
        thresholds=THRESHOLDS, taus=TAUS, profiles=profiles
    )
    model, inputs = stand_in()
    sums = script("folding_wing").simulate(
        model, inputs, grid, blocks=blocks, seed=20240611, draws=128
    )
    return (sums.mean - exact(script, profiles)) / sums.std_error


def test_simulation_agrees_with_the_exact_system(script: Script) -> None:
    z = z_scores(script, blocks=100)
    assert np.abs(z).max() < LIMIT
    # the standard errors are not too large either
    assert np.sqrt(np.mean(z**2)) > 0.3


def test_the_same_check_catches_powers_of_estimated_probabilities(
    script: Script, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(script("mission_estimators"), "failure_by_count", plug_in)
    z = z_scores(script, blocks=100)
    assert np.abs(z).max() > 4 * LIMIT
