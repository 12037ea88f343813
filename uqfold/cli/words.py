"""What the words of a command line mean: thresholds, tau, mission profiles."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterable
from typing import TypeVar

from uqfold.problems.criterion import Binomial, Criteria, Missions, criteria

Value = TypeVar("Value")

_BINOMIAL = re.compile(r"(?:binomial\()?\s*(\d+)\s*[:,]\s*([^)\s]+)\s*\)?")


def number(word: str, option: str, remedy: str = "give a number") -> float:
    """Read a number.

    Raises
    ------
    ValueError
        If the word is none; the message names the option.
    """
    try:
        return float(word)
    except ValueError:
        raise ValueError(f"--{option} {word}: {remedy}") from None


def number_or_none(word: str, option: str) -> float | None:
    """Read a number, or the word ``none``."""
    return None if word.lower() == "none" else number(word, option, "give a number or none")


def mission_profile(word: str, option: str) -> Missions:
    """Read a number of missions, or a binomial number as ``10:0.7`` or ``binomial(10, 0.7)``."""
    if word.isdecimal():
        return int(word)
    match = _BINOMIAL.fullmatch(word)
    if match is None:
        raise ValueError(f"--{option} {word}: give a whole number, or PLANNED:P as in 10:0.7")
    return Binomial(int(match[1]), number(match[2], option))


def listed(words: Iterable[str]) -> list[str]:
    """Split words at commas, but not inside parentheses."""
    parts = (part.strip() for word in words for part in re.split(r",(?![^(]*\))", word))
    return [part for part in parts if part]


def chosen_criteria(
    default: Criteria | None,
    threshold: Iterable[str] | None,
    tau: Iterable[str] | None,
    missions: Iterable[str] | None,
) -> Criteria:
    """Build the grid that the options ask for; what they leave open is as in the default grid.

    Raises
    ------
    ValueError
        If a word cannot be read or is out of range, or no threshold is known.
    """
    if default is None:
        if threshold is None:
            raise ValueError(
                "the problem has no criteria of its own: give --threshold T, or build it with "
                "default_criteria="
            )
        default = criteria(0.0)
    if threshold is None and tau is None and missions is None:
        return default
    return criteria(
        _read(threshold, number, "threshold", [one.threshold for one in default]),
        _read(tau, number_or_none, "tau", [one.tau for one in default]),
        _read(missions, mission_profile, "missions", [one.missions for one in default]),
    )


def _read(
    words: Iterable[str] | None,
    read: Callable[[str, str], Value],
    option: str,
    default: Iterable[Value],
) -> list[Value]:
    values = default if words is None else [read(word, option) for word in listed(words)]
    unique = list(dict.fromkeys(values))
    if not unique:
        raise ValueError(f"--{option} is empty: give at least one value")
    return unique
