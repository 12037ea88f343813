"""Surfaces over many inputs: sums, few directions of curvature, and what all inputs share."""

import math

import numpy as np
import pytest
from scipy import integrate, stats

from uqfold.inputs import normal
from uqfold.methods import Kriging
from uqfold.problems import Problem
from uqfold.surrogates.common_powers import with_common_powers
from uqfold.surrogates.curved_directions import curved_directions, without_products
from uqfold.surrogates.designs import space_filling_design
from uqfold.surrogates.gaussian_process import fit_gaussian_process
from uqfold.surrogates.polynomial_chaos import fit_polynomial_chaos
from uqfold.typing import FloatArray

D = 40
SLOPES = np.linspace(1.0, 0.1, D)
PLANE = np.linalg.qr(np.random.default_rng(3).standard_normal((D, 2)))[0]


def design(runs: int = 5 * D) -> FloatArray:
    return space_filling_design(runs, D, np.random.default_rng(1))


def folded(u: FloatArray) -> FloatArray:
    """Linear in 40 inputs, and curved along two directions that are no inputs."""
    z = u @ PLANE
    return u @ SLOPES + 0.08 * z[:, 0] ** 2 - 0.06 * z[:, 1] ** 2 + 0.01 * z[:, 0] * z[:, 1]


def squares(u: FloatArray) -> FloatArray:
    return u @ SLOPES + 0.02 * (u**2).sum(axis=1)


def test_directions_of_curvature_are_found_among_forty_inputs() -> None:
    """Five runs for each input are far fewer than the 861 terms of degree two."""
    found = curved_directions(design(), folded(design()))
    assert found is not None
    assert found.error < 1e-12
    plane = found.rotation[:, :2]
    np.testing.assert_allclose(plane @ plane.T, PLANE @ PLANE.T, atol=1e-6)
    np.testing.assert_allclose(found.rotation.T @ found.rotation, np.eye(D), atol=1e-12)


def test_a_plane_has_no_directions_of_curvature() -> None:
    assert curved_directions(design(), design() @ SLOPES) is None


@pytest.mark.parametrize("response", [folded, squares])
def test_mildly_curved_responses_of_many_inputs_are_expanded_exactly(response) -> None:
    """They were off by hundreds of per cent of pf: a plane was all that runs allowed."""
    surface = fit_polynomial_chaos(design(), response(design()), directions=True)
    points = np.random.default_rng(5).standard_normal((200, D))
    np.testing.assert_allclose(surface.mean(points), response(points), atol=1e-6)
    assert surface.leave_one_out().rms < 1e-6


def test_sensitivities_and_chaospy_of_rotated_polynomials_are_those_of_the_inputs() -> None:
    surface = fit_polynomial_chaos(design(), folded(design()), directions=True)
    assert surface.rotation is not None
    found = surface.sobol_indices()
    linear = SLOPES**2 / (SLOPES @ SLOPES)
    np.testing.assert_allclose(found.main, linear, atol=0.05)
    np.testing.assert_allclose(found.total, linear, atol=0.05)
    assert surface.variance == pytest.approx(SLOPES @ SLOPES, rel=0.01)
    # 200 runs cannot tell directions in a response without any
    assert fit_polynomial_chaos(design(), folded(design())).rotation is None


def test_kriging_has_its_trend_and_process_along_directions_of_curvature() -> None:
    """It knew of the inputs alone, and missed 6 to 60 % of pf, though doubtful."""
    model = lambda u: folded(u) + 0.001 * np.sin(u @ PLANE[:, 0])  # noqa: E731
    expansion = fit_polynomial_chaos(design(), model(design()), directions=True)
    trend = without_products(expansion.indices)
    assert trend.shape[0] < expansion.indices.shape[0] - D
    process = fit_gaussian_process(
        design(), model(design()), trend=trend, rotation=expansion.rotation
    )
    points = np.random.default_rng(5).standard_normal((200, D))
    missed = process.mean(points) - model(points)
    assert np.abs(missed).max() < 5e-3
    np.testing.assert_allclose(process.mean_and_std(points)[0], process.mean(points), rtol=1e-12)
    np.testing.assert_allclose(process.mean(design()), model(design()), atol=5e-3)
    paths = process.sample_paths(np.random.default_rng(2), 50)(points)
    spread = paths.std(axis=0) / process.std(points)
    assert 0.5 < np.median(spread) < 2.0
    assert np.abs(paths.mean(axis=0) - process.mean(points)).max() < 1e-2


def test_kriging_is_right_about_curvature_along_a_direction() -> None:
    z = PLANE[:20, 0] / np.linalg.norm(PLANE[:20, 0])
    problem = Problem.from_limit_state(
        lambda x: 4.0 - x[:, 0] - 0.1 * (x @ z) ** 2,
        {f"x{i}": normal(0.0, 1.0) for i in range(20)},
    )
    row = Kriging(kernel="gaussian").estimate(problem, rng=1)[0]
    # given x1, a chi-square with one degree of freedom that is not central
    share = z[0]
    integral, _ = integrate.quad(
        lambda t: stats.norm.pdf(t)
        * stats.ncx2.sf(
            max(0.0, 4.0 - t) / (0.1 * (1.0 - share**2)), 1, (t * share) ** 2 / (1.0 - share**2)
        ),
        -8.0, 4.0, epsabs=0.0, epsrel=1e-9, limit=200,
    )  # fmt: skip
    right = integral + stats.norm.sf(4.0)
    assert row.status == "converged"
    assert row.pf == pytest.approx(right, rel=2e-3)


def test_what_all_inputs_share_is_seen_where_each_of_them_hides_it() -> None:
    """Runs left out by a plane miss by little, and the mean of forty squares by all of them."""
    u = design(90)
    plane = fit_polynomial_chaos(u, squares(u), max_degree=1)
    better = with_common_powers(plane.mean, u, squares(u), plane.leave_one_out().residuals)
    points = np.random.default_rng(5).standard_normal((2_000, D))
    missed, left = (float(np.mean(one(points) - squares(points))) for one in (plane.mean, better))
    assert missed > 1.0
    assert abs(left) < 0.5 * missed
    assert math.isfinite(left)
