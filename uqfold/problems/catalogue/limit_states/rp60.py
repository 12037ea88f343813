"""Five lognormal parts under one load, in series and in parallel (RP60).

Given the load x5, each part has lost the whole load, half of it or nothing, independent of the
others: a sum over the states of three parts, and an integral over the load.
"""

from __future__ import annotations

import math
from itertools import product

import numpy as np

from uqfold.problems.catalogue.distributions import lognormal, lognormal_parameters
from uqfold.problems.catalogue.integrals import normal_cdf, over_normal
from uqfold.problems.catalogue.record import Entry
from uqfold.problems.catalogue.sources import RPREPO
from uqfold.typing import FloatArray

MOMENTS = ((2200.0, 220.0), (2100.0, 210.0), (2300.0, 230.0), (2000.0, 200.0), (1200.0, 480.0))


def limit_state(x: FloatArray) -> FloatArray:
    """Return g (n,) of X (n, 5)."""
    x1, x2, x3, x4, load = x.T
    whole = np.maximum(x4 - load, np.minimum(x2, x3) - load)
    half = np.minimum(np.minimum(x2, x3), x4) - load / 2.0
    return np.asarray(np.minimum(x1 - load, np.maximum(half, whole)))


def reference() -> tuple[float, float]:
    """Return pf and its error."""
    parameters = [lognormal_parameters(*moments) for moments in MOMENTS[:4]]
    mu, sigma = lognormal_parameters(*MOMENTS[4])

    def given(u: float) -> float:
        log_load = mu + sigma * u
        whole = [normal_cdf((log_load - m) / s) for m, s in parameters]
        half = [normal_cdf((log_load - math.log(2.0) - m) / s) for m, s in parameters]
        # state of a part: 0 withstands, 1 loses the whole load only, 2 even half of it
        chances = [(1.0 - w, w - h, h) for w, h in zip(whole, half, strict=True)]
        lost = 0.0
        for a, b, c in product(range(3), repeat=3):
            if max(a, b, c) == 2 and c >= 1 and max(a, b) >= 1:
                lost += chances[1][a] * chances[2][b] * chances[3][c]
        return float(whole[0] + (1.0 - whole[0]) * lost)

    return over_normal(given)


ENTRY = Entry(
    source=f"RP60 of {RPREPO}",
    kinds=("series", "parallel", "heavy tail"),
    limit_state=limit_state,
    inputs=lambda: {f"x{i}": lognormal(*two) for i, two in enumerate(MOMENTS, 1)},
    reference=reference,
    pf=0.0448396999768,
    error=7e-14,
    how="integral over the load, of a sum over states of the parts",
    published={"otbenchmark": "0.0456"},
)
