"""What "works" means: response threshold, synchronization threshold, mission profile."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any, TypeAlias, overload

import numpy as np

from uqfold.checks import instance, keep, listed, or_none, real, refused, whole

LIMIT_STATE_THRESHOLD = float(np.nextafter(0.0, -1.0))
"""Threshold of a plain limit state: failure is g <= 0, so y = -g works only below zero."""


def threshold_text(threshold: float, unit: str = "") -> str:
    """Write a threshold, for instance ``T = 0.55 s``; that of a limit state is ``g <= 0``."""
    limit_state = threshold == LIMIT_STATE_THRESHOLD
    return "g <= 0" if limit_state else f"T = {threshold:g} {unit}".rstrip()


@dataclass(frozen=True)
class Binomial:
    """A binomial number of missions, Eq. (29): `planned` flights, each flown with probability `p`.

    Raises
    ------
    ValueError, TypeError
        If `planned` is not a positive whole number or `p` is outside [0, 1].
    """

    planned: int
    p: float

    def __post_init__(self) -> None:
        keep(self, "planned", whole, at_least=1)
        keep(self, "p", real, at_least=0.0, at_most=1.0, what="probability")

    def __str__(self) -> str:
        return f"binomial({self.planned}, {self.p:g})"


Missions: TypeAlias = int | Binomial


@dataclass(frozen=True)
class Criterion:
    """One question: with what probability does the system miss this requirement?

    Attributes
    ----------
    threshold
        T: a unit works in one mission when its response t <= T, Eq. (22). +-inf are allowed.
    tau
        Synchronization threshold on max - min over the units of one mission (works when
        max - min <= tau, Eq. (37)); None where synchronization is not required.
    missions
        A fixed number m >= 1, or a `Binomial` number.

    Raises
    ------
    ValueError, TypeError
        If a value is not a number, tau is negative, or missions is neither a whole number >= 1
        nor a `Binomial`.
    """

    threshold: float
    tau: float | None = None
    missions: Missions = 1

    def __post_init__(self) -> None:
        keep(self, "threshold", real, finite=False, what="number or +-inf")
        keep(self, "tau", or_none, real, at_least=0.0, finite=False)
        if not isinstance(self.missions, Binomial):
            keep(self, "missions", whole, at_least=1, what="Binomial or a whole number")

    @property
    def max_missions(self) -> int:
        """The largest number of missions that can occur."""
        return self.missions.planned if isinstance(self.missions, Binomial) else self.missions

    def __str__(self) -> str:
        parts = [threshold_text(self.threshold)]
        if self.tau is not None:
            parts.append(f"tau = {self.tau:g}")
        parts.append(f"m = {self.missions}")
        return ", ".join(parts)


class Criteria(Sequence[Criterion]):
    """An immutable, ordered set of criteria, answered together by one run of a method."""

    def __init__(self, criteria: Iterable[Criterion]) -> None:
        self._criteria = tuple(
            instance(f"criteria[{i}]", one, Criterion, "give a Criterion")
            for i, one in enumerate(listed("criteria", criteria, what="list of Criterion"))
        )
        if not self._criteria:
            raise refused("criteria", self._criteria, "give at least one Criterion")

    @overload
    def __getitem__(self, index: int) -> Criterion: ...
    @overload
    def __getitem__(self, index: slice) -> Criteria: ...
    def __getitem__(self, index: int | slice) -> Criterion | Criteria:
        if isinstance(index, slice):
            return Criteria(self._criteria[index])
        return self._criteria[index]

    def __len__(self) -> int:
        return len(self._criteria)

    def __iter__(self) -> Iterator[Criterion]:
        return iter(self._criteria)

    def __add__(self, other: Iterable[Criterion]) -> Criteria:
        return Criteria([*self._criteria, *other])

    def __eq__(self, other: object) -> bool:
        return isinstance(other, Criteria) and self._criteria == other._criteria

    def __hash__(self) -> int:
        return hash(self._criteria)

    def __repr__(self) -> str:
        return f"Criteria([{'; '.join(str(c) for c in self._criteria)}])"


def criteria(
    threshold: float | Iterable[float],
    tau: float | Iterable[float | None] | None = None,
    missions: Missions | Iterable[Missions] = 1,
) -> Criteria:
    """Build the grid of all combinations of thresholds, tau and mission profiles.

    Parameters
    ----------
    threshold
        One response threshold T or several, in the unit of the response.
    tau
        One synchronization threshold or several, in the same unit; None: not required.
    missions
        One mission profile or several: numbers m, or `Binomial(planned, p)`.

    Returns
    -------
    Criteria
        Thresholds run fastest, then missions, then tau.

    Examples
    --------
    >>> grid = criteria(threshold=[0.55, 0.56], tau=[None, 0.04], missions=[1, Binomial(10, 0.7)])
    >>> len(grid)
    8
    >>> print(grid[1])
    T = 0.56, m = 1
    """
    thresholds = _one_or_more("threshold", threshold)
    taus = _one_or_more("tau", tau)
    profiles = _one_or_more("missions", missions)
    return Criteria(Criterion(t, s, m) for s in taus for m in profiles for t in thresholds)


def _one_or_more(name: str, value: Any) -> tuple[Any, ...]:
    """Return the items of a list, or a value that is none as the only item."""
    one = isinstance(value, str | bytes | bytearray | Mapping)
    if one or not isinstance(value, Iterable) or getattr(value, "shape", None) == ():
        return (value,)
    items = tuple(value)
    if not items:
        raise refused(name, value, "give at least one value")
    return items
