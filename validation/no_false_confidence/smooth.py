"""Smooth responses of normal inputs: linear, bent, closed around the origin, with heavy tails."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any

import numpy as np
from scipy import special, stats

from validation.no_false_confidence import truths
from validation.no_false_confidence.hard import Hard
from validation.no_false_confidence.truths import tail


def linear(d: int, pf: float) -> Hard:
    """A weighted sum; its reliability index is the threshold."""
    weights = np.arange(1.0, d + 1.0) ** -0.5
    weights /= math.sqrt(float(weights @ weights))
    beta = float(-special.ndtri(pf))
    return Hard(
        f"linear, {d} inputs, {pf:g}", "linear", d, lambda x: x @ weights, beta,
        lambda: tail(beta), smooth=True,
    )  # fmt: skip


def mild(d: int, threshold: float, curvature: float) -> Hard:
    """All inputs matter alike, each bent a little."""
    slope = 1.0 / math.sqrt(d)
    return Hard(
        f"mildly curved, {d} inputs, T = {threshold:g}", "curved", d,
        lambda x: slope * x.sum(axis=1) + curvature * (x**2).sum(axis=1), threshold,
        lambda: truths.curved_sum(threshold, d, slope, curvature), smooth=True,
    )  # fmt: skip


def bent(d: int, directions: int, threshold: float, curvature: float) -> Hard:
    """Linear in the first input, curved in some of the others, without the rest."""
    return Hard(
        f"curved in {directions} of {d} inputs, T = {threshold:g}", "curved", d,
        lambda x: x[:, 0] + curvature * (x[:, 1 : directions + 1] ** 2).sum(axis=1), threshold,
        lambda: truths.bent(threshold, curvature, directions), smooth=True,
    )  # fmt: skip


def sphere(d: int, pf: float) -> Hard:
    """Failure all around."""
    return Hard(
        f"|x|^2, {d} inputs, {pf:g}", "failure all around", d, lambda x: (x**2).sum(axis=1),
        float(stats.chi2.isf(pf, d)), lambda: pf, smooth=True,
    )  # fmt: skip


def exponentials(d: int, sigma: float, threshold: float) -> Hard:
    """A sum of exponentials of normal variables: one large term is enough."""
    return Hard(
        f"{d} exponentials, sigma = {sigma:g}", "heavy tails", d,
        lambda x: np.exp(sigma * x).sum(axis=1), threshold,
        lambda: truths.sum_of_exponentials(threshold, d, sigma), smooth=True,
    )  # fmt: skip


def waiting(d: int, pf: float) -> Hard:
    """A sum of exponential variables."""
    return Hard(
        f"{d} exponential variables, {pf:g}", "skewed inputs", d, lambda x: x.sum(axis=1),
        float(stats.gamma.isf(pf, d)), lambda: pf, smooth=True,
        inputs=lambda: [stats.expon() for _ in range(d)],
    )  # fmt: skip


def lognormal(name: str, kind: str, slopes: Sequence[float], pf: float, **more: Any) -> Hard:
    """A product of lognormal variables."""
    factors = np.array(slopes)
    beta = float(-special.ndtri(pf))
    return Hard(
        f"{name}, {pf:g}", kind, len(factors), lambda x: np.exp(x @ factors),
        math.exp(math.sqrt(float(factors @ factors)) * beta), lambda: pf, **more,
    )  # fmt: skip


def powers_of_ten(sigma: float, pf: float) -> Hard:
    """A response that spans many powers of ten."""
    slopes = sigma * np.array([0.6, 0.64, 0.48])
    return lognormal(f"exp({sigma:g} u)", "scales", slopes, pf)


SMOOTH = [
    linear(1, 0.9), linear(2, 1e-8), linear(10, 1e-6), linear(50, 1e-4), linear(100, 1e-6),
    mild(2, 3.5, 0.1), mild(10, 4.0, 0.03), mild(30, 4.5, 0.02), mild(49, 5.0, 0.02),
    bent(2, 1, 3.0, 0.2), bent(8, 3, 5.0, -0.1), bent(100, 5, 5.5, 0.1),
    sphere(2, 1e-4), sphere(8, 1e-4), sphere(10, 1e-2),
    exponentials(2, 1.0, 22.0), exponentials(5, 0.5, 15.0),
    waiting(2, 1e-5), waiting(20, 1e-3), waiting(100, 1e-7), powers_of_ten(8.0, 1e-3),
]  # fmt: skip
