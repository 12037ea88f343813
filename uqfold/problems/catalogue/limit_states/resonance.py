"""Natural frequency within a narrow band around resonance.

Failure is m (w - e)^2 <= k <= m (w + e)^2 with w = 6 rad/s and e = 1e-4 rad/s: a parallel system of
two planes a hair apart. Its description says w = 5, its program 6.
"""

from __future__ import annotations

import numpy as np

from uqfold.inputs import normal
from uqfold.problems.catalogue.integrals import normal_cdf, over_normal
from uqfold.problems.catalogue.record import Entry
from uqfold.typing import FloatArray

LOW, HIGH = (6.0 - 1e-4) ** 2, (6.0 + 1e-4) ** 2


def limit_state(x: FloatArray) -> FloatArray:
    """Return g (n,), in N/m, of X (n, 2)."""
    mass, stiffness = x.T
    return np.asarray(np.maximum(stiffness - HIGH * mass, LOW * mass - stiffness))


def reference() -> tuple[float, float]:
    """Return pf and its error."""

    def given(u: float) -> float:
        mass = 5.0 + u
        between = (normal_cdf((b * mass - 125.0) / 20.0) for b in (HIGH, LOW))
        return next(between) - next(between) if mass > 0.0 else 0.0

    return over_normal(given, -5.0)


ENTRY = Entry(
    source="UQpy, as of 2025, example: subset simulation for a SDOF resonance problem",
    kinds=("parallel",),
    limit_state=limit_state,
    inputs=lambda: {"m": normal(5.0, 1.0), "k": normal(125.0, 20.0)},
    reference=reference,
    pf=3.65250005878e-05,
    error=6.3e-17,
    how="integral over the mass, of the probability of an interval of stiffness",
    units={"m": "kg", "k": "N/m"},
)
