"""Directions along which a response of many inputs is curved.

A response that is linear but for a polynomial of a few linear combinations of its inputs has a
Hessian of low rank. Its directions are found from far fewer runs than all pairs of inputs would
need: a first one by its share in what is left unexplained, then all of them together by
regression on their products with every input, which tells how they are to be turned.

References
----------
Li K.-C. On principal Hessian directions for data visualization and dimension reduction. Journal
of the American Statistical Association 87 (1992) 1025-1039.
Hokanson J. M., Constantine P. G. Data-driven polynomial ridge approximation using variable
projection. SIAM Journal on Scientific Computing 40 (2018) A1566-A1589.
Papaioannou I., Ehre M., Straub D. PLS-based adaptation for efficient PCE representation in high
dimensions. Journal of Computational Physics 387 (2019) 186-204.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np

from uqfold.surrogates.hermite import hermite_basis, total_degree_indices
from uqfold.time_limit import check_time
from uqfold.typing import FloatArray, IntArray

MOST_DIRECTIONS = 5
_DEGREE = 3
# Runs for each coefficient below which directions are not looked for.
_POINTS_PER_TERM = 1.15
_TURNS = 25
# Operations of one regression, of which there are some hundreds.
_MOST_OPERATIONS = 100_000_000
# A relative error of the fit at which nothing is left to be found; the shortest share of a turn
# that is tried, and a gain by which no other one follows.
_EXACT, _SHORTEST, _LITTLE = 1e-9, 0.05, 1e-3
# What another direction has to gain.
_WORTH = 0.9


@dataclass(frozen=True, eq=False)
class CurvedDirections:
    """A rotation of standard-normal space, and the polynomials of its coordinates.

    Attributes
    ----------
    rotation
        Orthonormal directions in columns (d, d), those of curvature first.
    indices
        Multi-indices (P, d) of polynomials in the coordinates u @ rotation: all of the curved
        ones up to total degree three, the others linear, and the products of both, whose
        coefficients are what an error of the directions would be.
    error
        Mean square of left-out residuals relative to the variance of the responses, the
        directions counted as fitted.
    """

    rotation: FloatArray
    indices: IntArray
    error: float


def curved_directions(u: FloatArray, y: FloatArray) -> CurvedDirections | None:
    """Find directions of curvature; None if none helps to foretell left-out runs.

    Parameters
    ----------
    u
        Points (n, d) of about unit spread.
    y
        Responses (n,), not all the same.
    """
    n, d = u.shape
    y = y - y.mean()
    linear = _Fit.of(u, y, np.eye(d), 0)
    best, before, found = linear, linear, None
    curved = _most_curved(u, linear.residuals, np.empty((d, 0)))
    for count in range(1, MOST_DIRECTIONS + 1):
        indices = _indices(d, count)
        size = indices.shape[0]
        if size * _POINTS_PER_TERM > n or n * size**2 > _MOST_OPERATIONS:
            break
        if best.error < _EXACT**2:
            break
        # from where one direction less led to, and from all of them at once
        known = before.rotation[:, : count - 1]
        next_one = _most_curved(u, before.residuals, known)[:, :1]
        starts = [curved[:, :count], np.hstack([known, next_one])]
        if count == 1:
            starts[1] = linear.coefficients[1 : d + 1, None]
        tried = [_turned(u, y, start) for start in starts]
        before = min(tried, key=lambda fit: fit.unexplained)
        if before.error < _WORTH * best.error:
            best = before
            found = CurvedDirections(best.rotation, indices, best.error)
    return found


def without_products(indices: IntArray) -> IntArray:
    """Of the multi-indices (P, d) of a fit, those (Q, d) that do not mix curved with other inputs.

    The products are not there when the directions are right.
    """
    degree = indices.sum(axis=1)
    curved = indices[(degree > 1) & ((indices > 0).sum(axis=1) == 1)].any(axis=0)
    kept = (degree < 2) | (indices[:, ~curved] == 0).all(axis=1)
    return np.asarray(indices[kept])


@dataclass(frozen=True, eq=False)
class _Fit:
    """Least squares in rotated coordinates, `count` of which are curved."""

    rotation: FloatArray
    coefficients: FloatArray
    residuals: FloatArray
    error: float
    unexplained: float = 1.0

    @classmethod
    def of(cls, u: FloatArray, y: FloatArray, rotation: FloatArray, count: int) -> _Fit:
        check_time()
        basis = hermite_basis(u @ rotation, _indices(u.shape[1], count))
        q, r = np.linalg.qr(basis)
        diagonal = np.abs(np.diag(r))
        if not diagonal.min() > 1e-10 * diagonal.max():
            return cls(rotation, np.zeros(basis.shape[1]), y, math.inf)
        projected = q.T @ y
        residuals = y - q @ projected
        leverage = (q**2).sum(axis=1)
        left_out = residuals / np.maximum(1.0 - leverage, 1e-12)
        freedom = max(y.size - basis.shape[1], 1)
        error = float(np.mean(left_out**2)) / float(np.var(y)) * y.size / freedom
        return cls(rotation, np.linalg.solve(r, projected), residuals, error)


def _indices(d: int, count: int) -> IntArray:
    """The constant, all linear terms, then those of the curved coordinates and their products."""
    eye = np.eye(d, dtype=np.int64)
    rest = np.arange(count, d)
    products = [eye[i] + eye[rest] for i in range(count)]
    curved = np.empty((0, d), dtype=np.int64)
    if count:
        few = _curved_terms(count)
        curved = np.hstack([few, np.zeros((few.shape[0], d - count), dtype=np.int64)])
    return np.vstack([np.zeros((1, d), dtype=np.int64), eye, curved, *products])


def _most_curved(u: FloatArray, residuals: FloatArray, known: FloatArray) -> FloatArray:
    """Directions (d, d) across the known ones (d, k), those first in which residuals curve most."""
    hessian = (u * residuals[:, None]).T @ u
    across = np.eye(u.shape[1]) - known @ known.T
    values, vectors = np.linalg.eigh(across @ hessian @ across)
    return np.asarray(vectors[:, np.argsort(-np.abs(values), kind="stable")])


def _turned(u: FloatArray, y: FloatArray, directions: FloatArray) -> _Fit:
    """Turn directions (d, m) until nothing is gained: by the Hessian at first, which leads far."""
    m = directions.shape[1]
    rotation = _completed(directions)
    unexplained = _unexplained(u, y, rotation[:, :m])
    for turn_of in (_turn_by_hessian, _turn_by_gradient):
        step = 1.0
        for _ in range(_TURNS):
            if unexplained < _EXACT**2 or step < _SHORTEST:
                break
            try:
                turn = turn_of(u, y, rotation, m)
            except np.linalg.LinAlgError:
                break
            tried = _completed(rotation[:, :m] + step * rotation[:, m:] @ turn)
            gain = 1.0 - _unexplained(u, y, tried[:, :m]) / unexplained
            if gain > 0.0:
                rotation, step = tried, min(1.0, 2.0 * step)
                unexplained *= 1.0 - gain
            else:
                step *= 0.5
            if 0.0 < gain < _LITTLE:
                break
    return replace(_Fit.of(u, y, rotation, m), unexplained=unexplained)


def _unexplained(u: FloatArray, y: FloatArray, directions: FloatArray) -> float:
    """Share of the variance that linear terms and polynomials of the directions leave."""
    q = np.linalg.qr(_plain(u, directions))[0]
    rest = y - q @ (q.T @ y)
    return float(rest @ rest / (y @ y))


def _plain(u: FloatArray, directions: FloatArray) -> FloatArray:
    curved = hermite_basis(u @ directions, _curved_terms(directions.shape[1]))
    return np.hstack([np.ones((u.shape[0], 1)), u, curved])


def _turn_by_hessian(u: FloatArray, y: FloatArray, rotation: FloatArray, m: int) -> FloatArray:
    """A Hessian H of rank m has the range of H V, with parts along V and across it.

    They are the coefficients of the quadratic terms and of the products.
    """
    d = u.shape[1]
    few, fit = _curved_terms(m), _Fit.of(u, y, rotation, m)
    along = np.zeros((m, m))
    for index, value in zip(few, fit.coefficients[1 + d :], strict=False):
        if index.sum() == 2:
            i, j = np.repeat(np.arange(m), index)
            # the orthonormal polynomial of degree two is (z^2 - 1) / sqrt(2)
            along[i, j] = along[j, i] = value * (math.sqrt(2.0) if i == j else 1.0)
    across = fit.coefficients[1 + d + few.shape[0] :].reshape(m, d - m)
    return np.asarray(np.linalg.solve(along, across).T)


def _turn_by_gradient(u: FloatArray, y: FloatArray, rotation: FloatArray, m: int) -> FloatArray:
    """Return the step of Gauss and Newton, which the higher powers have a part in as well."""
    d = u.shape[1]
    few = _curved_terms(m)
    z, rest = u @ rotation[:, :m], u @ rotation[:, m:]
    columns = [_plain(u, rotation[:, :m])]
    coefficients = np.linalg.lstsq(columns[0], y, rcond=None)[0][1 + d :]
    for j in range(m):
        # the derivative of the orthonormal polynomial of degree k is sqrt(k) times the one below
        lower = np.maximum(few - np.eye(m, dtype=np.int64)[j], 0)
        slope = hermite_basis(z, lower) @ (np.sqrt(few[:, j]) * coefficients)
        columns.append(slope[:, None] * rest)
    found = np.linalg.lstsq(np.hstack(columns), y, rcond=None)[0]
    return np.asarray(found[1 + d + few.shape[0] :].reshape(m, d - m).T)


def _curved_terms(m: int) -> IntArray:
    """Multi-indices (P, m) of the curved terms in m coordinates."""
    few = total_degree_indices(m, _DEGREE)
    return np.asarray(few[few.sum(axis=1) > 1])


def _completed(directions: FloatArray) -> FloatArray:
    """An orthonormal basis (d, d) that begins with the span of the directions (d, m)."""
    full = np.linalg.qr(directions, mode="complete")[0]
    return np.asarray(full)
