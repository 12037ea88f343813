"""Convex domain of failure in two standard normals (RP22).

With s = (x1 + x2) / sqrt(2) and t = (x1 - x2) / sqrt(2), again standard normals, failure is
s >= 2.5 + 0.2 t^2: an integral over t.
"""

from __future__ import annotations

import numpy as np

from uqfold.problems.catalogue.distributions import standard_normals
from uqfold.problems.catalogue.integrals import normal_cdf, over_normal
from uqfold.problems.catalogue.record import Entry
from uqfold.problems.catalogue.sources import RPREPO, WAARTS
from uqfold.typing import FloatArray


def limit_state(x: FloatArray) -> FloatArray:
    """Return g (n,) of X (n, 2)."""
    x1, x2 = x.T
    return np.asarray(2.5 - (x1 + x2) / np.sqrt(2.0) + 0.1 * (x1 - x2) ** 2)


def reference() -> tuple[float, float]:
    """Return pf and its error."""
    return over_normal(lambda t: normal_cdf(-(2.5 + 0.2 * t * t)))


ENTRY = Entry(
    source=f"Borri A, Speranzini E (1997), by {WAARTS}: convex failure domain; RP22 of {RPREPO}",
    kinds=("curved",),
    limit_state=limit_state,
    inputs=lambda: standard_normals(2),
    reference=reference,
    pf=0.0042073055113,
    error=4.6e-15,
    how="integral over t, of the tail of s",
    published={
        "otbenchmark": "0.00420730551129961794",
        "uqtestfuns, after Waarts (2000)": "4.2692e-3",
        "rareeventestimation": "4.21e-3",
    },
)
