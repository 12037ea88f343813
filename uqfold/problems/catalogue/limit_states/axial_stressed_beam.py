"""Yield of a bar under traction.

Given the load failure is R <= F / (pi d^2 / 4), with a lognormal yield stress.
"""

from __future__ import annotations

import math

import numpy as np

from uqfold.inputs import normal
from uqfold.problems.catalogue.distributions import lognormal, lognormal_parameters
from uqfold.problems.catalogue.integrals import normal_cdf, over_normal
from uqfold.problems.catalogue.record import Entry
from uqfold.problems.catalogue.sources import OPENTURNS
from uqfold.typing import FloatArray

AREA = 100.0 * math.pi


def limit_state(x: FloatArray) -> FloatArray:
    """Return g (n,), in MPa, of X (n, 2)."""
    return np.asarray(x[:, 0] - x[:, 1] / AREA)


def reference() -> tuple[float, float]:
    """Return pf and its error."""
    mu, sigma = lognormal_parameters(300.0, 30.0)

    def given(u: float) -> float:
        stress = (75e3 + 5e3 * u) / AREA
        return normal_cdf((math.log(stress) - mu) / sigma) if stress > 0.0 else 0.0

    return over_normal(given)


ENTRY = Entry(
    source=f"{OPENTURNS}, use case: an axial stressed beam; otbenchmark",
    kinds=(),
    limit_state=limit_state,
    inputs=lambda: {"R": lognormal(300.0, 30.0), "F": normal(75e3, 5e3)},
    reference=reference,
    pf=0.0291981946248,
    error=6.1e-14,
    how="integral over the load, of the distribution of the yield stress",
    units={"R": "MPa", "F": "N"},
)
