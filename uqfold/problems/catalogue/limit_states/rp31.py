"""A needle of failure: x2 must exceed a steep quartic of x1 (RP31).

Given x1 failure is x2 >= 2 + 256 x1^4: an integral over x1.
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
    return np.asarray(2.0 - x2 + 256.0 * x1**4)


def reference() -> tuple[float, float]:
    """Return pf and its error."""
    return over_normal(lambda x1: normal_cdf(-(2.0 + 256.0 * x1**4)))


ENTRY = Entry(
    source=f"RP31 of {RPREPO}",
    kinds=("curved",),
    limit_state=limit_state,
    inputs=lambda: standard_normals(2),
    reference=reference,
    pf=0.00322668120959,
    error=5.6e-15,
    how="integral over x1, of the tail of x2",
    published={"otbenchmark": "0.0032266812095876910"},
)
