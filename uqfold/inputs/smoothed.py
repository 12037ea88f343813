"""Measured values as a smooth distribution: a normal kernel around each of them."""

from __future__ import annotations

import math
from functools import cached_property
from typing import Any

import numpy as np
from scipy.interpolate import PchipInterpolator
from scipy.special import ndtr, ndtri
from scipy.stats import rv_continuous

from uqfold.typing import FloatArray

_AT_ONCE = 2**21
"""Pairs of a value and a place that are computed together."""
_BEYOND = 9.0
"""So many bandwidths beyond the outermost values an unbounded distribution ends."""
_EVEN, _CROWDED, _HALVED = 1501, 1501, 60
"""Places of the table: at even steps, where values are, and ever nearer to a bound."""
_STEPS, _NEAR = 60, 1e-13
_NODES = 4


class SmoothedData(rv_continuous):  # type: ignore[misc]
    """The mean of normal distributions around values, reflected at bounds.

    The values are drawn together first so that the variance stays that of the data, as in the
    smoothed bootstrap (Silverman & Young, Biometrika 74 (1987) 469-479). The width is Silverman's
    rule (Density Estimation, 1986, Eq. 3.31). It is kept as the standard-normal value of a place,
    a monotone function between some 3,000 places.

    Attributes
    ----------
    values
        The data (n,), not all equal.
    low, high
        Bounds, which may be infinite.
    width
        Standard deviation of each kernel.
    """

    def __init__(self, values: FloatArray, low: float, high: float) -> None:
        self.values, self.low, self.high = values, low, high
        spread = float(values.std(ddof=1))
        robust = float(np.subtract(*np.quantile(values, [0.75, 0.25]))) / 1.349
        self.width = 0.9 * min(spread, robust or spread) * len(values) ** -0.2
        shrink = math.sqrt((spread**2 - self.width**2) / float(values.var()))
        self._centres = np.sort(values.mean() + shrink * (values - values.mean()))
        reach = _BEYOND * self.width
        first = max(low, float(self._centres[0]) - reach)
        last = min(high, float(self._centres[-1]) + reach)
        super().__init__(a=first, b=last, name=f"from_data({len(values)} values)")

    def __deepcopy__(self, _: Any) -> SmoothedData:
        """Return itself: it never changes."""
        return self

    def __reduce__(self) -> tuple[Any, ...]:
        """Hand on the values and not what follows from them."""
        return SmoothedData, (self.values, self.low, self.high)

    def _updated_ctor_param(self) -> dict[str, Any]:
        """Return the arguments of a copy, which SciPy makes whenever it freezes one."""
        return {"values": self.values, "low": self.low, "high": self.high}

    def uncut(self, x: FloatArray, side: float = 1.0) -> FloatArray:
        """Return probabilities (n,) below places x (n,), or above for a side of -1, without bounds.

        Infinite places are allowed.
        """
        if np.isinf(x).all():
            return np.where(side * x > 0.0, 1.0, 0.0)
        p, rows = np.empty(len(x)), max(1, _AT_ONCE // len(self.values))
        for start in range(0, len(x), rows):
            part = x[start : start + rows, None]
            p[start : start + rows] = ndtr(side * (part - self._centres) / self.width).mean(axis=1)
        return p

    @cached_property
    def _score(self) -> PchipInterpolator:
        """Standard-normal value of a place."""
        even = np.linspace(self.a, self.b, _EVEN)
        offsets = self.width * np.array([[-2.0], [0.0], [2.0]])
        crowded = np.quantile(self._centres, np.linspace(0.0, 1.0, _CROWDED // 3)) + offsets
        halved = (even[1] - even[0]) * 0.5 ** np.arange(1.0, _HALVED)
        x = np.unique(np.concatenate([even, crowded.ravel(), self.a + halved, self.b - halved]))
        x = x[(x > self.a) & (x < self.b)]
        # what lies beyond a bound comes back from it
        beyond_low, beyond_high = (
            self.uncut(2.0 * self.low - x),
            self.uncut(2.0 * self.high - x, -1.0),
        )
        with np.errstate(divide="ignore", invalid="ignore"):
            below = ndtri(self.uncut(x) - beyond_low + beyond_high)
            above = -ndtri(self.uncut(x, -1.0) - beyond_high + beyond_low)
        u = np.where(below < 0.0, below, above)
        rising = np.isfinite(u)
        rising[rising] = np.diff(np.maximum.accumulate(u[rising]), prepend=-np.inf) > 0.0
        return PchipInterpolator(x[rising], u[rising], extrapolate=True)

    def _pdf(self, x: Any) -> FloatArray:
        u, slope = self._score(x), self._score(x, nu=1)
        return np.asarray(np.exp(-0.5 * u * u) * slope / math.sqrt(2.0 * math.pi))

    def _cdf(self, x: Any) -> FloatArray:
        return np.asarray(ndtr(self._score(x)))

    def _sf(self, x: Any) -> FloatArray:
        return np.asarray(ndtr(-self._score(x)))

    def _ppf(self, q: Any) -> FloatArray:
        return self._at(ndtri(q))

    def _isf(self, q: Any) -> FloatArray:
        return self._at(-ndtri(q))

    def _at(self, u: FloatArray) -> FloatArray:
        """Places of standard-normal values, by Newton's steps between two places of the table."""
        places = self._score.x
        scores = self._score(places)
        u = np.clip(u, scores[0], scores[-1])
        cell = np.clip(np.searchsorted(scores, u, side="right") - 1, 0, len(places) - 2)
        low, high = places[cell], places[cell + 1]
        x = low + (u - scores[cell]) / (scores[cell + 1] - scores[cell]) * (high - low)
        near = _NEAR * (high - low) + 4.0 * np.spacing(np.abs(high))
        for _ in range(_STEPS):
            missing = u - self._score(x)
            low, high = np.where(missing > 0.0, x, low), np.where(missing > 0.0, high, x)
            with np.errstate(divide="ignore", invalid="ignore"):
                newton = x + missing / self._score(x, nu=1)
            step = np.where((low < newton) & (newton < high), newton, 0.5 * (low + high))
            done = np.abs(step - x) <= near
            x = step
            if done.all():
                break
        return np.asarray(x)

    def _stats(self) -> tuple[Any, Any, None, None]:
        places = self._score.x
        node, weight = np.polynomial.legendre.leggauss(_NODES)
        half = 0.5 * np.diff(places)[:, None]
        x = 0.5 * (places[1:] + places[:-1])[:, None] + half * node
        p = half * weight * self._pdf(x)
        mean = (p * x).sum() / p.sum()
        return mean, (p * (x - mean) ** 2).sum() / p.sum(), None, None
