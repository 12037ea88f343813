"""Mixtures of von Mises-Fisher distributions: where on a sphere failure lies.

References
----------
Papaioannou I., Geyer S., Straub D. Improved cross entropy-based importance sampling with a
flexible mixture model. Reliability Engineering & System Safety 191 (2019) 106564.
Wood A. T. A. Simulation of the von Mises Fisher distribution. Communications in Statistics,
Simulation and Computation 23 (1994) 157-164.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from uqfold.typing import FloatArray

SMALLEST = 1e-9
"""Concentration below which a law is uniform to the computer."""
_STEPS = 15
_SMALLEST_SHARE = 1e-3
# Mean lengths above this would make a component so narrow that it forgets its surroundings.
_LONGEST = 0.995


@dataclass(frozen=True, eq=False)
class DirectionMixture:
    """A density over the unit sphere in d dimensions.

    Attributes
    ----------
    means
        Unit vectors (K, d).
    concentrations
        Numbers >= 0 (K,); with 0 a component is uniform.
    shares
        Probabilities (K,) of the components.
    """

    means: FloatArray
    concentrations: FloatArray
    shares: FloatArray

    @classmethod
    def uniform(cls, dimension: int) -> DirectionMixture:
        """The uniform density."""
        return cls(np.eye(dimension)[:1], np.zeros(1), np.ones(1))

    @classmethod
    def of(cls, parts: list[tuple[float, DirectionMixture]]) -> DirectionMixture:
        """A mixture of mixtures, each with its share."""
        return cls(
            np.concatenate([one.means for _, one in parts]),
            np.concatenate([one.concentrations for _, one in parts]),
            np.concatenate([share * one.shares for share, one in parts]),
        )

    @classmethod
    def fitted(
        cls, directions: FloatArray, weights: FloatArray, count: int, rng: np.random.Generator
    ) -> DirectionMixture:
        """Fit at most `count` components to weighted directions (n, d), by expectation maximised.

        Raises
        ------
        ValueError
            If no direction has any weight.
        """
        d = directions.shape[1]
        weights = weights / weights.sum()
        starts = far_apart(directions, weights, count, rng)
        k = len(starts)
        found = cls(starts, np.full(k, 2.0 * d), np.full(k, 1.0 / k))
        for _ in range(_STEPS):
            logs = found._component_logs(directions)
            belongs = np.exp(logs - np.logaddexp.reduce(logs, axis=1)[:, None])
            belongs *= weights[:, None]
            shares = belongs.sum(axis=0)
            kept = shares > _SMALLEST_SHARE
            sums = belongs[:, kept].T @ directions
            lengths = np.linalg.norm(sums, axis=1)
            shares = shares[kept]
            mean_length = np.clip(lengths / shares, 1e-6, _LONGEST)
            found = cls(
                sums / lengths[:, None],
                # Banerjee et al. (2005), Eq. (4.4)
                (mean_length * d - mean_length**3) / (1.0 - mean_length**2),
                shares / shares.sum(),
            )
        return found

    def log_density(self, directions: FloatArray) -> FloatArray:
        """Logarithm of the density (n,) relative to the uniform one."""
        logs = self._component_logs(directions)
        return np.asarray(np.logaddexp.reduce(logs, axis=1))

    def draw(self, size: int, rng: np.random.Generator) -> FloatArray:
        """Draw directions (size, d), independent of one another."""
        chosen = rng.choice(self.shares.size, size, p=self.shares / self.shares.sum())
        drawn = np.empty((size, self.means.shape[1]))
        for k in np.unique(chosen):
            mine = np.flatnonzero(chosen == k)
            drawn[mine] = around(self.means[k], float(self.concentrations[k]), mine.size, rng)
        return drawn

    def _component_logs(self, directions: FloatArray) -> FloatArray:
        normaliser = log_normaliser(self.concentrations, directions.shape[1])
        return np.asarray(
            np.log(self.shares) + normaliser + (directions @ self.means.T) * self.concentrations
        )


def log_normaliser(concentration: FloatArray, d: int) -> FloatArray:
    """Logarithm of the factor that makes exp(concentration * cosine) a density, uniform: 0."""
    from scipy.special import gammaln, ive

    order = 0.5 * d - 1.0
    # nothing changes below, and zero has no logarithm
    concentration = np.maximum(concentration, SMALLEST)
    with np.errstate(divide="ignore"):
        bessel = np.log(ive(order, concentration)) + concentration
    # far below the order the scaled function is zero to the computer; its series is not
    lost = ~np.isfinite(bessel)
    bessel[lost] = [_log_bessel_series(order, one) for one in concentration[lost].tolist()]
    return np.asarray(order * np.log(0.5 * concentration) - gammaln(order + 1.0) - bessel)


def _log_bessel_series(order: float, argument: float) -> float:
    """Logarithm of the modified Bessel function by its power series."""
    from scipy.special import gammaln, logsumexp

    # its largest terms come before k = argument / 2
    k = np.arange(50 + int(argument))
    terms = (2.0 * k + order) * math.log(0.5 * argument)
    return float(logsumexp(terms - gammaln(k + 1.0) - gammaln(k + order + 1.0)))


def around(
    mean: FloatArray, concentration: float, size: int, rng: np.random.Generator
) -> FloatArray:
    """Draw unit vectors (size, d) about a mean direction (Wood 1994)."""
    d = mean.size
    if d == 1:
        same = rng.random(size) < 1.0 / (1.0 + math.exp(-2.0 * concentration))
        return np.asarray(np.where(same, mean[0], -mean[0])[:, None])
    root = math.hypot(2.0 * concentration, d - 1.0)
    b = (d - 1.0) / (root + 2.0 * concentration)
    x = (1.0 - b) / (1.0 + b)
    c = concentration * x + (d - 1.0) * math.log1p(-x * x)
    cosine = np.empty(size)
    waiting = np.arange(size)
    while waiting.size:
        z = rng.beta(0.5 * (d - 1.0), 0.5 * (d - 1.0), waiting.size)
        tried = (1.0 - (1.0 + b) * z) / (1.0 - (1.0 - b) * z)
        level = concentration * tried + (d - 1.0) * np.log1p(-x * tried) - c
        taken = level >= np.log(rng.random(waiting.size))
        cosine[waiting[taken]] = tried[taken]
        waiting = waiting[~taken]
    across = rng.standard_normal((size, d))
    across -= np.outer(across @ mean, mean)
    across /= np.maximum(np.linalg.norm(across, axis=1, keepdims=True), 1e-300)
    sine = np.sqrt(np.maximum(0.0, 1.0 - cosine**2))
    return np.asarray(cosine[:, None] * mean + sine[:, None] * across)


def far_apart(
    directions: FloatArray, weights: FloatArray, count: int, rng: np.random.Generator
) -> FloatArray:
    """Choose at most `count` of some directions (n, d), far from one another (k-means++).

    The weights (n,) sum to one.
    """
    chosen = [directions[rng.choice(weights.size, p=weights)]]
    for _ in range(count - 1):
        nearest = (1.0 - directions @ np.array(chosen).T).min(axis=1)
        share = np.maximum(nearest, 0.0) * weights
        if not share.sum() > 0.0:
            break
        chosen.append(directions[rng.choice(weights.size, p=share / share.sum())])
    return np.array(chosen)
