"""Which polynomials an expansion keeps: least-angle paths judged by the leave-one-out error.

The leave-one-out error of a least-squares fit follows from its residuals and leverages; a factor
corrects it for the number of terms.

References
----------
Chapelle O., Vapnik V., Bengio Y. Model selection for small sample regression. Machine Learning 48
(2002) 9-23.
"""

from __future__ import annotations

import math
import warnings
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from typing import TypeAlias

import numpy as np

from uqfold.surrogates.hermite import hermite_basis, total_degree_indices
from uqfold.time_limit import check_time
from uqfold.typing import FloatArray, IntArray

Basis: TypeAlias = Callable[[FloatArray, IntArray], FloatArray]
"""Values (n, P) of the polynomials with multi-indices (P, d) at points u (n, d)."""

MANY_INPUTS = 20
"""Inputs from which sums of functions of one input or of one direction each are tried as well."""
# Candidate polynomials per point, and in all, of a least-angle path.
_CANDIDATES = 5
_MOST_CANDIDATES = 1_000
_MOST_INDICES = 50_000
_POINTS_PER_TERM = 1.5
# Degrees without improvement after which the search ends.
_PATIENCE = 2
_DEPENDENT = 1e-8
# A relative root-mean-square error at which there is nothing left to explain.
_EXACT = 1e-13
# Operations of one factorisation or path, seconds that no limit on time can interrupt.
_MOST_OPERATIONS = 40_000_000_000


@dataclass(frozen=True, eq=False)
class Regression:
    """Least-squares fit in a basis of polynomials.

    Attributes
    ----------
    indices
        Multi-indices (p, d).
    coefficients
        Coefficients (p,).
    residuals, leverage
        Of the n points, (n,).
    root_covariance
        A matrix A (p, p) with A A' = (F' F)^-1, the covariance for residuals of unit variance.
    error
        Corrected leave-one-out error: mean square, relative to the variance of the responses.
    """

    indices: IntArray
    coefficients: FloatArray
    residuals: FloatArray
    leverage: FloatArray
    root_covariance: FloatArray
    error: float


def select_basis(
    u: FloatArray,
    y: FloatArray,
    *,
    sparse: bool,
    max_degree: int,
    max_orders: IntArray | None = None,
    basis: Basis = hermite_basis,
) -> Regression:
    """Raise the degree until the corrected leave-one-out error stops falling; keep the best fit.

    Parameters
    ----------
    u
        Points (n, d); for Hermite polynomials scaled to unit spread.
    y
        Responses (n,).
    sparse
        Whether polynomials may be left out along a least-angle path.
    max_degree
        Highest total degree.
    max_orders
        Highest degree in each variable (d,); None: `max_degree`.
    basis
        The polynomials.
    """
    n, d = u.shape
    constant = total_degree_indices(d, 0)
    best = _Fits(basis(u, constant), y, constant).prefix(1)
    since = 0
    for degree in range(1, max_degree + 1):
        check_time()
        before = best.error
        if before <= _EXACT**2 or math.comb(d + degree, degree) > _MOST_INDICES:
            break
        candidates = total_degree_indices(d, degree)
        if max_orders is not None:
            candidates = candidates[(candidates <= max_orders).all(axis=1)]
        size = candidates.shape[0]
        contenders = []
        if size * _POINTS_PER_TERM <= n and n * size**2 <= _MOST_OPERATIONS:
            contenders.append(_Fits(basis(u, candidates), y, candidates).prefix(size))
        elif not sparse:
            break
        if sparse and degree > 1:
            if size > min(_CANDIDATES * n, _MOST_CANDIDATES):
                break
            path = _least_angle_path(basis(u, candidates), y, candidates)
            contenders.append(_Fits(basis(u, path), y, path).best())
        best = min([best, *contenders], key=lambda fit: fit.error)
        since = 0 if best.error < before else since + 1
        if since >= _PATIENCE:
            break
    if d >= MANY_INPUTS:
        degrees = range(2, max_degree + 1)
        best = min([best, *_additive(u, y, degrees, max_orders, basis, sparse)], key=_error)
    return best


def regression(basis: FloatArray, y: FloatArray, indices: IntArray) -> Regression:
    """Fit all polynomials with the given values (n, p) and multi-indices (p, d)."""
    return _Fits(basis, y, indices).prefix(indices.shape[0])


def _error(fit: Regression) -> float:
    return fit.error


