"""Concave domain of failure in two standard normals.

With s = (x1 + x2) / sqrt(2) and t = (x1 - x2) / sqrt(2), again standard normals, failure is
s >= 3 - t^2: an integral over t.
"""

from __future__ import annotations

import math

import numpy as np

from uqfold.problems.catalogue.distributions import standard_normals
from uqfold.problems.catalogue.integrals import normal_cdf, over_normal
from uqfold.problems.catalogue.record import Entry
from uqfold.problems.catalogue.sources import WAARTS
from uqfold.typing import FloatArray


def limit_state(x: FloatArray) -> FloatArray:
    """Return g (n,) of X (n, 2)."""
    x1, x2 = x.T
    return np.asarray(3.0 - 0.5 * (x1 - x2) ** 2 - (x1 + x2) / math.sqrt(2.0))


def reference() -> tuple[float, float]:
    """Return pf and its error."""
    return over_normal(lambda t: normal_cdf(t * t - 3.0))


ENTRY = Entry(
    source=f"{WAARTS}: concave failure domain",
    kinds=("frequent", "curved", "design points"),
    limit_state=limit_state,
    inputs=lambda: standard_normals(2),
    reference=reference,
    pf=0.104563693176,
    error=5.1e-13,
    how="integral over t, of the tail of s",
)
