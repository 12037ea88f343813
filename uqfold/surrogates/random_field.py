"""Stationary random surfaces, approximated by random Fourier features.

References
----------
Rahimi A., Recht B. Random features for large-scale kernel machines. NIPS 2007.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np

from uqfold.surrogates.kernels import Kernel, spectral_frequencies
from uqfold.time_limit import check_time
from uqfold.typing import FloatArray

_CHUNK = 512


@dataclass(frozen=True, eq=False)
class RandomField:
    """R draws of one field: sums of waves; call it at u (m, d) for (R, m).

    Attributes
    ----------
    frequencies
        Of the waves (d, W).
    amplitudes
        Of their cosines, then their sines (2 W, R).
    """

    frequencies: FloatArray
    amplitudes: FloatArray

    def scaled(self, factor: float) -> RandomField:
        """Multiply all draws by a factor."""
        return replace(self, amplitudes=self.amplitudes * factor)

    def __call__(self, u: FloatArray) -> FloatArray:
        """Values (R, m) at u (m, d)."""
        out = np.empty((self.amplitudes.shape[1], u.shape[0]))
        for start in range(0, u.shape[0], _CHUNK):
            check_time()
            phase = u[start : start + _CHUNK] @ self.frequencies
            half = phase.shape[1]
            some = np.cos(phase) @ self.amplitudes[:half]
            some += np.sin(phase) @ self.amplitudes[half:]
            out[:, start : start + _CHUNK] = some.T
        return out


def random_field(
    kernel: Kernel, length_scales: FloatArray, features: int, count: int, rng: np.random.Generator
) -> RandomField:
    """Draw `count` fields of unit variance with the given correlation.

    Parameters
    ----------
    kernel, length_scales
        Correlation function and its length scales (d,).
    features
        Number of waves, cosines and sines counted apart.
    count
        Number of fields R.
    rng
        Source of randomness.
    """
    half = max(1, features // 2)
    frequencies = spectral_frequencies(kernel, length_scales, half, rng)
    amplitudes = rng.standard_normal((2 * half, count)) / math.sqrt(half)
    return RandomField(frequencies, amplitudes)
