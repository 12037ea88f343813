"""A conditional distribution given as a table of normal scores.

The normal score of a level t is z(t) = Phi^-1(P(Y <= t)). For most responses it is nearly a
straight line, so that a short table and a smooth interpolation hold both tails accurately.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from uqfold.moments.conditional import AtCoordinate
from uqfold.typing import FloatArray

# Integrals end where the normal score, continued beyond the table, reaches this value.
_REACH = 12.0
_ROOT_TWO_PI = math.sqrt(2.0 * math.pi)


@dataclass(frozen=True, eq=False)
class TabulatedDistribution:
    """Distribution with tabulated normal scores.

    Between levels the score is a cubic spline, or the monotone cubic of Fritsch and Carlson where
    the spline would fall; beyond the first and the last level it is continued as a straight line.

    Attributes
    ----------
    levels
        Responses t, strictly increasing (L,), L >= 2.
    scores
        Normal scores z(t), strictly increasing (L,).

    Raises
    ------
    ValueError
        If the arrays do not pair up, are not finite or do not increase.
    """

    levels: FloatArray
    scores: FloatArray

    def __post_init__(self) -> None:
        if self.levels.ndim != 1 or self.levels.shape != self.scores.shape or self.levels.size < 2:
            raise ValueError(
                f"{self.levels.shape} levels and {self.scores.shape} scores: give two arrays of "
                "one length >= 2"
            )
        if not (np.isfinite(self.levels).all() and np.isfinite(self.scores).all()):
            raise ValueError("levels and scores must be finite")
        levels, scores = self.levels, self.scores
        if not ((levels[1:] > levels[:-1]).all() and (scores[1:] > scores[:-1]).all()):
            raise ValueError("levels and scores must both increase strictly")

    @cached_property
    def _position(self) -> FloatArray:
        """Levels as numbers of order one around zero, so that any unit of the response works."""
        return self._scaled(self.levels)

    @cached_property
    def _centre(self) -> float:
        return float(np.interp(0.0, self.scores, self.levels))

    @cached_property
    def _unit(self) -> float:
        return float((self.levels[-1] - self.levels[0]) / (self.scores[-1] - self.scores[0]))

    def _scaled(self, y: ArrayLike) -> FloatArray:
        return np.asarray((np.asarray(y, dtype=float) - self._centre) / self._unit)

    @cached_property
    def _curve(self) -> Any:
        from scipy.interpolate import PchipInterpolator, PPoly

        x, z = self._position, self.scores
        if x.size >= 4:
            spline = _spline(x, z)
            cubic, square, start, _ = spline
            lengths = np.diff(x) * np.array([[0.0], [0.25], [0.5], [0.75], [1.0]])
            if float(((3.0 * cubic * lengths + 2.0 * square) * lengths + start).min()) > 0.0:
                return PPoly.construct_fast(spline, x)
        return PchipInterpolator(x, z)

    @cached_property
    def _ends(self) -> tuple[FloatArray, FloatArray]:
        """Slopes with which the score goes on beyond the first and last level."""
        x, z = self._position, self.scores
        chord = np.array([z[1] - z[0], z[-1] - z[-2]]) / np.array([x[1] - x[0], x[-1] - x[-2]])
        slopes = np.asarray(self._curve(x[[0, -1]], 1))
        return x[[0, -1]], np.where(slopes > 0.1 * chord, slopes, chord)

    def score(self, y: ArrayLike) -> FloatArray:
        """Normal score Phi^-1(P(Y <= y))."""
        # most tables are asked once, at a threshold that is one of their levels: no curve is needed
        near = np.minimum(np.searchsorted(self.levels, y), self.levels.size - 1)
        if (self.levels[near] == y).all():
            return np.asarray(self.scores[near])
        x = self._scaled(y)
        (first, last), (before, after) = self._ends
        with np.errstate(over="ignore"):
            score = self._curve(np.clip(x, first, last)) + before * np.minimum(x - first, 0.0)
            return np.asarray(score + after * np.maximum(x - last, 0.0))

    def _slope(self, y: ArrayLike) -> FloatArray:
        """Slope of the normal score per unit of the response."""
        x = self._scaled(y)
        (first, last), (before, after) = self._ends
        inside = self._curve(np.clip(x, first, last), 1)
        slope = np.where(x < first, before, np.where(x > last, after, inside))
        return np.asarray(slope / self._unit)

    @property
    def support(self) -> tuple[float, float]:
        """The whole line."""
        return -math.inf, math.inf

    @property
    def bounded(self) -> bool:
        """Whether the density is bounded: the slope of the score is finite."""
        return True

    @cached_property
    def breakpoints(self) -> FloatArray:
        """Levels, and where the score reaches +-12 beyond them."""
        (first, last), (before, after) = self._ends
        low = min(first, first - (self.scores[0] + _REACH) / before)
        high = max(last, last + (_REACH - self.scores[-1]) / after)
        return np.unique(self._centre + self._unit * np.array([low, *self._position, high]))

    @property
    def atoms(self) -> tuple[FloatArray, FloatArray]:
        """None."""
        return np.empty(0), np.empty(0)

    def tails(self, y: ArrayLike) -> tuple[FloatArray, FloatArray]:
        """Return (cdf, sf) at y."""
        from scipy.special import ndtr

        score = self.score(y)
        return np.asarray(ndtr(score)), np.asarray(ndtr(-score))

    def cdf(self, y: ArrayLike) -> FloatArray:
        """P(Y <= y)."""
        return self.tails(y)[0]

    def sf(self, y: ArrayLike) -> FloatArray:
        """P(Y > y)."""
        return self.tails(y)[1]

    def pdf(self, y: ArrayLike) -> FloatArray:
        """Density (per unit of the response)."""
        return self._density(y, self.score(y))

    def _density(self, y: ArrayLike, score: FloatArray) -> FloatArray:
        with np.errstate(over="ignore", under="ignore"):
            return np.asarray(np.exp(-0.5 * score**2) / _ROOT_TWO_PI * self._slope(y))

    def coordinate(self, y: ArrayLike) -> FloatArray:
        """Return y: the density is bounded."""
        return np.asarray(y, dtype=float)

    def at_coordinate(self, x: ArrayLike) -> AtCoordinate:
        """Response x itself with density and tails."""
        from scipy.special import ndtr

        score = self.score(x)
        density = self._density(x, score)
        return AtCoordinate(np.asarray(x, dtype=float), density, ndtr(score), ndtr(-score))

    def ppf(self, p: ArrayLike) -> FloatArray:
        """Value that the response exceeds with probability 1 - p, to about 1e-9 of the spread."""
        from scipy.special import ndtri

        return self._inverse(np.asarray(ndtri(np.asarray(p, dtype=float))))

    def _inverse(self, score: FloatArray) -> FloatArray:
        """Response with a given normal score, by bisection."""
        edges = self.breakpoints
        low = np.full(score.shape, edges[0])
        high = np.full(score.shape, edges[-1])
        for _ in range(45):
            middle = 0.5 * (low + high)
            below = self.score(middle) < score
            low, high = np.where(below, middle, low), np.where(below, high, middle)
        return np.asarray(0.5 * (low + high))

    def sample(self, rng: np.random.Generator, size: int | tuple[int, ...]) -> FloatArray:
        """Independent draws."""
        return self._inverse(rng.standard_normal(size))


def _spline(x: FloatArray, z: FloatArray) -> FloatArray:
    """Coefficients (4, n - 1) of the not-a-knot cubic spline through n >= 4 points.

    They are those of scipy's `CubicSpline`, which would spend most of its time checking arguments:
    thousands of short tables are made for one answer.
    """
    from scipy.linalg.lapack import dgtsv

    dx = x[1:] - x[:-1]
    chord = (z[1:] - z[:-1]) / dx
    # the third derivative does not jump at the second point, nor at the last but one
    start, stop = x[2] - x[0], x[-1] - x[-3]
    first = ((dx[0] + 2.0 * start) * dx[1] * chord[0] + dx[0] ** 2 * chord[1]) / start
    last = (dx[-1] ** 2 * chord[-2] + (2.0 * stop + dx[-1]) * dx[-2] * chord[-1]) / stop
    inner = 3.0 * (dx[1:] * chord[:-1] + dx[:-1] * chord[1:])
    diagonal = np.concatenate([dx[1:2], 2.0 * (dx[:-1] + dx[1:]), dx[-2:-1]])
    below, above = np.append(dx[1:], stop), np.append(start, dx[:-1])
    right = np.concatenate([[first], inner, [last]])
    slope = dgtsv(below, diagonal, above, right)[3]
    bend = (slope[:-1] + slope[1:] - 2.0 * chord) / dx
    return np.array([bend / dx, (chord - slope[:-1]) / dx - bend, slope[:-1], z[:-1]])
