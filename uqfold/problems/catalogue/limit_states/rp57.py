"""A disc of failure, and a parallel system beyond it (RP57).

Given x2, the first two limit states both fail where x1 >= 2 - 8 x2 and |x1| >= sqrt(x2^3 + 3); the
third fails in an interval around -3 if |x2 + 3| <= 2, and there 2 - 8 x2 lies far away from it.
"""

from __future__ import annotations

import math

import numpy as np

from uqfold.problems.catalogue.distributions import standard_normals
from uqfold.problems.catalogue.integrals import normal_cdf, over_normal
from uqfold.problems.catalogue.record import Entry
from uqfold.problems.catalogue.sources import RPREPO
from uqfold.typing import FloatArray


def limit_state(x: FloatArray) -> FloatArray:
    """Return g (n,) of X (n, 2)."""
    x1, x2 = x.T
    both = np.maximum(-(x1**2) + x2**3 + 3.0, 2.0 - x1 - 8.0 * x2)
    return np.asarray(np.minimum(both, (x1 + 3.0) ** 2 + (x2 + 3.0) ** 2 - 4.0))


def reference() -> tuple[float, float]:
    """Return pf and its error."""

    def given(x2: float) -> float:
        line, arm = 2.0 - 8.0 * x2, math.sqrt(max(x2**3 + 3.0, 0.0))
        fails = normal_cdf(-max(line, arm)) + max(normal_cdf(-arm) - normal_cdf(line), 0.0)
        if abs(x2 + 3.0) < 2.0:
            half = math.sqrt(4.0 - (x2 + 3.0) ** 2)
            fails += normal_cdf(half - 3.0) - normal_cdf(-half - 3.0)
        return float(fails)

    # where the line meets an arm: (2 - 8 x2)^2 = x2^3 + 3; and where the arms begin
    meetings = np.roots([1.0, -64.0, 32.0, -1.0]).real
    return over_normal(given, *meetings[np.abs(meetings) < 9.0], -5.0, -1.0, -(3.0 ** (1.0 / 3.0)))


ENTRY = Entry(
    source=f"RP57 of {RPREPO}",
    kinds=("series", "parallel", "design points"),
    limit_state=limit_state,
    inputs=lambda: standard_normals(2),
    reference=reference,
    pf=0.0282375065843,
    error=3.4e-14,
    how="integral over x2, of the probability of intervals of x1",
    published={"otbenchmark": "0.0284"},
)
