"""Inputs that take single values with positive probability: discrete ones, and mixed ones.

Such a value, an atom, has a whole interval of standard-normal values to itself, so that the map
from these to the input is a function with steps. Probabilities are summed up from both ends, which
keeps the digits of both tails.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
from scipy.special import ndtr, ndtri

from uqfold.inputs.behind import family_of
from uqfold.inputs.counts import LISTED, MISSING, joined, parts_of, table_of
from uqfold.inputs.engine import openturns
from uqfold.inputs.marginal import Marginal, called
from uqfold.typing import FloatArray

_FURTHEST, _NUDGE, _NOTHING = 8.0, 1e-3, 1e-6
"""How a gap beside an atom is seen: of what lies between it and the value so small a normal step
away, less than this share lies in the nearer half."""
_SHOWN = 5
"""Values of a discrete distribution that are shown one by one."""


@dataclass(frozen=True, eq=False)
class SteppedMarginal(Marginal):
    """An input with atoms; see `DiscreteMarginal` and `MixedMarginal`.

    Attributes
    ----------
    distribution
        See `Marginal`.
    values, probabilities
        The atoms (k,), increasing, and their probabilities (k,), all positive.
    """

    values: FloatArray
    probabilities: FloatArray

    @property
    def atoms(self) -> tuple[FloatArray, FloatArray]:
        """See `Marginal`."""
        return self.values, self.probabilities

    @cached_property
    def _sums(self) -> tuple[FloatArray, FloatArray]:
        """Probabilities (k + 1,) of the atoms before each place between them, and after it."""
        below = np.concatenate([[0.0], np.cumsum(self.probabilities)])
        above = np.concatenate([np.cumsum(self.probabilities[::-1])[::-1], [0.0]])
        return below, above

    def _probability(self, x: FloatArray) -> FloatArray:
        """Probabilities (n,) of single values x."""
        at = np.minimum(np.searchsorted(self.values, x), len(self.values) - 1)
        return np.where(self.values[at] == x, self.probabilities[at], 0.0)

    def to_normal(self, x: FloatArray) -> FloatArray:
        """See `Marginal`; for an atom the middle of its probability."""
        half = 0.5 * self._probability(x)
        return _score(self.cdf(x) - half, self.sf(x) + half)

    def with_moments(self, mean: float, std: float) -> Any:
        """See `Marginal`.

        Raises
        ------
        ValueError
            Always: what other moments would make of atoms is not known.
        """
        raise ValueError(
            f"{self} takes single values: it has no other mean or standard deviation, give another "
            "distribution"
        )


class DiscreteMarginal(SteppedMarginal):
    """An input that takes single values only, such as a count or a category."""

    @property
    def steps(self) -> bool:
        """See `Marginal`."""
        return True

    @cached_property
    def _edges(self) -> FloatArray:
        """Standard-normal values (k - 1,) at which the input goes on to its next value."""
        below, above = self._sums
        return _score(below[1:-1], above[1:-1])

    def from_normal(self, u: FloatArray) -> FloatArray:
        """See `Marginal`."""
        return np.where(np.isnan(u), np.nan, self.values[np.searchsorted(self._edges, u)])

    def cdf(self, x: FloatArray) -> FloatArray:
        """See `Marginal`."""
        return np.asarray(self._sums[0][np.searchsorted(self.values, x, side="right")])

    def sf(self, x: FloatArray) -> FloatArray:
        """See `Marginal`."""
        return np.asarray(self._sums[1][np.searchsorted(self.values, x, side="right")])

    def log_pdf(self, x: FloatArray) -> FloatArray:
        """Return the logarithm of the probability (n,) of x (n,)."""
        with np.errstate(divide="ignore"):
            return np.asarray(np.log(self._probability(x)))

    @property
    def bounds(self) -> tuple[float, float]:
        """See `Marginal`; of counts without end the last one whose probability is a number."""
        return float(self.values[0]), float(self.values[-1])

    @cached_property
    def moments(self) -> tuple[float, float]:
        """See `Marginal`."""
        mean = float(self.probabilities @ self.values)
        return mean, float(np.sqrt(self.probabilities @ (self.values - mean) ** 2))

    def __str__(self) -> str:
        own, family = family_of(self.distribution)
        if family != LISTED:
            return str(self.distribution)
        if own.getName() not in ("", "Unnamed", family):
            return str(own.getName())
        return f"discrete({_listed(self.values, self.probabilities)})"


@dataclass(frozen=True, eq=False)
class MixedMarginal(SteppedMarginal):
    """An input with atoms and a continuous part, such as the larger of zero and a normal variable.

    Attributes
    ----------
    distribution, values, probabilities
        See `SteppedMarginal`.
    rest
        Distribution of the continuous part.
    """

    rest: Marginal

    @cached_property
    def _weight(self) -> float:
        return float(1.0 - self.probabilities.sum())

    @cached_property
    def steps(self) -> bool:
        """See `Marginal`; none where the continuous part comes up to its atoms on both sides."""
        for edges, side in zip(self._edges, (-1.0, 1.0), strict=True):
            near = np.abs(edges) < _FURTHEST
            atom, next_to = self.values[near], self.from_normal(edges[near] + side * _NUDGE)
            p, half, there = (self.rest.cdf(x) for x in (atom, 0.5 * (atom + next_to), next_to))
            if (np.abs(half - p) < _NOTHING * np.abs(there - p)).any():
                return True
        return False

    @cached_property
    def _edges(self) -> tuple[FloatArray, FloatArray]:
        """Standard-normal values between which each atom lies, each (k,)."""
        cdf, sf = self.cdf(self.values), self.sf(self.values)
        own = self.probabilities
        return _score(cdf - own, sf + own), _score(cdf, sf)

    def from_normal(self, u: FloatArray) -> FloatArray:
        """See `Marginal`."""
        first, last = self._edges
        at = np.searchsorted(last, u)
        before, after = (sums[at] for sums in self._sums)
        lower = u <= 0.0
        # what is left of the probability is that of the continuous part
        below, above = (ndtr(u) - before) / self._weight, (ndtr(-u) - after) / self._weight
        below, above = np.where(lower, below, 1.0 - above), np.where(lower, 1.0 - below, above)
        x = self.rest.from_normal(_score(below, above))
        ends = np.concatenate([[-np.inf], self.values, [np.inf]])
        x = np.clip(x, ends[at], ends[at + 1])
        on = np.minimum(at, len(self.values) - 1)
        return np.where((at < len(self.values)) & (u >= first[on]), self.values[on], x)

    def cdf(self, x: FloatArray) -> FloatArray:
        """See `Marginal`."""
        atoms = self._sums[0][np.searchsorted(self.values, x, side="right")]
        return np.asarray(atoms + self._weight * self.rest.cdf(x))

    def sf(self, x: FloatArray) -> FloatArray:
        """See `Marginal`."""
        atoms = self._sums[1][np.searchsorted(self.values, x, side="right")]
        return np.asarray(atoms + self._weight * self.rest.sf(x))

    def log_pdf(self, x: FloatArray) -> FloatArray:
        """Return the logarithm of the density (n,) at x (n,); of the probability of an atom."""
        p = self._probability(x)
        density = np.log(self._weight) + self.rest.log_pdf(x)
        return np.where(p > 0.0, np.log(np.where(p > 0.0, p, 1.0)), density)

    @property
    def bounds(self) -> tuple[float, float]:
        """See `Marginal`."""
        low, high = self.rest.bounds
        return min(low, float(self.values[0])), max(high, float(self.values[-1]))

    @cached_property
    def moments(self) -> tuple[float, float]:
        """See `Marginal`."""
        own_mean, own_std = self.rest.moments
        p, weight = self.probabilities, self._weight
        mean = float(p @ self.values) + weight * own_mean
        spread = p @ (self.values - mean) ** 2 + weight * (own_std**2 + (own_mean - mean) ** 2)
        return mean, float(np.sqrt(spread))

    def __str__(self) -> str:
        atoms = _listed(self.values, self.probabilities)
        return f"mixture({atoms}, {self._weight:.4g} of {self.rest})"


def discrete_marginal(distribution: Any) -> DiscreteMarginal:
    """Return a discrete OpenTURNS distribution as a table of its values.

    Raises
    ------
    ValueError
        If it takes a single value or too many, or its probabilities do not add up.
    """
    values, probabilities = table_of(distribution)
    found = DiscreteMarginal(distribution, values, probabilities)
    if len(values) < 2:
        raise ValueError(f"it takes the value {values[0]:g} only: make that a part of the model")
    some = found.from_normal(np.linspace(-6.0, 6.0, 25))
    stated = called(distribution.computeCDF, some[:, None]).ravel()
    if not (apart := np.abs(found.cdf(some) - stated)).max() <= MISSING:
        at = int(np.argmax(apart))
        raise ValueError(
            f"its distribution function is {stated[at]:.6g} at {some[at]:g}, where the "
            f"probabilities of its values add up to {found.cdf(some)[at]:.6g}"
        )
    return found


def mixed_marginal(
    distribution: Any, checked: Callable[[Any], Marginal]
) -> DiscreteMarginal | MixedMarginal | None:
    """Return a mixture of discrete and continuous OpenTURNS distributions, or None if it is none.

    Parameters
    ----------
    distribution
        The distribution.
    checked
        Makes a `Marginal` of a continuous one.

    Raises
    ------
    ValueError
        As `discrete_marginal` and `checked` do.
    """
    ot = openturns()
    parts = list(parts_of(distribution))
    steps = [(weight, part) for weight, part in parts if part.isDiscrete()]
    smooth = [(weight, part) for weight, part in parts if part.isContinuous()]
    if len(steps) + len(smooth) < len(parts) or not (steps and smooth):
        return None
    rest = ot.Mixture([part for _, part in smooth], [weight for weight, _ in smooth])
    values, probabilities = joined([(weight, table_of(part)) for weight, part in steps])
    own = checked(smooth[0][1] if len(smooth) == 1 else rest)
    return MixedMarginal(distribution, values, probabilities, own)


def _score(below: FloatArray, above: FloatArray) -> FloatArray:
    """Standard-normal values of lower and upper probabilities, which add up to one."""
    smaller = ndtri(np.clip(np.minimum(below, above), 0.0, 1.0))
    return np.asarray(np.where(below < above, smaller, -smaller))


def _listed(values: FloatArray, probabilities: FloatArray) -> str:
    if len(values) > _SHOWN:
        return f"{len(values):,} values from {values[0]:g} to {values[-1]:g}"
    return ", ".join(f"{x:g}: {p:.4g}" for x, p in zip(values, probabilities, strict=True))
