"""Mixtures of normal distributions: where lines that lead to failure start.

The probability of failure along a line changes by orders of magnitude with the place where the
line runs, once a response bends in many directions. Places are therefore drawn wider, and further
to one side, than the inputs themselves, as far as lines tried before show that failure lies there
(cross-entropy, its first steps tempered so that no few of the lines carry all the weight).

References
----------
Rubinstein R. Y., Kroese D. P. The Cross-Entropy Method. Springer, 2004.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from uqfold.system.cross_rules import quasi_random_rule
from uqfold.typing import FloatArray

_LINES, _MOST_STEPS = 600, 10
# Coefficient of variation of the weights up to which places are taken for adapted.
_ADAPTED = 1.5
# Share of places that are drawn as the inputs are, whatever has been found.
_UNCHANGED = 0.2
# Variances are drawn towards their mean as by so many lines, and never fall below a floor.
_POOLED, _NARROWEST = 10.0, 0.05
_CLEAR = 2.0


@dataclass(frozen=True, eq=False)
class Places:
    """A density over standard-normal variables, relative to theirs.

    Attributes
    ----------
    means, variances
        Of K components (K, k), whose variables are independent.
    shares
        Probabilities (K,) of the components.
    """

    means: FloatArray
    variances: FloatArray
    shares: FloatArray

    @classmethod
    def unchanged(cls, dimension: int) -> Places:
        """The standard normal density itself."""
        return cls(np.zeros((1, dimension)), np.ones((1, dimension)), np.ones(1))

    @classmethod
    def of(cls, parts: list[tuple[float, Places]]) -> Places:
        """A mixture of mixtures, each with its share."""
        return cls(
            np.concatenate([one.means for _, one in parts]),
            np.concatenate([one.variances for _, one in parts]),
            np.concatenate([share * one.shares for share, one in parts]),
        )

    @classmethod
    def fitted(cls, places: FloatArray, weights: FloatArray) -> Places:
        """One component from weighted places (n, k)."""
        weights = weights / weights.sum()
        effective = 1.0 / float(weights @ weights)
        means = weights @ places
        variances = weights @ (places - means) ** 2
        own = effective / (effective + _POOLED)
        variances = own * variances + (1.0 - own) * variances.mean()
        variances = np.maximum(variances, _NARROWEST)
        # a mean that so few lines cannot tell from none would cost more than it gains
        means = np.where(means**2 > _CLEAR**2 * variances / effective, means, 0.0)
        return cls(means[None], variances[None], np.ones(1))

    def log_density(self, places: FloatArray) -> FloatArray:
        """Logarithm of the density (n,) relative to the standard normal one."""
        logs = [
            math.log(share)
            + 0.5 * (places**2 - (places - mean) ** 2 / variance - np.log(variance)).sum(axis=1)
            for share, mean, variance in zip(self.shares, self.means, self.variances, strict=True)
        ]
        return np.asarray(np.logaddexp.reduce(logs, axis=0))

    def draw(self, size: int, rng: np.random.Generator) -> FloatArray:
        """Draw places (size, k), independent of one another."""
        chosen = rng.choice(self.shares.size, size, p=self.shares / self.shares.sum())
        normal = rng.standard_normal((size, self.means.shape[1]))
        return np.asarray(self.means[chosen] + np.sqrt(self.variances[chosen]) * normal)

    def spread(self, size: int) -> FloatArray:
        """Return places (size, k) that fill the density evenly, always the same ones."""
        from scipy.special import ndtr

        normal = quasi_random_rule(self.means.shape[1] + 1, size)[0]
        edges = np.cumsum(self.shares / self.shares.sum())[:-1]
        chosen = np.searchsorted(edges, ndtr(normal[:, 0]))
        return np.asarray(self.means[chosen] + np.sqrt(self.variances[chosen]) * normal[:, 1:])


def failure_places(
    failing: Callable[[FloatArray], FloatArray], dimension: int, rng: np.random.Generator
) -> Places:
    """Find where lines lead to failure.

    Parameters
    ----------
    failing
        Takes places (n, k), gives the probability (T, n) of failure along the lines that start
        there, at T thresholds.
    dimension
        Number of variables k across the lines.
    rng
        Source of the places tried.
    """
    unchanged = Places.unchanged(dimension)
    start = unchanged.draw(_LINES, rng)
    first = failing(start)
    found = [(_UNCHANGED, unchanged)]
    share = (1.0 - _UNCHANGED) / first.shape[0]
    for threshold in range(first.shape[0]):
        places, probabilities, density = start, first[threshold], np.zeros(_LINES)
        adapted = unchanged
        for _ in range(_MOST_STEPS):
            if not probabilities.any():
                break
            power, weights = _tempered(probabilities, density)
            adapted = Places.fitted(places, weights)
            if power == 1.0:
                break
            places = adapted.draw(_LINES, rng)
            probabilities = failing(places)[threshold]
            density = adapted.log_density(places)
        found.append((share, adapted))
    return Places.of(found)


def _tempered(probabilities: FloatArray, log_density: FloatArray) -> tuple[float, FloatArray]:
    """Return the highest power of the probabilities, up to 1, that the lines bear, and weights."""
    with np.errstate(divide="ignore"):
        logs = np.log(probabilities)

    def weights(power: float) -> FloatArray:
        given = power * logs - log_density
        return np.asarray(np.exp(given - given.max()))

    if _variation(weights(1.0)) <= _ADAPTED:
        return 1.0, weights(1.0)
    low, high = 1e-3, 1.0
    for _ in range(20):
        middle = 0.5 * (low + high)
        low, high = (low, middle) if _variation(weights(middle)) > _ADAPTED else (middle, high)
    return low, weights(low)


def _variation(weights: FloatArray) -> float:
    return float(weights.std() / weights.mean())
