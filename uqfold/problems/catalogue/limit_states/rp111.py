"""Four hyperbolas around a flat centre (RP111).

Failure is |x2| >= 12.5 / |x1|: an integral over x1.
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
    return np.asarray(12.5 - np.abs(x[:, 0] * x[:, 1]))


def reference() -> tuple[float, float]:
    """Return pf and its error."""
    return over_normal(lambda x1: 2.0 * normal_cdf(-12.5 / abs(x1)) if x1 != 0.0 else 0.0)


ENTRY = Entry(
    source=f"RP111 of {RPREPO}",
    kinds=("design points", "rare", "flat"),
    limit_state=limit_state,
    inputs=lambda: standard_normals(2),
    reference=reference,
    pf=8.03508596496e-07,
    error=8.3e-19,
    how="integral over x1, of the tails of x2",
    published={"otbenchmark": "7.65e-7"},
)
