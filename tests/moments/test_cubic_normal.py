"""Cubic polynomials of a normal variable with given moments."""

import numpy as np
import pytest

from uqfold.moments.cubic_normal import cubic_normal


@pytest.mark.parametrize(("b", "c", "d"), [(1.0, 0.0, 0.0), (0.9, 0.1, 0.02), (0.85, -0.15, 0.04)])
def test_a_cubic_of_a_normal_variable_is_found_again(b: float, c: float, d: float) -> None:
    """One of the distributions that FFNI compares: exact where the response is such a cubic."""
    u, weights = np.polynomial.hermite_e.hermegauss(12)
    weights = weights / weights.sum()

    def cubic(u: np.ndarray) -> np.ndarray:
        return 5.0 + 2.0 * (b * u + c * (u**2 - 1.0) + d * u**3)

    mean = weights @ cubic(u)
    std = np.sqrt(weights @ (cubic(u) - mean) ** 2)
    z = (cubic(u) - mean) / std
    found = cubic_normal(mean, std, weights @ z**3, weights @ z**4)
    assert found is not None
    at = np.array([-3.0, -1.0, 0.0, 2.0, 5.0])
    np.testing.assert_allclose(found.score(cubic(at)), at, atol=1e-5)


def test_moments_without_a_rising_cubic_have_none() -> None:
    assert cubic_normal(0.0, 1.0, 0.0, 1.5) is None
    assert cubic_normal(0.0, 1.0, 3.0, 11.0) is None
