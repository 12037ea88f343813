"""Deflection of a cantilever beam under a distributed load.

The tip may sink by span / 325 = 6,000 / 325 mm. Given the depth failure is w >= 8 E h^3 / (12 l^3)
/ 325.
"""

from __future__ import annotations

import numpy as np

from uqfold.inputs import normal
from uqfold.problems.catalogue.integrals import normal_cdf, over_normal
from uqfold.problems.catalogue.record import Entry
from uqfold.typing import FloatArray

MODULUS, SPAN = 2.6e10, 6e3


def limit_state(x: FloatArray) -> FloatArray:
    """Return g (n,), in mm, of X (n, 2)."""
    load, depth = x.T
    return np.asarray(SPAN / 325.0 - 1.5 * load * SPAN**4 / (MODULUS * depth**3))


def reference() -> tuple[float, float]:
    """Return pf and its error."""

    def given(u: float) -> float:
        depth = 250.0 + 37.5 * u
        # a negative depth, 6.7 deviations away, would give a negative load of failure
        load = MODULUS * depth**3 / (1.5 * 325.0 * SPAN**3)
        z = (load - 1000.0) / 200.0
        return normal_cdf(-z) if depth > 0.0 else normal_cdf(z)

    return over_normal(given, -250.0 / 37.5)


ENTRY = Entry(
    source="Rajashekhar MR, Ellingwood BR (1993), A new look at the response surface approach for "
    "reliability analysis, Struct. Saf. 12, 205-220, Eq. (10), as in uqtestfuns",
    kinds=(),
    limit_state=limit_state,
    inputs=lambda: {"w": normal(1000.0, 200.0), "h": normal(250.0, 37.5)},
    reference=reference,
    pf=0.00951381317302,
    error=1.3e-14,
    how="integral over the depth, of the tail of the load",
    units={"w": "N/m2", "h": "mm"},
)
