"""Stationary anisotropic correlation functions, and their spectra for random features."""

from __future__ import annotations

from typing import Literal, TypeAlias

import numpy as np

from uqfold.typing import FloatArray

Kernel: TypeAlias = Literal["gaussian", "matern52"]
"""``gaussian``: infinitely smooth surfaces; ``matern52``: twice differentiable ones."""
KernelChoice: TypeAlias = Literal["best", "gaussian", "matern52"]
"""A kernel, or whichever predicts left-out runs best."""


def correlation(kernel: Kernel, squared: FloatArray) -> FloatArray:
    """Correlation of two points from their squared scaled distance sum_i (du_i / l_i)^2."""
    if kernel == "gaussian":
        half = -0.5 * squared
        return np.exp(half, out=half)
    a = np.sqrt(5.0 * squared)
    polynomial = a / 3.0
    polynomial += 1.0
    polynomial *= a
    polynomial += 1.0
    polynomial *= np.exp(np.negative(a, out=a), out=a)
    return polynomial


def correlation_and_slope(kernel: Kernel, squared: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Correlation, and its derivative in log(l_i), divided by the scaled square (du_i / l_i)^2."""
    if kernel == "gaussian":
        related = np.exp(-0.5 * squared)
        return related, related.copy()
    a = np.sqrt(5.0 * squared)
    fading = np.exp(-a)
    return (1.0 + a + a * a / 3.0) * fading, 5.0 / 3.0 * (1.0 + a) * fading


def scaled_squared_distances(a: FloatArray, b: FloatArray, length_scales: FloatArray) -> FloatArray:
    """Squared scaled distances (m, n) between the rows of a (m, d) and b (n, d)."""
    a, b = a / length_scales, b / length_scales
    squared = a @ (-2.0 * b.T)
    squared += (a * a).sum(axis=1)[:, None]
    squared += (b * b).sum(axis=1)
    return np.asarray(np.maximum(squared, 0.0, out=squared))


def spectral_frequencies(
    kernel: Kernel, length_scales: FloatArray, size: int, rng: np.random.Generator
) -> FloatArray:
    """Draw frequencies (d, size) from the spectral density of the correlation function."""
    frequencies = rng.standard_normal((length_scales.size, size)) / length_scales[:, None]
    if kernel == "matern52":
        # the spectrum of the Matern 5/2 correlation is a multivariate t with 5 degrees of freedom
        frequencies = frequencies * np.sqrt(5.0 / rng.chisquare(5.0, size))
    return np.asarray(frequencies)
