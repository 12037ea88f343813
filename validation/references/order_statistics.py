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

from collections.abc import Callable
from dataclasses import dataclass
from typing import TypeAlias

import numpy as np
from scipy.special import ndtr
from tables import Grid

from uqfold.problems.criterion import Binomial, Missions
from uqfold.problems.reference import Reference
from uqfold.typing import FloatArray

ROUNDING = 1e-12
"""Relative part of every error bound: rounding errors and the digits that are printed."""


@dataclass(frozen=True)
class Rules:
    """How to integrate: panels of the response, trapezoidal rules over standard normals.

    Attributes
    ----------
    start
        Responses below this are neglected.
    width
        Width of a panel; divides every threshold minus `start`, and every tau.
    panel_nodes
        Gauss-Legendre nodes per panel.
    reach
        All standard-normal variables run over +-reach.
    shared_step, individual_step
        Step of the rule over the shared and over the individual variables.
    """

    start: float
    width: float
    panel_nodes: int
    reach: float
    shared_step: float
    individual_step: float = 1.0

    def panels(self, length: float) -> int:
        """Return how many panels a length spans.

        Raises
        ------
        ValueError
            If it is no multiple of their width.
        """
        count = round(length / self.width)
        if abs(count * self.width - length) > 1e-9 * self.width:
            raise ValueError(f"{length} is no multiple of the panel width {self.width}")
        return count


Distribution: TypeAlias = tuple[FloatArray, FloatArray, FloatArray]
"""H, S = 1 - H and h at some responses."""
UnitLaw: TypeAlias = Callable[[FloatArray, float, Rules], Distribution]
"""The distribution of one unit's response at responses (k,), given the standardised shared
variable."""


def below_bound(z: FloatArray, slope: FloatArray, weights: FloatArray) -> Distribution:
    """Return the distribution of a unit whose last variable, standard normal, has a bound.

    Parameters
    ----------
    z, slope
        The response is at most t exactly where the variable is at most z; with dz/dt, (k, nodes).
    weights
        Weights (nodes,) of the individual variables that z depends on.
    """
    density = np.exp(-0.5 * z * z) / np.sqrt(2.0 * np.pi) * slope
    return ndtr(z) @ weights, ndtr(-z) @ weights, density @ weights


def standard_normal_rule(reach: float, step: float) -> tuple[FloatArray, FloatArray]:
    """Return nodes and weights of the trapezoidal rule against the standard normal density.

    For smooth integrands that vanish at both ends it converges faster than any power of the step.
    """
    n = round(reach / step)
    u: FloatArray = step * np.arange(-n, n + 1, dtype=np.float64)
    weights: FloatArray = step * np.exp(-0.5 * u * u) / np.sqrt(2.0 * np.pi)
    return u, weights


def gauss_panels(start: float, width: float, count: int, k: int) -> tuple[FloatArray, FloatArray]:
    """Return nodes (count, k) of Gauss-Legendre panels side by side, and weights (k,) of one."""
    x, w = np.polynomial.legendre.leggauss(k)
    left = start + width * np.arange(count)
    return left[:, None] + 0.5 * width * (x + 1.0), 0.5 * width * w


def integrate(unit: UnitLaw, grid: Grid, rules: Rules) -> FloatArray:
    """Return failure probabilities of the shape of the grid."""
    edges = [rules.panels(threshold - rules.start) for threshold in grid.thresholds]
    nodes, weights = gauss_panels(rules.start, rules.width, max(edges), rules.panel_nodes)
    responses = np.concatenate([nodes.ravel(), np.asarray(grid.thresholds, dtype=np.float64)])
    pf = np.zeros(grid.shape)
    for u, weight in zip(*standard_normal_rule(rules.reach, rules.shared_step), strict=True):
        H, S, h = unit(responses, float(u), rules)
        cdf, pdf = (values[: nodes.size].reshape(nodes.shape) for values in (H, h))
        with np.errstate(divide="ignore"):
            too_late = -np.expm1(grid.units * np.log1p(-np.minimum(S[nodes.size :], 1.0)))
        for i, tau in enumerate(grid.taus):
            failure = too_late
            if tau is not None:
                apart = _apart(cdf, pdf, rules.panels(tau), grid.units) @ weights
                failure = np.minimum(
                    too_late + np.concatenate([[0.0], np.cumsum(apart)])[edges], 1.0
                )
            for j, profile in enumerate(grid.profiles):
                pf[i, j] += weight * mission_failure(failure, profile)
    return pf


def _apart(cdf: FloatArray, pdf: FloatArray, shift: int, n: int) -> FloatArray:
    """Return the integrand of the largest response, where the smallest lies too far below it."""
    below = np.zeros_like(cdf)
    below[shift:] = cdf[: max(len(cdf) - shift, 0)]
    within = np.maximum(cdf - below, 0.0)
    terms = sum(cdf ** (n - 2 - j) * within**j for j in range(n - 1))
    integrand: FloatArray = n * pdf * below * terms
    return integrand


def mission_failure(f: FloatArray, profile: Missions) -> FloatArray:
    """Return the probability that at least one mission fails, each with probability f."""
    binomial = isinstance(profile, Binomial)
    trials, share = (profile.planned, profile.p) if binomial else (profile, 1.0)
    with np.errstate(divide="ignore"):  # f = 1: log1p gives -inf, expm1 of it -1
        failure: FloatArray = -np.expm1(trials * np.log1p(-share * f))
    return failure


def references(unit: UnitLaw, grid: Grid, coarse: Rules, fine: Rules) -> list[Reference]:
    """Return the answers by the finer rules; their bound is the change from the coarser ones."""
    rough, pf = integrate(unit, grid, coarse), integrate(unit, grid, fine)
    return grid.references(pf, np.abs(pf - rough) + ROUNDING * pf)
