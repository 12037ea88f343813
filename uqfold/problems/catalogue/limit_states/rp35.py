"""Series system of a hollow and two branches of a hyperbola (RP35).

Given x1 > 0 failure is x2 >= min(a, 4.5 / x1) with a = 2 + exp(-0.1 x1^2) + (0.2 x1)^4; given
x1 < 0 it is x2 >= a or x2 <= 4.5 / x1.
"""

from __future__ import annotations

import numpy as np

from uqfold.problems.catalogue.distributions import standard_normals
from uqfold.problems.catalogue.integrals import normal_cdf, over_normal
from uqfold.problems.catalogue.record import Entry
from uqfold.problems.catalogue.sources import RPREPO
from uqfold.typing import FloatArray


def hollow(x1: FloatArray) -> FloatArray:
    """Return the lowest x2 (n,) that fails by the first limit state."""
    return np.asarray(2.0 + np.exp(-0.1 * x1**2) + (0.2 * x1) ** 4)


def limit_state(x: FloatArray) -> FloatArray:
    """Return g (n,) of X (n, 2)."""
    x1, x2 = x.T
    return np.asarray(np.minimum(hollow(x1) - x2, 4.5 - x1 * x2))


def reference() -> tuple[float, float]:
    """Return pf and its error."""

    def given(x1: float) -> float:
        above, beyond = float(hollow(np.asarray(x1))), 4.5 / x1
        if x1 > 0.0:
            return normal_cdf(-min(above, beyond))
        return normal_cdf(-above) + normal_cdf(beyond)

    return over_normal(given)


ENTRY = Entry(
    source=f"RP35 of {RPREPO}",
    kinds=("series", "design points"),
    limit_state=limit_state,
    inputs=lambda: standard_normals(2),
    reference=reference,
    pf=0.00347894632093,
    error=4.6e-15,
    how="integral over x1, of the tails of x2",
    published={"otbenchmark": "0.00347894632"},
)
