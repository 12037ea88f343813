"""Parallel system of a parabola and a steep line (RP25).

Both fail where (x1^2 + 16) / 8 <= x2 <= 16 x1 - 32: an integral over x1, between the ends of that
interval.
"""

from __future__ import annotations

import numpy as np

from uqfold.problems.catalogue.distributions import standard_normals
from uqfold.problems.catalogue.integrals import normal_cdf, over_normal
from uqfold.problems.catalogue.record import Entry
from uqfold.problems.catalogue.sources import RPREPO
from uqfold.typing import FloatArray


def limit_state(x: FloatArray) -> FloatArray:
    """Return g (n,) of X (n, 2)."""
    x1, x2 = x.T
    return np.asarray(np.maximum(x1**2 - 8.0 * x2 + 16.0, -16.0 * x1 + x2 + 32.0))


def reference() -> tuple[float, float]:
    """Return pf and its error."""
    # the parabola meets the line where x1^2 - 128 x1 + 272 = 0
    first = 64.0 - np.sqrt(64.0**2 - 272.0)

    def both(x1: float) -> float:
        if x1 <= first:
            return 0.0
        return normal_cdf(-(x1**2 + 16.0) / 8.0) - normal_cdf(32.0 - 16.0 * x1)

    return over_normal(both, first)


ENTRY = Entry(
    source=f"RP25 of {RPREPO}",
    kinds=("parallel",),
    limit_state=limit_state,
    inputs=lambda: standard_normals(2),
    reference=reference,
    pf=4.14856629376e-05,
    error=4.5e-17,
    how="integral over x1, of the probability of an interval of x2",
    published={"otbenchmark": "4.148566293759747e-05"},
)
