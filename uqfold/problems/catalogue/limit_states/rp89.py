"""Series system of a parabola and a slanting line (RP89).

Given x1 failure is x2 >= min(8 - x1^2, 6 - x1 / 5): an integral over x1.
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
    return np.asarray(np.minimum(8.0 - x1**2, 6.0 - x1 / 5.0) - x2)


def reference() -> tuple[float, float]:
    """Return pf and its error."""
    meetings = np.roots([1.0, -0.2, -2.0])
    return over_normal(lambda x1: normal_cdf(-min(8.0 - x1**2, 6.0 - x1 / 5.0)), *meetings)


ENTRY = Entry(
    source=f"RP89 of {RPREPO}",
    kinds=("series", "curved", "design points"),
    limit_state=limit_state,
    inputs=lambda: standard_normals(2),
    reference=reference,
    pf=0.00547128052902,
    error=6.1e-15,
    how="integral over x1, of the tail of x2",
    published={"otbenchmark": "0.00543"},
)
