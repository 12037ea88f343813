"""The Pearson differential equation, Eq. (42): coefficients, type, and the ends of the support.

For the standardised response z (mean 0, variance 1) with skewness s >= 0 and kurtosis k,

    f'(z) / f(z) = -(a z + b) / (c + b z + d z^2),
    a = 10 k - 12 s^2 - 18,  b = s (k + 3),  c = 4 k - 3 s^2,  d = 2 k - 3 s^2 - 6

(Zhao and Ono, Structural Safety 26 (2004) 343). Nothing here divides by a, which may vanish, nor
by d unless the other root of the denominator is asked for.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from uqfold.typing import FloatArray

# Closer to a boundary between types than this, the boundary's own name is given. It is a label
# only: the density is computed in one way for all types.
_LABEL_TOLERANCE = 1e-9
# Kurtosis and skewness carry rounding errors of this relative size; within them the moments
# belong to a two-point distribution.
_ROUNDING = 1e-12


class ImpossibleMomentsError(ValueError):
    """No distribution has these moments."""


def check_moments(mean: float, std: float, skewness: float, kurtosis: float) -> None:
    """Refuse moments that no distribution has.

    Raises
    ------
    ImpossibleMomentsError
        For a value that is not finite, a negative std, or kurtosis < skewness^2 + 1 (beyond
        rounding).
    """
    given = f"mean {mean}, std {std}, skewness {skewness}, kurtosis {kurtosis}"
    if not all(math.isfinite(value) for value in (mean, std, skewness, kurtosis)):
        raise ImpossibleMomentsError(f"{given}: all four must be finite")
    if std < 0:
        raise ImpossibleMomentsError(f"{given}: std must not be negative")
    if std > 0 and kurtosis - skewness**2 - 1.0 < -_ROUNDING * (1.0 + kurtosis):
        raise ImpossibleMomentsError(
            f"{given}: kurtosis must be at least skewness^2 + 1 = {skewness**2 + 1.0}; check that "
            "kurtosis is not the excess over 3 and that the quadrature weights are not negative"
        )


def is_two_point(skewness: float, kurtosis: float) -> bool:
    """Whether kurtosis = skewness^2 + 1 up to rounding: two-point distributions, no others."""
    return kurtosis - skewness**2 - 1.0 <= _ROUNDING * (1.0 + kurtosis)


@dataclass(frozen=True)
class SupportEnd:
    """A finite end of the standardised support, where f ~ x^(exponent - 1) at distance x inside.

    Attributes
    ----------
    position
        z of the end; `inside` is +1 at the lower end, -1 at the upper one.
    exponent
        r > 0 of the power law; the density is infinite there for r < 1.
    slope
        |denominator'| at the end, so that the denominator is x (slope + d x).
    regular
        q of the remaining factor g = f / x^(r-1), which obeys g'/g = -q / (slope + d x).
    """

    position: float
    inside: int
    exponent: float
    slope: float
    regular: float


@dataclass(frozen=True)
class PearsonEquation:
    """Eq. (42) for one skewness >= 0 and kurtosis > skewness^2 + 1."""

    skewness: float
    kurtosis: float

    @property
    def a(self) -> float:
        """Coefficient of z in the numerator."""
        return 10.0 * self.kurtosis - 12.0 * self.skewness**2 - 18.0

    @property
    def b(self) -> float:
        """Constant of the numerator and coefficient of z in the denominator."""
        return self.skewness * (self.kurtosis + 3.0)

    @property
    def c(self) -> float:
        """Constant of the denominator; always positive."""
        return 4.0 * self.kurtosis - 3.0 * self.skewness**2

    @property
    def d(self) -> float:
        """Coefficient of z^2: negative for type I and II, 0 for III and normal, else positive."""
        d = 2.0 * self.kurtosis - 3.0 * self.skewness**2 - 6.0
        # Squares of the far root must not overflow; 1e-100 changes nothing within double range.
        return 0.0 if abs(d) < 1e-100 else d

    @property
    def discriminant(self) -> float:
        """b^2 - 4 c d: negative where the denominator has no real root (types IV, VII, normal)."""
        return self.b**2 - 4.0 * self.c * self.d

    @property
    def type(self) -> str:
        """Pearson's name: normal, I, II, III, IV, V, VI or VII."""
        b, c, d = self.b, self.c, self.d
        symmetric = self.skewness <= _LABEL_TOLERANCE
        if abs(d) <= _LABEL_TOLERANCE * c:
            return "normal" if symmetric else "III"
        if d < 0:
            return "II" if symmetric else "I"
        if symmetric:
            return "VII"
        if abs(self.discriminant) <= _LABEL_TOLERANCE * b**2:
            return "V"
        return "IV" if self.discriminant < 0 else "VI"

    @cached_property
    def ends(self) -> tuple[SupportEnd | None, SupportEnd | None]:
        """Lower and upper end of the support; None where it is unbounded."""
        if self.discriminant < 0 or (self.b == 0 and self.d == 0):
            return None, None
        slope = math.sqrt(self.discriminant)
        lower = -2.0 * self.c / (self.b + slope)
        if self.d >= 0:
            return self._end(lower, +1, slope), None
        return self._end(lower, +1, slope), self._end((self.b + slope) / (-2.0 * self.d), -1, slope)

    def _end(self, position: float, inside: int, slope: float) -> SupportEnd:
        # 2 d - a = -6 (k - s^2 - 1): the exponent directly, without 1 + residue.
        gap = self.kurtosis - self.skewness**2 - 1.0
        if slope == 0.0:
            # Type V exactly: an essential singularity, where f vanishes faster than any power.
            return SupportEnd(position, inside, math.inf, 0.0, 0.0)
        exponent = 6.0 * abs(position) * gap / slope
        return SupportEnd(position, inside, exponent, slope, self.a + (exponent - 1.0) * self.d)

    def log_density_slope(self, z: FloatArray) -> FloatArray:
        """f'/f at z, with a denominator that keeps its relative accuracy next to its roots."""
        return np.asarray(-(self.a * z + self.b) / self.denominator(z))

    def denominator(self, z: FloatArray) -> FloatArray:
        """Evaluate c + b z + d z^2, from its roots where there are any."""
        lower, upper = self.ends
        if lower is not None and upper is not None:
            return np.asarray(-self.d * (z - lower.position) * (upper.position - z))
        if lower is not None:
            x = z - lower.position
            return np.asarray(x * (lower.slope + self.d * x))
        if self.d == 0:
            return np.asarray(self.c + 0.0 * z)
        centre, half_width = self.complex_root
        return np.asarray(self.d * ((z - centre) ** 2 + half_width**2))

    @property
    def complex_root(self) -> tuple[float, float]:
        """Real and imaginary part of the complex roots (discriminant < 0, d > 0)."""
        return -self.b / (2.0 * self.d), math.sqrt(-self.discriminant) / (2.0 * self.d)
