"""Outside an oblate spheroid around the origin, in ten standard normals.

A weighted sum of squares must not exceed 10; each pair of equal limits on the way there is far from
the others in direction, but not in distance.
"""

from __future__ import annotations

import math

import numpy as np

from uqfold.problems.catalogue.distributions import standard_normals
from uqfold.problems.catalogue.integrals import panel_rule, refined
from uqfold.problems.catalogue.record import Entry
from uqfold.problems.catalogue.sources import WAARTS
from uqfold.typing import FloatArray

WEIGHTS = 1.0 / (1.0 + np.arange(1, 11) / 10.0)


def limit_state(x: FloatArray) -> FloatArray:
    """Return g (n,) of X (n, 10)."""
    return np.asarray(10.0 - x**2 @ WEIGHTS)


def reference() -> tuple[float, float]:
    """Return pf and its error, by the formula of Imhof (1961)."""

    def by_rule(panels: int) -> float:
        # beyond 400 the integrand is below 1e-14
        t, weight = panel_rule(0.0, 400.0, panels)
        scaled = WEIGHTS[:, None] * t
        angle = 0.5 * np.arctan(scaled).sum(axis=0) - 5.0 * t
        size = np.prod((1.0 + scaled**2) ** 0.25, axis=0)
        return 0.5 + float(weight @ (np.sin(angle) / (t * size))) / math.pi

    return refined(by_rule, 1000, 2000)


ENTRY = Entry(
    source=f"{WAARTS}: oblate spheroid",
    kinds=("frequent", "flat", "curved"),
    limit_state=limit_state,
    inputs=lambda: standard_normals(10),
    reference=reference,
    pf=0.136223518737,
    error=9.9e-12,
    how="inversion of the characteristic function of the weighted sum of chi-squares",
)
