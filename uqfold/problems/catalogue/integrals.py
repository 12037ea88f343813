"""Integrals that give failure probabilities, with their errors."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence

import numpy as np
import numpy.typing as npt

from uqfold.typing import FloatArray

FARTHEST = 12.0
"""Standard deviations to integrate over: what lies beyond has a probability of 4e-33."""
ROUNDING = 1e-13
"""Relative error of a closed form, and the least that is claimed for an integral."""


def closed(pf: float) -> tuple[float, float]:
    """Return a failure probability known in closed form, and its error."""
    return float(pf), ROUNDING * float(pf)


def normal_cdf(u: float) -> float:
    """Return the distribution function of a standard-normal variable."""
    return 0.5 * math.erfc(-u / math.sqrt(2.0))


def normal_pdf(u: FloatArray) -> FloatArray:
    """Return the density (n,) of a standard-normal variable."""
    return np.asarray(np.exp(-0.5 * u * u) / math.sqrt(2.0 * math.pi))


def refined(by_rule: Callable[[int], float], coarse: int, fine: int) -> tuple[float, float]:
    """Return what a rule finds with the finer of two numbers of nodes, and its error.

    The error is the difference between the two, plus rounding.
    """
    pf = by_rule(fine)
    return pf, abs(pf - by_rule(coarse)) + 1e-12 * pf


def over_normal(tail: Callable[[float], float], *kinks: float) -> tuple[float, float]:
    """Return the mean of a function of one standard-normal variable, and its error.

    Parameters
    ----------
    tail
        Probability of failure given the variable.
    kinks
        Where it, or its derivative, jumps.
    """
    from scipy.integrate import quad

    def weighted(u: float) -> float:
        return math.exp(-0.5 * u * u) / math.sqrt(2.0 * math.pi) * tail(u)

    places = sorted({*range(-9, 10), *kinks})
    pf, error = quad(
        weighted, -FARTHEST, FARTHEST, points=places, epsabs=0.0, epsrel=1e-12, limit=1000
    )
    return pf, max(error, ROUNDING * pf)


def of_sum(
    level: float,
    terms: Sequence[tuple[Callable[[FloatArray], FloatArray], int]],
    nodes: int = 2001,
) -> tuple[float, float]:
    """Return the probability that a sum of independent terms is at most a level, and its error.

    The arguments are those of `of_sums`.
    """
    pf, error = of_sums(np.array([level]), terms, nodes)
    return float(pf[0]), error


def of_sums(
    levels: FloatArray,
    terms: Sequence[tuple[Callable[[FloatArray], FloatArray], int]],
    nodes: int = 2001,
) -> tuple[FloatArray, float]:
    """Return the probabilities that a sum of independent terms is at most each level.

    Parameters
    ----------
    levels
        Levels (n,), no more than 14 standard deviations of the sum away from its mean.
    terms
        Each a function of a standard-normal variable of its own, and how often it occurs.
    nodes
        Nodes over that variable; more where a function oscillates.

    Returns
    -------
    tuple
        The probabilities (n,) and the largest of their errors.

    Notes
    -----
    By the inversion of Gil-Pelaez (1951), P(S <= a) = 1/2 - 1/pi int Im[exp(-i t a) f(t)] / t dt
    over t > 0, where f is the product of the characteristic functions of the terms. The rules of
    midpoints (t) and trapezia (u) converge faster than any power of their steps; the error is the
    change with another step of t, plus rounding.
    """
    u = np.linspace(-9.0, 9.0, nodes)
    weight = np.exp(-0.5 * u * u)
    weight /= weight.sum()
    values = [(term(u), times) for term, times in terms]
    means = [float(value @ weight) for value, _ in values]
    variance = sum(
        times * float((value - mean) ** 2 @ weight)
        for (value, times), mean in zip(values, means, strict=True)
    )
    spread = variance**0.5
    found = []
    for step in (0.2, 0.16):
        t = (np.arange(0.0, 14.0, step) + 0.5 * step) / spread
        wave = np.exp(-1j * np.outer(levels, t))
        for value, times in values:
            wave *= _means_of_waves(t[0], step / spread, t.size, value, weight) ** times
        found.append(0.5 - (wave.imag / t).sum(axis=1) * step / spread / np.pi)
    return found[1], float(np.abs(found[1] - found[0]).max()) + 1e-15


def _means_of_waves(
    first: float, step: float, count: int, values: FloatArray, weight: FloatArray
) -> npt.NDArray[np.complex128]:
    """Return the weighted means (count,) of exp(i t v) over values, for t in equal steps."""
    wave, turn = weight * np.exp(1j * first * values), np.exp(1j * step * values)
    means = np.empty(count, dtype=complex)
    for k in range(count):
        means[k] = wave.sum()
        wave *= turn
    return means


def normal_rule(mean: float, std: float, nodes: int) -> tuple[FloatArray, FloatArray]:
    """Return nodes and weights of the rule of Gauss and Hermite for a normal variable."""
    u, weight = np.polynomial.hermite_e.hermegauss(nodes)
    return mean + std * u, weight / weight.sum()


def panel_rule(low: float, high: float, panels: int) -> tuple[FloatArray, FloatArray]:
    """Return nodes and weights of four Gauss-Legendre points in each of equal panels."""
    x, weight = np.polynomial.legendre.leggauss(4)
    half = 0.5 * (high - low) / panels
    centres = low + half * (2.0 * np.arange(panels) + 1.0)
    return (centres[:, None] + half * x).ravel(), np.tile(half * weight, panels)


def over_normals(
    given: Callable[..., FloatArray],
    dimension: int,
    steps: tuple[float, float] = (0.25, 0.2),
    stretch: Sequence[float] = (),
) -> tuple[float, float]:
    """Return the mean of a smooth function of several standard-normal variables, and its error.

    Parameters
    ----------
    given
        Probability of failure given the variables, each an array; they broadcast.
    dimension
        How many there are.
    steps
        Of two rules of trapezia, which converge faster than any power of their steps; the error is
        the difference between the two.
    stretch
        By how much the step of each variable is longer.
    """
    found = []
    for step in steps:
        own = step * np.array(stretch or [1.0] * dimension)
        nodes = [np.arange(-8.5, 8.5 + h, h) for h in own]
        mean = np.broadcast_to(given(*np.ix_(*nodes)), [u.size for u in nodes])
        for u, h in zip(nodes[::-1], own[::-1], strict=True):
            mean = mean @ (h * normal_pdf(u))
        found.append(float(mean))
    return found[1], max(abs(found[1] - found[0]), ROUNDING * found[1])
