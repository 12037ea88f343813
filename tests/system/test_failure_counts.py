"""Estimates from counts of failures: without bias, exact, and a biased one is caught."""

import numpy as np
import pytest
from scipy import stats

from uqfold.problems.criterion import Binomial, Missions
from uqfold.system import failure_counts
from uqfold.system.failure_counts import failure_by_count

PROFILES: list[Missions] = [1, 2, 5, 10, Binomial(10, 0.7), Binomial(4, 0.5), Binomial(3, 1.0)]


def bias(table: np.ndarray, per_mission: int, missions: Missions, p: float) -> float:
    """Exact bias when each trial fails with probability p."""
    works = (1 - p) ** per_mission
    if isinstance(missions, Binomial):
        truth = 1 - (1 - missions.p * (1 - works)) ** missions.planned
    else:
        truth = 1 - works**missions
    trials = len(table) - 1
    return float(stats.binom.pmf(np.arange(trials + 1), trials, p) @ table - truth)


@pytest.mark.parametrize("missions", PROFILES, ids=str)
@pytest.mark.parametrize(("trials", "per_mission"), [(48, 4), (12, 1)])
@pytest.mark.parametrize("p", [0.0, 1e-3, 0.1, 0.7, 1.0])
def test_expectation_over_the_counts_is_exact(
    missions: Missions, trials: int, per_mission: int, p: float
) -> None:
    table = failure_by_count(trials, per_mission, missions)
    assert table[0] == 0.0
    assert (np.diff(table) >= 0.0).all()
    assert abs(bias(table, per_mission, missions, p)) < 1e-12


def test_a_plug_in_estimate_is_biased() -> None:
    plug_in = 1 - (1 - np.arange(49) / 48) ** 40
    assert bias(plug_in, 4, 10, 0.01) < -1e-3


def test_small_estimates_are_not_lost_to_rounding() -> None:
    # one failure among 40 spoils one mission of four in ten: exactly 4 / 40
    assert failure_by_count(40, 4, 1)[1] == 0.1
    assert failure_by_count(40, 4, Binomial(1, 1e-12))[1] == pytest.approx(1e-13, rel=1e-12)


@pytest.mark.parametrize("missions", PROFILES, ids=str)
def test_logarithms_say_what_whole_numbers_say(
    missions: Missions, monkeypatch: pytest.MonkeyPatch
) -> None:
    exact = failure_by_count(48, 4, missions)
    monkeypatch.setattr(failure_counts, "EXACT_TERMS", 0)
    np.testing.assert_allclose(failure_by_count(48, 4, missions), exact, rtol=1e-12, atol=0.0)


def test_many_units_and_missions_are_counted_at_once() -> None:
    """100,000 units, and 2,000 missions of a random number: whole numbers had no end there."""
    table = failure_by_count(400_000, 100_000, 1)
    assert table[[0, 1, -1]] == pytest.approx([0.0, 0.25, 1.0], rel=1e-12)
    table = failure_by_count(2_000, 1, Binomial(2_000, 0.5))
    # one failed mission of 2,000 is among half of them with probability 1 / 2
    assert table[[0, 1, -1]] == pytest.approx([0.0, 0.5, 1.0], rel=1e-12)


def test_too_few_trials_are_refused() -> None:
    with pytest.raises(ValueError, match="40 trials are too few for 11 missions"):
        failure_by_count(40, 4, 11)
