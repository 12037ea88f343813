"""The keys of a study file: what each may hold, how it is read, and what it means.

A table of the file is described by a tuple of `Key` records. Reading, checking and the reference
in the documentation all come from them.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any, Final

from uqfold.checks import LARGEST_WHOLE, shown
from uqfold.comparison.studies.document import Place, nearest


@dataclass(frozen=True)
class Value:
    """What a key may hold.

    Attributes
    ----------
    text
        In words, for the documentation and for messages.
    read
        Turns what the file holds into what the program uses, or raises a `StudyError`.
    """

    text: str
    read: Callable[[Any, Place], Any]


class _Required:
    def __repr__(self) -> str:
        return "required"


REQUIRED: Final = _Required()


@dataclass(frozen=True)
class Key:
    """One key of a table.

    Attributes
    ----------
    name
        The key.
    value
        What it may hold.
    meaning
        One sentence for the documentation.
    default
        What the program uses where the key is missing; `REQUIRED` if it must not be.
    """

    name: str
    value: Value
    meaning: str
    default: Any = REQUIRED


@dataclass(frozen=True)
class RowIdentity:
    """How rows of two runs of a study are matched and compared.

    Attributes
    ----------
    index
        Columns that identify a row.
    sample
        Columns that tell one random sample from another; where they agree, so must all numbers.
    estimates
        Column -> column of its standard error, for estimates from different samples.
    sampled
        Further columns that depend on the sample, and are not compared between different ones.
    """

    index: tuple[str, ...]
    sample: tuple[str, ...] = ()
    estimates: Mapping[str, str] = field(default_factory=dict)
    sampled: tuple[str, ...] = ()


@dataclass(frozen=True)
class Kind:
    """One kind of analysis, figure or table, as the registries hold them.

    Attributes
    ----------
    name
        How a study calls it.
    meaning
        One sentence for the documentation.
    keys
        Its keys, besides those that all of its sort have.
    call
        What does it: see the registry.
    columns
        Analyses only: column -> type (`str`, `int`, `float`) of the table it makes; NaN stands
        for "none" in the float columns.
    identity
        Analyses only: what identifies a row, and what in it depends on a sample.
    needs
        Figures and tables only: columns that the tables they read must have.
    picture
        Figures only: the file that the report shows. Where it is ``svg``, `call` gives the text
        of an SVG picture instead of a figure, and there is no other file.
    """

    name: str
    meaning: str
    keys: tuple[Key, ...]
    call: Callable[..., Any]
    columns: Mapping[str, type] = field(default_factory=dict)
    identity: RowIdentity = RowIdentity(())
    needs: tuple[str, ...] = ()
    picture: str = "png"


def read_table(content: Any, place: Place, keys: Sequence[Key]) -> dict[str, Any]:
    """Read one table of the file.

    Raises
    ------
    StudyError
        For a key that is unknown, missing, or holds something else than it may.
    """
    if not isinstance(content, Mapping):
        raise place.error(f"{content!r} is no table of keys")
    known = {key.name: key for key in keys}
    for name in content:
        if name not in known:
            raise place.at(name).error(f"unknown key; {nearest(name, known)}")
    read = {}
    for name, key in known.items():
        if name in content:
            read[name] = key.value.read(content[name], place.at(name))
        elif key.default is REQUIRED:
            raise place.error(f"the key {name} is missing ({key.value.text})")
        else:
            read[name] = key.default
    return read


def choice(*words: str) -> Value:
    """Give the value that is one of some words."""

    def read(content: Any, place: Place) -> str:
        if not isinstance(content, str):
            raise place.error(f"{content!r} is none of {', '.join(words)}")
        if content not in words:
            raise place.error(f"{content!r} is unknown; {nearest(content, words)}")
        return content

    return Value(" or ".join(words), read)


def list_of(value: Value, *, at_least: int = 1) -> Value:
    """Give the value that is a list; one value alone stands for a list of one."""

    def read(content: Any, place: Place) -> tuple[Any, ...]:
        if not isinstance(content, list):
            return (value.read(content, place),)
        if len(content) < at_least:
            raise place.error(f"the list is empty: give {value.text}")
        return tuple(value.read(one, place.at(i)) for i, one in enumerate(content))

    return Value(f"{value.text}, or a list of such", read)


def listed(value: str | Sequence[str] | None) -> tuple[str, ...]:
    """Give the names that a key holds: none, one or several."""
    if value is None:
        return ()
    return (value,) if isinstance(value, str) else tuple(value)


def _text(content: Any, place: Place) -> str:
    if not isinstance(content, str) or not content.strip():
        raise place.error(f"{content!r} is no text: give one that is not empty")
    return content


def _number(content: Any, place: Place) -> float:
    if isinstance(content, bool) or not isinstance(content, int | float):
        raise place.error(f"{shown(content)} is no number")
    try:
        number = float(content)
    except OverflowError:
        number = math.nan
    if math.isnan(number):
        raise place.error(f"{shown(content)}: give a number that a float can hold")
    return number


def _count(content: Any, place: Place) -> int:
    if isinstance(content, bool) or not isinstance(content, int) or content < 1:
        raise place.error(f"{shown(content)}: give a whole number >= 1")
    if content > LARGEST_WHOLE:
        raise place.error(f"{shown(content)}: give a number below 2**63")
    return content


def _flag(content: Any, place: Place) -> bool:
    if not isinstance(content, bool):
        raise place.error(f"{content!r}: give true or false")
    return content


def _mapping(content: Any, place: Place) -> dict[str, Any]:
    if not isinstance(content, dict):
        raise place.error(f"{content!r} is no table of keys")
    return content


def _tables(content: Any, place: Place) -> tuple[dict[str, Any], ...]:
    if not isinstance(content, list) or not all(isinstance(one, dict) for one in content):
        raise place.error(f"{content!r} is no array of tables: write [[{place.path[-1]}]]")
    return tuple(content)


TEXT = Value("text", _text)
NUMBER = Value("number", _number)
COUNT = Value("whole number >= 1", _count)
FLAG = Value("true or false", _flag)
MAPPING = Value("table", _mapping)
TABLES = Value("array of tables", _tables)

# These are checked against the tables of the study once all of them are known.
TABLE_NAME = Value("name of a run or an analysis", _text)
TABLE_NAMES = list_of(TABLE_NAME)
COLUMN = Value("a column of that table", _text)
WHERE = Value(
    "table: column -> value or list of values; the text none where a number is missing", _mapping
)
