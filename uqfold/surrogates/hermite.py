"""Products of orthonormal polynomials, those of Hermite in standard-normal variables first of all.

A multi-index a = (a_1, ..., a_d) stands for the product of the polynomials of degree a_i in u_i.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from itertools import chain, combinations_with_replacement
from typing import TypeAlias

import numpy as np

from uqfold.typing import FloatArray, IntArray

Polynomials: TypeAlias = Callable[[FloatArray, int], FloatArray]
"""Values (n, degree + 1) of one variable's polynomials at its standard-normal scores (n,)."""


def total_degree_indices(dimension: int, degree: int) -> IntArray:
    """Return all multi-indices (P, d) of total degree up to `degree`, lowest degree first.

    Raises
    ------
    ValueError
        If there is no variable or the degree is negative.
    """
    if dimension < 1 or degree < 0:
        raise ValueError(f"{dimension} variables, degree {degree}: need d >= 1 and degree >= 0")
    return np.concatenate([fixed_degree_indices(dimension, one) for one in range(degree + 1)])


def fixed_degree_indices(dimension: int, degree: int) -> IntArray:
    """Return all multi-indices (P, d) of one total degree, in lexicographic order."""
    count = math.comb(dimension + degree - 1, degree)
    factors = combinations_with_replacement(range(dimension), degree)
    variables = np.fromiter(chain.from_iterable(factors), dtype=np.int64, count=count * degree)
    variables = variables.reshape(count, degree)
    indices = np.zeros((count, dimension), dtype=np.int64)
    for variable in variables.T:
        indices[np.arange(count), variable] += 1
    return indices[::-1]


def hermite_basis(u: FloatArray, indices: IntArray) -> FloatArray:
    """Evaluate products of Hermite polynomials.

    Parameters
    ----------
    u
        Standard-normal variables (n, d).
    indices
        Multi-indices (P, d).

    Returns
    -------
    FloatArray
        Values (n, P); their expected products under the standard normal are 0 or 1.
    """
    return product_basis(u, indices, [one_dimensional] * u.shape[1])


def product_basis(
    u: FloatArray, indices: IntArray, polynomials: Sequence[Polynomials]
) -> FloatArray:
    """Evaluate products (n, P) of any polynomials, one kind for each of the d variables."""
    degrees = indices.max(axis=0, initial=0)
    # one polynomial after the other in memory
    basis = np.ones((indices.shape[0], u.shape[0]))
    for column, degree in enumerate(degrees):
        if degree > 0:
            # of many variables, most polynomials hold few
            some = np.flatnonzero(indices[:, column])
            values = polynomials[column](u[:, column], int(degree)).T
            basis[some] *= values[indices[some, column]]
    return basis.T


def one_dimensional(x: FloatArray, degree: int) -> FloatArray:
    """Values (n, degree + 1) of the orthonormal Hermite polynomials at x (n,)."""
    values = np.empty((degree + 1, x.size))
    values[0] = 1.0
    if degree > 0:
        values[1] = x
    for k in range(1, degree):
        values[k + 1] = (x * values[k] - math.sqrt(k) * values[k - 1]) / math.sqrt(k + 1)
    return values.T


def rescaled(degree: int, factor: float) -> FloatArray:
    """Matrix (degree + 1, degree + 1) with H_k(factor x) = sum_j matrix[k, j] H_j(x)."""
    nodes, weights = np.polynomial.hermite_e.hermegauss(degree + 1)
    values = one_dimensional(nodes, degree)
    moved = one_dimensional(factor * nodes, degree)
    matrix = (moved * (weights / weights.sum())[:, None]).T @ values
    # a polynomial of degree k holds none of higher degree, and only those of its own parity
    k, j = np.indices(matrix.shape)
    return np.where((j <= k) & ((k - j) % 2 == 0), matrix, 0.0)