def _additive(
    u: FloatArray,
    y: FloatArray,
    degrees: range,
    max_orders: IntArray | None,
    basis: Basis,
    sparse: bool,
) -> Iterator[Regression]:
    """Fits without products of inputs, for inputs too many for all products of two."""
    n, d = u.shape
    eye = np.eye(d, dtype=np.int64)
    indices = np.vstack([np.zeros_like(eye[:1]), eye])
    for degree in degrees:
        check_time()
        further = eye * degree
        if max_orders is not None:
            further = further[(further <= max_orders).all(axis=1)]
        indices = np.vstack([indices, further])
        size = indices.shape[0]
        if size * _POINTS_PER_TERM <= n:
            yield regression(basis(u, indices), y, indices)
            continue
        if not sparse or size > min(_CANDIDATES * n, _MOST_CANDIDATES):
            return
        path = _least_angle_path(basis(u, indices), y, indices)
        yield _Fits(basis(u, path), y, path).best()


class _Fits:
    """Least-squares fits in the first 1, 2, ..., p polynomials of a list, from one factorisation.

    With F = Q R, the fit in the first k columns uses the first k columns of Q, and its inverse
    factor is the leading block of R^-1.
    """

    def __init__(self, basis: FloatArray, y: FloatArray, indices: IntArray) -> None:
        from scipy.linalg import solve_triangular

        q, r = np.linalg.qr(basis)
        diagonal = np.abs(np.diag(r))
        dependent = np.flatnonzero(diagonal <= _DEPENDENT * np.maximum.accumulate(diagonal))
        p = int(dependent[0]) if dependent.size else diagonal.size
        self.y, self.indices = y, indices[:p]
        self.q, self.projected = q[:, :p], q[:, :p].T @ y
        self.root = solve_triangular(r[:p, :p], np.eye(p))

    def errors(self) -> FloatArray:
        """Corrected leave-one-out errors (p,)."""
        n, p = self.q.shape
        counts = np.arange(1, p + 1)
        leverage = np.minimum(np.cumsum(self.q**2, axis=1), 1.0)
        residuals = self.y[:, None] - np.cumsum(self.q * self.projected, axis=1)
        trace = np.cumsum((self.root**2).sum(axis=0))
        with np.errstate(divide="ignore", invalid="ignore"):
            mean_square = np.mean((residuals / (1.0 - leverage)) ** 2, axis=0)
            error = mean_square * n / (n - counts) * (1.0 + trace)
        usable = (counts < n) & (leverage.max(axis=0) < 1.0 - 1e-9)
        return np.where(usable, error / (float(np.var(self.y)) or 1.0), math.inf)

    def best(self) -> Regression:
        """The fit with the smallest error."""
        return self.prefix(int(np.argmin(self.errors())) + 1)

    def prefix(self, count: int) -> Regression:
        """The fit in the first `count` polynomials; without end in error if they are dependent."""
        if count > self.indices.shape[0]:
            return Regression(
                self.indices, self.projected, self.y, self.y, self.root, error=math.inf
            )
        q, projected = self.q[:, :count], self.projected[:count]
        residuals = self.y - q @ projected
        # once more: what rounding left of the part inside the basis
        rest = q.T @ residuals
        residuals, projected = residuals - q @ rest, projected + rest
        root = self.root[:count, :count]
        return Regression(
            indices=self.indices[:count],
            coefficients=root @ projected,
            residuals=residuals,
            leverage=(q**2).sum(axis=1),
            root_covariance=root,
            error=float(self.errors()[count - 1]),
        )


def _least_angle_path(basis: FloatArray, y: FloatArray, candidates: IntArray) -> IntArray:
    """Polynomials in the order in which the least-angle path takes them, the constant first."""
    from sklearn.linear_model import lars_path

    basis = basis[:, 1:] - basis[:, 1:].mean(axis=0)
    length = np.linalg.norm(basis, axis=0)
    usable = np.flatnonzero(length > _DEPENDENT * length.max())
    basis = basis[:, usable] / length[usable]
    centred = y - y.mean()
    with warnings.catch_warnings():
        # a column that depends on earlier ones is dropped, which the path says in a warning
        warnings.simplefilter("ignore")
        most = min(usable.size, int(y.size / _POINTS_PER_TERM))
        most = min(most, max(1, _MOST_OPERATIONS // (4 * basis.size)))
        centred = centred / np.linalg.norm(centred)
        _, active, _ = lars_path(basis, centred, method="lar", max_iter=most)
    order = usable[np.asarray(active, dtype=int)] + 1
    return np.asarray(candidates[np.concatenate([[0], order])])
