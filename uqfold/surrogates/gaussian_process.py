"""Gaussian-process regression (universal Kriging) in standard-normal space.

The response is modelled as a polynomial trend, a stationary process and independent noise. The
noise stands for what the model does at the smallest scale (chaotic impacts, solver tolerances):
the surface smooths over it, and its posterior does not shrink below what it allows.

References
----------
Rasmussen C. E., Williams C. K. I. Gaussian Processes for Machine Learning. MIT Press, 2006.
Wilson J. T. et al. Efficiently sampling functions from Gaussian process posteriors. ICML 2020.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from uqfold.algebra import one_blas_thread
from uqfold.checks import or_none, real, refused
from uqfold.surrogates.centring import centre_of
from uqfold.surrogates.cross_validation import LeaveOneOut
from uqfold.surrogates.hermite import hermite_basis, total_degree_indices
from uqfold.surrogates.kernels import (
    Kernel,
    correlation,
    scaled_squared_distances,
)
from uqfold.surrogates.likelihood import (
    JITTER,
    Hyperparameters,
    Projection,
    Starts,
    estimate_hyperparameters,
)
from uqfold.surrogates.random_field import RandomField, random_field
from uqfold.surrogates.selection import MANY_INPUTS
from uqfold.time_limit import check_time
from uqfold.typing import FloatArray, IntArray

LARGEST_NOISE = 1e100
"""As a standard deviation, and in those of the responses: its square has to fit into a float."""
# Rows handled at once: keeps the distance matrix to a hundred runs in a core's own cache.
_CHUNK = 512
# Hyperparameters are learned on at most so many points: the cost grows with the cube.
_LEARNED_ON = 300
# Squared differences of coordinates of these points: bounds memory where variables are many.
_MOST_SQUARES = 40_000_000


@dataclass(frozen=True, eq=False)
class GaussianProcess:
    """Posterior of a Gaussian process given its training data; built by `fit_gaussian_process`.

    Attributes
    ----------
    u, y
        Training points (n, d) in standard-normal space and responses (n,).
    kernel
        Correlation function.
    trend
        Multi-indices (p, d) of the Hermite polynomials that form the trend.
    hyperparameters
        Length scales (in standard deviations), process and noise variance.
    rotation
        Directions in columns (d, d) along which the variables of trend and process are measured;
        None: the inputs themselves.
    """

    u: FloatArray
    y: FloatArray
    kernel: Kernel
    trend: IntArray
    hyperparameters: Hyperparameters
    rotation: FloatArray | None = None

    @property
    def size(self) -> int:
        """Number of training points."""
        return self.y.size

    @property
    def noise_std(self) -> float:
        """Standard deviation of the noise, in the unit of the response."""
        return math.sqrt(self.hyperparameters.noise_variance)

    @cached_property
    def _projection(self) -> Projection:
        variance = self.hyperparameters.process_variance
        covariance = variance * self._correlation(self._points)
        noise = self.hyperparameters.noise_variance + JITTER * variance
        covariance[np.diag_indices(self.y.size)] += noise
        return Projection(covariance, hermite_basis(self._points, self.trend))

    @cached_property
    def _points(self) -> FloatArray:
        return _turned(self.u, self.rotation)

    @cached_property
    def _centre(self) -> float:
        return centre_of(self.y)

    @cached_property
    def _weights(self) -> tuple[FloatArray, FloatArray]:
        """Kernel weights (n,) and trend coefficients (p,) of the posterior mean."""
        return self._weights_of(self.y - self._centre)

    def _weights_of(self, responses: FloatArray) -> tuple[FloatArray, FloatArray]:
        p = self._projection
        variance = self.hyperparameters.process_variance
        return variance * (p.matrix @ responses), p.coefficients @ responses

    def _correlation(self, u: FloatArray) -> FloatArray:
        """Correlations (m, n) with the training points of turned points (m, d)."""
        squared = scaled_squared_distances(u, self._points, self.hyperparameters.length_scales)
        return correlation(self.kernel, squared)

    def mean(self, u: FloatArray) -> FloatArray:
        """Posterior mean of the surface (m,) at u (m, d)."""
        kernel, trend = self._weights
        u, out = _turned(u, self.rotation), np.empty(u.shape[0])
        for rows in _chunks(u.shape[0]):
            out[rows] = hermite_basis(u[rows], self.trend) @ trend
            out[rows] += self._correlation(u[rows]) @ kernel
        return out + self._centre

    def std(self, u: FloatArray) -> FloatArray:
        """Posterior standard deviation of the surface (m,) at u (m, d), noise not included."""
        return self.mean_and_std(u)[1]

    def mean_and_std(self, u: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Posterior mean and standard deviation of the surface, each (m,), at u (m, d)."""
        p, variance = self._projection, self.hyperparameters.process_variance
        kernel, trend = self._weights
        u = _turned(u, self.rotation)
        mean, spread = np.empty(u.shape[0]), np.empty(u.shape[0])
        for rows in _chunks(u.shape[0]):
            basis, cross = hermite_basis(u[rows], self.trend), self._correlation(u[rows])
            mean[rows] = basis @ trend + cross @ kernel
            # prior - explained + trend, with the trend's share of the cross terms
            cross = variance * cross
            explained = ((cross @ p.matrix) * cross).sum(axis=1)
            mixed = (basis * (cross @ p.coefficients.T)).sum(axis=1)
            of_trend = ((basis @ p.trend_covariance) * basis).sum(axis=1)
            spread[rows] = variance - explained - 2.0 * mixed + of_trend
        floor = JITTER * variance
        return mean + self._centre, np.sqrt(np.maximum(spread, floor))

    def product(self, first: FloatArray, second: FloatArray) -> float:
        """Return first' P second of values (n,) at the runs, whatever the trend is of both."""
        return float((first - first.mean()) @ self._projection.matrix @ (second - second.mean()))

    def leave_one_out(self) -> LeaveOneOut:
        """Leave-one-out residuals and their stated standard deviations, from one factorisation."""
        diagonal = np.diag(self._projection.matrix)
        residuals = (self._projection.matrix @ (self.y - self._centre)) / diagonal
        return LeaveOneOut(residuals, np.sqrt(1.0 / diagonal))

    def sample_paths(
        self, rng: np.random.Generator, count: int, features: int = 512
    ) -> SamplePaths:
        """Draw whole surfaces from the posterior.

        A prior draw by random features is corrected by what its own Kriging would predict from
        the training points (Matheron's rule), so that each path is one function of u, consistent
        over all points it is asked for.

        Parameters
        ----------
        rng
            Source of randomness.
        count
            Number of paths R.
        features
            Number of random features of the prior draw.
        """
        values = self.hyperparameters
        field = random_field(self.kernel, values.length_scales, features, count, rng)
        prior = field.scaled(math.sqrt(values.process_variance))
        noise = self.noise_std * rng.standard_normal((self.y.size, count))
        weights, trend = self._weights_of(
            (self.y - self._centre)[:, None] - prior(self._points).T - noise
        )
        return SamplePaths(self, weights, trend, prior)

    def without(self, groups: Sequence[IntArray]) -> SamplePaths:
        """Return the surfaces that some runs less would have given, hyperparameters kept.

        Parameters
        ----------
        groups
            For each surface the runs (k,) that it leaves out.
        """
        responses, matrix = self.y - self._centre, self._projection.matrix
        # runs that a fit to all others foretells exactly teach nothing
        foretold = np.tile(responses[:, None], len(groups))
        missed = matrix @ responses
        for column, some in enumerate(groups):
            own = np.linalg.lstsq(matrix[np.ix_(some, some)], missed[some], rcond=None)[0]
            foretold[some, column] -= own
        return SamplePaths(self, *self._weights_of(foretold))


