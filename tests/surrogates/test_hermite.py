"""Orthonormal Hermite polynomials."""

import math

import numpy as np
import pytest
from numpy.testing import assert_allclose

from uqfold.moments.quadrature import tensor_grid
from uqfold.surrogates.hermite import (
    hermite_basis,
    one_dimensional,
    rescaled,
    total_degree_indices,
)


@pytest.mark.parametrize(("dimension", "degree"), [(1, 4), (3, 3), (5, 2)])
def test_indices_are_all_of_total_degree_and_lowest_first(dimension: int, degree: int) -> None:
    indices = total_degree_indices(dimension, degree)
    assert indices.shape == (math.comb(dimension + degree, degree), dimension)
    assert len({tuple(row) for row in indices}) == indices.shape[0]
    assert (np.diff(indices.sum(axis=1)) >= 0).all()
    assert indices.sum(axis=1).max() == degree


def test_products_are_orthonormal() -> None:
    nodes, weights = np.polynomial.hermite_e.hermegauss(6)
    points, w = tensor_grid([(nodes, weights / weights.sum())] * 2)
    basis = hermite_basis(points, total_degree_indices(2, 4))
    assert_allclose(basis.T @ (w[:, None] * basis), np.eye(basis.shape[1]), atol=1e-12)


def test_rescaled_polynomials_are_those_of_the_scaled_variable() -> None:
    x = np.linspace(-4.0, 4.0, 9)
    assert_allclose(one_dimensional(0.6 * x, 5), one_dimensional(x, 5) @ rescaled(5, 0.6).T)


def test_impossible_bases_are_refused() -> None:
    with pytest.raises(ValueError, match="0 variables"):
        total_degree_indices(0, 2)
