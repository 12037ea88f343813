"""Limit state with a quartic term: a narrow domain of failure (RP24).

With s and t the sum and the difference of the standardised inputs over sqrt(2), failure is
0.2357 3 sqrt(2) t >= 2.5 + 0.00463 (3 sqrt(2) s)^4: an integral over s.
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
    return np.asarray(2.5 - 0.2357 * (x1 - x2) + 0.00463 * (x1 + x2 - 20.0) ** 4)


def reference() -> tuple[float, float]:
    """Return pf and its error."""
    scale = 3.0 * np.sqrt(2.0)
    return over_normal(lambda s: normal_cdf(-(2.5 + 0.00463 * (scale * s) ** 4) / (0.2357 * scale)))


ENTRY = Entry(
    source=f"RP24 of {RPREPO}",
    kinds=("curved",),
    limit_state=limit_state,
    inputs=lambda: {"x1": normal(10.0, 3.0), "x2": normal(10.0, 3.0)},
    reference=reference,
    pf=0.00285994568754,
    error=3.1e-15,
    how="integral over the sum of the inputs, of the tail of their difference",
    published={"otbenchmark": "0.00286"},
)
