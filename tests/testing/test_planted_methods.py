"""The contract suite can fail: each planted fault is found by the check that is meant for it."""

import re

import pytest

from tests.testing.planted import (
    FINE,
    PLANTED,
    Biased,
    ExactOnALinearSystem,
    Honest,
    OverConfidentSurface,
)
from uqfold.methods import ReliabilityMethod
from uqfold.methods.result import STATUSES
from uqfold.testing import CHECKS, ContractError, check_method
from uqfold.testing.verdict import Level

OF_NO_CRITERION = {
    "is_a_frozen_record_of_settings",
    "evaluations_are_counted_per_sample",
    "same_seed_same_answer",
    "other_seed_other_answer",
    "same_answer_in_a_fresh_process",
    "problem_is_left_alone",
}


def _marks(planted: type[ReliabilityMethod]) -> pytest.MarkDecorator:
    # thirty surfaces
    dear = issubclass(planted, OverConfidentSurface)
    return pytest.mark.slow if dear else pytest.mark.thorough


LEVELS = ["quick", pytest.param("full", marks=pytest.mark.thorough)]


@pytest.mark.parametrize(
    ("planted", "check", "level"),
    [(*pair, "quick") for pair in PLANTED if pair[0] not in FINE]
    + [pytest.param(*pair, "full", marks=_marks(pair[0])) for pair in PLANTED],
)
def test_planted_fault_is_found_at_each_level(
    planted: type[ReliabilityMethod], check: str, level: Level
) -> None:
    """The message names the check, and the criterion and the status wherever a row was judged."""
    with pytest.raises(ContractError) as broken:
        check_method(planted(), level, only=[check])
    told = str(broken.value)
    assert told.startswith(f"{check}: ")
    if check not in OF_NO_CRITERION:
        assert re.search(rf"(T = .*|g <= 0), m = .*\b({'|'.join(STATUSES)})\b", told)


def test_all_broken_promises_are_told_at_once() -> None:
    """A line for each: the check, the criterion, the status; what is kept is not named."""
    checks = ["one_unit_is_exact", "certain_outcomes", "plain_limit_state"]
    with pytest.raises(ContractError) as broken:
        check_method(Biased(), only=checks)
    first, second = str(broken.value).splitlines()
    assert first.startswith("one_unit_is_exact: planted, 1 units, ")
    assert "T = 9.5, m = 1: converged with pf = " in first
    assert second.startswith("plain_limit_state: planted")


@pytest.mark.parametrize("level", LEVELS)
def test_control_without_a_fault_passes_every_check(level: Level) -> None:
    assert check_method(Honest(), level) == list(CHECKS)


def test_every_check_has_been_seen_to_fail() -> None:
    assert {check for _, check in PLANTED} == set(CHECKS)


def test_seeds_that_agree_on_a_linear_system_are_no_fault() -> None:
    # there the expansion is exact: what the contract saw of the seed was the rounding of one
    # processor
    check = "other_seed_other_answer"
    assert check_method(ExactOnALinearSystem(), "quick", only=[check]) == [check]
