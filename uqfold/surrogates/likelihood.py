"""Length scales, process and noise variance of a Gaussian process, by restricted likelihood.

The trend coefficients are integrated out, so that a trend of many terms does not make the process
look smaller than it is (REML). Weak priors keep what the data do not determine in a sane range.

References
----------
Stein M. L. Interpolation of Spatial Data: Some Theory for Kriging. Springer, 1999, section 6.4.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np

from uqfold.surrogates.kernels import Kernel, correlation_and_slope, scaled_squared_distances
from uqfold.time_limit import check_time
from uqfold.typing import FloatArray

# In standard-normal space, where the inputs have spread one: a prior on length scales that holds
# 95 % between 0.3 and 50, and hard ends far outside of it.
_LENGTH_PRIOR = (math.log(4.0), 1.3)
_LENGTH_RANGE = (0.05, 500.0)
# Responses are standardised, so that variances are relative to theirs.
_PROCESS_RANGE = (1e-10, 1e8)
_NOISE_RANGE = (1e-14, 1.0)
_NOT_POSITIVE_DEFINITE = 1e25
ONE_SCALE_FROM = 50
"""Inputs from which one length scale is learned for all of them."""
JITTER = 1e-8
"""Noise relative to the process variance, always present.

It keeps the Cholesky factor in existence, and length scales from growing until rounding, of which
the posterior knows nothing, is the largest error.
"""


@dataclass(frozen=True, eq=False)
class Hyperparameters:
    """Length scales (d,) in standard deviations; variances in the squared unit of the response."""

    length_scales: FloatArray
    process_variance: float
    noise_variance: float

    def scaled(self, factor: float) -> Hyperparameters:
        """Express the variances for responses multiplied by `factor`."""
        return replace(
            self,
            process_variance=self.process_variance * factor**2,
            noise_variance=self.noise_variance * factor**2,
        )


def estimate_hyperparameters(
    u: FloatArray,
    y: FloatArray,
    basis: FloatArray,
    kernel: Kernel,
    starts: list[Hyperparameters],
    noise_variance: float | None,
) -> Hyperparameters:
    """Maximise the penalised restricted likelihood from each start and keep the best.

    Parameters
    ----------
    u
        Points (n, d) in standard-normal space.
    y
        Responses (n,) of about unit variance.
    basis
        Trend functions at the points (n, p), n > p.
    kernel
        Correlation function.
    starts
        Where the search starts.
    noise_variance
        Known, or None to learn it.
    """
    from scipy.optimize import minimize

    objective = _Objective(u, y, basis, kernel, noise_variance)
    bounds = [tuple(np.log(_LENGTH_RANGE))] * objective.scales + [tuple(np.log(_PROCESS_RANGE))]
    if noise_variance is None:
        bounds.append(tuple(np.log(_NOISE_RANGE)))
    best_value, best = math.inf, objective.pack(starts[0])
    options = {"maxiter": 80, "ftol": 1e-8, "gtol": 1e-4}
    for start in starts:
        x0 = np.clip(objective.pack(start), *np.array(bounds).T)
        found = minimize(objective, x0, jac=True, method="L-BFGS-B", bounds=bounds, options=options)
        if found.fun < best_value:
            best_value, best = float(found.fun), found.x
    return objective.unpack(best)


@dataclass(frozen=True, eq=False)
class Starts:
    """Where to start the search for hyperparameters."""

    rng: np.random.Generator
    dimension: int

    def draw(self, count: int) -> list[Hyperparameters]:
        """Return `count` starts: a smooth one, then random ones."""
        starts = [Hyperparameters(np.full(self.dimension, 3.0), 1.0, 1e-6)]
        for _ in range(count - 1):
            spread = np.exp(self.rng.uniform(math.log(0.7), math.log(20.0), self.dimension))
            noise = math.exp(self.rng.uniform(math.log(1e-10), math.log(1e-2)))
            starts.append(Hyperparameters(spread, 1.0, noise))
        return starts


class _Objective:
    """Minus twice the restricted log likelihood plus priors, with gradient."""

    def __init__(
        self,
        u: FloatArray,
        y: FloatArray,
        basis: FloatArray,
        kernel: Kernel,
        noise_variance: float | None,
    ) -> None:
        self.y, self.basis, self.kernel = y, basis, kernel
        self.noise_variance = noise_variance
        self.dimension = u.shape[1]
        # matrices are symmetric: what lies below the diagonal, row by row, tells them
        self.row, self.column = np.tril_indices(y.size, -1)
        self.below = self.row * y.size + self.column
        if self.dimension < ONE_SCALE_FROM:
            self.squares = (u[self.row] - u[self.column]).T ** 2
        else:
            whole = scaled_squared_distances(u, u, np.ones(self.dimension))
            self.squares = whole[None, self.row, self.column]
        self.scales = self.squares.shape[0]

    def pack(self, values: Hyperparameters) -> FloatArray:
        lengths = np.log(values.length_scales[: self.scales])
        logs = [*lengths, math.log(values.process_variance)]
        if self.noise_variance is None:
            logs.append(math.log(max(values.noise_variance, _NOISE_RANGE[0])))
        return np.array(logs)

    def unpack(self, logs: FloatArray) -> Hyperparameters:
        d = self.scales
        noise = self.noise_variance
        return Hyperparameters(
            length_scales=np.exp(np.broadcast_to(logs[:d], self.dimension)),
            process_variance=math.exp(logs[d]),
            noise_variance=math.exp(logs[d + 1]) if noise is None else noise,
        )

    def __call__(self, logs: FloatArray) -> tuple[float, FloatArray]:
        check_time()
        values, d, n = self.unpack(logs), self.scales, self.y.size
        inverse_squares = values.length_scales[:d] ** -2.0
        variance = values.process_variance
        related, slope = correlation_and_slope(self.kernel, inverse_squares @ self.squares)
        covariance = np.zeros((n, n))
        covariance.ravel()[self.below] = variance * related
        jitter = JITTER * variance
        covariance[np.diag_indices(n)] = variance + values.noise_variance + jitter
        try:
            projection = Projection(covariance, self.basis)
        except np.linalg.LinAlgError:
            return _NOT_POSITIVE_DEFINITE, np.zeros(logs.size)
        alpha = projection.matrix @ self.y
        value = projection.log_determinant + float(self.y @ alpha)
        sensitivity = projection.matrix.ravel()[self.below] - alpha[self.row] * alpha[self.column]
        trace = float(np.trace(projection.matrix) - alpha @ alpha)
        gradient = np.empty(logs.size)
        slope *= sensitivity
        gradient[:d] = 2.0 * variance * (self.squares @ slope) * inverse_squares
        gradient[d] = 2.0 * variance * float(sensitivity @ related) + (variance + jitter) * trace
        if self.noise_variance is None:
            gradient[d + 1] = values.noise_variance * trace
        centre, spread = _LENGTH_PRIOR
        deviation = (logs[:d] - centre) / spread
        value += float(deviation @ deviation)
        gradient[:d] += 2.0 * deviation / spread
        return value, gradient


class Projection:
    """Inverse of a covariance matrix with the trend projected out; its lower half is read.

    Attributes
    ----------
    matrix
        P = K^-1 - K^-1 F (F' K^-1 F)^-1 F' K^-1, (n, n): the inverse under trends F (n, p).
    coefficients
        Generalised-least-squares operator (p, n): trend coefficients from responses.
    trend_covariance
        (F' K^-1 F)^-1, (p, p).
    log_determinant
        log |K| + log |F' K^-1 F|.

    Raises
    ------
    numpy.linalg.LinAlgError
        If the covariance is not positive definite, or the trend functions are dependent.
    """

    def __init__(self, covariance: FloatArray, basis: FloatArray) -> None:
        from scipy.linalg import solve_triangular
        from scipy.linalg.lapack import dpotri

        p = basis.shape[1]
        factor = np.linalg.cholesky(covariance)
        triangle = dpotri(factor.T)[0]
        inverse = triangle + triangle.T
        inverse[np.diag_indices_from(inverse)] *= 0.5
        whitened = solve_triangular(factor, basis, lower=True, check_finite=False)
        q, r = np.linalg.qr(whitened)
        diagonal = np.abs(np.diag(r))
        if p and not diagonal.min() > 1e-12 * diagonal.max():
            raise np.linalg.LinAlgError("dependent trend functions")
        reduced = solve_triangular(factor, q, lower=True, trans=1, check_finite=False)
        self.matrix = inverse - reduced @ reduced.T
        self.log_determinant = 2.0 * float(np.log(np.diag(factor)).sum() + np.log(diagonal).sum())
        self.coefficients = solve_triangular(r, reduced.T, check_finite=False)
        half = solve_triangular(r, np.eye(p), check_finite=False)
        self.trend_covariance = half @ half.T
