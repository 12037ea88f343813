"""Series system of a plane and a convex limit state on opposite sides.

With s = (x1 + x2) / sqrt(2) and t = (x1 - x2) / sqrt(2), failure is s <= -3.2 or
s >= 2.5 + 0.2 t^2.
"""

from __future__ import annotations

import math

import numpy as np

from uqfold.problems.catalogue.distributions import standard_normals
from uqfold.problems.catalogue.integrals import normal_cdf, over_normal
from uqfold.problems.catalogue.record import Entry
from uqfold.problems.catalogue.sources import ERA, GEYER
from uqfold.typing import FloatArray


def limit_state(x: FloatArray) -> FloatArray:
    """Return g (n,) of X (n, 2)."""
    x1, x2 = x.T
    s = (x1 + x2) / math.sqrt(2.0)
    return np.asarray(np.minimum(3.2 + s, 2.5 - s + 0.1 * (x1 - x2) ** 2))


def reference() -> tuple[float, float]:
    """Return pf and its error."""
    convex, error = over_normal(lambda t: normal_cdf(-(2.5 + 0.2 * t * t)))
    return convex + normal_cdf(-3.2), error


ENTRY = Entry(
    source=f"{GEYER}, example 1, as in {ERA}",
    kinds=("series", "design points"),
    limit_state=limit_state,
    inputs=lambda: standard_normals(2),
    reference=reference,
    pf=0.00489444344922,
    error=9.5e-15,
    how="normal tail and integral over t, of the tail of s",
    published={"ERA-Software": "4.90e-3"},
)
