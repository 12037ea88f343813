"""Normal conditional distribution: the choice of earlier work on folding wings."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from uqfold.moments.conditional import AtCoordinate, AtomicDistribution
from uqfold.typing import FloatArray

# Beyond 38.5 standard deviations both density and tail underflow to zero.
_BREAKPOINTS = np.concatenate([[-38.5, -30.0, -22.0, -16.0], np.arange(-12.0, 12.5, 1.0)])
_BREAKPOINTS = np.concatenate([_BREAKPOINTS, [16.0, 22.0, 30.0, 38.5]])


@dataclass(frozen=True)
class NormalDistribution:
    """Normal distribution with given mean and standard deviation > 0 (unit of the response)."""

    mean: float
    std: float

    def __post_init__(self) -> None:
        if not (math.isfinite(self.mean) and math.isfinite(self.std) and self.std > 0):
            raise ValueError(
                f"mean {self.mean}, std {self.std}: both must be finite and std > 0; "
                "a response that does not scatter is built by from_moments"
            )

    @classmethod
    def from_moments(cls, mean: float, std: float) -> NormalDistribution | AtomicDistribution:
        """Build the normal distribution, or a step at the mean where std = 0."""
        if std == 0.0:
            return AtomicDistribution((mean,))
        return cls(mean, std)

    @property
    def support(self) -> tuple[float, float]:
        """The whole line."""
        return -math.inf, math.inf

    @property
    def bounded(self) -> bool:
        """Whether the density has a bound: that of a normal distribution has."""
        return True

    @property
    def breakpoints(self) -> FloatArray:
        """Panel edges for integrals, from -38.5 to 38.5 standard deviations."""
        return self.mean + self.std * _BREAKPOINTS

    @property
    def atoms(self) -> tuple[FloatArray, FloatArray]:
        """None."""
        return np.empty(0), np.empty(0)

    def _standardise(self, y: ArrayLike) -> FloatArray:
        return np.asarray((np.asarray(y, dtype=float) - self.mean) / self.std)

    def tails(self, y: ArrayLike) -> tuple[FloatArray, FloatArray]:
        """Return (cdf, sf) at y."""
        return self.cdf(y), self.sf(y)

    def cdf(self, y: ArrayLike) -> FloatArray:
        """P(Y <= y)."""
        from scipy.special import ndtr

        return np.asarray(ndtr(self._standardise(y)))

    def sf(self, y: ArrayLike) -> FloatArray:
        """P(Y > y)."""
        from scipy.special import ndtr

        return np.asarray(ndtr(-self._standardise(y)))

    def logpdf(self, y: ArrayLike) -> FloatArray:
        """Logarithm of the density (per unit of the response)."""
        z = self._standardise(y)
        return np.asarray(-0.5 * z**2 - math.log(self.std * math.sqrt(2 * math.pi)))

    def pdf(self, y: ArrayLike) -> FloatArray:
        """Density (per unit of the response)."""
        return np.asarray(np.exp(self.logpdf(y)))

    def ppf(self, p: ArrayLike) -> FloatArray:
        """Value that the response exceeds with probability 1 - p."""
        from scipy.special import ndtri

        return np.asarray(self.mean + self.std * ndtri(np.asarray(p, dtype=float)))

    def coordinate(self, y: ArrayLike) -> FloatArray:
        """Return y: the density is bounded."""
        return np.asarray(y, dtype=float)

    def at_coordinate(self, x: ArrayLike) -> AtCoordinate:
        """Response x itself with density and tails."""
        return AtCoordinate(np.asarray(x, dtype=float), self.pdf(x), *self.tails(x))

    def sample(self, rng: np.random.Generator, size: int | tuple[int, ...]) -> FloatArray:
        """Independent draws."""
        return np.asarray(rng.normal(self.mean, self.std, size))
