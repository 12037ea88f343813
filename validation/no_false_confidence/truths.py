"""Exact probabilities behind the hard problems: closed forms, and integrals without sampling.

Nothing here knows uqfold. Inputs are standard normal variables unless a name says otherwise.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from functools import reduce
from itertools import pairwise
from typing import Any

import numpy as np
from scipy import integrate, optimize, special, stats

REACH = 9.0


def tail(beta: float) -> float:
    """Return P(u > beta)."""
    return float(special.ndtr(-beta))


def average(value: Callable[..., Any], dimension: int = 1, breaks: Sequence[float] = ()) -> float:
    """Return E[value(u_1, ..., u_k)].

    In one dimension by Gauss-Legendre panels between the breaks of the function; in several, where
    it has to be smooth, by the trapezoidal rule, which converges faster than any power of the step.
    """
    if dimension == 1:
        x, w = np.polynomial.legendre.leggauss(12)
        ends = [
            np.linspace(low, high, 2 + int((high - low) / 0.1))
            for low, high in pairwise([-REACH, *breaks, REACH])
        ]
        left = np.concatenate([part[:-1] for part in ends])
        half = 0.5 * np.concatenate([np.diff(part) for part in ends])
        nodes = np.add.outer(left + half, np.zeros(12)) + np.outer(half, x)
        nodes, weights = nodes.ravel(), np.outer(half, w).ravel()
    else:
        step = 0.05 if dimension == 2 else 0.5
        nodes = np.arange(-REACH, REACH + step / 2, step)
        weights = np.full(len(nodes), step)
    weights = weights * stats.norm.pdf(nodes)
    found = value(*np.meshgrid(*[nodes] * dimension, indexing="ij"))
    return float((reduce(np.multiply.outer, [weights] * dimension) * found).sum())


def either(p: float, q: float) -> float:
    """Return the probability that one of two independent events happens, or both."""
    return p + q - p * q


def curved_sum(threshold: float, d: int, slope: float, curvature: float) -> float:
    """Return P(sum of (slope u_i + curvature u_i^2) > T): a noncentral chi-square variable."""
    shift = slope / (2.0 * curvature)
    level = threshold / curvature + d * shift**2
    return float(stats.ncx2.sf(level, d, d * shift**2))


def bent(threshold: float, curvature: float, directions: int) -> float:
    """Return P(u_0 + curvature (u_1^2 + ... + u_k^2) > T)."""
    radius = np.linspace(0.0, 15.0, 20_001)
    beyond = special.ndtr(curvature * radius**2 - threshold)
    return float(integrate.simpson(beyond * stats.chi.pdf(radius, directions), x=radius))


def sum_of_exponentials(threshold: float, d: int, sigma: float) -> float:
    """Return P(exp(sigma u_1) + ... + exp(sigma u_d) > T) by convolution of densities.

    Either one term is beyond T alone, or all lie below it. Their density there is tilted by
    exp(s x), so that the sum of the tilted variables has its mean at T: the tail is then the body
    of what the Fourier transforms convolve, and no rounding matters.
    """
    size = 1 << 16
    step = threshold / size
    x = (np.arange(size) + 0.5) * step
    mass = step * stats.lognorm.pdf(x, sigma)

    def tilted(s: float) -> Any:
        return mass * np.exp(s * (x - threshold / d))

    def excess(s: float) -> float:
        weights = tilted(s)
        return float(weights @ x / weights.sum()) - threshold / d

    s = float(optimize.brentq(excess, 0.0, 600.0 / threshold))
    weights = tilted(s)
    log_sum = math.log(weights.sum())
    length = d * size
    joined = np.fft.irfft(np.fft.rfft(weights / weights.sum(), length) ** d, length)
    sums = (np.arange(length) + 0.5 * d) * step
    beyond = np.clip((sums - threshold) / step + 0.5, 0.0, 1.0)
    logs = np.where(beyond > 0.0, d * log_sum - s * (sums - threshold), -math.inf)
    alone = -math.expm1(d * math.log1p(-float(stats.lognorm.sf(threshold, sigma))))
    return alone + float(np.maximum(joined, 0.0) @ (np.exp(logs) * beyond))


def clayton(p: float, q: float, theta: float) -> float:
    """Return the Clayton copula C(p, q)."""
    return float((p**-theta + q**-theta - 1.0) ** (-1.0 / theta))


def clayton_sum(threshold: float, theta: float) -> float:
    """Return P(x_1 + x_2 > T) of standard normal margins joined by a Clayton copula."""

    def beyond(u: Any) -> Any:
        p, q = special.ndtr(u), special.ndtr(threshold - u)
        power = -1.0 / theta - 1.0
        return -np.expm1(power * np.log1p(p**theta * np.expm1(-theta * np.log(q))))

    return average(beyond, breaks=[-3.0, 0.0, 2.0, 4.0, 6.0])
