"""Integrals that give failure probabilities, with their errors."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence

import numpy as np

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

    Parameters
    ----------
    level
        The level.
    terms
        Each a function of a standard-normal variable of its own, and how often it occurs.
    nodes
        Nodes over that variable; more where a function oscillates.

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
        wave = np.exp(-1j * t * level)
        for value, times in values:
            wave *= (np.exp(1j * np.outer(t, value)) @ weight) ** times
        found.append(0.5 - float((wave.imag / t).sum()) * step / spread / np.pi)
    return found[1], abs(found[1] - found[0]) + 1e-15


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
