"""Standardised Pearson density, both tails and quantiles, by integrating Eq. (42) numerically.

ln f follows from f'/f by integration over panels, f by exponentiation, the tails by a second
integration, summed from both ends: every step keeps its relative accuracy in either tail. Next
to a finite end, f = x^(r-1) g(x) with a power series for g, which holds for any r > 0. No type is
special and no ratio of gamma functions occurs, so a nearly normal type IV costs what a beta does.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from uqfold.moments import chebyshev
from uqfold.moments.pearson_panels import march
from uqfold.moments.pearson_types import PearsonEquation, SupportEnd
from uqfold.typing import BoolArray, FloatArray

_SERIES_TERMS = 30
_APPROACH = 4.0 ** np.arange(-20.0, 0.0)  # shares of the strip's width


@dataclass(frozen=True)
class EndStrip:
    """The strip of given width next to a finite end: P(distance <= x) = mass t^r s(t), t = x/width.

    s(t) = sum_k p_k t^k with s(1) = 1.
    """

    end: SupportEnd
    width: float
    mass: float
    integral: FloatArray
    density: FloatArray

    @property
    def breakpoints(self) -> FloatArray:
        """Panel edges from the end inwards, without the strip's inner edge.

        Where the density is infinite they are rescaled probabilities: almost all of it may sit on
        the end, and the distance from it then changes within a tiny part of that coordinate.
        """
        t = np.array([0.0])
        if self.end.exponent < 1.0:
            t = self.inner(self.width * np.append(0.0, _APPROACH)) / self.mass
        return np.asarray(self.end.position + self.end.inside * self.width * t)

    def inner(self, distance: FloatArray) -> FloatArray:
        """Probability between the end and `distance` from it."""
        t = np.clip(distance / self.width, 0.0, 1.0)
        return np.asarray(
            self.mass * t**self.end.exponent * np.polynomial.polynomial.polyval(t, self.integral)
        )

    def outer(self, distance: FloatArray) -> FloatArray:
        """Probability between `distance` and the strip's inner edge."""
        t = np.clip(distance / self.width, 0.0, 1.0)
        with np.errstate(divide="ignore"):
            log_share = self.end.exponent * np.log(t) + np.log(
                np.polynomial.polynomial.polyval(t, self.integral)
            )
        return np.asarray(-self.mass * np.expm1(np.minimum(log_share, 0.0)))

    def log_density(self, distance: FloatArray) -> FloatArray:
        """Logarithm of f at `distance`; +inf at the end itself for r < 1, -inf for r > 1."""
        t = np.clip(distance / self.width, 0.0, 1.0)
        r = self.end.exponent
        with np.errstate(divide="ignore"):
            power = (r - 1.0) * np.log(t) if r != 1.0 else np.zeros_like(t)
            return np.asarray(
                np.log(self.mass / self.width)
                + power
                + np.log(np.polynomial.polynomial.polyval(t, self.density))
            )

    def distance(self, probability: FloatArray) -> FloatArray:
        """Inverse of `inner`, by Newton's method in ln t, where it is nearly a straight line."""
        r = self.end.exponent
        with np.errstate(divide="ignore"):
            target = np.minimum(np.log(probability) - np.log(self.mass), 0.0)
        log_t = target / r
        for _ in range(50):
            t = np.exp(log_t)
            series = np.polynomial.polynomial.polyval(t, self.integral)
            slope = np.polynomial.polynomial.polyval(t, self.density) / series
            with np.errstate(invalid="ignore"):
                step = (r * log_t + np.log(series) - target) / slope
            step = np.where(np.isfinite(step), step, 0.0)
            log_t = np.minimum(log_t - step, 0.0)
            if not (np.abs(step) > 1e-15 * (1.0 + np.abs(log_t))).any():
                break
        return np.asarray(self.width * np.exp(log_t))


