"""Exact probabilities behind the hard problems: closed forms, and integrals without sampling.

Nothing here knows uqfold. Inputs are standard normal variables unless a name says otherwise.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from itertools import pairwise
from typing import Any

import numpy as np
from scipy import integrate, optimize, special, stats

REACH = 9.0


def tail(beta: float) -> float:
    """Return P(u > beta)."""
    return float(special.ndtr(-beta))


def average(value: Callable[..., Any], dimension: int = 1, step: float = 0.01) -> float:
    """Return E[value(u_1, ..., u_k)] of a smooth function, by the trapezoidal rule.

    It converges faster than any power of the step, and each node keeps the tail that it holds.
    """
    nodes = np.arange(-REACH, REACH + step / 2, step)
    weights = step * np.exp(-0.5 * nodes**2) / math.sqrt(2.0 * math.pi)
    total = 0.0
    for node, weight in zip(nodes, weights, strict=True):
        if dimension == 1:
            total += weight * float(value(node))
            continue
        # the first variable one by one, the others all at once
        others = np.meshgrid(*[nodes] * (dimension - 1), indexing="ij")
        product = np.ones(1)
        for _ in range(dimension - 1):
            product = np.multiply.outer(product, weights)
        total += weight * float((value(node, *others) * product[0]).sum())
    return total


def pieces(value: Callable[[float], float], *breaks: float) -> float:
    """Return E[value(u)] of a function that is smooth between breaks, by Gauss-Legendre panels."""
    node, weight = np.polynomial.legendre.leggauss(12)
    total = 0.0
    for low, high in pairwise([-REACH, *breaks, REACH]):
        edges = np.linspace(low, high, 2 + int((high - low) / 0.2))
        for start, end in pairwise(edges):
            half = 0.5 * (end - start)
            for u, w in zip(start + half * (1.0 + node), half * weight, strict=True):
                density = math.exp(-0.5 * u * u) / math.sqrt(2.0 * math.pi)
                total += w * density * value(float(u))
    return float(total)


def chi_square(threshold: float, d: int) -> float:
    """Return P(|u|^2 > T) in d variables."""
    return float(stats.chi2.sf(threshold, d))


def chi_square_level(pf: float, d: int) -> float:
    """Return the level that |u|^2 exceeds with probability pf."""
    return float(stats.chi2.isf(pf, d))


def curved_sum(threshold: float, d: int, slope: float, curvature: float) -> float:
    """Return P(sum of (slope u_i + curvature u_i^2) > T): a noncentral chi-square variable."""
    shift = slope / (2.0 * curvature)
    level = threshold / curvature + d * shift**2
    return float(stats.ncx2.sf(level, d, d * shift**2))


def bent(threshold: float, curvature: float, directions: int, scale: float = 1.0) -> float:
    """Return P(scale u_0 + curvature (u_1^2 + ... + u_k^2) > T)."""
    radius = np.linspace(0.0, 15.0, 20_001)
    beyond = special.ndtr((curvature * radius**2 - threshold) / scale)
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


def sum_of_uniforms(threshold: float, d: int) -> float:
    """Return P(U_1 + ... + U_d > T) of Irwin and Hall, in the tail T >= d - 1."""
    return float((d - threshold) ** d / math.factorial(d)) if threshold < d else 0.0


def normal_of_exchangeable(threshold: float, units: int, shared: float, missions: int = 1) -> float:
    """Return P(some of n m responses sqrt(1 - s^2) u_i + s v exceeds T), all of one v."""
    own = math.sqrt(1.0 - shared**2)

    def conditional(v: Any) -> Any:
        works = special.log_ndtr((threshold - shared * v) / own)
        return -np.expm1(units * missions * works)

    return average(conditional)


def clayton(p: float, q: float, theta: float) -> float:
    """Return the Clayton copula C(p, q)."""
    return float((p**-theta + q**-theta - 1.0) ** (-1.0 / theta))


def clayton_sum(threshold: float, theta: float) -> float:
    """Return P(x_1 + x_2 > T) of standard normal margins joined by a Clayton copula."""

    def beyond(u: float) -> float:
        p, q = float(special.ndtr(u)), float(special.ndtr(threshold - u))
        if q <= 0.0:
            return 1.0
        power = -1.0 / theta - 1.0
        return -math.expm1(power * math.log1p(p**theta * math.expm1(-theta * math.log(q))))

    return pieces(beyond, -3.0, 0.0, 2.0, 4.0, 6.0)
