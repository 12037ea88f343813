"""Gaussian processes: fit, posterior, draws and cross-validation."""

import numpy as np
import pytest
from numpy.testing import assert_allclose

from uqfold.surrogates.designs import space_filling_design
from uqfold.surrogates.gaussian_process import GaussianProcess, fit_gaussian_process
from uqfold.surrogates.hermite import total_degree_indices
from uqfold.surrogates.kernels import Kernel
from uqfold.surrogates.likelihood import JITTER, Hyperparameters, Starts, _Objective
from uqfold.typing import FloatArray

KERNELS: tuple[Kernel, ...] = ("gaussian", "matern52")


def wavy(u: FloatArray) -> FloatArray:
    return np.sin(u[:, 0]) + 0.3 * u[:, 1] ** 2 + 0.1 * u[:, 0] * u[:, 1]


def design(size: int, seed: int = 0, dimension: int = 2) -> FloatArray:
    return space_filling_design(size, dimension, np.random.default_rng(seed))


@pytest.mark.parametrize("kernel", KERNELS)
@pytest.mark.parametrize("noise", [None, 0.1])
def test_gradient_of_the_likelihood_is_that_of_finite_differences(
    kernel: Kernel, noise: float | None
) -> None:
    u = design(20)
    y = wavy(u)
    basis = np.hstack([np.ones((20, 1)), u])
    objective = _Objective(u, y / y.std(), basis, kernel, noise)
    logs = objective.pack(Starts(np.random.default_rng(3), 2).draw(2)[1])
    gradient = objective(logs)[1]
    steps = 1e-5 * np.eye(logs.size)
    numerical = [(objective(logs + s)[0] - objective(logs - s)[0]) / 2e-5 for s in steps]
    assert_allclose(gradient, numerical, rtol=2e-4, atol=1e-4)


@pytest.mark.parametrize("kernel", KERNELS)
@pytest.mark.parametrize("trend", [0, 1, 2])
def test_a_smooth_function_is_learned(kernel: Kernel, trend: int) -> None:
    u = design(60)
    gp = fit_gaussian_process(u, wavy(u), kernel=kernel, trend=trend)
    new = np.random.default_rng(9).standard_normal((300, 2))
    mean, std = gp.mean_and_std(new)
    assert np.sqrt(np.mean((mean - wavy(new)) ** 2)) < 0.02
    assert_allclose(gp.mean(new), mean, rtol=1e-10, atol=1e-12)
    assert_allclose(gp.std(new), std)
    # errors in units of the stated deviation
    assert 0.05 < np.sqrt(np.mean(((mean - wavy(new)) / std) ** 2)) < 3.0


def test_noise_is_learned_and_smoothed_over() -> None:
    u = design(200)
    rng = np.random.default_rng(4)
    gp = fit_gaussian_process(u, wavy(u) + 0.05 * rng.standard_normal(200), trend=1)
    # relative standard error of a standard deviation from 200 values is 5 %
    assert gp.noise_std == pytest.approx(0.05, rel=0.25)
    new = rng.standard_normal((300, 2))
    assert np.sqrt(np.mean((gp.mean(new) - wavy(new)) ** 2)) < 0.03


def test_known_noise_is_taken_as_it_is() -> None:
    u = design(40)
    assert fit_gaussian_process(u, wavy(u), noise=0.07).noise_std == pytest.approx(0.07)
    exact = fit_gaussian_process(u, wavy(u), noise=0.0)
    assert exact.noise_std == 0.0
    assert_allclose(exact.mean(u), wavy(u), atol=1e-3)


@pytest.mark.parametrize("trend", [0, 2])
def test_leave_one_out_is_that_of_refits(trend: int) -> None:
    u = design(25)
    y = wavy(u) + 0.05 * np.random.default_rng(2).standard_normal(25)
    gp = fit_gaussian_process(u, y, trend=trend, kernel="matern52")
    found = gp.leave_one_out()
    for i in (0, 7, 24):
        rest = np.arange(25) != i
        other = GaussianProcess(u[rest], gp.y[rest], gp.kernel, gp.trend, gp.hyperparameters)
        mean, std = other.mean_and_std(u[[i]])
        assert found.residuals[i] == pytest.approx(gp.y[i] - mean[0], rel=1e-5, abs=1e-9)
        # a left-out run has the noise, and the little that keeps the matrix regular, of its own
        own = gp.hyperparameters.noise_variance + JITTER * gp.hyperparameters.process_variance
        assert found.std[i] == pytest.approx(np.sqrt(std[0] ** 2 + own), rel=1e-3)