def _strip(end: SupportEnd, width: float, d: float, density: float) -> EndStrip:
    """Power series of the strip, scaled so that f = `density` at its inner edge."""
    g = np.empty(_SERIES_TERMS)
    g[0] = 1.0
    for k in range(_SERIES_TERMS - 1):
        g[k + 1] = -g[k] * width * (end.regular + d * k) / (end.slope * (k + 1))
    integral = g / (end.exponent + np.arange(_SERIES_TERMS))
    mass = density * width * integral.sum() / g.sum()
    # f = (mass / width) t^(r-1) g(t) / sum(integral), so that its integral over the strip is mass.
    return EndStrip(end, width, mass, integral / integral.sum(), g / integral.sum())


class PearsonTable:
    """Density and both tails of the standardised Pearson distribution for one (s >= 0, k).

    Parameters
    ----------
    equation
        Eq. (42) with its coefficients.

    Attributes
    ----------
    edges
        Panel edges in z, (P + 1,); the density is negligible (below 1e-300 of its peak) outside
        them unless a strip next to a finite end continues it.
    lower, upper
        The strips, or None.
    """

    def __init__(self, equation: PearsonEquation) -> None:
        left, right = march(equation, -1), march(equation, +1)
        n_left = left.edges.size - 1
        self.edges = np.concatenate([-left.edges[:0:-1], right.edges])
        self._half = 0.5 * np.diff(self.edges)
        self._middle = 0.5 * (self.edges[:-1] + self.edges[1:])
        nodes = self._middle + chebyshev.NODES[:, None] * self._half
        log_f = chebyshev.antiderivative(equation.log_density_slope(nodes), self._half)
        rise = chebyshev.at_right_edge(log_f)
        # Sum outwards from the mean on each side, so that no far tail's rounding enters the body.
        start = np.concatenate(
            [-np.cumsum(rise[:n_left][::-1])[::-1], [0.0], np.cumsum(rise[n_left:])]
        )
        log_f[0] += start[:-1]
        peak = start.max()
        log_f[0] -= peak
        log_edge = start - peak
        integral = chebyshev.antiderivative(np.exp(chebyshev.at_nodes(log_f)), self._half)
        masses = chebyshev.at_right_edge(integral)
        ends = equation.ends
        lower = upper = None
        if left.strip > 0 and ends[0] is not None:
            lower = _strip(ends[0], left.strip, equation.d, float(np.exp(log_edge[0])))
        if right.strip > 0 and ends[1] is not None:
            upper = _strip(ends[1], right.strip, equation.d, float(np.exp(log_edge[-1])))
        lower_mass = lower.mass if lower else 0.0
        upper_mass = upper.mass if upper else 0.0
        total = masses.sum() + lower_mass + upper_mass
        self._log_f = log_f
        self._log_f[0] -= np.log(total)
        self._integral = integral / total
        self._masses = masses / total
        self.lower = _rescaled(lower, total)
        self.upper = _rescaled(upper, total)
        self.below = np.cumsum(np.concatenate([[lower_mass], masses])) / total
        self.above = np.cumsum(np.concatenate([[upper_mass], masses[::-1]]))[::-1] / total

    def _locate(self, z: FloatArray) -> tuple[NDArray[np.intp], FloatArray]:
        """Panel and local position of z, clipped to the panels."""
        panel = np.clip(np.searchsorted(self.edges, z, side="right") - 1, 0, self._half.size - 1)
        with np.errstate(over="ignore"):
            x = (z - self._middle[panel]) / self._half[panel]
        return panel, np.clip(x, -1.0, 1.0)

    def tails(self, z: FloatArray) -> tuple[FloatArray, FloatArray]:
        """(cdf, sf) at standardised values z of any shape; NaN stays NaN."""
        flat = np.ravel(z)
        panel, x = self._locate(flat)
        inside = chebyshev.evaluate(self._integral, panel, x)
        cdf = self.below[panel] + inside
        sf = self.above[panel + 1] + (self._masses[panel] - inside)
        low, high = flat < self.edges[0], flat > self.edges[-1]
        if low.any():
            if self.lower is None:
                cdf[low], sf[low] = 0.0, 1.0
            else:
                distance = flat[low] - self.lower.end.position
                cdf[low] = self.lower.inner(distance)
                sf[low] = self.above[0] + self.lower.outer(distance)
        if high.any():
            if self.upper is None:
                cdf[high], sf[high] = 1.0, 0.0
            else:
                distance = self.upper.end.position - flat[high]
                sf[high] = self.upper.inner(distance)
                cdf[high] = self.below[-1] + self.upper.outer(distance)
        shape = np.shape(z)
        return np.minimum(cdf, 1.0).reshape(shape), np.minimum(sf, 1.0).reshape(shape)

    def log_density(self, z: FloatArray) -> FloatArray:
        """Logarithm of f at standardised values z; -inf where f is below 1e-300 of its peak."""
        flat = np.ravel(z)
        panel, x = self._locate(flat)
        log_f = chebyshev.evaluate(self._log_f, panel, x)
        for mask, strip in (
            (flat < self.edges[0], self.lower),
            (flat > self.edges[-1], self.upper),
        ):
            if strip is None:
                log_f[mask] = -np.inf
            elif mask.any():
                distance = (flat[mask] - strip.end.position) * strip.end.inside
                log_f[mask] = np.where(distance < 0, -np.inf, strip.log_density(distance))
        return log_f.reshape(np.shape(z))

    def quantile(self, cdf: FloatArray, sf: FloatArray) -> FloatArray:
        """Find z from both probabilities (N,); the smaller one decides, so either may be tiny."""
        from_below = cdf <= sf
        panel = np.where(
            from_below,
            np.searchsorted(self.below, cdf, side="right") - 1,
            self._half.size - np.searchsorted(self.above[::-1], sf, side="right"),
        )
        panel = np.clip(panel, 0, self._half.size - 1)
        target = np.where(from_below, cdf - self.below[panel], 0.0)
        rest = np.where(from_below, 0.0, sf - self.above[panel + 1])
        z = self._invert(panel, target, rest, from_below)
        if self.lower is not None:
            low = np.where(from_below, cdf < self.below[0], sf > self.above[0])
            near = np.where(from_below, cdf, 1.0 - sf)[low]
            z[low] = self.lower.end.position + self.lower.distance(near)
        if self.upper is not None:
            high = np.where(from_below, cdf > self.below[-1], sf < self.above[-1])
            near = np.where(from_below, 1.0 - cdf, sf)[high]
            z[high] = self.upper.end.position - self.upper.distance(near)
        return z

    def _invert(
        self,
        panel: NDArray[np.intp],
        target: FloatArray,
        rest: FloatArray,
        from_below: BoolArray,
    ) -> FloatArray:
        """Safeguarded Newton iteration inside the panels."""
        mass, half = self._masses[panel], self._half[panel]
        with np.errstate(invalid="ignore", divide="ignore"):
            share = np.where(from_below, target / mass, 1.0 - rest / mass)
        found = np.clip(np.where(np.isfinite(share), 2.0 * share - 1.0, 0.0), -1.0, 1.0)
        low, high = np.full(panel.shape, -1.0), np.full(panel.shape, 1.0)
        active = np.arange(panel.size)
        for _ in range(60):
            x, where = found[active], panel[active]
            inside = chebyshev.evaluate(self._integral, where, x)
            error = np.where(
                from_below[active], inside - target[active], rest[active] - (mass[active] - inside)
            )
            low[active] = np.where(error < 0, x, low[active])
            high[active] = np.where(error >= 0, x, high[active])
            slope = np.exp(chebyshev.evaluate(self._log_f, where, x)) * half[active]
            with np.errstate(invalid="ignore", divide="ignore"):
                newton = x - error / slope
            accepted = (newton > low[active]) & (newton < high[active])
            middle = 0.5 * (low[active] + high[active])
            found[active] = np.where(accepted, newton, middle)
            active = active[np.abs(found[active] - x) > 1e-14]
            if active.size == 0:
                break
        return np.asarray(self._middle[panel] + found * half)


def _rescaled(strip: EndStrip | None, total: float) -> EndStrip | None:
    """Divide the density of a strip by `total`."""
    if strip is None:
        return None
    return EndStrip(strip.end, strip.width, strip.mass / total, strip.integral, strip.density)
