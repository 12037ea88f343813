"""Product of two normals: a hyperbola far from the mean (RP28).

Given x1 > 0 failure is x2 <= 146.14 / x1, given x1 < 0 it is x2 >= 146.14 / x1, which is all but
certain.
"""

from __future__ import annotations

import numpy as np

from uqfold.inputs import normal
from uqfold.problems.catalogue.integrals import normal_cdf, over_normal
from uqfold.problems.catalogue.record import Entry
from uqfold.problems.catalogue.sources import RPREPO
from uqfold.typing import FloatArray

LIMIT = 146.14


def limit_state(x: FloatArray) -> FloatArray:
    """Return g (n,) of X (n, 2)."""
    x1, x2 = x.T
    return np.asarray(x1 * x2 - LIMIT)


def reference() -> tuple[float, float]:
    """Return pf and its error."""

    def given(u: float) -> float:
        x1 = 78064.0 + 11710.0 * u
        return normal_cdf(np.copysign(1.0, x1) * (LIMIT / x1 - 0.0104) / 0.00156)

    return over_normal(given, -78064.0 / 11710.0)


ENTRY = Entry(
    source=f"RP28 of {RPREPO}",
    kinds=("rare",),
    limit_state=limit_state,
    inputs=lambda: {"x1": normal(78064.0, 11710.0), "x2": normal(0.0104, 0.00156)},
    reference=reference,
    pf=1.453294655e-07,
    error=4e-19,
    how="integral over x1, of the tail of x2",
)
