"""What the words of the command line mean."""

import pytest

from uqfold.cli.words import chosen_criteria, listed, mission_profile
from uqfold.problems.criterion import Binomial, Criterion, criteria

DEFAULT = criteria([1.0, 2.0], tau=[None, 0.5])


@pytest.mark.parametrize(
    ("words", "parts"),
    [
        (["1", "2"], ["1", "2"]),
        (["1,2", "3"], ["1", "2", "3"]),
        (["1, 10:0.7 ,2"], ["1", "10:0.7", "2"]),
        ([","], []),
    ],
)
def test_lists_are_split_at_commas(words: list[str], parts: list[str]) -> None:
    assert listed(words) == parts


@pytest.mark.parametrize(
    ("word", "missions"),
    [
        ("1", 1),
        ("12", 12),
        ("10:0.7", Binomial(10, 0.7)),
    ],
)
def test_mission_profiles(word: str, missions: object) -> None:
    assert mission_profile(word) == missions


def test_without_options_the_default_grid() -> None:
    assert chosen_criteria(DEFAULT, None, None, None) is DEFAULT


def test_what_the_options_leave_open_is_as_in_the_default_grid() -> None:
    assert list(chosen_criteria(DEFAULT, ["3"], None, None)) == [
        Criterion(3.0),
        Criterion(3.0, 0.5),
    ]
    assert list(chosen_criteria(DEFAULT, None, ["none"], ["2", "10:0.7"])) == [
        Criterion(threshold, None, missions)
        for missions in (2, Binomial(10, 0.7))
        for threshold in (1.0, 2.0)
    ]


def test_a_value_given_twice_is_asked_once() -> None:
    assert len(chosen_criteria(DEFAULT, ["3", "3.0"], ["none,none"], None)) == 1


@pytest.mark.parametrize(
    ("threshold", "tau", "missions", "said"),
    [
        (["x"], None, None, "--threshold x: give a number"),
        (["nan"], None, None, "threshold = nan"),
        ([","], None, None, "--threshold is empty"),
        (None, ["half"], None, "--tau half: give a number"),
        (None, ["-1"], None, r"tau = -1.0: give a number >= 0"),
        (None, None, ["0"], "missions = 0"),
        (None, None, ["1.5"], "--missions 1.5: give a whole number, or PLANNED:P"),
        (None, None, ["10:x"], "--missions 10:x: give a number"),
        (None, None, ["10:1.7"], "p = 1.7: give a probability"),
        (None, None, ["0:0.7"], "planned = 0"),
    ],
)
def test_what_cannot_be_read_is_refused(
    threshold: list[str] | None, tau: list[str] | None, missions: list[str] | None, said: str
) -> None:
    with pytest.raises(ValueError, match=said):
        chosen_criteria(DEFAULT, threshold, tau, missions)
