"""Cumulant-generating functions of a standardised response, in the form that saddlepoints need.

With K(0) = 0, K'(0) = 0 and K''(0) = 1 the numbers w and v of Lugannani and Rice are

    w = s sqrt(A(s)),  s^2 A / 2 = s K' - K,        v = s sqrt(B(s)),  B = K'',

and C = (B - A) / s holds what 1 / w - 1 / v is made of near s = 0, where it cancels. All three are
given without cancellation, with their slopes in s.

The sum of r >= 2 known cumulants k_r s^r / r! has

    A = sum 2 (r - 1) k_r s^(r-2) / r!,  B = sum k_r s^(r-2) / (r - 2)!.

A response of degree two in standard normal inputs is, along the eigenvectors of its matrix,
constant + sum (l_i u_i^2 + b_i u_i) with independent u_i. With x = 2 l_i s,

    K(s) = sum [ -log(1 - x) / 2 - l_i s + b_i^2 s^2 / (2 (1 - x)) ]
    A = sum [ 4 l_i^2 g(x) + b_i^2 / (1 - x)^2 ],  g = [ x / (1 - x) + log(1 - x) ] / x^2
    B = sum [ 2 l_i^2 / (1 - x)^2 + b_i^2 / (1 - x)^3 ]
    C = sum [ 4 l_i^3 g'(x) + 2 l_i b_i^2 / (1 - x)^3 ],  g' = [ 1 / (1 - x)^2 - 2 g ] / x

(the first terms are those of Imhof 1961 for quadratic forms, the mean taken off).

References
----------
Imhof J.P. Computing the distribution of quadratic forms in normal variables. Biometrika 48 (1961)
419-426.
Kuonen D. Saddlepoint approximations for distributions of quadratic forms in normal variables.
Biometrika 86 (1999) 929-935.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property
from typing import Protocol

import numpy as np

from uqfold.typing import FloatArray

_TERMS = np.arange(24.0)
_SERIES = 0.15
"""Size of x up to which g is a sum of powers: 0.15^24 is below rounding."""
_UNEXPLAINED = 1e-9
"""Share of the variance that is rounding; a cubic part of 1e-6 moves pf = 1e-6 by a quarter."""


class GeneratingFunction(Protocol):
    """A cumulant-generating function K of a response with mean 0 and variance 1."""

    def slope(self, s: FloatArray) -> FloatArray:
        """K'(s)."""
        ...

    def bend(self, s: FloatArray) -> FloatArray:
        """K''(s)."""
        ...

    def parts(self, s: FloatArray) -> tuple[FloatArray, FloatArray, FloatArray]:
        """A, B and C of the module's docstring."""
        ...

    def slopes(self, s: FloatArray) -> tuple[FloatArray, FloatArray, FloatArray]:
        """Derivatives of A, B and C."""
        ...

    def end(self, direction: float) -> float:
        """How far from 0 the branch with K'' > 0 reaches towards +1 or -1; inf without an end."""
        ...

    @property
    def scale(self) -> float:
        """Distance in s over which K changes its form."""
        ...


@dataclass(frozen=True)
class Cumulants:
    """The sum of a few cumulants: K(s) = s^2 / 2 + k_3 s^3 / 6 + ...

    Attributes
    ----------
    higher
        Standardised cumulants k_3, k_4, ...: skewness, excess kurtosis and so on.
    """

    higher: tuple[float, ...]

    @cached_property
    def _coefficients(self) -> tuple[FloatArray, FloatArray, FloatArray]:
        """Coefficients of A, B and C in powers of s."""
        order = np.arange(2, 3 + len(self.higher))
        factorials = np.array([math.factorial(r - 2) for r in order.tolist()])
        b = np.array([1.0, *self.higher]) / factorials
        a = 2.0 * b / order
        return a, b, (b - a)[1:]

    def slope(self, s: FloatArray) -> FloatArray:
        """K'(s)."""
        b = self._coefficients[1]
        return s * _power_sum(s, b / np.arange(1, 1 + b.size))

    def bend(self, s: FloatArray) -> FloatArray:
        """K''(s)."""
        return _power_sum(s, self._coefficients[1])

    def parts(self, s: FloatArray) -> tuple[FloatArray, FloatArray, FloatArray]:
        """A, B and C."""
        a, b, c = self._coefficients
        return _power_sum(s, a), _power_sum(s, b), _power_sum(s, c)

    def slopes(self, s: FloatArray) -> tuple[FloatArray, FloatArray, FloatArray]:
        """Derivatives of A, B and C."""
        a, b, c = (_derived(one) for one in self._coefficients)
        return _power_sum(s, a), _power_sum(s, b), _power_sum(s, c)

    def end(self, direction: float) -> float:
        """The first zero of K''."""
        b = self._coefficients[1] * direction ** np.arange(1 + len(self.higher))
        return _first_positive_root(b)

    @property
    def scale(self) -> float:
        """Distance over which K changes: 1 / skewness, 1 / sqrt(excess), ..."""
        total = 1.0
        for order, cumulant in enumerate(self.higher, start=1):
            total += math.pow(abs(cumulant), 1.0 / order)
        return 1.0 / total


def _power_sum(s: FloatArray, coefficients: FloatArray) -> FloatArray:
    """Return the sum of coefficients times powers 0, 1, ... of s."""
    total = np.full(s.shape, coefficients[-1])
    for coefficient in coefficients[-2::-1]:
        total = total * s + coefficient
    return np.asarray(total)


