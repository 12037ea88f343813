"""Failure probability of a system of like units, from the distribution of one, by integration.

Given the shared inputs v, the n units are independent with distribution function H and density h.
One mission fails when the largest response exceeds T, or when it does not and the smallest lies
more than tau below it. Conditioning on the largest response t,

    f = 1 - H(T)^n + n int_{-inf}^{T} h(t) {H(t)^(n-1) - [H(t) - H(t - tau)]^(n-1)} dt,

and the braces factor into H(t - tau) times a sum of positive terms, so that nothing cancels
however small f is. Missions and the expectation over v follow.

The integral runs over Gauss-Legendre panels of one width, which divides every T and every tau:
then each T is the end of a panel, and t - tau is a node of an earlier panel.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Protocol

import numpy as np
from tables import Row

from uqfold.problems.criterion import Binomial, Missions
from uqfold.typing import FloatArray

ROUNDING = 1e-12
"""Relative part of every error bound: rounding errors and the digits that are printed."""


@dataclass(frozen=True)
class Resolution:
    """How finely to integrate: trapezoidal rules over standard-normal variables, and panels.

    Attributes
    ----------
    reach
        All standard-normal variables run over +-reach.
    shared_step, individual_step
        Step of the rule over the shared and over the individual variables.
    panel_nodes
        Gauss-Legendre nodes per panel of the response.
    """

    reach: float
    shared_step: float
    individual_step: float
    panel_nodes: int


class Unit(Protocol):
    """The distribution of one unit's response given the shared variable."""

    def distribution(
        self, t: FloatArray, u: float, resolution: Resolution
    ) -> tuple[FloatArray, FloatArray, FloatArray]:
        """Give H, S = 1 - H and h at responses t (k,), given the standardised shared variable."""
        ...


@dataclass(frozen=True)
class Grid:
    """Thresholds, synchronization thresholds and profiles asked for, and the panels.

    Attributes
    ----------
    start
        Responses below this are neglected.
    width
        Width of a panel; divides every threshold minus `start`, and every tau.
    thresholds, taus, profiles
        T, tau (None: not required) and mission profiles; all combinations are computed.
    n_units
        Number of units n.
    """

    start: float
    width: float
    thresholds: Sequence[float]
    taus: Sequence[float | None]
    profiles: Sequence[Missions]
    n_units: int

    @cached_property
    def edges(self) -> list[int]:
        """How many panels lie below each threshold."""
        return [self._panels(threshold - self.start) for threshold in self.thresholds]

    def shift(self, tau: float) -> int:
        """How many panels tau spans."""
        return self._panels(tau)

    def _panels(self, length: float) -> int:
        count = round(length / self.width)
        if abs(count * self.width - length) > 1e-9 * self.width:
            raise ValueError(f"{length} is no multiple of the panel width {self.width}")
        return count

    def nodes(self, k: int) -> tuple[FloatArray, FloatArray]:
        """Give the nodes (panels, k) of all panels, and the weights (k,) of one."""
        x, w = np.polynomial.legendre.leggauss(k)
        left = self.start + self.width * np.arange(max(self.edges))
        return left[:, None] + 0.5 * self.width * (x + 1.0), 0.5 * self.width * w


def standard_normal_rule(reach: float, step: float) -> tuple[FloatArray, FloatArray]:
    """Trapezoidal rule against the standard normal density: nodes, weights.

    For smooth integrands that vanish at both ends it converges faster than any power of the step.
    """
    n = round(reach / step)
    u: FloatArray = step * np.arange(-n, n + 1, dtype=np.float64)
    weights: FloatArray = step * np.exp(-0.5 * u * u) / np.sqrt(2.0 * np.pi)
    return u, weights


def mission_failure(f: FloatArray, profile: Missions) -> FloatArray:
    """Probability that at least one mission fails, each with probability f."""
    if isinstance(profile, Binomial):
        trials, share = profile.planned, profile.p
    else:
        trials, share = profile, 1.0
    with np.errstate(divide="ignore"):  # f = 1: log1p gives -inf, expm1 of it -1
        failure: FloatArray = -np.expm1(trials * np.log1p(-share * f))
    return failure


def one_mission_failures(
    grid: Grid, cdf: FloatArray, pdf: FloatArray, survival: FloatArray, weights: FloatArray
) -> dict[float | None, FloatArray]:
    """Failure probability of one mission given v, for every tau: arrays (thresholds,).

    Parameters
    ----------
    grid
        What is asked.
    cdf, pdf
        H and h at the nodes (panels, k).
    survival
        S = 1 - H at the thresholds.
    weights
        Weights (k,) of one panel.
    """
    n = grid.n_units
    with np.errstate(divide="ignore"):
        too_late = -np.expm1(n * np.log1p(-np.minimum(survival, 1.0)))
    failures: dict[float | None, FloatArray] = {}
    for tau in grid.taus:
        if tau is None:
            failures[tau] = too_late
            continue
        shift = min(grid.shift(tau), len(cdf))
        below = np.zeros_like(cdf)
        below[shift:] = cdf[: len(cdf) - shift]
        within = np.maximum(cdf - below, 0.0)
        terms = sum(cdf ** (n - 2 - j) * within**j for j in range(n - 1))
        panels = np.concatenate([[0.0], np.cumsum((n * pdf * below * terms) @ weights)])
        failures[tau] = np.minimum(too_late + panels[grid.edges], 1.0)
    return failures


def integrate(unit: Unit, grid: Grid, resolution: Resolution) -> FloatArray:
    """Failure probabilities (taus, profiles, thresholds) at one resolution."""
    nodes, weights = grid.nodes(resolution.panel_nodes)
    responses = np.concatenate([nodes.ravel(), np.asarray(grid.thresholds, dtype=np.float64)])
    pf = np.zeros((len(grid.taus), len(grid.profiles), len(grid.thresholds)))
    for u, weight in zip(
        *standard_normal_rule(resolution.reach, resolution.shared_step), strict=True
    ):
        cdf, survival, pdf = unit.distribution(responses, float(u), resolution)
        failures = one_mission_failures(
            grid,
            cdf[: nodes.size].reshape(nodes.shape),
            pdf[: nodes.size].reshape(nodes.shape),
            survival[nodes.size :],
            weights,
        )
        for i, tau in enumerate(grid.taus):
            for j, profile in enumerate(grid.profiles):
                pf[i, j] += weight * mission_failure(failures[tau], profile)
    return pf


def rows(unit: Unit, grid: Grid, coarse: Resolution, fine: Resolution) -> list[Row]:
    """Reference rows at the finer resolution; their error bound is the change from the coarser."""
    rough, pf = integrate(unit, grid, coarse), integrate(unit, grid, fine)
    bound = np.abs(pf - rough) + ROUNDING * pf
    return [
        Row(float(threshold), tau, profile, float(pf[i, j, k]), float(bound[i, j, k]))
        for i, tau in enumerate(grid.taus)
        for j, profile in enumerate(grid.profiles)
        for k, threshold in enumerate(grid.thresholds)
    ]
