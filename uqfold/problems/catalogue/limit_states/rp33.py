"""Series system of two planes in three standard normals (RP33).

Given x3 < 3 failure is (x1 + x2) / sqrt(2) >= (3 sqrt(3) - x3) / sqrt(2), given x3 >= 3 it is
certain.
"""

from __future__ import annotations

import numpy as np

from uqfold.problems.catalogue.distributions import standard_normals
from uqfold.problems.catalogue.integrals import normal_cdf, over_normal
from uqfold.problems.catalogue.record import Entry
from uqfold.problems.catalogue.sources import RPREPO
from uqfold.typing import FloatArray


def limit_state(x: FloatArray) -> FloatArray:
    """Return g (n,) of X (n, 3)."""
    x1, x2, x3 = x.T
    return np.asarray(np.minimum(3.0 * np.sqrt(3.0) - x1 - x2 - x3, 3.0 - x3))


def reference() -> tuple[float, float]:
    """Return pf and its error."""

    def given(x3: float) -> float:
        return 1.0 if x3 >= 3.0 else normal_cdf(-(3.0 * np.sqrt(3.0) - x3) / np.sqrt(2.0))

    return over_normal(given)


ENTRY = Entry(
    source=f"RP33 of {RPREPO}",
    kinds=("series", "design points"),
    limit_state=limit_state,
    inputs=lambda: standard_normals(3),
    reference=reference,
    pf=0.0025755977908,
    error=2.9e-15,
    how="integral over x3, of the tail of x1 + x2",
    published={"otbenchmark": "0.00257"},
)
