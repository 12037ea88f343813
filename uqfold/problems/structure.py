"""How the units of a system combine: which of them may fail.

The records only name the structure; the algebra that turns it into a probability is in
`uqfold.system`. A synchronization threshold needs `Series`.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from typing import TypeAlias

from uqfold.checks import keep, listed, refused, whole


@dataclass(frozen=True)
class Series:
    """The system works when every unit works."""


@dataclass(frozen=True)
class Parallel:
    """The system works when at least one unit works."""


@dataclass(frozen=True)
class KOutOfN:
    """The system works when at least `k` of its units work."""

    k: int

    def __post_init__(self) -> None:
        keep(self, "k", whole, at_least=1)


@dataclass(frozen=True, init=False)
class CutSets:
    """The system fails when all units of at least one set (of unit indices from 0) fail."""

    sets: tuple[frozenset[int], ...]

    def __init__(self, sets: Iterable[Iterable[int]]) -> None:
        frozen = tuple(
            frozenset(
                whole(f"a unit of sets[{i}]", unit, at_least=0)
                for unit in listed(f"sets[{i}]", one, what="set of unit indices", sets=True)
            )
            for i, one in enumerate(listed("sets", sets, what="list of sets", sets=True))
        )
        if not frozen or not all(frozen):
            raise refused("sets", sets, "give at least one set, none of them empty")
        object.__setattr__(self, "sets", frozen)


Structure: TypeAlias = Series | Parallel | KOutOfN | CutSets
