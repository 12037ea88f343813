"""Orthonormal polynomials of the inputs' own distributions."""

import numpy as np
import openturns as ot
import pytest
from numpy.testing import assert_allclose

from uqfold.inputs import product_inputs
from uqfold.inputs.polynomials import OwnPolynomials, own_polynomials


def own_of(distribution: ot.Distribution, degree: int = 6) -> OwnPolynomials:
    found = own_polynomials(product_inputs(None, {"x": distribution}), degree)[0]
    assert found is not None
    return found


@pytest.mark.parametrize(
    "distribution",
    [
        ot.Uniform(-2.0, 5.0),
        ot.Exponential(0.3, 1.0),
        ot.Gamma(2.5, 4.0, -1.0),
        ot.Beta(2.0, 3.0, 0.0, 10.0),
        ot.Triangular(0.0, 1.0, 3.0),
        ot.TruncatedNormal(0.0, 1.0, -1.0, 2.0),
        ot.Gumbel(0.2, 1.0),
    ],
)
def test_products_have_mean_zero_or_one(distribution: ot.Distribution) -> None:
    nodes, weights = np.polynomial.legendre.leggauss(400)
    u = 8.5 * nodes
    density = 8.5 * weights * np.exp(-0.5 * u**2) / np.sqrt(2.0 * np.pi)
    values = own_of(distribution)(u, 6)
    assert_allclose((values.T * density) @ values, np.eye(7), atol=1e-4)


@pytest.mark.parametrize(
    ("distribution", "of_chaospy"),
    [
        (ot.Uniform(-2.0, 5.0), lambda cp: cp.Uniform(-2.0, 5.0)),
        (ot.Exponential(0.5), lambda cp: cp.Exponential(2.0)),
        (ot.Beta(2.0, 3.0, 0.0, 10.0), lambda cp: cp.Beta(2.0, 3.0, 0.0, 10.0)),
    ],
)
def test_chaospy_finds_the_same_polynomials(distribution: ot.Distribution, of_chaospy) -> None:
    chaospy = pytest.importorskip("chaospy")
    expansion = chaospy.generate_expansion(5, of_chaospy(chaospy), normed=True)
    x = np.linspace(0.1, 4.9, 40)
    own = own_of(distribution)
    values = np.column_stack([np.broadcast_to(one, x.shape) for one in own.ladder(x, 5)])
    # chaospy's sign of a polynomial is its own
    assert_allclose(np.abs(values.T), np.abs(expansion(x)), rtol=1e-7, atol=1e-9)


def test_what_has_none_of_its_own() -> None:
    inputs = product_inputs(
        {"load": ot.Normal(3.0, 0.5)},
        {"gap": ot.Uniform(0.0, 1.0), "heavy": ot.Student(1.0)},
    )
    normal, uniform, heavy = own_polynomials(inputs, 4)
    assert normal is None
    assert uniform is not None
    assert uniform.highest == 4
    assert heavy is None


def test_missing_moments_end_the_ladder() -> None:
    # of Student's t with 6.5 degrees of freedom, the sixth moment is the last
    found = own_of(ot.Student(6.5), 8)
    assert found.highest == 2


def test_an_input_that_depends_on_another_keeps_its_score() -> None:
    copula = ot.NormalCopula(ot.CorrelationMatrix([[1.0, 0.5], [0.5, 1.0]]))
    both = ot.JointDistribution([ot.Uniform(0.0, 1.0)] * 2, copula)
    assert own_polynomials(product_inputs(None, both), 3) == [None, None]
