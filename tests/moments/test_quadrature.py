import numpy as np
import pytest

from uqfold.moments.quadrature import tensor_grid


def test_first_variable_is_slowest() -> None:
    rules = [(np.array([1.0, 2.0]), np.array([0.25, 0.75])), (np.arange(3.0), np.full(3, 1 / 3))]
    points, weights = tensor_grid(rules)
    expected = [[1, 0], [1, 1], [1, 2], [2, 0], [2, 1], [2, 2]]
    np.testing.assert_array_equal(points, expected)
    np.testing.assert_allclose(weights, [1 / 12] * 3 + [1 / 4] * 3, rtol=1e-15)


def test_no_rule_gives_one_empty_row_of_weight_one() -> None:
    points, weights = tensor_grid([])
    assert points.shape == (1, 0)
    np.testing.assert_array_equal(weights, [1.0])


def test_product_rule_is_exact_for_the_product_of_polynomials() -> None:
    nodes, weights = np.polynomial.legendre.leggauss(4)
    points, w = tensor_grid([(nodes, weights)] * 3)
    value = w @ (points[:, 0] ** 6 * points[:, 1] ** 4 * points[:, 2] ** 2)
    assert value == pytest.approx(2 / 7 * 2 / 5 * 2 / 3, rel=1e-13, abs=0)
    assert len(points) == 64


@pytest.mark.parametrize(
    "rule",
    [
        (np.zeros(2), np.zeros(3)),
        (np.zeros((2, 1)), np.zeros((2, 1))),
        (np.empty(0), np.empty(0)),
    ],
)
def test_bad_rule_is_named(rule: tuple[np.ndarray, np.ndarray]) -> None:
    with pytest.raises(ValueError, match="rule 1"):
        tensor_grid([(np.zeros(1), np.ones(1)), rule])
