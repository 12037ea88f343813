"""Sum of two cubes beyond one.

Given x1 failure is x2^3 >= 1 - x1^3: an integral over x1.
"""

from __future__ import annotations

import numpy as np

from uqfold.inputs import normal
from uqfold.problems.catalogue.integrals import normal_cdf, over_normal
from uqfold.problems.catalogue.record import Entry
from uqfold.problems.catalogue.sources import LI_2018
from uqfold.typing import FloatArray


def limit_state(x: FloatArray) -> FloatArray:
    """Return g (n,) of X (n, 2)."""
    return np.asarray(1.0 - (x**3).sum(axis=1))


def reference() -> tuple[float, float]:
    """Return pf and its error."""

    def given(u: float) -> float:
        x1 = 0.5 + 0.2 * u
        return normal_cdf((0.5 - float(np.cbrt(1.0 - x1**3))) / 0.2)

    return over_normal(given, 2.5)


ENTRY = Entry(
    source=f"{LI_2018}, Eq. (10), as in uqtestfuns (hyper-sphere bound)",
    kinds=("curved",),
    limit_state=limit_state,
    inputs=lambda: {"x1": normal(0.5, 0.2), "x2": normal(0.5, 0.2)},
    reference=reference,
    pf=0.0335611802923,
    error=4.7e-14,
    how="integral over x1, of the tail of x2",
)
