"""Saddlepoint approximation of a distribution (Eqs. 32-36), from four cumulants or another K.

In standard units x = (y - kappa_1) / sigma the quartic cumulant-generating function has

    K'(s)  = s + l3 s^2 / 2 + l4 s^3 / 6,      K''(s) = 1 + l3 s + l4 s^2 / 2

with skewness l3 and excess kurtosis l4. On the branch through s = 0, where K'' > 0, Eq. (36) is

    w = s sqrt(A),      v = s sqrt(B),      B = K''(s)

because w^2 / 2 = s K' - K = int_0^s u K''(u) du > 0: w is real there. Then

    1/w - 1/v = C / (sqrt(A B) (sqrt(A) + sqrt(B))),      C = (B - A) / s

holds for all s without cancellation (`generating` gives A, B and C). It replaces the series around
y = kappa_1, where it gives l3 / 6 and so F = 1/2 + l3 / (6 sqrt(2 pi)).
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import ArrayLike

from uqfold.moments.conditional import AtomicDistribution
from uqfold.moments.generating import Cumulants, GeneratingFunction
from uqfold.moments.pearson import PearsonDistribution
from uqfold.moments.pearson_types import check_moments
from uqfold.typing import BoolArray, FloatArray

_SQRT_2PI = math.sqrt(2.0 * math.pi)
_FARTHEST = 38.5  # beyond this w both tails underflow


@dataclass(frozen=True)
class SaddlepointValue:
    """Both tails at each y, and how they were obtained.

    Attributes
    ----------
    cdf, sf
        P(Y <= y) and P(Y > y), same shape as y.
    fallback
        True where no admissible saddlepoint exists and the Pearson distribution answers.
    clipped
        True where that answer had to be limited to keep the curve from turning back.
    """

    cdf: FloatArray
    sf: FloatArray
    fallback: BoolArray
    clipped: BoolArray

    @property
    def message(self) -> str:
        """What was unusual, in words; empty if nothing was."""
        if not self.fallback.any():
            return ""
        text = (
            f"no admissible saddlepoint at {int(self.fallback.sum())} of {self.fallback.size} "
            "points; a Pearson distribution with the same four moments answers there"
        )
        if self.clipped.any():
            text += f", limited at {int(self.clipped.sum())} of them to stay monotone"
        return text


@dataclass(frozen=True)
class SaddlepointDistribution:
    """Lugannani-Rice approximation, by default from mean, std, skewness and kurtosis.

    The approximation is used on the widest interval around kappa_1 on which a saddlepoint exists
    on the branch through s = 0, the formula rises with y, and both tails lie in [0, 1] (`window`).
    Outside (for instance beyond 2.9 standard deviations for skewness 0 and excess kurtosis -0.1)
    the Pearson distribution with the same four moments answers. It is the natural second choice:
    it uses the same information, exists for every possible set of moments, and is a genuine
    distribution. Its tails are limited by the values at the window's ends, so that the whole
    curve is a distribution function.

    Parameters
    ----------
    mean, std
        In the unit of the response; std = 0 is a step at the mean.
    skewness, kurtosis
        Standardised; kurtosis is 3 for a normal.
    more
        A cumulant-generating function of the standardised response that knows more than these
        cumulants: more of them, or all.

    Raises
    ------
    ImpossibleMomentsError
        If no distribution has these moments.
    """

    mean: float
    std: float
    skewness: float
    kurtosis: float
    more: GeneratingFunction | None = None

    def __post_init__(self) -> None:
        check_moments(self.mean, self.std, self.skewness, self.kurtosis)

    @property
    def support(self) -> tuple[float, float]:
        """The whole line; the mean alone for std = 0."""
        return (-math.inf, math.inf) if self.std > 0 else (self.mean, self.mean)

    @property
    def window(self) -> tuple[float, float]:
        """Interval of y on which the saddlepoint approximation itself answers; may be empty."""
        low, high = (self._slope(s) for s in self._branch)
        return self.mean + self.std * low, self.mean + self.std * high

    def cdf(self, y: ArrayLike) -> FloatArray:
        """P(Y <= y)."""
        return self.evaluate(y).cdf

    def sf(self, y: ArrayLike) -> FloatArray:
        """P(Y > y), directly: Q(w) + phi(w) (1/v - 1/w)."""
        return self.evaluate(y).sf

    def evaluate(self, y: ArrayLike) -> SaddlepointValue:
        """Both tails at y with flags; y = +-inf is allowed, NaN stays NaN."""
        values = np.asarray(y, dtype=float)
        if self.std == 0:
            cdf, sf = AtomicDistribution((self.mean,)).tails(values)
            no = np.zeros(values.shape, dtype=bool)
            return SaddlepointValue(cdf, sf, no, no)
        x = np.ravel((values - self.mean) / self.std)
        low, high = self._branch
        x_low, x_high = self._slope(low), self._slope(high)
        empty = low >= high
        below = np.full(x.shape, empty) | (x < x_low)
        above = ~below & (x > x_high)
        usable = ~below & ~above & np.isfinite(x)
        cdf = np.where(x > 0, 1.0, 0.0)
        sf = np.where(x > 0, 0.0, 1.0)
        cdf[usable], sf[usable] = self._lugannani_rice(self._saddlepoint(x[usable]))
        fallback = (below | above) & np.isfinite(x)
        clipped = np.zeros(x.shape, dtype=bool)
        if fallback.any():
            pearson_cdf, pearson_sf = self._pearson.tails(self.mean + self.std * x[fallback])
            part = below[fallback]
            limit_cdf, limit_sf = (
                (1.0, 1.0) if empty else (self._edge_values[0][0], self._edge_values[1][1])
            )
            too_high = np.where(part, pearson_cdf > limit_cdf, pearson_sf > limit_sf)
            edge_cdf = np.where(part, limit_cdf, 1.0 - limit_sf)
            edge_sf = np.where(part, 1.0 - limit_cdf, limit_sf)
            cdf[fallback] = np.where(too_high, edge_cdf, pearson_cdf)
            sf[fallback] = np.where(too_high, edge_sf, pearson_sf)
            clipped[fallback] = too_high
        missing = np.isnan(x)
        cdf[missing] = sf[missing] = np.nan
        shape = values.shape
        return SaddlepointValue(
            cdf.reshape(shape), sf.reshape(shape), fallback.reshape(shape), clipped.reshape(shape)
        )

    @cached_property
    def _generating(self) -> GeneratingFunction:
        return self.more or Cumulants((self.skewness, self.kurtosis - 3.0))

    def _slope(self, s: float) -> float:
        """K'(s), the standardised y that belongs to saddlepoint s."""
        return s if math.isinf(s) else float(self._generating.slope(np.array(s)))

    def _saddlepoint(self, x: FloatArray) -> FloatArray:
        """Root of Eq. (34) on the branch: safeguarded Newton iteration, all points at once."""
        ends = [np.sign(s) * 1e3 if math.isinf(s) else s for s in self._branch]
        low, high = np.full(x.shape, ends[0]), np.full(x.shape, ends[1])
        s = np.clip(x, low, high)
        for _ in range(100):
            error = self._generating.slope(s) - x
            low, high = np.where(error <= 0, s, low), np.where(error >= 0, s, high)
            with np.errstate(divide="ignore", invalid="ignore"):
                newton = s - error / self._generating.bend(s)
            inside = (newton >= low) & (newton <= high)
            proposal = np.where(inside, newton, 0.5 * (low + high))
            done = np.abs(proposal - s) <= 4e-16 * np.abs(s)
            s = proposal
            if done.all():
                break
        return s

    def _lugannani_rice(self, s: FloatArray) -> tuple[FloatArray, FloatArray]:
        """(cdf, sf) at saddlepoints s inside the branch, Eq. (35)."""
        from scipy.special import erfcx, ndtr

        big_a, big_b, big_c = self._generating.parts(s)
        root_a, root_b = np.sqrt(big_a), np.sqrt(big_b)
        w = s * root_a
        correction = big_c / (root_a * root_b * (root_a + root_b))
        density = np.exp(-0.5 * w**2) / _SQRT_2PI
        # The smaller tail as density * (Mills ratio -+ correction), the other one as a plain sum.
        mills = math.sqrt(math.pi / 2.0) * erfcx(np.abs(w) / math.sqrt(2.0))
        right = w > 0
        cdf = np.where(right, ndtr(w) + density * correction, density * (mills + correction))
        sf = np.where(right, density * (mills - correction), ndtr(-w) - density * correction)
        return cdf, sf

    def _rise(self, s: FloatArray) -> FloatArray:
        """(dF/ds) / phi(w) = sqrt(K'') + d(1/w - 1/v)/ds: its sign says whether F rises."""
        big_a, big_b, big_c = self._generating.parts(s)
        slope_a, slope_b, slope_c = self._generating.slopes(s)
        root_a, root_b = np.sqrt(big_a), np.sqrt(big_b)
        bottom = big_a * root_b + big_b * root_a
        slope_bottom = (
            slope_a * root_b
            + big_a * slope_b / (2.0 * root_b)
            + slope_b * root_a
            + big_b * slope_a / (2.0 * root_a)
        )
        return np.asarray(root_b + (slope_c - big_c * slope_bottom / bottom) / bottom)

    @cached_property
    def _branch(self) -> tuple[float, float]:
        """Interval of admissible s; +-inf where the approximation holds until it underflows."""
        if not bool(self._rise(np.zeros(1))[0] > 0.0) or abs(self.skewness) >= 3 * _SQRT_2PI:
            return 0.0, 0.0  # the formula falls, or leaves [0, 1], at the mean itself
        return -self._reach(-1.0), self._reach(+1.0)

    def _reach(self, direction: float) -> float:
        """How far |s| may go: until K'' = 0, F stops rising, or a tail leaves [0, 1]."""
        singular = self._generating.end(direction)
        farthest = _FARTHEST if math.isinf(singular) else singular * (1.0 - 1e-12)
        vanishing = False
        for _ in range(20):
            if not math.isinf(singular):
                break
            # w must reach the underflow; A may stay below 1 for a while.
            big_a = float(self._generating.parts(np.array([direction * farthest]))[0][0])
            vanishing = farthest * math.sqrt(big_a) >= _FARTHEST
            if vanishing:
                break
            farthest *= 2.0
        # K and the formula may change over a much shorter distance
        scale = self._generating.scale
        grid = np.geomspace(0.01 * min(scale, farthest), farthest, 800)

        def admissible(size: FloatArray) -> BoolArray:
            s = direction * size
            big_a = self._generating.parts(s)[0]
            cdf, sf = self._lugannani_rice(s)
            tail = np.where(direction > 0, sf, cdf)
            underflow = s**2 * big_a > _FARTHEST**2
            return np.asarray(
                underflow | ((self._rise(s) > 0) & (tail >= 0) & (cdf >= 0) & (sf >= 0))
            )

        good = admissible(grid)
        if good.all():
            # a bounded response has a probability left at the end of its support
            return math.inf if vanishing else float(farthest)
        first = int(np.argmin(good))
        low, high = (0.0 if first == 0 else float(grid[first - 1])), float(grid[first])
        for _ in range(10):
            within = np.linspace(low, high, 66)
            good = admissible(within[1:-1])
            last = good.size if good.all() else int(np.argmin(good))
            low, high = float(within[last]), float(within[last + 1])
        return low

    @cached_property
    def _edge_values(self) -> tuple[tuple[float, float], tuple[float, float]]:
        """(cdf, sf) at both ends of the window, limits of the fallback."""
        values = []
        for s in self._branch:
            if math.isinf(s):
                values.append((0.0, 1.0) if s < 0 else (1.0, 0.0))
            else:
                cdf, sf = self._lugannani_rice(np.array([s]))
                values.append((float(cdf[0]), float(sf[0])))
        return values[0], values[1]

    @cached_property
    def _pearson(self) -> PearsonDistribution | AtomicDistribution:
        return PearsonDistribution.from_moments(self.mean, self.std, self.skewness, self.kurtosis)