def _derived(coefficients: FloatArray) -> FloatArray:
    """Coefficients of the derivative."""
    return np.asarray(coefficients[1:] * np.arange(1, coefficients.size))


def _first_positive_root(coefficients: FloatArray) -> float:
    """Smallest s > 0 at which a polynomial with constant part 1 vanishes; inf if none does."""
    used = np.flatnonzero(coefficients)
    if used[-1] == 0:
        return math.inf
    if used[-1] <= 2:
        _, linear, quadratic = np.pad(coefficients, (0, 2))[:3].tolist()
        discriminant = linear**2 - 4.0 * quadratic
        if discriminant < 0 or (quadratic >= 0 and linear >= 0):
            return math.inf
        denominator = -linear + math.sqrt(discriminant)
        return 2.0 / denominator if denominator > 0 else math.inf
    roots = np.polynomial.polynomial.polyroots(coefficients[: used[-1] + 1])
    real = roots.real[(np.abs(roots.imag) < 1e-9 * np.abs(roots)) & (roots.real > 0.0)]
    return float(real.min()) if real.size else math.inf


@dataclass(frozen=True, eq=False)
class QuadraticForm:
    """The exact K of sum (l_i u_i^2 + b_i u_i) with standard normal u_i, standardised.

    Attributes
    ----------
    squares, linear
        l_i and b_i (q,), with sum (2 l_i^2 + b_i^2) = 1.
    """

    squares: FloatArray
    linear: FloatArray

    @classmethod
    def of(cls, matrix: FloatArray, linear: FloatArray, std: float) -> QuadraticForm | None:
        """Build it for y = constant + u' matrix u + linear' u.

        Parameters
        ----------
        matrix
            Symmetric (q, q).
        linear
            (q,).
        std
            Standard deviation of the response that y stands for; None is returned where that is
            not of degree two, by its variance.
        """
        squares, vectors = np.linalg.eigh(matrix)
        along = vectors.T @ linear
        variance = float(2.0 * squares @ squares + along @ along)
        if not variance >= (1.0 - _UNEXPLAINED) * std**2 > 0.0:
            return None
        return cls(squares / math.sqrt(variance), along / math.sqrt(variance))

    def _terms(self, s: FloatArray) -> tuple[FloatArray, FloatArray, FloatArray]:
        squares, linear = (one.reshape(-1, *(1,) * s.ndim) for one in (self.squares, self.linear))
        return squares, linear, 2.0 * squares * s

    def slope(self, s: FloatArray) -> FloatArray:
        """K'(s)."""
        squares, linear, x = self._terms(s)
        parts = squares * x / (1.0 - x) + linear**2 * s * (1.0 - 0.5 * x) / (1.0 - x) ** 2
        return np.asarray(parts.sum(axis=0))

    def bend(self, s: FloatArray) -> FloatArray:
        """K''(s)."""
        squares, linear, x = self._terms(s)
        near = 1.0 / (1.0 - x)
        return np.asarray((2.0 * squares**2 * near**2 + linear**2 * near**3).sum(axis=0))

    def parts(self, s: FloatArray) -> tuple[FloatArray, FloatArray, FloatArray]:
        """A, B and C."""
        squares, linear, x = self._terms(s)
        g, g_slope = _g(x, 1)
        near = 1.0 / (1.0 - x)
        a = 4.0 * squares**2 * g + linear**2 * near**2
        b = 2.0 * squares**2 * near**2 + linear**2 * near**3
        c = 4.0 * squares**3 * g_slope + 2.0 * squares * linear**2 * near**3
        return a.sum(axis=0), b.sum(axis=0), c.sum(axis=0)

    def slopes(self, s: FloatArray) -> tuple[FloatArray, FloatArray, FloatArray]:
        """Derivatives of A, B and C."""
        squares, linear, x = self._terms(s)
        _, g_slope, g_bend = _g(x, 2)
        near = 1.0 / (1.0 - x)
        a = 4.0 * squares**2 * g_slope + 2.0 * linear**2 * near**3
        b = 4.0 * squares**2 * near**3 + 3.0 * linear**2 * near**4
        c = 4.0 * squares**3 * g_bend + 6.0 * squares * linear**2 * near**4
        a, b, c = (np.asarray((2.0 * squares * one).sum(axis=0)) for one in (a, b, c))
        return a, b, c

    def end(self, direction: float) -> float:
        """The first pole of K."""
        steepest = float((direction * self.squares).max(initial=0.0))
        return 0.5 / steepest if steepest > 0.0 else math.inf

    @property
    def scale(self) -> float:
        """Distance over which K changes: to the nearest pole."""
        return 1.0 / (1.0 + 2.0 * float(np.abs(self.squares).max(initial=0.0)))


def _g(x: FloatArray, order: int) -> list[FloatArray]:
    """Return g(x) of the module's docstring, and its derivatives up to an order of 1 or 2."""
    near = np.abs(x) < _SERIES
    small, large = np.where(near, x, 0.0), np.where(near, 0.5, x)
    one = 1.0 / (1.0 - large)
    g = (large * one + np.log1p(-large)) / large**2
    slope = (one**2 - 2.0 * g) / large
    bend = (2.0 * one**3 - 3.0 * slope) / large
    terms = 1.0 - 1.0 / (_TERMS + 2.0)
    found = []
    for value in (g, slope, bend)[: order + 1]:
        found.append(np.asarray(np.where(near, _power_sum(small, terms), value)))
        terms = _derived(terms)
    return found
