"""Polynomial chaos: regression, selection, Sobol' indices, draws, chaospy."""

import numpy as np
import pytest
from numpy.testing import assert_allclose

from uqfold.surrogates.designs import space_filling_design
from uqfold.surrogates.polynomial_chaos import fit_basis, fit_polynomial_chaos
from uqfold.typing import FloatArray


def design(size: int, dimension: int, seed: int = 0) -> FloatArray:
    return space_filling_design(size, dimension, np.random.default_rng(seed))


def cubic(u: FloatArray) -> FloatArray:
    return 2.0 + u[:, 0] + 0.5 * u[:, 1] ** 2 - 0.3 * u[:, 0] * u[:, 1] + 0.2 * u[:, 2] ** 3


@pytest.mark.parametrize("sparse", [False, True])
def test_a_polynomial_is_recovered(sparse: bool) -> None:
    u = design(60, 3)
    found = fit_polynomial_chaos(u, cubic(u), sparse=sparse)
    new = 2.0 * np.random.default_rng(1).standard_normal((100, 3))
    assert_allclose(found.mean(new), cubic(new), rtol=1e-8, atol=1e-9)
    assert found.degree == 3
    assert found.mean_response == pytest.approx(2.5)
    # variances: u_0 1, u_1 0.25 * 2, product 0.09, u_2^3 0.04 * 15
    assert found.variance == pytest.approx(1.0 + 0.5 + 0.09 + 0.6)
    indices = found.sobol_indices()
    assert_allclose(indices.main, np.array([1.0, 0.5, 0.6]) / 2.19, rtol=1e-6)
    assert_allclose(indices.total, np.array([1.09, 0.59, 0.6]) / 2.19, rtol=1e-6)


def test_least_angles_find_few_terms_among_many() -> None:
    def few(u: FloatArray) -> FloatArray:
        return u[:, 0] + 0.4 * u[:, 3] * u[:, 7] + 0.2 * (u[:, 5] ** 3 - 3.0 * u[:, 5])

    u = design(120, 8)
    found = fit_polynomial_chaos(u, few(u))
    new = np.random.default_rng(1).standard_normal((200, 8))
    # 165 polynomials of degree 3 cannot be told apart by 120 runs without sparsity
    assert_allclose(found.mean(new), few(new), atol=1e-6)
    full = fit_polynomial_chaos(u, few(u), sparse=False)
    assert np.abs(full.mean(new) - few(new)).max() > 0.1


def test_leave_one_out_is_that_of_refits() -> None:
    u = design(40, 2)
    y = np.exp(0.4 * u[:, 0]) + u[:, 1]
    found = fit_polynomial_chaos(u, y, sparse=False, max_degree=2)
    residuals = found.leave_one_out().residuals
    for i in (0, 11, 39):
        rest = np.arange(40) != i
        other = fit_basis(u[rest], y[rest], found.indices)
        assert residuals[i] == pytest.approx(y[i] - other(u[[i]])[0], rel=1e-8)


def test_degree_rises_with_the_number_of_runs() -> None:
    def smooth(u: FloatArray) -> FloatArray:
        return np.exp(0.4 * u[:, 0]) / (3.0 + np.tanh(0.3 * u[:, 1]))

    found = [
        fit_polynomial_chaos(design(size, 2), smooth(design(size, 2)), sparse=False)
        for size in (20, 60, 200)
    ]
    degrees = [one.degree for one in found]
    errors = [one.leave_one_out().rms for one in found]
    assert degrees[0] < degrees[1] < degrees[2]
    assert errors[2] < 0.2 * errors[1]
    assert errors[1] < 0.6 * errors[0]


def test_noise_does_not_raise_the_degree() -> None:
    u = design(80, 3)
    y = u.sum(axis=1) + 0.1 * np.random.default_rng(3).standard_normal(80)
    found = fit_polynomial_chaos(u, y)
    assert found.degree <= 2
    assert found.residual_std == pytest.approx(0.1, rel=0.35)


def test_draws_spread_as_wide_as_the_errors() -> None:
    ratios = []
    for seed in range(12):
        u = design(40, 2, seed)
        y = np.exp(0.5 * u[:, 0] + 0.3 * u[:, 1])
        found = fit_polynomial_chaos(u, y, max_degree=4)
        new = np.random.default_rng(seed).standard_normal((200, 2))
        truth = np.exp(0.5 * new[:, 0] + 0.3 * new[:, 1])
        spread = found.sample_paths(np.random.default_rng(seed), 60)(new).std(axis=0)
        ratios.append(np.sqrt(np.mean(((found.mean(new) - truth) / spread) ** 2)))
    assert 0.1 < np.median(ratios) < 1.5


def test_a_constant_response_is_reproduced_exactly() -> None:
    value = 0.1 + 0.2
    found = fit_polynomial_chaos(design(30, 2), np.full(30, value))
    new = design(20, 2, seed=1)
    assert (found.mean(new) == value).all()
    assert (found.sample_paths(np.random.default_rng(0), 3)(new) == value).all()
    assert np.isnan(found.sobol_indices().total).all()


def test_orders_that_a_design_cannot_tell_are_left_out() -> None:
    nodes = np.polynomial.hermite_e.hermegauss(3)[0]
    u = np.array([[a, b] for a in nodes for b in np.linspace(-3.0, 3.0, 7)])
    found = fit_polynomial_chaos(u, u[:, 0] ** 2 + u[:, 1] ** 3, max_orders=np.array([2, 6]))
    assert found.indices[:, 0].max() == 2
    new = design(20, 2)
    assert_allclose(found.mean(new), new[:, 0] ** 2 + new[:, 1] ** 3, atol=1e-7)


def test_chaospy_takes_the_expansion_and_agrees_on_it() -> None:
    chaospy = pytest.importorskip("chaospy")
    u = design(60, 3)
    found = fit_polynomial_chaos(u, cubic(u))
    expansion = found.to_chaospy()
    new = np.random.default_rng(2).standard_normal((3, 50))
    assert_allclose(expansion(*new), found.mean(new.T), rtol=1e-9)
    standard = chaospy.Iid(chaospy.Normal(0, 1), 3)
    assert float(chaospy.Var(expansion, standard)) == pytest.approx(found.variance)
    indices = found.sobol_indices()
    assert_allclose(chaospy.Sens_m(expansion, standard), indices.main, atol=1e-9)
    assert_allclose(chaospy.Sens_t(expansion, standard), indices.total, atol=1e-9)


def test_bad_data_are_refused() -> None:
    with pytest.raises(ValueError, match="expected"):
        fit_polynomial_chaos(np.zeros((3, 2)), np.zeros(2))
    with pytest.raises(ValueError, match="finite"):
        fit_polynomial_chaos(np.zeros((3, 2)), np.array([0.0, np.inf, 1.0]))


def test_expansions_without_some_runs_are_those_of_the_others() -> None:
    u, new = design(40, 3), design(5, 3, seed=1)
    y = np.exp(0.4 * u.sum(axis=1))
    expansion = fit_polynomial_chaos(u, y)
    groups = [np.arange(first, 40, 10) for first in range(3)]
    found = expansion.without(groups)(new)
    for values, left_out in zip(found, groups, strict=True):
        others = np.delete(np.arange(40), left_out)
        again = fit_basis(u[others], y[others], expansion.indices)
        assert_allclose(values, again(new), rtol=1e-6)
    assert np.abs(found - expansion.mean(new)).max() > 1e-4
