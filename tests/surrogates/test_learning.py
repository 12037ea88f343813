"""Learning functions against their definitions, and batches that do not repeat themselves."""

import numpy as np
import pytest

from uqfold.surrogates.gaussian_process import GaussianProcess, fit_gaussian_process
from uqfold.surrogates.hermite import hermite_basis
from uqfold.surrogates.kernel_choice import KernelFits
from uqfold.surrogates.kernels import Kernel, correlation
from uqfold.surrogates.learning import (
    Candidates,
    LearningFunction,
    expected_feasibility,
    u_function,
)
from uqfold.surrogates.posterior_covariance import PosteriorCovariance
from uqfold.typing import FloatArray


def surface(u: FloatArray) -> FloatArray:
    return np.asarray(np.sin(u[:, 0]) + 0.3 * u[:, 1] ** 2)


def fitted(kernel: Kernel = "gaussian", size: int = 25, noise: float = 0.03) -> GaussianProcess:
    u = 1.5 * np.random.default_rng(2).standard_normal((size, 2))
    return fit_gaussian_process(u, surface(u), noise=noise, trend=1, kernel=kernel)


def test_expected_feasibility_is_the_expectation_it_stands_for() -> None:
    rng = np.random.default_rng(1)
    mean, std = np.array([0.0, 1.0, -2.5]), np.array([1.0, 0.4, 1.5])
    level = np.array([0.7])
    draws = mean + std * rng.standard_normal((400_000, 3))
    value = np.maximum(0.0, 2.0 * std - np.abs(draws - level))
    found = expected_feasibility(mean, std, level)
    error = value.std(axis=0) / np.sqrt(len(value))
    assert (np.abs(found - value.mean(axis=0)) < 5.0 * error).all()


def test_nearest_level_counts() -> None:
    mean, std = np.array([0.0, 4.0, 10.0]), np.array([1.0, 2.0, 1.0])
    np.testing.assert_allclose(u_function(mean, std, np.array([1.0, 9.0])), [1.0, 1.5, 1.0])
    both = expected_feasibility(mean, std, np.array([1.0, 9.0]))
    single = [expected_feasibility(mean, std, np.array([level])) for level in (1.0, 9.0)]
    np.testing.assert_allclose(both, np.maximum(*single))
    assert np.isinf(u_function(mean, std, np.empty(0))).all()
    assert (expected_feasibility(mean, std, np.empty(0)) == 0.0).all()


def solved(matrix: FloatArray, right: FloatArray) -> FloatArray:
    """Gauss elimination in extended precision."""
    work = np.hstack([matrix, right]).astype(np.longdouble)
    n = len(matrix)
    for k in range(n):
        pivot = k + int(np.argmax(np.abs(work[k:, k])))
        work[[k, pivot]] = work[[pivot, k]]
        work[k] /= work[k, k]
        others = np.arange(n) != k
        work[others] -= np.outer(work[others, k], work[k])
    return np.asarray(work[:, n:])


@pytest.mark.parametrize("noise", [1e-3, 0.1])
@pytest.mark.parametrize("kernel", ["gaussian", "matern52"])
def test_posterior_covariance_is_that_of_universal_kriging(kernel: Kernel, noise: float) -> None:
    """k(a, b) - k_a K^-1 k_b + h_a (F K^-1 F)^-1 h_b with h = f - F K^-1 k, in long numbers."""
    process = fitted(kernel, noise=noise)
    values = process.hyperparameters
    rng = np.random.default_rng(3)
    a, b = 2.0 * rng.standard_normal((2, 12, 2))

    def prior(one: FloatArray, other: FloatArray) -> FloatArray:
        squared = (((one[:, None] - other[None]) / values.length_scales) ** 2).sum(axis=2)
        return np.asarray(values.process_variance * correlation(kernel, squared))

    covariance = PosteriorCovariance(process)
    total = prior(process.u, process.u) + covariance.noise_variance * np.eye(len(process.y))
    basis = hermite_basis(process.u, process.trend)
    right = solved(total, np.hstack([basis, prior(process.u, b)]))
    inner = solved(basis.T @ right[:, :3], np.eye(3))
    h_a = hermite_basis(a, process.trend) - prior(a, process.u) @ right[:, :3]
    h_b = hermite_basis(b, process.trend).T - basis.T @ right[:, 3:]
    expected = prior(a, b) - prior(a, process.u) @ right[:, 3:] + h_a @ inner @ h_b
    error = np.abs(covariance(a, b) - expected.astype(float)).max()
    assert error < 1e-9 * values.process_variance
    np.testing.assert_allclose(covariance(b, a), covariance(a, b).T, rtol=0, atol=2.0 * error)


def candidates(process: GaussianProcess, u: FloatArray, nodes: FloatArray) -> Candidates:
    covariance = PosteriorCovariance(process)
    influence = np.full((1, len(nodes)), 1.0 / len(nodes))
    return Candidates(
        mean=process.mean(u),
        covariance=covariance(u, u),
        with_answers=covariance(u, nodes) @ influence.T,
        levels=np.array([0.5]),
        noise_variance=np.full(len(u), covariance.noise_variance),
    )


def test_variance_score_is_the_reduction_that_a_run_brings() -> None:
    """The variance of an average over nodes, before and after a run, hyperparameters kept."""
    process = fitted()
    rng = np.random.default_rng(4)
    u, nodes = 2.0 * rng.standard_normal((8, 2)), rng.standard_normal((30, 2))
    scores = candidates(process, u, nodes).scores("variance")

    def variance(some: GaussianProcess) -> float:
        return float(PosteriorCovariance(some)(nodes, nodes).mean())

    before = variance(process)
    for index in range(len(u)):
        after = GaussianProcess(
            np.vstack([process.u, u[index]]),
            np.append(process.y, 0.0),
            process.kernel,
            process.trend,
            process.hyperparameters,
        )
        assert scores[index] == pytest.approx(before - variance(after), rel=1e-5, abs=1e-9 * before)


@pytest.mark.parametrize("learning", ["variance", "u", "eff"])
def test_batch_spreads_over_twins(learning: LearningFunction) -> None:
    """Of two points that lie together, one teaches nearly all: the batch takes no second."""
    process = fitted("matern52", size=8, noise=1e-3)
    rng = np.random.default_rng(5)
    places = np.array([[2.0, 1.5], [-2.0, 1.0], [0.5, -2.5], [-1.0, -1.5]])
    u = np.repeat(places, 3, axis=0) + 1e-6 * rng.standard_normal((12, 2))
    chosen = candidates(process, u, 1.5 * rng.standard_normal((50, 2))).batch(learning, 4)
    assert sorted(index // 3 for index in chosen) == [0, 1, 2, 3]
    assert len(candidates(process, u, places).batch(learning, 50)) == 12


def test_kernel_is_chosen_by_prediction() -> None:
    rng = np.random.default_rng(6)
    u = 1.7 * rng.standard_normal((60, 2))
    assert KernelFits(("gaussian", "matern52")).fit(u, surface(u)).kernel == "gaussian"
    kinked = np.abs(u[:, 0] + u[:, 1]) - np.abs(u[:, 0] - 0.5)
    assert KernelFits(("gaussian", "matern52")).fit(u, kinked).kernel == "matern52"
    assert KernelFits(("gaussian",)).fit(u, kinked).kernel == "gaussian"
