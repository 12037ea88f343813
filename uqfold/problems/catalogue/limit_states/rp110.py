"""Limit states of two slopes, all but flat where they mislead (RP110).

Neither slope before the bends reaches zero: failure is x1 >= 4 or x2 >= 5. At the origin the second
falls ten times as steeply as the first, but it is the first that fails.
"""

from __future__ import annotations

import numpy as np

from uqfold.problems.catalogue.distributions import standard_normals
from uqfold.problems.catalogue.integrals import closed, normal_cdf
from uqfold.problems.catalogue.record import Entry
from uqfold.problems.catalogue.sources import RPREPO
from uqfold.typing import FloatArray


def limit_state(x: FloatArray) -> FloatArray:
    """Return g (n,) of X (n, 2)."""
    x1, x2 = x.T
    first = np.where(x1 <= 3.5, 0.85 - 0.1 * x1, 4.0 - x1)
    second = np.where(x2 <= 2.0, 2.3 - x2, 0.5 - 0.1 * x2)
    return np.asarray(np.minimum(first, second))


def reference() -> tuple[float, float]:
    """Return pf and its error."""
    return closed(normal_cdf(-4.0) + normal_cdf(4.0) * normal_cdf(-5.0))


ENTRY = Entry(
    source=f"RP110 of {RPREPO}",
    kinds=("flat", "series"),
    limit_state=limit_state,
    inputs=lambda: standard_normals(2),
    reference=reference,
    pf=3.19578843264e-05,
    error=4.5e-17,
    how="closed form: normal tails",
    published={"otbenchmark": "3.19e-5"},
)
