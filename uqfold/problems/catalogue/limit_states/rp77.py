"""Two branches: the limit state jumps where x3 passes 5 (RP77).

Given x3, g is normal: x1 - x2 - x3 up to x3 = 5, and x3 - x2 beyond.
"""

from __future__ import annotations

import math

import numpy as np

from uqfold.inputs import normal
from uqfold.problems.catalogue.integrals import normal_cdf, over_normal
from uqfold.problems.catalogue.record import Entry
from uqfold.problems.catalogue.sources import RPREPO, WAARTS
from uqfold.typing import FloatArray


def limit_state(x: FloatArray) -> FloatArray:
    """Return g (n,) of X (n, 3)."""
    x1, x2, x3 = x.T
    return np.asarray(np.where(x3 <= 5.0, x1 - x2 - x3, x3 - x2))


def reference() -> tuple[float, float]:
    """Return pf and its error."""

    def given(u: float) -> float:
        x3 = 4.0 + u
        return normal_cdf(-(10.0 - x3) / math.sqrt(1.25)) if x3 <= 5.0 else normal_cdf(-x3)

    return over_normal(given)


ENTRY = Entry(
    source=f"{WAARTS}: two branches; RP77 of {RPREPO}",
    kinds=("jump", "rare", "design points"),
    limit_state=limit_state,
    inputs=lambda: {"x1": normal(10.0, 0.5), "x2": normal(0.0, 1.0), "x3": normal(4.0, 1.0)},
    reference=reference,
    pf=2.6908439522e-07,
    error=4.1e-19,
    how="integral over x3, of normal tails",
    published={"otbenchmark": "0.000000287"},
)
