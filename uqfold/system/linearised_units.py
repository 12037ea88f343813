"""System failure from linearised units that differ (FORM): the integral over what they share.

Unit j fails if alpha_j . u > beta_j. With the shared part a_j of its unit vector alpha_j, it fails
given the shared variables v with probability Phi((a_j . v - beta_j) / sqrt(1 - |a_j|^2)), whatever
the other units do. Only the projection of v on the span of all a_j matters, which is again standard
normal: one factor where all design points lie in the same shared direction, or opposite; else as
many as there are independent directions, u at most for u sorts of units.

One factor is integrated adaptively. Two and three take sums over equal steps, which are spectrally
accurate for smooth integrands, halved until nothing changes; more are drawn where the system fails.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import numpy as np

from uqfold.moments.panels import integrate
from uqfold.problems.criterion import Missions
from uqfold.system.missions import over_missions
from uqfold.system.places import failure_places
from uqfold.system.structure import SystemUnits
from uqfold.time_limit import check_time
from uqfold.typing import FloatArray

_FARTHEST = 38.5  # the normal density underflows beyond
_PARALLEL = 1e-9
"""Share of the largest direction below which another one is none."""
_REACH = 12.0
_STEPS = {2: (0.4, 0.2, 0.1, 0.05), 3: (0.8, 0.4, 0.25)}
_CHANGE = 1e-9
"""Relative change of an answer that asks for no finer steps."""
_BLOCK, _DRAWN, _GROUPS = 16_384, 1 << 16, 16
_TRIED = 1 << 13
"""Places that are tried for those that are drawn."""


@dataclass(frozen=True, eq=False)
class Planes:
    """Linearised limit states of all sorts of units.

    Attributes
    ----------
    betas
        Reliability indices (J,), of either sign; +-inf allowed.
    shared
        Shared parts (J, s) of the unit vectors towards failure.
    """

    betas: FloatArray
    shared: FloatArray

    def with_betas(self, betas: FloatArray) -> Planes:
        """Return the planes moved in parallel."""
        return replace(self, betas=betas)


@dataclass(frozen=True)
class FactorIntegral:
    """Failure probability and reliability, and what the integration may miss them by."""

    pf: float
    reliability: float
    error: float


class PlanesGiven:
    """Failure and success of a system of linearised units, given what they share.

    Parameters
    ----------
    planes
        One for each sort of units, in the order of `units`.
    units
        The units and their structure.
    missions
        A fixed or a binomial number.
    """

    def __init__(self, planes: Planes, units: SystemUnits, missions: Missions) -> None:
        left, sizes, right = np.linalg.svd(planes.shared, full_matrices=False)
        kept = sizes > _PARALLEL * max(1.0, float(sizes.max(initial=0.0)))
        self.betas, self.units, self.missions = planes.betas, units, missions
        signs = np.where(left.sum(axis=0) < 0.0, -1.0, 1.0)[kept]
        self.factors: FloatArray = left[:, kept] * sizes[kept] * signs
        """Coordinates (J, r) of the shared parts in their own span."""
        self.span: FloatArray = right[kept] * signs[:, None]
        """That span: r unit vectors (r, s)."""
        self.own = np.sqrt(np.maximum(0.0, 1.0 - (self.factors**2).sum(axis=1)))
        """Lengths (J,) of the parts that are the units' own."""

    @property
    def n_factors(self) -> int:
        """Number of independent directions r."""
        return int(self.factors.shape[1])

    def __call__(self, z: FloatArray) -> FloatArray:
        """Failure and success (2, N) at the factors z (r, N)."""
        gap = self.betas[:, None] - self.factors @ z
        own = self.own[:, None]
        with np.errstate(divide="ignore", invalid="ignore"):
            x = np.where(own > 0.0, gap / own, np.where(gap < 0.0, -np.inf, np.inf))
        return self.of_indices(list(x[:, None]))

    def at(self, shared: FloatArray) -> FloatArray:
        """Failure and success (2, N) at shared variables (N, s)."""
        return self(self.span @ shared.T)

    def of_indices(self, indices: Sequence[FloatArray]) -> FloatArray:
        """Failure and success (2, N) given the reliability indices of each sort of units.

        Of a sort there may be several (lines, N), each as likely as the others.
        """
        from scipy.special import ndtr

        check_time()
        fails, works = (
            np.stack([ndtr(sign * one).mean(axis=0) for one in indices]) for sign in (-1.0, 1.0)
        )
        failure, success = self.units.mission(fails, works)
        return np.stack(over_missions(failure, success, self.missions))

    def drawn(self, which: int, count: int, rng: np.random.Generator) -> FloatArray:
        """Draw shared variables (count, s) where the system fails (which = 0) or works (1).

        They are spread evenly over the direction in which such places vary most; all are the same
        where none, or one, of those that are tried has any weight.
        """
        free = rng.standard_normal((count, self.span.shape[1]))
        if self.n_factors == 0:
            return free
        places = failure_places(lambda z: self(z.T)[which][None], self.n_factors, rng)
        tried = places.draw(_TRIED, rng)
        weights = self(tried.T)[which] * np.exp(-places.log_density(tried))
        if not weights.any():
            return 0.0 * free
        # one place alone may have all the weight
        spread = np.cov(tried.T, aweights=weights, ddof=0).reshape(self.n_factors, -1)
        widest = np.linalg.eigh(spread)[1][:, -1]
        order = np.argsort(tried @ widest * math.copysign(1.0, widest.sum()))
        ends = np.cumsum(weights[order])
        chosen = order[np.searchsorted(ends / ends[-1], (np.arange(count) + rng.random()) / count)]
        free -= free @ self.span.T @ self.span
        return np.asarray(free + tried[chosen] @ self.span)


