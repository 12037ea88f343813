"""How places are distributed along a line: normal on lines in a direction, chi on rays."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from uqfold.typing import FloatArray

TOLERANCE = 2e-3
"""How well a crossing is known, relative to the smallest of the probabilities on its two sides and
that of the event."""

Tail = Callable[[FloatArray], FloatArray]


@dataclass(frozen=True)
class LineLaw:
    """How places are distributed along a line.

    Attributes
    ----------
    below, above
        Probabilities (k,) of lower and of larger places than those given (k,).
    density
        Their density (k,).
    place
        The places (k,) that are exceeded with some probabilities (k,).
    event
        Probability of what is looked for, as far as it is known.
    """

    below: Tail
    above: Tail
    density: Tail
    place: Tail
    event: float = 1.0

    def between(self, start: FloatArray, end: FloatArray) -> FloatArray:
        """Probabilities (k,) of the places from start (k,) to end (k,), by the nearer tail."""
        low, high = self.below(start), self.above(start)
        by_low, by_high = self.below(end) - low, high - self.above(end)
        return np.maximum(0.0, np.where(low < high, by_low, by_high))

    def tolerance(self, at: FloatArray) -> FloatArray:
        """How well crossings at some places (k,) are to be known, in standard deviations."""
        density = self.density(at)
        smaller = np.minimum(np.minimum(self.below(at), self.above(at)), self.event)
        with np.errstate(divide="ignore", invalid="ignore"):
            known = TOLERANCE * smaller / density
        return np.where(np.isfinite(known) & (known > 0.0), known, TOLERANCE)


def normal_law() -> LineLaw:
    """Return the standard normal law, that of places along a line in any direction."""
    from scipy.special import ndtr, ndtri

    return LineLaw(
        below=ndtr,
        above=lambda at: np.asarray(ndtr(-at)),
        density=lambda at: np.asarray(np.exp(-0.5 * at**2) / math.sqrt(2.0 * math.pi)),
        place=lambda share: np.asarray(-ndtri(share)),
    )


def chi_law(dimension: int) -> LineLaw:
    """Return the law of distances from the origin in standard-normal space."""
    from scipy.special import chdtr, chdtrc, chdtri, gammaln

    constant = (0.5 * dimension - 1.0) * math.log(2.0) + float(gammaln(0.5 * dimension))

    def density(at: FloatArray) -> FloatArray:
        with np.errstate(divide="ignore"):
            logs = (dimension - 1.0) * np.log(at) - 0.5 * at**2 - constant
        return np.asarray(np.exp(logs))

    return LineLaw(
        below=lambda at: np.asarray(chdtr(dimension, np.maximum(at, 0.0) ** 2)),
        above=lambda at: np.asarray(chdtrc(dimension, np.maximum(at, 0.0) ** 2)),
        density=density,
        place=lambda share: np.asarray(np.sqrt(chdtri(dimension, share))),
    )
