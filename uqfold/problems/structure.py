"""How the units of a system combine: which of them may fail.

The records only name the structure; the algebra that turns it into a probability is in
`uqfold.system`. A synchronization threshold needs `Series`.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from typing import TypeAlias


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
        if self.k < 1:
            raise ValueError(f"KOutOfN(k={self.k}): k must be at least 1")


@dataclass(frozen=True, init=False)
class CutSets:
    """The system fails when all units of at least one set (of unit indices from 0) fail."""

    sets: tuple[frozenset[int], ...]

    def __init__(self, sets: Iterable[Iterable[int]]) -> None:
        frozen = tuple(frozenset(int(i) for i in one) for one in sets)
        if not frozen or any(not one for one in frozen):
            raise ValueError(f"CutSets({sets!r}): give at least one set, none of them empty")
        if any(i < 0 for one in frozen for i in one):
            raise ValueError(f"CutSets({sets!r}): unit indices count from 0")
        object.__setattr__(self, "sets", frozen)


Structure: TypeAlias = Series | Parallel | KOutOfN | CutSets
