"""Scattered islands of failure: Rastrigin's function, modified.

g = 10 - h(x1) - h(x2) with h(x) = x^2 - 5 cos(2 pi x). Given x1 failure is h(x2) >= 10 - h(x1),
between roots that each lie between two extremes of h. New islands begin, with infinite slope, where
10 - h(x1) is one of these extremes; between such places a substitution makes the integrand smooth.
"""

from __future__ import annotations

from itertools import pairwise

import numpy as np
from scipy.optimize import brentq
from scipy.special import ndtr

from uqfold.problems.catalogue.distributions import standard_normals
from uqfold.problems.catalogue.integrals import normal_pdf, refined
from uqfold.problems.catalogue.record import Entry
from uqfold.problems.catalogue.sources import ECHARD_2011
from uqfold.typing import FloatArray


def limit_state(x: FloatArray) -> FloatArray:
    """Return g (n,) of X (n, 2)."""
    return np.asarray(10.0 - (x**2 - 5.0 * np.cos(2.0 * np.pi * x)).sum(axis=1))


def reference() -> tuple[float, float]:
    """Return pf and its error."""
    return refined(_by_rule, 12, 16)


def _wave(x: FloatArray) -> FloatArray:
    return np.asarray(x**2 - 5.0 * np.cos(2.0 * np.pi * x))


def _by_rule(nodes: int) -> float:
    extremes = _extremes()
    kinks = [kink for e in extremes for kink in _where(10.0 - float(_wave(e)), extremes)]
    places = np.unique([0.0, *kinks, 9.0])
    s, weight = np.polynomial.legendre.leggauss(nodes)
    s, weight = 0.5 * (1.0 + s), 0.5 * weight
    width = np.diff(places)[:, None]
    x1 = (places[:-1, None] + width * s**2 * (3.0 - 2.0 * s)).ravel()
    weight = (width * weight * 6.0 * s * (1.0 - s)).ravel()
    tail = np.zeros(x1.size)
    for low, high in pairwise(extremes):
        root, rises = _between(low, high, 10.0 - _wave(x1))
        tail += ndtr(-root) - ndtr(-high) if rises else ndtr(-low) - ndtr(-root)
    return float(4.0 * (weight * normal_pdf(x1)) @ tail)


def _extremes() -> FloatArray:
    """Return the extremes of h over [0, 9], and both ends, ascending."""

    def slope(x: FloatArray) -> FloatArray:
        return np.asarray(2.0 * x + 10.0 * np.pi * np.sin(2.0 * np.pi * x))

    grid = np.linspace(0.01, 9.0, 900)
    changes = np.flatnonzero(slope(grid[:-1]) * slope(grid[1:]) < 0.0)
    inside = [brentq(slope, grid[i], grid[i + 1], xtol=1e-14) for i in changes]
    return np.array([0.0, *inside, 9.0])


def _where(level: float, extremes: FloatArray) -> list[float]:
    """Return where h passes a level."""
    above = _wave(extremes) > level
    crossed = np.flatnonzero(above[:-1] != above[1:])
    at = np.array([level])
    return [float(_between(extremes[i], extremes[i + 1], at)[0][0]) for i in crossed]


def _between(low: float, high: float, level: FloatArray) -> tuple[FloatArray, bool]:
    """Return where h passes each level between two extremes, or the end there, and if it rises."""
    rises = bool(_wave(np.array(high)) > _wave(np.array(low)))
    a, b = np.full(level.size, low), np.full(level.size, high)
    for _ in range(52):
        middle = 0.5 * (a + b)
        right = (_wave(middle) < level) == rises
        a, b = np.where(right, middle, a), np.where(right, b, middle)
    return b, rises


ENTRY = Entry(
    source=f"{ECHARD_2011}, as on UQWorld (modified Rastrigin function)",
    kinds=("rough", "design points", "frequent"),
    limit_state=limit_state,
    inputs=lambda: standard_normals(2),
    reference=reference,
    pf=0.07297933765,
    error=4.8e-10,
    how="integral over x1, of the probability of the intervals of x2 between roots",
)
