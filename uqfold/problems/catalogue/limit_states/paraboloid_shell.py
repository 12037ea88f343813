"""A thin shell over a paraboloid, in five standard normals.

With the chi-square variable q = x1^2 + ... + x4^2, failure is q + 3.5 <= x5 <= q + 3.52: a parallel
system of two surfaces that lie 0.02 apart.
"""

from __future__ import annotations

import numpy as np
from scipy.special import ndtr

from uqfold.problems.catalogue.distributions import standard_normals
from uqfold.problems.catalogue.integrals import panel_rule, refined
from uqfold.problems.catalogue.record import Entry
from uqfold.problems.catalogue.sources import OPENTURNS
from uqfold.typing import FloatArray


def limit_state(x: FloatArray) -> FloatArray:
    """Return g (n,) of X (n, 5)."""
    y = (x[:, :4] ** 2).sum(axis=1) - x[:, 4]
    return np.asarray(np.maximum(y + 3.5, -3.52 - y))


def reference() -> tuple[float, float]:
    """Return pf and its error."""
    return refined(_by_rule, 400, 800)


def _by_rule(panels: int) -> float:
    q, weight = panel_rule(0.0, 40.0, panels)
    # density of chi-square with four degrees of freedom
    density = 0.25 * q * np.exp(-0.5 * q)
    return float((weight * density) @ (ndtr(-q - 3.5) - ndtr(-q - 3.52)))


ENTRY = Entry(
    source=f"{OPENTURNS}, test of line sampling: paraboloid",
    kinds=("parallel", "rare", "curved"),
    limit_state=limit_state,
    inputs=lambda: standard_normals(5),
    reference=reference,
    pf=2.24025490381e-07,
    error=5.6e-19,
    how="integral over chi-square, of the probability of an interval of x5",
)
