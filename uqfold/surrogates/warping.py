"""A monotone transformation of strongly scaled responses, found from the runs.

A response that spans decades (a product, an exponential, a reciprocal) is hardly a polynomial, nor
a stationary process, in its inputs; a power or the logarithm of its distance from an origin often
is. Failure is the same event before and after such a transformation, so that a surface may be
fitted to transformed responses and answer with transformed thresholds. What compares responses of
several units by their differences has to be asked in the responses themselves.

References
----------
Box G. E. P., Cox D. R. An analysis of transformations. J. R. Stat. Soc. B 26 (1964) 211-252.
Snelson E., Rasmussen C. E., Ghahramani Z. Warped Gaussian processes. NIPS 16 (2003).
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from uqfold.surrogates.hermite import hermite_basis, total_degree_indices
from uqfold.typing import FloatArray

# Responses reach so many times further from their median on one side than on the other.
_LOPSIDED = 2.0
# A transformation is used where it makes left-out runs' errors smaller than this share.
_WORTHWHILE = 0.5
# Powers that are tried, the plainest first; distances of the origin from the nearest response, in
# the median's.
_POWERS = np.array(sorted(np.arange(-24, 12) / 12.0, key=abs))
_DISTANCES = np.geomspace(1e-6, 1e2, 33)
# An error, relative to the spread of responses, below which none is better than another.
_EXACT = 1e-9
# Points for every polynomial of the fit that transformations are compared by.
_POINTS_PER_TERM = 2.0


@dataclass(frozen=True)
class Warp:
    """An increasing transformation of responses, in their own unit.

    With the distance v = side (y - origin) / scale it is side scale (v^power - 1) / power, or the
    logarithm in the place of a power of zero. As the scale is the geometric mean of the distances
    that it was found from, residuals before and after are comparable: the mean logarithm of its
    slope is zero over these responses.

    Attributes
    ----------
    origin
        Response at which the distance is zero.
    side
        1 where responses lie above the origin, -1 where they lie below.
    scale
        Geometric mean of the distances, in the unit of the response.
    power
        The exponent.
    """

    origin: float
    side: float
    scale: float
    power: float

    def __call__(self, y: FloatArray) -> FloatArray:
        """Transform responses (n,); infinite ones stay so, those beyond the origin become so."""
        distance = np.maximum(self.side * (y - self.origin), 0.0) / self.scale
        with np.errstate(divide="ignore"):
            log = np.log(distance)
        z = self.side * self.scale * _power(log, self.power)
        beyond = (distance == 0.0) | ~np.isfinite(y)
        return np.where(beyond, np.where(np.isnan(y), y, np.copysign(np.inf, log * self.side)), z)

    def inverse(self, z: FloatArray) -> FloatArray:
        """Responses (n,) of transformed ones, infinite beyond what the transformation reaches."""
        value = self.side * z / self.scale
        with np.errstate(divide="ignore", over="ignore"):
            if self.power == 0.0:
                distance = np.exp(value)
            else:
                distance = np.maximum(1.0 + self.power * value, 0.0) ** (1.0 / self.power)
        return self.origin + self.side * self.scale * distance

    def takes(self, y: float) -> bool:
        """Whether a response lies on the side of the origin that is transformed, or is infinite."""
        return math.isinf(y) or self.side * (y - self.origin) > 0.0


def find_warp(u: FloatArray, y: FloatArray) -> Warp | None:
    """Find the transformation after which polynomials foretell left-out runs best.

    Parameters
    ----------
    u
        Points (n, d) in standard-normal space.
    y
        Finite responses (n,).

    Returns
    -------
    Warp | None
        None where the responses are not strongly scaled, or no transformation helps much.
    """
    low, middle, high = float(y.min()), float(np.median(y)), float(y.max())
    if not max(high - middle, middle - low) > _LOPSIDED * min(high - middle, middle - low) > 0.0:
        return None
    side = 1.0 if high - middle > middle - low else -1.0
    nearest = low if side > 0.0 else high
    fit, exact = _Fit.of(u), _EXACT * float(y.std())
    origins = (nearest - side * abs(middle - nearest) * _DISTANCES).tolist()
    if side * nearest > 0.0:
        origins = [0.0, *origins]

    def best(origin: float) -> tuple[float, Warp]:
        log = np.log(side * (y - origin))
        scale = math.exp(float(log.mean()))
        log -= log.mean()
        errors = fit.errors(scale * np.column_stack([_power(log, one) for one in _POWERS]))
        i = int(np.maximum(errors, exact).argmin())
        return max(float(errors[i]), exact), Warp(origin, side, scale, float(_POWERS[i]))

    error, warp = min(map(best, origins), key=lambda pair: pair[0])
    own = float(fit.errors(y[:, None])[0])
    return warp if error < _WORTHWHILE * own else None


def _power(log: FloatArray, power: float) -> FloatArray:
    """(v^power - 1) / power from the logarithm of v."""
    with np.errstate(over="ignore"):
        return log if power == 0.0 else np.asarray(np.expm1(power * log) / power)


@dataclass(frozen=True, eq=False)
class _Fit:
    """Least squares in a few polynomials: orthonormal values (n, p) and leverages (n,)."""

    q: FloatArray
    leverage: FloatArray

    @classmethod
    def of(cls, u: FloatArray) -> _Fit:
        n, d = u.shape
        degree = 3
        while degree > 1 and _POINTS_PER_TERM * math.comb(d + degree, degree) > n:
            degree -= 1
        spread = float(np.sqrt(np.mean(u**2))) or 1.0
        q = np.linalg.qr(hermite_basis(u / spread, total_degree_indices(d, degree)))[0]
        return cls(q, (q**2).sum(axis=1))

    def errors(self, y: FloatArray) -> FloatArray:
        """Root mean squares (k,) of the leave-one-out residuals of responses (n, k)."""
        residuals = y - self.q @ (self.q.T @ y)
        rest = np.maximum(1.0 - self.leverage, 1e-9)[:, None]
        return np.asarray(np.sqrt(np.mean((residuals / rest) ** 2, axis=0)))
