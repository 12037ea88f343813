"""Marginals that are computed without OpenTURNS: closed forms, and what is cut out of them."""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
from scipy import special

from uqfold.inputs.behind import family_of
from uqfold.inputs.engine import openturns
from uqfold.inputs.families import FAMILIES, Maps, normal_of
from uqfold.inputs.marginal import Marginal, OpenTURNSMarginal, beyond
from uqfold.inputs.moments import checked_moments
from uqfold.typing import FloatArray

_NODES, _REACH, _PANELS = 24, 37.0, 300
"""Of the integration of moments, over all probabilities down to 1e-299."""


def closed_form(distribution: Any) -> Marginal | None:
    """Return the closed form of an OpenTURNS distribution, or None where we have none."""
    own, family = family_of(distribution)
    if family in FAMILIES:
        return ClosedMarginal(distribution)
    if family == "TruncatedNormal":
        base = openturns().Normal(own.getMu(), own.getSigma())
        return TruncatedMarginal(distribution, ClosedMarginal(base), own.getA(), own.getB())
    if family == "TruncatedDistribution":
        base = own.getDistribution()
        cut = closed_form(base) or OpenTURNSMarginal(base)
        bounds = own.getBounds()
        low, high = bounds.getLowerBound()[0], bounds.getUpperBound()[0]
        return TruncatedMarginal(
            distribution,
            cut,
            low if bounds.getFiniteLowerBound()[0] else -math.inf,
            high if bounds.getFiniteUpperBound()[0] else math.inf,
        )
    return None


class ClosedMarginal(OpenTURNSMarginal):
    """A family in closed form; what takes no time, and the density, are OpenTURNS' own."""

    @cached_property
    def _maps(self) -> Maps:
        own, family = family_of(self.distribution)
        return FAMILIES[family](own)

    def from_normal(self, u: FloatArray) -> FloatArray:
        """See `Marginal`."""
        with np.errstate(all="ignore"):
            return np.asarray(self._maps[0](u))

    def to_normal(self, x: FloatArray) -> FloatArray:
        """See `Marginal`."""
        with np.errstate(all="ignore"):
            return beyond(self.bounds, x, self._maps[1](x))


@dataclass(frozen=True, eq=False)
class TruncatedMarginal(Marginal):
    """A distribution between two bounds: a truncated normal variable, mapped as the base is.

    Attributes
    ----------
    distribution
        See `Marginal`.
    base
        The distribution that is cut.
    low, high
        The bounds, either of which may be infinite.
    """

    base: Marginal
    low: float
    high: float

    @property
    def bounds(self) -> tuple[float, float]:
        """See `Marginal`."""
        low, high = self.base.bounds
        return max(low, self.low), min(high, self.high)

    @property
    def kinks(self) -> FloatArray:
        """See `Marginal`."""
        inside = (self.base.kinks > self.low) & (self.base.kinks < self.high)
        return np.asarray(self.base.kinks[inside])

    @cached_property
    def _ends(self) -> tuple[FloatArray, FloatArray]:
        """Standard-normal values of the bounds under the base, each (1,)."""
        low, high = self.base.to_normal(np.array([self.low, self.high]))
        return np.array([low]), np.array([high])

    @cached_property
    def _mass(self) -> float:
        """Logarithm of the probability between the bounds under the base."""
        return float(_log_between(*self._ends)[0])

    def from_normal(self, u: FloatArray) -> FloatArray:
        """See `Marginal`."""
        low, high = self._ends
        below = np.logaddexp(special.log_ndtr(low), special.log_ndtr(u) + self._mass)
        above = np.logaddexp(special.log_ndtr(-high), special.log_ndtr(-u) + self._mass)
        return np.clip(self.base.from_normal(normal_of(below, above)), *self.bounds)

    def to_normal(self, x: FloatArray) -> FloatArray:
        """See `Marginal`."""
        low, high = self._ends
        v = np.clip(self.base.to_normal(x), low, high)
        u = normal_of(_log_between(low, v) - self._mass, _log_between(v, high) - self._mass)
        return beyond(self.bounds, x, u)

    def log_pdf(self, x: FloatArray) -> FloatArray:
        """See `Marginal`."""
        inside = (x >= self.low) & (x <= self.high)
        return np.where(inside, self.base.log_pdf(x) - self._mass, -np.inf)

    @cached_property
    def moments(self) -> tuple[float, float]:
        """See `Marginal`; integrated over the standard-normal variable."""
        edges = np.linspace(-_REACH, _REACH, _PANELS + 1)
        node, weight = np.polynomial.legendre.leggauss(_NODES)
        half = 0.5 * np.diff(edges)[:, None]
        u = (0.5 * (edges[1:] + edges[:-1])[:, None] + half * node).ravel()
        p = (half * weight).ravel() * np.exp(-0.5 * u * u)
        p /= p.sum()
        x = self.from_normal(u)
        with np.errstate(all="ignore"):
            centre = float(np.median(x))
            mean = float(p @ (x - centre))
            squares = p * (x - centre - mean) ** 2
            variance = float(squares.sum())
            outermost = float(squares[np.abs(u) > 0.9 * _REACH].sum())
        if not (math.isfinite(variance) and outermost <= 1e-6 * variance):
            raise ValueError(f"{self} has no finite mean and standard deviation")
        return centre + mean, math.sqrt(variance)

    def with_moments(self, mean: float, std: float) -> Any:
        """See `Marginal`; it is shifted and stretched."""
        checked_moments(mean, std)
        ratio = std / self.moments[1]
        shift = mean - ratio * self.moments[0]
        ot = openturns()
        if (
            isinstance(self.base, ClosedMarginal)
            and family_of(self.base.distribution)[1] == "Normal"
        ):
            centre, spread = self.base.moments
            low, high = (ratio * bound + shift for bound in (self.low, self.high))
            if math.isfinite(low) and math.isfinite(high):
                return ot.Distribution(
                    ot.TruncatedNormal(ratio * centre + shift, ratio * spread, low, high)
                )
        return ratio * ot.Distribution(self.distribution) + shift


def _log_between(low: FloatArray, high: FloatArray) -> FloatArray:
    """Logarithm of the probability between two standard-normal values."""
    upper = low > 0.0
    larger = special.log_ndtr(np.where(upper, -low, high))
    smaller = special.log_ndtr(np.where(upper, -high, low))
    with np.errstate(divide="ignore"):
        return np.asarray(larger + np.log(-np.expm1(smaller - larger)))
