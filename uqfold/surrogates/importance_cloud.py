"""Weighted points in standard-normal space that gather where they are wanted, tails included.

A first layer spreads over all radii, so that regions far out are seen however rare they are. The
following ones are drawn from Gaussian mixtures fitted to what the layers before found important,
each cluster for itself, so that several regions are kept apart (cross-entropy method). All layers
together are weighted by their joint mixture (balance heuristic), which keeps weights bounded.

References
----------
Rubinstein R. Y., Kroese D. P. The Cross-Entropy Method. Springer, 2004.
Veach E., Guibas L. J. Optimally combining sampling techniques for Monte Carlo rendering.
SIGGRAPH 1995.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, Protocol

import numpy as np

from uqfold.time_limit import check_time
from uqfold.typing import FloatArray

REACH = 8.5
"""The first layer ends at this many standard deviations."""
_IN_BULK = 0.3
_CLUSTERS = 8
_FITTED_TO = 600
_LLOYD_STEPS = 12
# Mixtures are a little wider than what they are fitted to.
_INFLATION = 1.5
_LOG_ROOT_TWO_PI = 0.5 * math.log(2.0 * math.pi)


@dataclass(frozen=True, eq=False)
class ImportanceCloud:
    """Points u (N, d) and weights (N,) with E[g(u)] = sum of weights * g, u standard normal.

    Attributes
    ----------
    u, weights
        Points and their weights.
    values
        What the caller wanted to know at the points, (C, N).
    proposal
        From where one more layer would be drawn.
    """

    u: FloatArray
    weights: FloatArray
    values: FloatArray
    proposal: Proposal

    def fresh(self, size: int, rng: np.random.Generator) -> tuple[FloatArray, FloatArray]:
        """Draw points (size, d) and weights (size,) that do not depend on the cloud's own points.

        The cloud's own sums lean to the low side, since its layers went where the earlier ones
        had found something; sums over fresh points have the right mean.
        """
        d = self.u.shape[1]
        wide = WideProposal(d)
        few = max(1, size // 8)
        u = np.concatenate([_draw(self.proposal, d, size - few, rng), _draw(wide, d, few, rng)])
        return u, _balanced(u, [self.proposal, wide], (size - few, few))


class Proposal(Protocol):
    """A density over standard-normal space to draw from."""

    def draw(self, uniforms: FloatArray) -> FloatArray:
        """Map uniforms (n, d + 1) to points (n, d)."""
        ...

    def log_density(self, u: FloatArray) -> FloatArray:
        """Logarithm of the density (n,)."""
        ...


def importance_cloud(
    wanted: Callable[[FloatArray], FloatArray],
    dimension: int,
    rng: np.random.Generator,
    layers: tuple[int, ...],
    scouted: Callable[[FloatArray], FloatArray] | None = None,
) -> ImportanceCloud:
    """Draw a cloud that follows phi(u) |wanted(u)|.

    Parameters
    ----------
    wanted
        Values (C, N) at points (N, d). Each row that is not zero counts alike, however rare.
    dimension
        Number of variables d.
    rng
        Source of randomness.
    layers
        Points of each layer, the first of them spread wide.
    scouted
        More values at the points of the first layer, which the second one follows, too: of wide
        regions beside narrow ones that are wanted.
    """
    proposals: list[Proposal] = [WideProposal(dimension)]
    drawn = [_draw(proposals[0], dimension, layers[0], rng)]
    values = [wanted(drawn[0])]
    for size in layers[1:]:
        check_time()
        u = np.concatenate(drawn)
        weights = _balanced(u, proposals, layers)
        known = np.concatenate(values, axis=1)
        if scouted is not None and len(drawn) == 1:
            known = np.concatenate([known, scouted(u)])
        importance = _importance(known, weights)
        if importance is None:
            break
        proposals.append(_fitted(u, importance, rng))
        drawn.append(_draw(proposals[-1], dimension, size, rng))
        values.append(wanted(drawn[-1]))
    u = np.concatenate(drawn)
    weights = _balanced(u, proposals, layers)
    found = np.concatenate(values, axis=1)
    importance = _importance(found, weights)
    last = proposals[0] if importance is None else _fitted(u, importance, rng)
    return ImportanceCloud(u, weights, found, last)


def _draw(proposal: Proposal, dimension: int, size: int, rng: np.random.Generator) -> FloatArray:
    from scipy.stats import qmc

    sampler = qmc.Sobol(dimension + 1, rng=rng)
    uniforms = sampler.random_base2(max(0, math.ceil(math.log2(size))))[:size]
    return proposal.draw(np.clip(uniforms, 1e-12, 1.0 - 1e-12))


def _balanced(u: FloatArray, proposals: list[Proposal], layers: tuple[int, ...]) -> FloatArray:
    """Weights phi(u) / sum_l N_l q_l(u)."""
    logs = np.stack(
        [
            math.log(size) + proposal.log_density(u)
            for proposal, size in zip(proposals, layers, strict=False)
        ]
    )
    top = logs.max(axis=0)
    log_total = top + np.log(np.exp(logs - top).sum(axis=0))
    return np.asarray(np.exp(_log_normal(u) - log_total))


def _importance(values: FloatArray, weights: FloatArray) -> FloatArray | None:
    """Share (N,) of each point in what is wanted; None if nothing is."""
    share = np.abs(values) * weights
    total = share.sum(axis=1, keepdims=True)
    share = share[(total[:, 0] > 0.0) & np.isfinite(total[:, 0])]
    if share.size == 0:
        return None
    return np.asarray((share / share.sum(axis=1, keepdims=True)).mean(axis=0))


def _log_normal(u: FloatArray) -> FloatArray:
    return np.asarray(-0.5 * (u * u).sum(axis=1) - u.shape[1] * _LOG_ROOT_TWO_PI)


@dataclass(frozen=True)
class WideProposal:
    """Uniform over directions and radii up to REACH, mixed with the standard normal."""

    dimension: int

    @property
    def _reach(self) -> float:
        # in many dimensions most of the standard normal itself lies far out
        return REACH + math.sqrt(self.dimension) - 1.0

    def draw(self, uniforms: FloatArray) -> FloatArray:
        """Map uniforms (n, d + 1) to points (n, d)."""
        from scipy.special import ndtri

        normal = ndtri(uniforms[:, 1:])
        choice = uniforms[:, 0]
        radius = self._reach * (choice - _IN_BULK) / (1.0 - _IN_BULK)
        length = np.sqrt((normal * normal).sum(axis=1))
        scale = np.where(choice < _IN_BULK, 1.0, radius / np.maximum(length, 1e-300))
        return np.asarray(normal * scale[:, None])

    def log_density(self, u: FloatArray) -> FloatArray:
        """Logarithm of the density (n,)."""
        d = self.dimension
        radius = np.sqrt((u * u).sum(axis=1))
        log_surface = math.log(2.0) + 0.5 * d * math.log(math.pi) - math.lgamma(0.5 * d)
        with np.errstate(divide="ignore"):
            wide = -math.log(self._reach) - log_surface - (d - 1.0) * np.log(radius)
        wide = np.where(radius <= self._reach, wide + math.log(1.0 - _IN_BULK), -np.inf)
        return np.logaddexp(wide, _log_normal(u) + math.log(_IN_BULK))


@dataclass(frozen=True, eq=False)
class GaussianMixture:
    """Mixture of K normal distributions.

    Attributes
    ----------
    shares
        Probabilities (K,).
    means
        Centres (K, d).
    factors
        Lower Cholesky factors (K, d, d) of the covariances.
    """

    shares: FloatArray
    means: FloatArray
    factors: FloatArray

    def draw(self, uniforms: FloatArray) -> FloatArray:
        """Map uniforms (n, d + 1) to points (n, d)."""
        from scipy.special import ndtri

        which = np.searchsorted(np.cumsum(self.shares)[:-1], uniforms[:, 0], side="right")
        drawn = ndtri(uniforms[:, 1:])
        for k, (mean, factor) in enumerate(zip(self.means, self.factors, strict=True)):
            drawn[which == k] = mean + drawn[which == k] @ factor.T
        return np.asarray(drawn)

    def log_density(self, u: FloatArray) -> FloatArray:
        """Logarithm of the density (n,)."""
        from scipy.linalg import solve_triangular

        logs = np.empty((self.shares.size, u.shape[0]))
        for k, (share, mean, factor) in enumerate(
            zip(self.shares, self.means, self.factors, strict=True)
        ):
            z = solve_triangular(factor, (u - mean).T, lower=True, check_finite=False)
            logs[k] = math.log(share) - np.log(np.diag(factor)).sum() - 0.5 * (z * z).sum(axis=0)
        top = logs.max(axis=0)
        total = top + np.log(np.exp(logs - top).sum(axis=0))
        return np.asarray(total - u.shape[1] * _LOG_ROOT_TWO_PI)


def _fitted(u: FloatArray, importance: FloatArray, rng: np.random.Generator) -> GaussianMixture:
    """Gaussian mixture around clusters of the important points."""
    picked = resampled(importance, _FITTED_TO, rng)
    label = _clusters(u[picked], rng)
    d = u.shape[1]
    shares, means, factors = [], [], []
    for k in range(int(label.max()) + 1):
        own = picked[label == k]
        if own.size == 0:
            continue
        # copies of one point say nothing about the spread around it: shrink towards identity
        copies = np.unique(own, return_counts=True)[1]
        distinct = own.size**2 / float((copies**2).sum()) - 1.0
        spread = np.cov(u[own].T, bias=True).reshape(d, d)
        covariance = (distinct * _INFLATION * spread + (d + 2) * np.eye(d)) / (distinct + d + 2)
        shares.append(own.size)
        means.append(u[own].mean(axis=0))
        factors.append(np.linalg.cholesky(covariance))
    share = np.array(shares, dtype=float)
    return GaussianMixture(share / share.sum(), np.array(means), np.array(factors))


def resampled(importance: FloatArray, size: int, rng: np.random.Generator) -> Any:
    """Return `size` indices drawn in proportion to `importance` (N,), by systematic resampling."""
    edges = np.cumsum(importance)
    positions = (rng.random() + np.arange(size)) / size * edges[-1]
    return np.minimum(np.searchsorted(edges, positions), importance.size - 1)


def _clusters(points: FloatArray, rng: np.random.Generator) -> Any:
    """Labels (n,) of Lloyd's algorithm from well-spread starts."""
    centres = points[rng.integers(points.shape[0])][None, :]
    for _ in range(_CLUSTERS - 1):
        distance = _squared(points, centres).min(axis=1)
        if not distance.max() > 0.0:
            break
        pick = rng.choice(points.shape[0], p=distance / distance.sum())
        centres = np.vstack([centres, points[pick]])
    for _ in range(_LLOYD_STEPS):
        label = _squared(points, centres).argmin(axis=1)
        kept = [k for k in range(centres.shape[0]) if (label == k).any()]
        centres = np.array([points[label == k].mean(axis=0) for k in kept])
    return _squared(points, centres).argmin(axis=1)


def _squared(a: FloatArray, b: FloatArray) -> FloatArray:
    return np.asarray(((a[:, None, :] - b[None, :, :]) ** 2).sum(axis=2))