def failure_of_planes(planes: Planes, units: SystemUnits, missions: Missions) -> FactorIntegral:
    """Failure of a system of linearised units that differ.

    Parameters
    ----------
    planes, units, missions
        As in `PlanesGiven`.

    Raises
    ------
    ValueError
        If an index is NaN.
    """
    if np.isnan(planes.betas).any():
        raise ValueError("a beta is NaN: FORM gave no design point")
    given = PlanesGiven(planes, units, missions)
    if given.n_factors == 0:
        failure, success = given(np.zeros((0, 1)))[:, 0].tolist()
        return FactorIntegral(failure, success, 0.0)
    if given.n_factors == 1:
        edges = _edges(planes.betas, given.factors[:, 0], given.own)
        found = integrate(lambda z: given(z[None]) * _density(z[None]), edges, np.zeros(2))
        failure, success = np.minimum(found, 1.0).tolist()
        return FactorIntegral(failure, success, 0.0)
    if given.n_factors in _STEPS:
        return _by_steps(given, given.n_factors)
    return _by_draws(given, given.n_factors)


def _density(z: FloatArray) -> FloatArray:
    """Standard normal density (N,) at z (r, N)."""
    return np.asarray(np.exp(-0.5 * (z**2).sum(axis=0)) / math.sqrt(2.0 * math.pi) ** len(z))


def _edges(betas: FloatArray, factor: FloatArray, own: FloatArray) -> FloatArray:
    """Where to divide an integral over one factor: where units turn from working to failing."""
    known = np.isfinite(betas) & (np.abs(factor) > _PARALLEL)
    centres, widths = betas[known] / factor[known], own[known] / np.abs(factor[known])
    turns = [-8.0, -5.0, -3.0, -2.0, -1.0, 0.0, 1.0, 2.0, 3.0, 5.0, 8.0]
    if centres.size > len(turns):
        turns = [0.0]
    far = [-_FARTHEST, -30.0, -22.0, -16.0, 16.0, 22.0, 30.0, _FARTHEST]
    around = (centres[:, None] + widths[:, None] * np.array(turns)).ravel()
    edges = np.concatenate([far, np.arange(-12.0, 12.5, 1.0), around])
    return np.unique(edges[np.abs(edges) <= _FARTHEST])


def _by_steps(given: Callable[[FloatArray], FloatArray], n_factors: int) -> FactorIntegral:
    found: list[FloatArray] = []
    for step in _STEPS[n_factors]:
        line = np.arange(-_REACH, _REACH + 0.5 * step, step)
        grid = np.stack([one.ravel() for one in np.meshgrid(*[line] * n_factors)])
        weights = _density(grid)
        total = sum(
            given(grid[:, start : start + _BLOCK]) @ weights[start : start + _BLOCK]
            for start in range(0, weights.size, _BLOCK)
        )
        found.append(np.minimum(total / weights.sum(), 1.0))
        if len(found) > 1 and abs(found[-1] - found[-2]).min() <= _CHANGE * found[-1].min():
            break
    pf, reliability = found[-1].tolist()
    return FactorIntegral(pf, reliability, float(np.abs(found[-1] - found[-2]).min()))


def _by_draws(given: Callable[[FloatArray], FloatArray], n_factors: int) -> FactorIntegral:
    """Draw the factors where the system fails, or where it works if that is rarer."""
    rng = np.random.default_rng(0)
    rarer = int(np.argmin(given(rng.standard_normal((n_factors, 1000))).mean(axis=1)))
    places = failure_places(lambda z: given(z.T)[rarer][None], n_factors, rng)
    means = np.empty(_GROUPS)
    for group in range(_GROUPS):
        drawn = places.draw(_DRAWN // _GROUPS, rng)
        chance = given(drawn.T)[rarer]
        means[group] = float(np.mean(chance * np.exp(-places.log_density(drawn))))
    small = min(1.0, float(means.mean()))
    pf, reliability = (small, 1.0 - small) if rarer == 0 else (1.0 - small, small)
    return FactorIntegral(pf, reliability, float(means.std(ddof=1)) / math.sqrt(_GROUPS))