@pytest.mark.parametrize("kernel", KERNELS)
def test_paths_have_the_posterior_mean_and_deviation(kernel: Kernel) -> None:
    u = design(12)
    values = Hyperparameters(np.array([1.2, 2.0]), 0.8, 1e-3)
    gp = GaussianProcess(u, wavy(u), kernel, total_degree_indices(2, 1), values)
    new = np.random.default_rng(2).standard_normal((40, 2)) * 1.5
    mean, std = gp.mean_and_std(new)
    count = 2000
    draws = gp.sample_paths(np.random.default_rng(7), count, features=8000)(new)
    assert draws.shape == (count, 40)
    z = (draws.mean(axis=0) - mean) / (std / np.sqrt(count))
    assert np.abs(z).max() < 4.5
    # 5 standard errors of a standard deviation, and 4 % for the finite number of features
    assert_allclose(draws.std(axis=0) / std, 1.0, atol=5.0 / np.sqrt(2 * count) + 0.04)


def test_paths_are_functions() -> None:
    u = design(20)
    paths = fit_gaussian_process(u, wavy(u)).sample_paths(np.random.default_rng(1), 3)
    new = design(50, seed=3)
    assert_allclose(paths(new)[:, 10:20], paths(new[10:20]), rtol=1e-9, atol=1e-9)


def test_the_unit_of_the_response_does_not_matter() -> None:
    u = design(40)
    new = design(30, seed=8)
    y = wavy(u) + 0.05 * np.random.default_rng(5).standard_normal(40)
    plain = fit_gaussian_process(u, y, trend=1)
    other = fit_gaussian_process(u, 1e-3 * y + 0.5, trend=1)
    assert_allclose(other.mean(new), 1e-3 * plain.mean(new) + 0.5, rtol=1e-5)
    # the search for the hyperparameters ends where the likelihood is flat
    assert_allclose(other.std(new), 1e-3 * plain.std(new), rtol=0.05)


def test_a_constant_response_is_reproduced_exactly() -> None:
    value = 0.1 + 0.2
    gp = fit_gaussian_process(design(30), np.full(30, value), trend=2)
    new = design(20, seed=1)
    assert (gp.mean(new) == value).all()
    assert gp.std(new).max() < 1e-12
    assert gp.leave_one_out().rms == 0.0


def test_repeated_points_and_few_points_do_no_harm() -> None:
    u = np.repeat(design(6), 3, axis=0)
    assert np.isfinite(fit_gaussian_process(u, wavy(u), noise=0.0).mean(design(9))).all()
    assert np.isfinite(fit_gaussian_process(u[:2], np.array([0.0, 1.0])).mean(design(9))).all()


def test_a_warm_start_gives_the_same_surface() -> None:
    u = design(50)
    first = fit_gaussian_process(u[:45], wavy(u[:45]), trend=1)
    cold = fit_gaussian_process(u, wavy(u), trend=1)
    warm = fit_gaussian_process(u, wavy(u), trend=1, start=first)
    new = design(100, seed=2)
    assert_allclose(warm.mean(new), cold.mean(new), atol=0.02)


def test_trend_keeps_two_points_per_term() -> None:
    u = design(16, dimension=3)
    y = u.sum(axis=1)
    assert fit_gaussian_process(u, y, trend=2).trend.shape == (4, 3)
    assert fit_gaussian_process(design(40, dimension=3), design(40, dimension=3)[:, 0], trend=2
                                ).trend.shape == (10, 3)  # fmt: skip


@pytest.mark.parametrize(
    ("u", "y", "noise", "message"),
    [
        (np.zeros((3, 2)), np.zeros(2), None, "expected"),
        (np.zeros((1, 2)), np.zeros(1), None, "n >= 2"),
        (np.zeros((3, 2)), np.array([0.0, np.nan, 1.0]), None, "finite"),
        (np.zeros((3, 2)), np.zeros(3), -1.0, "noise = -1.0"),
    ],
)
def test_bad_data_are_refused(
    u: FloatArray, y: FloatArray, noise: float | None, message: str
) -> None:
    with pytest.raises(ValueError, match=message):
        fit_gaussian_process(u, y, noise=noise)


def test_one_length_scale_is_learned_for_fifty_inputs() -> None:
    """A hundred scales took a minute, and four hundred runs do not tell them apart."""
    u = np.random.default_rng(2).standard_normal((70, 50))
    gp = fit_gaussian_process(u, wavy(u), trend=0)
    assert np.ptp(gp.hyperparameters.length_scales) == 0.0
    few = fit_gaussian_process(u[:, :4], wavy(u), trend=0)
    assert np.ptp(few.hyperparameters.length_scales) > 0.0


def test_surfaces_without_some_runs_are_those_of_the_others() -> None:
    u, new = design(24), design(5, seed=1)
    process = fit_gaussian_process(u, wavy(u), trend=1)
    groups = [np.arange(first, 24, 8) for first in range(3)]
    found = process.without(groups)(new)
    for values, left_out in zip(found, groups, strict=True):
        others = np.delete(np.arange(24), left_out)
        again = GaussianProcess(
            u[others], wavy(u)[others], process.kernel, process.trend, process.hyperparameters
        )
        assert_allclose(values, again.mean(new), rtol=1e-5, atol=1e-5)
    assert np.abs(found - process.mean(new)).max() > 1e-4
