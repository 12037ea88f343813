"""Pearson distributions with given first four moments (Eqs. 41-42)."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import ArrayLike

from uqfold.moments.conditional import AtCoordinate, AtomicDistribution
from uqfold.moments.pearson_table import PearsonTable
from uqfold.moments.pearson_types import PearsonEquation, check_moments, is_two_point
from uqfold.typing import FloatArray

# A lower tail of this depth is kept as breakpoints every panel, a deeper one every fourth.
_BODY = 1e-18


class PearsonDistribution:
    """Member of the Pearson family with given mean, std (> 0), skewness and kurtosis.

    Build it with `from_moments`, which also answers the cases without a density. All types are
    covered, chosen by the moments: normal, I (also J- and U-shaped), II, III, IV, V, VI, VII.

    Attributes
    ----------
    mean, std
        In the unit of the response.
    skewness, kurtosis
        Standardised; kurtosis is 3 for a normal.
    type
        Pearson's name of the type.
    support
        Ends in the unit of the response. Beyond a finite end the probability is exactly zero,
        a property of the fitted family and not of the response: a pf of 0 there deserves doubt.
    """

    def __init__(self, mean: float, std: float, skewness: float, kurtosis: float) -> None:
        check_moments(mean, std, skewness, kurtosis)
        if std == 0 or is_two_point(skewness, kurtosis):
            raise ValueError(
                f"std {std}, skewness {skewness}, kurtosis {kurtosis}: these moments belong to a "
                "distribution without a density; build it with PearsonDistribution.from_moments"
            )
        self.mean, self.std = float(mean), float(std)
        self.skewness, self.kurtosis = float(skewness), float(kurtosis)
        # Skewness < 0 is the mirror image. Below 1e-100 its square underflows: symmetric.
        self._mirror = -1.0 if skewness < 0 else 1.0
        magnitude = abs(self.skewness)
        equation = PearsonEquation(magnitude if magnitude > 1e-100 else 0.0, self.kurtosis)
        self.type = equation.type
        self._table = PearsonTable(equation)
        lower, upper = equation.ends
        ends = (
            -math.inf if lower is None else lower.position,
            math.inf if upper is None else upper.position,
        )
        if self._mirror < 0:
            ends = -ends[1], -ends[0]
        self.support = (self.mean + self.std * ends[0], self.mean + self.std * ends[1])

    @classmethod
    def from_moments(
        cls, mean: float, std: float, skewness: float, kurtosis: float
    ) -> PearsonDistribution | AtomicDistribution:
        """Distribution with these four moments.

        Returns
        -------
        PearsonDistribution, or AtomicDistribution
            A step at the mean for std = 0; the two-point distribution for kurtosis =
            skewness^2 + 1, the limit of the U-shaped type I.

        Raises
        ------
        ImpossibleMomentsError
            If a value is not finite, std < 0, or kurtosis < skewness^2 + 1.
        """
        check_moments(mean, std, skewness, kurtosis)
        if std == 0:
            return AtomicDistribution((float(mean),))
        if is_two_point(skewness, kurtosis):
            root = math.sqrt(skewness**2 + 4.0)
            # z_1 z_2 = -1 and z_1 + z_2 = skewness; the larger root in size first.
            far = 0.5 * (skewness + math.copysign(root, skewness))
            z = sorted((far, -1.0 / far))
            share = 1.0 / (1.0 + z[0] ** 2), 1.0 / (1.0 + z[1] ** 2)
            return AtomicDistribution((mean + std * z[0], mean + std * z[1]), share)
        return cls(mean, std, skewness, kurtosis)

    def __repr__(self) -> str:
        return (
            f"PearsonDistribution(mean={self.mean}, std={self.std}, skewness={self.skewness}, "
            f"kurtosis={self.kurtosis}, type={self.type!r})"
        )

    def _standardise(self, y: ArrayLike) -> FloatArray:
        return np.asarray(self._mirror * ((np.asarray(y, dtype=float) - self.mean) / self.std))

    def _response(self, z: FloatArray) -> FloatArray:
        y = self.mean + self.std * (self._mirror * z)
        return np.asarray(np.clip(y, *self.support))

    def tails(self, y: ArrayLike) -> tuple[FloatArray, FloatArray]:
        """Return (cdf, sf) at y, same shape as y; each is accurate down to 1e-300."""
        cdf, sf = self._table.tails(self._standardise(y))
        return (cdf, sf) if self._mirror > 0 else (sf, cdf)

    def cdf(self, y: ArrayLike) -> FloatArray:
        """P(Y <= y)."""
        return self.tails(y)[0]

    def sf(self, y: ArrayLike) -> FloatArray:
        """P(Y > y), not formed as 1 - cdf."""
        return self.tails(y)[1]

    def logpdf(self, y: ArrayLike) -> FloatArray:
        """Logarithm of the density; -inf outside the support, +inf at an infinite end."""
        return np.asarray(self._table.log_density(self._standardise(y)) - math.log(self.std))

    def pdf(self, y: ArrayLike) -> FloatArray:
        """Density (per unit of the response)."""
        return np.asarray(np.exp(self.logpdf(y)))

    def ppf(self, p: ArrayLike) -> FloatArray:
        """Value with P(Y <= value) = p, for 0 <= p <= 1; the ends of the support at 0 and 1."""
        p = np.asarray(p, dtype=float)
        return self._quantile(p, 1.0 - p)

    def isf(self, p: ArrayLike) -> FloatArray:
        """Value with P(Y > value) = p, for 0 <= p <= 1; p may be as small as 1e-300."""
        p = np.asarray(p, dtype=float)
        return self._quantile(1.0 - p, p)

    def _quantile(self, cdf: FloatArray, sf: FloatArray) -> FloatArray:
        if not ((cdf >= 0) & (sf >= 0)).all():
            raise ValueError("a probability lies outside [0, 1]")
        ends = self.support
        if self._mirror < 0:
            cdf, sf = sf, cdf
            ends = ends[1], ends[0]
        y = self._response(self._table.quantile(np.ravel(cdf), np.ravel(sf))).reshape(cdf.shape)
        return np.asarray(np.where(cdf == 0, ends[0], np.where(sf == 0, ends[1], y)))

    def sample(self, rng: np.random.Generator, size: int | tuple[int, ...]) -> FloatArray:
        """Independent draws by inverse transform, as section 3.2.2 of the paper proposes."""
        u = np.asarray(rng.random(size))
        # Both tails get the full resolution of the generator: fold u at 1/2.
        half = 0.5 * np.asarray(rng.random(size))
        return self._quantile(*_folded(u, half))

    @property
    def atoms(self) -> tuple[FloatArray, FloatArray]:
        """None: the distribution is continuous."""
        return np.empty(0), np.empty(0)

    @property
    def bounded(self) -> bool:
        """Whether the density is finite at both ends of the support."""
        strips = (self._table.lower, self._table.upper)
        return all(strip is None or strip.end.exponent >= 1.0 for strip in strips)

    @property
    def breakpoints(self) -> FloatArray:
        """Integration coordinates of the panel edges, thinned in the far tails."""
        table = self._table
        edges = table.edges
        far = np.minimum(table.below, table.above) < _BODY
        keep = ~far | (np.arange(edges.size) % 4 == 0)
        keep[[0, -1]] = True
        z = edges[keep]
        if table.lower is not None:
            z = np.concatenate([table.lower.breakpoints, z])
        if table.upper is not None:
            z = np.concatenate([z, table.upper.breakpoints[::-1]])
        y = self.mean + self.std * self._mirror * z
        return np.asarray(y if self._mirror > 0 else y[::-1])

    def coordinate(self, y: ArrayLike) -> FloatArray:
        """Return y, or its rescaled probability next to an end with infinite density."""
        z = self._standardise(y)
        x = z.copy()
        for strip in (self._table.lower, self._table.upper):
            if strip is not None and strip.end.exponent < 1.0:
                distance = (z - strip.end.position) * strip.end.inside
                near = distance < strip.width
                share = strip.inner(distance) / strip.mass
                moved = strip.end.position + strip.end.inside * strip.width * share
                x = np.where(near, moved, x)
        return np.asarray(self.mean + self.std * self._mirror * x)

    def at_coordinate(self, x: ArrayLike) -> AtCoordinate:
        """Response, density and tails at integration coordinates x."""
        table, coordinate = self._table, self._standardise(x)
        z = coordinate.copy()
        density = np.exp(table.log_density(coordinate))
        cdf, sf = table.tails(coordinate)
        for strip in (table.lower, table.upper):
            if strip is not None and strip.end.exponent < 1.0:
                distance = (coordinate - strip.end.position) * strip.end.inside
                near = distance < strip.width
                mass = strip.mass * np.clip(distance[near] / strip.width, 0.0, 1.0)
                away = strip.distance(mass)
                z[near] = strip.end.position + strip.end.inside * away
                density[near] = np.where(distance[near] < 0, 0.0, strip.mass / strip.width)
                rest = (strip.mass - mass) + (
                    table.above[0] if strip is table.lower else table.below[-1]
                )
                cdf[near], sf[near] = (mass, rest) if strip is table.lower else (rest, mass)
        if self._mirror < 0:
            cdf, sf = sf, cdf
        return AtCoordinate(self._response(z), np.asarray(density / self.std), cdf, sf)


def _folded(u: FloatArray, half: FloatArray) -> tuple[FloatArray, FloatArray]:
    """(cdf, sf) of a uniform variable: the side from u, the depth from `half` in [0, 1/2)."""
    below = u < 0.5
    return np.where(below, half, 1.0 - half), np.where(below, 1.0 - half, half)
