"""The probability of second order: behind a paraboloid at a design point, or behind several.

The limit state near a design point at the distance beta is u_d = beta + sum kappa_i v_i^2 / 2 over
the tangent directions, with main curvatures kappa_i that are positive where it bends away from the
origin. All is about the domain beyond the point, whose probability is the smaller one.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal, TypeAlias

import numpy as np

from uqfold.methods.design_point_check import Surroundings
from uqfold.typing import FloatArray

Formula: TypeAlias = Literal["paraboloid", "breitung", "hohenbichler-rackwitz", "tvedt"]
NODES, LAST = 400, 13.0
"""Nodes of the integral over the paraboloid, and where it ends: its integrand falls like a normal
density."""
STRAIGHT = 0.5
"""A secant is believed if the response there is so much nearer to T."""
DEEP = 60
"""Points behind the limit state that are run."""
ROOM = 0.9
"""How near the integral may come to where a curvature makes it infinite."""


@dataclass(frozen=True, eq=False)
class Paraboloid:
    """The limit state around a design point, to second order.

    Attributes
    ----------
    towards
        Unit vector (d,) from the origin to the point.
    radius
        Its distance beta from the origin.
    curvatures
        Main curvatures (d - 1,), ascending, over one standard deviation.
    further
        The same over `FAR_OUT`.
    misfit
        What points drawn on the tangent plane show of what the paraboloid misses, with its standard
        error, and what mixed curvatures that are not known may change; relative to the probability
        behind the plane.
    """

    towards: FloatArray
    radius: float
    curvatures: FloatArray
    further: FloatArray
    misfit: float

    @classmethod
    def at(cls, around: Surroundings) -> Paraboloid:
        """Fit it to runs around a design point, most of which a second look has made.

        Raises
        ------
        BudgetExceededError
            If the others do not fit.
        """
        tangents, near, far, hidden = around.curvatures()
        drawn, distances, weights = around.drawn()
        distances = _crossings(around, drawn, distances)
        across = drawn @ tangents.T
        by_paraboloid = around.radius + 0.5 * np.einsum("ni,ij,nj->n", across, near, across)
        missed = weights * (around.shares(distances) - around.shares(by_paraboloid))
        misfit = float(abs(missed.mean()) + missed.std() / math.sqrt(len(missed))) + hidden
        misfit += _works_beyond(around, drawn, distances, weights)
        bends = (np.asarray(np.linalg.eigvalsh(one), dtype=np.float64) for one in (near, far))
        return cls(around.towards, around.radius, next(bends), next(bends), misfit)

    @property
    def is_nearest(self) -> bool:
        """Whether no point of the limit state beside it is nearer to the origin.

        Where the limit state bends towards the origin more than a sphere does, the gradient leads
        to the origin as well, but nearer points lie to both sides, and have paraboloids of their
        own.
        """
        return bool((1.0 + self.radius * self.curvatures > 0.0).all())

    def probabilities(self) -> dict[Formula, float]:
        """Return what each formula gives; infinite where the paraboloid bends too much for it.

        The probability behind the paraboloid is an integral (Tvedt L. Distribution of quadratic
        forms in normal space. J. Eng. Mech. 116 (1990) 1183-1197). The others approximate it:
        Breitung K. Asymptotic approximations for multinormal integrals. J. Eng. Mech. 110 (1984)
        357-366; Hohenbichler M., Rackwitz R. Improvement of second-order reliability estimates by
        importance sampling. J. Eng. Mech. 114 (1988) 2195-2199; the three terms of Tvedt L. Two
        second-order approximations to the failure probability. Veritas report RDIV/20-004-83, 1983.
        """
        from scipy.special import log_ndtr

        beta, kappa = self.radius, self.curvatures
        behind = math.exp(float(log_ndtr(-beta)))
        log_density = -0.5 * beta**2 - 0.5 * math.log(2.0 * math.pi)
        rate = math.exp(log_density - float(log_ndtr(-beta)))
        found: dict[Formula, float] = {
            "paraboloid": behind_paraboloid(beta, kappa),
            "breitung": math.inf,
            "hohenbichler-rackwitz": math.inf,
            "tvedt": math.inf,
        }
        if self.is_nearest:
            found["breitung"] = behind * _product(beta, kappa).real
        if (1.0 + rate * kappa > 0.0).all():
            found["hohenbichler-rackwitz"] = behind * _product(rate, kappa).real
        if (1.0 + (beta + 1.0) * kappa > 0.0).all():
            first = _product(beta, kappa).real
            # beta Phi(-beta) - phi(beta), without what cancels in it
            less = behind * (beta - rate)
            second = less * (first - _product(beta + 1.0, kappa).real)
            third = (beta + 1.0) * less * (first - _product(beta + 1j, kappa).real)
            found["tvedt"] = max(0.0, behind * first + second + third)
        return found


def _crossings(around: Surroundings, drawn: FloatArray, distances: FloatArray) -> FloatArray:
    """Return distances (k,) of T above points on the plane, by one more run each and a secant."""
    ahead = distances - around.radius
    there = (around.radius + ahead)[:, None] * around.towards
    left = around.margin(there + drawn)
    with np.errstate(divide="ignore", invalid="ignore"):
        further = ahead * ahead / (ahead + left)
    straight = np.abs(left) < STRAIGHT * np.abs(ahead)
    return np.asarray(np.where(straight, around.radius + further, distances - left))


def _works_beyond(
    around: Surroundings, drawn: FloatArray, distances: FloatArray, weights: FloatArray
) -> float:
    """Share of points behind the limit state that do not fail, with the error of that.

    The points lie above those on the plane, as deep as standard-normal ones would, some of which
    may work again: a domain may be bounded, or cut off by another condition.
    """
    from scipy.special import ndtr, ndtri

    weights = weights * around.shares(distances)
    rng = np.random.default_rng(1)
    chosen = rng.choice(len(drawn), DEEP, p=weights / weights.sum())
    depth = -ndtri(np.maximum(ndtr(-distances[chosen]) * rng.random(DEEP), 1e-300))
    works = around.margin(drawn[chosen] + depth[:, None] * around.towards) < 0.0
    share = float(works.mean())
    return share + math.sqrt(share / DEEP)


def behind_paraboloid(beta: float, curvatures: FloatArray) -> float:
    """Probability of U > beta + sum kappa_i V_i^2 / 2 with standard normal U and V_i.

    Parameters
    ----------
    beta
        Distance of the paraboloid from the origin, not negative.
    curvatures
        Main curvatures (k,), positive where it bends away from the origin.
    """
    sharpest = float(curvatures.min(initial=0.0))
    centre = max(beta, 1.0)
    if sharpest < 0.0:
        centre = min(centre, -ROOM / sharpest)
    t = (np.arange(NODES) + 0.5) * LAST / NODES
    s = centre + 1j * t
    logs = 0.5 * s * s - beta * s
    logs -= 0.5 * np.log(1.0 + np.multiply.outer(s, curvatures)).sum(axis=1)
    values = np.exp(logs) / s
    return float(values.real.sum()) * LAST / NODES / math.pi


def _product(factor: complex, curvatures: FloatArray) -> complex:
    """Product of (1 + factor kappa)^(-1/2)."""
    return complex(np.prod((1.0 + factor * curvatures.astype(complex)) ** -0.5))


def union(indices: Sequence[float], towards: FloatArray) -> tuple[float, float]:
    """Probability behind any of several planes, and what it may be off by.

    With two planes it is exact but for an integration; with more the middle of the bounds that
    pairs give, and half their distance (Ditlevsen O. Narrow reliability bounds for structural
    systems. J. Struct. Mech. 7 (1979) 453-472).

    Parameters
    ----------
    indices
        Distances (K,) of the planes from the origin.
    towards
        Unit vectors (K, d) to them.
    """
    from scipy.special import ndtr

    order = np.argsort(indices)
    betas, towards = np.asarray(indices, dtype=float)[order], towards[order]
    alone = ndtr(-betas)
    least = most = float(alone[0])
    for i in range(1, betas.size):
        both = [_behind_both(betas[j], betas[i], float(towards[j] @ towards[i])) for j in range(i)]
        least += max(0.0, float(alone[i]) - sum(both))
        most += float(alone[i]) - max(both)
    return 0.5 * (least + most), 0.5 * (most - least)


def _behind_both(first: float, second: float, cosine: float) -> float:
    """Probability behind both of two planes whose normals have a cosine."""
    from scipy.integrate import quad
    from scipy.special import ndtr

    if abs(cosine) >= 1.0 - 1e-12:
        return float(ndtr(-max(first, second))) if cosine > 0.0 else 0.0
    sine = math.sqrt(1.0 - cosine**2)

    def density(t: float) -> float:
        """Relative to that at the first plane, so that it is no tiny number."""
        return math.exp(-0.5 * t * t - first * t) * float(
            ndtr((cosine * (first + t) - second) / sine)
        )

    scale = math.exp(-0.5 * first**2) / math.sqrt(2.0 * math.pi)
    return scale * float(quad(density, 0.0, 12.0, limit=200)[0])
