"""A wavy limit state: sine over a saddle (RP53).

Given x1 failure is x2 >= 1 + 20 (sin(5 x1 / 2) + 2) / (x1^2 + 4): an integral over x1.
"""

from __future__ import annotations

import numpy as np

from uqfold.inputs import normal
from uqfold.problems.catalogue.integrals import normal_cdf, over_normal
from uqfold.problems.catalogue.record import Entry
from uqfold.problems.catalogue.sources import RPREPO
from uqfold.typing import FloatArray


def limit_state(x: FloatArray) -> FloatArray:
    """Return g (n,) of X (n, 2)."""
    x1, x2 = x.T
    return np.asarray(np.sin(2.5 * x1) + 2.0 - (x1**2 + 4.0) * (x2 - 1.0) / 20.0)


def reference() -> tuple[float, float]:
    """Return pf and its error."""

    def given(u: float) -> float:
        x1 = 1.5 + u
        return normal_cdf(-(1.0 + 20.0 * (np.sin(2.5 * x1) + 2.0) / (x1**2 + 4.0) - 2.5))

    return over_normal(given)


ENTRY = Entry(
    source=f"RP53 of {RPREPO}",
    kinds=("rough", "design points"),
    limit_state=limit_state,
    inputs=lambda: {"x1": normal(1.5, 1.0), "x2": normal(2.5, 1.0)},
    reference=reference,
    pf=0.0313204856867,
    error=4.9e-14,
    how="integral over x1, of the tail of x2",
    published={"otbenchmark": "0.0313"},
)
