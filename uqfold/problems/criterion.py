"""What "works" means: response threshold, synchronization threshold, mission profile."""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from typing import Any, TypeAlias, overload

import numpy as np


@dataclass(frozen=True)
class Binomial:
    """A binomial number of missions, Eq. (29): `planned` flights, each flown with probability `p`.

    Raises
    ------
    ValueError
        If `planned` is not a positive whole number or `p` is outside [0, 1].
    """

    planned: int
    p: float

    def __post_init__(self) -> None:
        if not _is_count(self.planned):
            raise ValueError(f"Binomial(planned={self.planned!r}): give a whole number >= 1")
        if not 0.0 <= self.p <= 1.0:
            raise ValueError(f"Binomial(p={self.p}): a probability lies in [0, 1]")
        object.__setattr__(self, "planned", int(self.planned))
        object.__setattr__(self, "p", float(self.p))

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
    ValueError
        If a value is NaN, tau is negative, or the number of missions is not a whole number >= 1.
    """

    threshold: float
    tau: float | None = None
    missions: Missions = 1

    def __post_init__(self) -> None:
        object.__setattr__(self, "threshold", float(self.threshold))
        if math.isnan(self.threshold):
            raise ValueError("threshold is NaN: give a number, or +-inf")
        if self.tau is not None:
            object.__setattr__(self, "tau", float(self.tau))
            if math.isnan(float(self.tau)) or float(self.tau) < 0.0:
                raise ValueError(f"tau = {self.tau}: give a number >= 0, or None")
        if not isinstance(self.missions, Binomial):
            if not _is_count(self.missions):
                raise ValueError(
                    f"missions = {self.missions!r}: give a whole number >= 1, or a Binomial"
                )
            object.__setattr__(self, "missions", int(self.missions))

    @property
    def max_missions(self) -> int:
        """The largest number of missions that can occur."""
        return self.missions.planned if isinstance(self.missions, Binomial) else self.missions

    def __str__(self) -> str:
        parts = [f"T = {self.threshold:g}"]
        if self.tau is not None:
            parts.append(f"tau = {self.tau:g}")
        parts.append(f"m = {self.missions}")
        return ", ".join(parts)


class Criteria(Sequence[Criterion]):
    """An immutable, ordered set of criteria, answered together by one run of a method."""

    def __init__(self, criteria: Iterable[Criterion]) -> None:
        self._criteria = tuple(criteria)
        wrong = [c for c in self._criteria if not isinstance(c, Criterion)]
        if wrong:
            raise TypeError(f"{wrong[0]!r} is not a Criterion")
        if not self._criteria:
            raise ValueError("no criterion: give at least one threshold")

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
    thresholds, taus, profiles = _listed(threshold), _listed(tau), _listed(missions)
    return Criteria(Criterion(t, s, m) for s in taus for m in profiles for t in thresholds)


def _is_count(value: object) -> bool:
    """Whether a value is a whole number >= 1, of whatever numeric type."""
    if isinstance(value, bool) or not isinstance(value, int | float | np.integer | np.floating):
        return False
    number = float(value)
    return number.is_integer() and number >= 1.0


def _listed(value: Any) -> list[Any]:
    scalar = isinstance(value, str) or (isinstance(value, np.ndarray) and value.ndim == 0)
    return list(value) if isinstance(value, Iterable) and not scalar else [value]
