"""The contract suite can fail: each planted fault is found by the check that is meant for it."""

import pytest

from tests.testing.planted import (
    PLANTED,
    Biased,
    ExactOnALinearSystem,
    Honest,
    OverConfidentSurface,
)
from uqfold.methods import ReliabilityMethod
from uqfold.testing import CHECKS, ContractError, check_method

CASES = [
    # thirty fits of a surface
    pytest.param(*pair, marks=pytest.mark.slow if pair[0] is OverConfidentSurface else ())
    for pair in PLANTED
]


@pytest.mark.parametrize(("planted", "check"), CASES)
def test_planted_fault_is_found(planted: type[ReliabilityMethod], check: str) -> None:
    with pytest.raises(ContractError):
        check_method(planted(), only=[check])


def test_all_broken_promises_are_told_at_once() -> None:
    """A line for each: the check, the criterion, the status; what is kept is not named."""
    checks = ["one_unit_is_exact", "certain_outcomes", "plain_limit_state"]
    with pytest.raises(ContractError) as broken:
        check_method(Biased(), only=checks)
    first, second = str(broken.value).splitlines()
    assert first.startswith("one_unit_is_exact: planted, 1 units, ")
    assert "T = 9.5, m = 1: converged with pf = " in first
    assert second.startswith("plain_limit_state: planted")


def test_control_without_a_fault_passes_every_check() -> None:
    assert check_method(Honest()) == list(CHECKS)


def test_every_check_has_been_seen_to_fail() -> None:
    assert {check for _, check in PLANTED} == set(CHECKS)


def test_seeds_that_agree_on_a_linear_system_are_no_fault() -> None:
    # there the expansion is exact: what the contract saw of the seed was the rounding of one
    # processor
    check = "other_seed_other_answer"
    assert check_method(ExactOnALinearSystem(), only=[check]) == [check]
