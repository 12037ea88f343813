"""Clouds of weighted points: right sums, rare regions reached, several of them found."""

import numpy as np
import pytest
from scipy.special import ndtr

from uqfold.algebra import one_blas_thread
from uqfold.surrogates.importance_cloud import (
    GaussianMixture,
    WideProposal,
    importance_cloud,
    resampled,
)
from uqfold.typing import FloatArray

LAYERS = (1500, 1000, 1000)


def beyond(beta: float, dimension: int) -> tuple[object, FloatArray]:
    direction = np.ones(dimension) / np.sqrt(dimension)

    def wanted(u: FloatArray) -> FloatArray:
        return (u @ direction > beta)[None].astype(float)

    return wanted, direction


@pytest.mark.parametrize(("dimension", "beta"), [(1, 1.0), (1, 6.0), (2, 3.0), (5, 1.0), (5, 6.0)])
@one_blas_thread()
def test_fresh_points_give_the_probability(dimension: int, beta: float) -> None:
    wanted, _ = beyond(beta, dimension)
    exact = ndtr(-beta)
    z = []
    for seed in range(8):
        rng = np.random.default_rng(seed)
        cloud = importance_cloud(wanted, dimension, rng, LAYERS)  # type: ignore[arg-type]
        u, weights = cloud.fresh(4096, rng)
        z.append(float(wanted(u)[0] @ weights) / exact - 1.0)  # type: ignore[operator]
    error = np.std(z, ddof=1) / np.sqrt(len(z))
    assert abs(np.mean(z)) <= 5.0 * error
    assert np.std(z) < 0.06


def test_weights_are_those_of_the_standard_normal() -> None:
    rng = np.random.default_rng(3)
    cloud = importance_cloud(lambda u: np.ones((1, len(u))), 3, rng, LAYERS)
    assert cloud.weights.sum() == pytest.approx(1.0, abs=0.02)
    np.testing.assert_allclose(cloud.weights @ cloud.u**2, 1.0, atol=0.08)


def test_all_regions_are_found_and_each_row_counts_alike() -> None:
    """Four regions in four directions, one of them a thousand times rarer."""
    centres = 4.0 * np.array([[1.0, 0.0], [-1.0, 0.0], [0.0, 1.0], [0.0, -1.4]])

    def wanted(u: FloatArray) -> FloatArray:
        near = [np.exp(-2.0 * ((u - c) ** 2).sum(axis=1)) for c in centres]
        return np.array([near[0] + near[1] + near[2], near[3]])

    cloud = importance_cloud(wanted, 2, np.random.default_rng(4), LAYERS)
    u = cloud.proposal.draw(np.clip(np.random.default_rng(5).random((2000, 3)), 1e-9, None))
    shares = [np.mean(((u - 0.8 * c) ** 2).sum(axis=1) < 1.0) for c in centres]
    assert min(shares) > 0.05, shares


def test_nothing_wanted_leaves_the_wide_layer() -> None:
    cloud = importance_cloud(lambda u: np.zeros((1, len(u))), 2, np.random.default_rng(6), LAYERS)
    assert len(cloud.u) == LAYERS[0]
    assert isinstance(cloud.proposal, WideProposal)


@pytest.mark.parametrize("dimension", [1, 2, 4])
def test_densities_are_those_of_the_draws(dimension: int) -> None:
    """E_q[p / q] = 1 for a normal p that q covers."""
    rng = np.random.default_rng(7)
    mixture = GaussianMixture(
        np.array([0.3, 0.7]),
        np.vstack([np.ones(dimension), -np.ones(dimension)]),
        np.stack([np.tril(np.full((dimension, dimension), 0.3)) + np.eye(dimension)] * 2),
    )
    for proposal in (WideProposal(dimension), mixture):
        u = proposal.draw(np.clip(rng.random((200_000, dimension + 1)), 1e-12, 1.0 - 1e-12))
        log_p = -0.5 * (u * u).sum(axis=1) / 0.49 - dimension * np.log(0.7 * np.sqrt(2.0 * np.pi))
        ratio = np.exp(log_p - proposal.log_density(u))
        error = ratio.std() / np.sqrt(ratio.size)
        assert abs(ratio.mean() - 1.0) < 5.0 * error
        assert error < 0.02


def test_systematic_resampling_keeps_proportions() -> None:
    importance = np.array([1.0, 0.0, 3.0, 6.0])
    counts = np.bincount(resampled(importance, 1000, np.random.default_rng(8)), minlength=4)
    assert counts[1] == 0
    np.testing.assert_allclose(counts, 100.0 * importance, atol=1)
