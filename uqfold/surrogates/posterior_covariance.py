"""Covariance between the values of a Gaussian process at different points, given its data."""

from __future__ import annotations

import numpy as np

from uqfold.surrogates.gaussian_process import GaussianProcess
from uqfold.surrogates.hermite import hermite_basis
from uqfold.surrogates.kernels import correlation, scaled_squared_distances
from uqfold.surrogates.likelihood import JITTER
from uqfold.typing import FloatArray


class PosteriorCovariance:
    """Posterior covariance of a fitted process, the uncertainty of its trend included.

    Parameters
    ----------
    process
        The process.

    Attributes
    ----------
    noise_variance
        Variance of a run beside the surface: its noise, and what keeps matrices regular.
    """

    def __init__(self, process: GaussianProcess) -> None:
        from scipy.linalg import solve_triangular

        self._process = process
        variance = process.hyperparameters.process_variance
        covariance = self._prior(process.u, process.u)
        self.noise_variance = process.hyperparameters.noise_variance + JITTER * variance
        covariance[np.diag_indices(process.y.size)] += self.noise_variance
        # in factors rather than inverses: what is left of a large variance keeps its digits
        self._factor = np.linalg.cholesky(covariance)
        basis = hermite_basis(process.u, process.trend)
        self._basis = solve_triangular(self._factor, basis, lower=True, check_finite=False)
        self._triangle = np.linalg.qr(self._basis)[1]

    def __call__(self, a: FloatArray, b: FloatArray) -> FloatArray:
        """Covariances (m, n) between the surface at a (m, d) and at b (n, d)."""
        known_a, trend_a = self._parts(a)
        known_b, trend_b = (known_a, trend_a) if b is a else self._parts(b)
        return np.asarray(self._prior(a, b) - known_a.T @ known_b + trend_a.T @ trend_b)

    def _parts(self, u: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Square roots of what the data explain, and of what they leave open in the trend."""
        from scipy.linalg import solve_triangular

        gp = self._process
        known = solve_triangular(self._factor, self._prior(gp.u, u), lower=True, check_finite=False)
        open_ = hermite_basis(u, gp.trend).T - self._basis.T @ known
        return known, solve_triangular(self._triangle, open_, trans=1, check_finite=False)

    def _prior(self, a: FloatArray, b: FloatArray) -> FloatArray:
        values = self._process.hyperparameters
        squared = scaled_squared_distances(a, b, values.length_scales)
        return np.asarray(values.process_variance * correlation(self._process.kernel, squared))
