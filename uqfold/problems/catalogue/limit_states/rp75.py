"""Saddle: the product of two standard normals beyond a level (RP75).

Failure is x2 >= 3 / x1 for x1 > 0 and x2 <= 3 / x1 for x1 < 0: two regions, and a gradient of zero
at the origin.
"""

from __future__ import annotations

import numpy as np

from uqfold.problems.catalogue.distributions import standard_normals
from uqfold.problems.catalogue.integrals import normal_cdf, over_normal
from uqfold.problems.catalogue.record import Entry
from uqfold.problems.catalogue.sources import RPREPO, WAARTS
from uqfold.typing import FloatArray


def limit_state(x: FloatArray) -> FloatArray:
    """Return g (n,) of X (n, 2)."""
    x1, x2 = x.T
    return np.asarray(3.0 - x1 * x2)


def reference() -> tuple[float, float]:
    """Return pf and its error."""
    return over_normal(lambda x1: normal_cdf(-3.0 / abs(x1)) if x1 != 0.0 else 0.0)


ENTRY = Entry(
    source=f"{WAARTS}: saddle surface; RP75 of {RPREPO}",
    kinds=("design points", "curved", "flat"),
    limit_state=limit_state,
    inputs=lambda: standard_normals(2),
    reference=reference,
    pf=0.00981929872155,
    error=1.3e-14,
    how="integral over x1, of the tail of x2",
    published={"otbenchmark": "0.00981929872154689"},
)
