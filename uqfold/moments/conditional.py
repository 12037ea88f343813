"""What every conditional distribution of a response offers, and the one that does not scatter.

A conditional distribution describes the response y of one unit while the shared inputs are held
fixed. Without a synchronization threshold the system algebra needs its two tails only; with one
it integrates over the distribution, which takes a little more (`IntegrableDistribution`).
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple, Protocol, TypeGuard

import numpy as np
from numpy.typing import ArrayLike

from uqfold.typing import FloatArray


class AtCoordinate(NamedTuple):
    """A distribution at integration coordinates x, arrays of their shape.

    Attributes
    ----------
    y
        Response. Next to an end with infinite density many different x round to the end itself.
    density
        Probability per unit of x.
    cdf, sf
        Both tails, from x and not from the rounded y.
    """

    y: FloatArray
    density: FloatArray
    cdf: FloatArray
    sf: FloatArray


class ConditionalDistribution(Protocol):
    """Both tails of a response, each accurate on its own (no sf formed as 1 - cdf)."""

    @property
    def support(self) -> tuple[float, float]:
        """Ends of the support; finite where the distribution promises that no value lies beyond."""
        ...

    def cdf(self, y: ArrayLike) -> FloatArray:
        """P(Y <= y), same shape as y."""
        ...

    def sf(self, y: ArrayLike) -> FloatArray:
        """P(Y > y), same shape as y."""
        ...


class IntegrableDistribution(ConditionalDistribution, Protocol):
    """A distribution with a density that integrals can run over, and possibly atoms.

    Integrals run over an own coordinate x: the response itself wherever the density is bounded,
    and a rescaled probability next to an end where the density is infinite. The continuous part
    has mass `density` dx there, and `breakpoints` cut x into panels on which it is smooth.
    """

    @property
    def bounded(self) -> bool:
        """Whether the density is bounded, so that x is the response itself everywhere."""
        ...

    @property
    def breakpoints(self) -> FloatArray:
        """Increasing values of x that cover the continuous part; empty if there is none."""
        ...

    @property
    def atoms(self) -> tuple[FloatArray, FloatArray]:
        """Values of probability > 0 and these probabilities; empty for a continuous response."""
        ...

    def tails(self, y: ArrayLike) -> tuple[FloatArray, FloatArray]:
        """Return (cdf, sf) at once."""
        ...

    def pdf(self, y: ArrayLike) -> FloatArray:
        """Density of the continuous part at y."""
        ...

    def coordinate(self, y: ArrayLike) -> FloatArray:
        """Integration coordinate x of the response y."""
        ...

    def at_coordinate(self, x: ArrayLike) -> AtCoordinate:
        """Response, density and tails at the integration coordinate x."""
        ...

    def sample(self, rng: np.random.Generator, size: int | tuple[int, ...]) -> FloatArray:
        """Draw independent responses."""
        ...


def integrable(distribution: ConditionalDistribution) -> TypeGuard[IntegrableDistribution]:
    """Whether a distribution has a density that integrals can run over."""
    # one attribute tells: this is asked for every node of every surface, and comparing with all
    # members of a protocol would take longer than what follows
    return hasattr(distribution, "at_coordinate")


@dataclass(frozen=True)
class AtomicDistribution:
    """Finitely many values with given probabilities: a step where the response cannot scatter.

    Parameters
    ----------
    values : tuple of float
        Increasing values.
    probabilities : tuple of float
        Their probabilities, positive and summing to 1.
    """

    values: tuple[float, ...]
    probabilities: tuple[float, ...] = (1.0,)

    def __post_init__(self) -> None:
        values, probabilities = np.asarray(self.values), np.asarray(self.probabilities)
        if values.shape != probabilities.shape or values.ndim != 1 or values.size == 0:
            raise ValueError(
                f"values {self.values} and probabilities {self.probabilities} must pair up"
            )
        if not np.isfinite(values).all() or (np.diff(values) <= 0).any():
            raise ValueError(f"values {self.values} must be finite and increasing")
        if not (probabilities > 0).all() or abs(probabilities.sum() - 1.0) > 1e-12:
            raise ValueError(f"probabilities {self.probabilities} must be positive and sum to 1")

    @property
    def support(self) -> tuple[float, float]:
        """Smallest and largest value."""
        return self.values[0], self.values[-1]

    @property
    def bounded(self) -> bool:
        """Whether the density is bounded; without one, nothing can be infinite."""
        return True

    @property
    def breakpoints(self) -> FloatArray:
        """Where the density may break: nowhere, there is no continuous part."""
        return np.empty(0)

    @property
    def atoms(self) -> tuple[FloatArray, FloatArray]:
        """The values and their probabilities."""
        return np.asarray(self.values, dtype=float), np.asarray(self.probabilities, dtype=float)

    def tails(self, y: ArrayLike) -> tuple[FloatArray, FloatArray]:
        """Return (cdf, sf) at y."""
        values, probabilities = self.atoms
        index = np.searchsorted(values, np.asarray(y, dtype=float), side="right")
        below = np.concatenate([[0.0], np.cumsum(probabilities)])
        above = np.concatenate([np.cumsum(probabilities[::-1])[::-1], [0.0]])
        below[-1] = above[0] = 1.0
        missing = np.isnan(np.asarray(y, dtype=float))
        return (
            np.asarray(np.where(missing, np.nan, below[index])),
            np.asarray(np.where(missing, np.nan, above[index])),
        )

    def cdf(self, y: ArrayLike) -> FloatArray:
        """P(Y <= y)."""
        return self.tails(y)[0]

    def sf(self, y: ArrayLike) -> FloatArray:
        """P(Y > y)."""
        return self.tails(y)[1]

    def pdf(self, y: ArrayLike) -> FloatArray:
        """Zero: the whole mass sits in the atoms."""
        return np.zeros(np.shape(y))

    def ppf(self, p: ArrayLike) -> FloatArray:
        """Smallest value whose cdf reaches p."""
        values, probabilities = self.atoms
        index = np.searchsorted(np.cumsum(probabilities), np.asarray(p, dtype=float), side="left")
        return np.asarray(values[np.minimum(index, values.size - 1)])

    def coordinate(self, y: ArrayLike) -> FloatArray:
        """Return y."""
        return np.asarray(y, dtype=float)

    def at_coordinate(self, x: ArrayLike) -> AtCoordinate:
        """Nothing is to be integrated: density 0 everywhere."""
        return AtCoordinate(np.asarray(x, dtype=float), np.zeros(np.shape(x)), *self.tails(x))

    def sample(self, rng: np.random.Generator, size: int | tuple[int, ...]) -> FloatArray:
        """Draw values with their probabilities."""
        return np.asarray(rng.choice(self.atoms[0], size=size, p=self.atoms[1]))
