"""What the words of a command line mean: thresholds, tau, mission profiles."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from pathlib import Path
from typing import Any

from uqfold.problems.criterion import Binomial, Criteria, Missions, criteria


def number(word: str) -> float:
    """Read a number."""
    try:
        return float(word)
    except ValueError:
        raise ValueError("give a number") from None


def number_or_none(word: str) -> float | None:
    """Read a number, or the word ``none``."""
    return None if word.lower() == "none" else number(word)


def mission_profile(word: str) -> Missions:
    """Read a number of missions, or a binomial number as ``10:0.7``."""
    planned, colon, p = word.partition(":")
    if not planned.isdecimal():
        raise ValueError("give a whole number, or PLANNED:P as in 10:0.7")
    return Binomial(int(planned), number(p)) if colon else int(planned)


_READ: dict[str, Callable[[str], Any]] = {
    "threshold": number,
    "tau": number_or_none,
    "missions": mission_profile,
}
"""Option -> what reads a word of it."""


def listed(words: Iterable[str]) -> list[str]:
    """Split words at commas."""
    parts = (part.strip() for word in words for part in word.split(","))
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
    given = {"threshold": threshold, "tau": tau, "missions": missions}
    if all(words is None for words in given.values()):
        return default
    return criteria(
        *(
            list(dict.fromkeys(getattr(one, option) for one in default))
            if words is None
            else _read(option, words)
            for option, words in given.items()
        )
    )


def known_reference(word: str) -> Any:
    """Return the reference that a word means: failure probabilities, or the rows of records.

    Raises
    ------
    ValueError, OSError
        If it is neither, or the records cannot be read.
    """
    if Path(word).exists():
        from uqfold.comparison.records import read_records

        return read_records(word)
    try:
        return [number(one) for one in listed([word])]
    except ValueError:
        raise ValueError(
            f"--reference {word}: give probabilities, or a folder of records"
        ) from None


def _read(option: str, words: Iterable[str]) -> list[Any]:
    values = []
    for word in listed(words):
        try:
            values.append(_READ[option](word))
        except ValueError as error:
            raise ValueError(f"--{option} {word}: {error}") from None
    if not values:
        raise ValueError(f"--{option} is empty: give at least one value")
    return list(dict.fromkeys(values))