@dataclass(frozen=True, eq=False)
class SamplePaths:
    """R surfaces with the correlations of one process; call it at u (m, d) for (R, m).

    Attributes
    ----------
    process
        The process.
    weights, trend
        Weights (n, R) of its training points, and trend coefficients (p, R).
    prior
        A draw from the process before its runs, to which these are added.
    """

    process: GaussianProcess
    weights: FloatArray
    trend: FloatArray
    prior: RandomField | None = None

    def __call__(self, u: FloatArray) -> FloatArray:
        """Values (R, m) of the R paths at u (m, d)."""
        gp = self.process
        u = _turned(u, gp.rotation)
        out = np.empty((self.weights.shape[1], u.shape[0]))
        for rows in _chunks(u.shape[0]):
            some = u[rows]
            values = gp._correlation(some) @ self.weights
            values += hermite_basis(some, gp.trend) @ self.trend
            out[:, rows] = values.T
        drawn = 0.0 if self.prior is None else self.prior(u)
        return drawn + out + gp._centre


def checked_noise(name: str, value: object) -> float:
    """Return a standard deviation of noise; its square has to fit into a float."""
    return real(name, value, at_least=0.0, at_most=LARGEST_NOISE, what="standard deviation")


@one_blas_thread()
def fit_gaussian_process(
    u: FloatArray,
    y: FloatArray,
    *,
    noise: float | None = None,
    trend: int | IntArray = 0,
    kernel: Kernel = "gaussian",
    rng: np.random.Generator | None = None,
    start: GaussianProcess | None = None,
    rotation: FloatArray | None = None,
) -> GaussianProcess:
    """Fit a Gaussian process to responses.

    Parameters
    ----------
    u
        Points (n, d) in standard-normal space.
    y
        Finite responses (n,).
    noise
        Standard deviation of the noise in the unit of the response; 0 interpolates; None learns
        it from the data.
    trend
        Total degree of the polynomial trend, or the multi-indices (p, d) of its Hermite
        polynomials. The degree is lowered, or the list cut, until there are two points per term.
    kernel
        ``gaussian`` or ``matern52``.
    rng
        Source of the random starts of the likelihood search; None starts from fixed seeds.
    start
        A process fitted before to similar data: the search starts from its hyperparameters alone,
        which is several times quicker.
    rotation
        Orthonormal directions in columns (d, d) along which trend and process have their
        variables; None: the inputs themselves.

    Raises
    ------
    ValueError
        If shapes do not fit, a value is not finite, or there are fewer than 2 points.
    """
    u, y = np.asarray(u, dtype=float), np.asarray(y, dtype=float)
    if u.ndim != 2 or y.shape != (u.shape[0],) or u.shape[0] < 2:
        raise ValueError(f"u has shape {u.shape}, y {y.shape}: expected (n, d) and (n,), n >= 2")
    if not (np.isfinite(u).all() and np.isfinite(y).all()):
        raise ValueError("u and y must be finite: leave out failed runs and infinite responses")
    noise = or_none("noise", noise, checked_noise)
    learned_on = _LEARNED_ON
    if u.shape[1] >= MANY_INPUTS and not isinstance(trend, int):
        learned_on = max(learned_on, 2 * trend.shape[0])
    learned_on = min(learned_on, math.isqrt(_MOST_SQUARES // u.shape[1]))
    few, points = np.arange(y.size), _turned(u, rotation)
    indices = _trend_indices(trend, u.shape[1], min(y.size, learned_on) // 2)
    centre, scale = centre_of(y), float(y.std())
    if scale <= 1e-14 * abs(centre):
        # a constant response: nothing to learn
        nothing = Hyperparameters(np.full(u.shape[1], 3.0), 1e-200 + scale**2, 0.0)
        return GaussianProcess(u, y, kernel, indices[:1], nothing, rotation)
    if noise is not None and noise / scale > LARGEST_NOISE:
        remedy = f"give less; the responses have the standard deviation {scale:.3g}"
        raise refused("noise", noise, remedy)
    rng = np.random.default_rng(0) if rng is None else rng
    if start is not None:
        starts = [start.hyperparameters.scaled(1.0 / scale)]
    else:
        starts = Starts(rng, u.shape[1]).draw(2)
    if y.size > learned_on:
        few = rng.choice(y.size, learned_on, replace=False)
    found = estimate_hyperparameters(
        points[few],
        (y[few] - centre) / scale,
        hermite_basis(points[few], indices),
        kernel,
        starts,
        None if noise is None else (noise / scale) ** 2,
    )
    return GaussianProcess(u, y, kernel, indices, found.scaled(scale), rotation)


def _turned(u: FloatArray, rotation: FloatArray | None) -> FloatArray:
    return u if rotation is None else u @ rotation


def _trend_indices(trend: int | IntArray, dimension: int, most: int) -> IntArray:
    if not isinstance(trend, int):
        return trend[: max(1, most)]
    while trend > 0 and math.comb(dimension + trend, trend) > most:
        trend -= 1
    return total_degree_indices(dimension, trend)


def _chunks(size: int) -> Iterator[slice]:
    for start in range(0, size, _CHUNK):
        check_time()
        yield slice(start, min(start + _CHUNK, size))
