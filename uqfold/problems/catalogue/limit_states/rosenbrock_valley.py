"""Inside the curved valley of Rosenbrock's function.

Given x1 failure is (x2 - x1^2)^2 <= (0.1 - (x1 - 1)^2) / 100: an interval of x2.
"""

from __future__ import annotations

import math

import numpy as np

from uqfold.problems.catalogue.distributions import standard_normals
from uqfold.problems.catalogue.integrals import normal_cdf, over_normal
from uqfold.problems.catalogue.record import Entry
from uqfold.problems.catalogue.sources import OPENTURNS
from uqfold.typing import FloatArray


def limit_state(x: FloatArray) -> FloatArray:
    """Return g (n,) of X (n, 2)."""
    x1, x2 = x.T
    return np.asarray(100.0 * (x2 - x1**2) ** 2 + (x1 - 1.0) ** 2 - 0.1)


def reference() -> tuple[float, float]:
    """Return pf and its error."""
    half = math.sqrt(0.1)

    def given(x1: float) -> float:
        if abs(x1 - 1.0) >= half:
            return 0.0
        width = math.sqrt(0.1 - (x1 - 1.0) ** 2) / 10.0
        return normal_cdf(x1**2 + width) - normal_cdf(x1**2 - width)

    return over_normal(given, 1.0 - half, 1.0 + half)


ENTRY = Entry(
    source=f"{OPENTURNS}, test of line sampling: rosenbrock",
    kinds=("curved",),
    limit_state=limit_state,
    inputs=lambda: standard_normals(2),
    reference=reference,
    pf=0.00188353602797,
    error=5e-15,
    how="integral over x1, of the probability of an interval of x2",
    published={"OpenTURNS, test of line sampling": "0.00110258"},
)
