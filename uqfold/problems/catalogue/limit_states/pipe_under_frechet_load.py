"""Product of five inputs, one of them with the tail of a power.

g = 1.44e5 pi X1 X5 - 24.1344 X2 X3^2 X4. Given all else failure is X3 beyond a limit, where X3 has
Frechet's distribution with mean 63 and coefficient of variation 0.16.
"""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from uqfold.inputs import normal
from uqfold.problems.catalogue.distributions import lognormal, lognormal_parameters
from uqfold.problems.catalogue.integrals import over_normals
from uqfold.problems.catalogue.record import Entry
from uqfold.typing import FloatArray

# the shape whose coefficient of variation is 0.16
SHAPE = 8.84236653664719
SCALE = 63.0 / math.gamma(1.0 - 1.0 / SHAPE)


def limit_state(x: FloatArray) -> FloatArray:
    """Return g (n,) of X (n, 5)."""
    x1, x2, x3, x4, x5 = x.T
    return np.asarray(1.44e5 * np.pi * x1 * x5 - 24.1344 * x2 * x3**2 * x4)


def inputs() -> dict[str, Any]:
    """Return X1 to X5."""
    from scipy.stats import invweibull

    return {
        "X1": lognormal(0.0988, 0.0988 * 0.08666),
        "X2": lognormal(10.6489, 10.6489 * 0.18652),
        "X3": invweibull(SHAPE, scale=SCALE),
        "X4": normal(0.672, 0.0672),
        "X5": normal(38.0, 3.8),
    }


def reference() -> tuple[float, float]:
    """Return pf and its error."""
    mu1, sigma1 = lognormal_parameters(0.0988, 0.0988 * 0.08666)
    mu2, sigma2 = lognormal_parameters(10.6489, 10.6489 * 0.18652)

    def given(ratio: FloatArray, u4: FloatArray, u5: FloatArray) -> FloatArray:
        x1_x2 = np.exp(mu1 - mu2 + math.hypot(sigma1, sigma2) * ratio)
        x4, x5 = 0.672 * (1.0 + 0.1 * u4), 38.0 * (1.0 + 0.1 * u5)
        square = 1.44e5 * np.pi * x1_x2 * x5 / (24.1344 * x4)
        return -np.expm1(-((np.sqrt(square) / SCALE) ** -SHAPE))

    return over_normals(given, 3)


ENTRY = Entry(
    source="Melchers RE (1989), Importance sampling in structural systems, Struct. Saf. 6, 3-10, "
    "as in the programs of Real MV (2021)",
    kinds=("heavy tail",),
    limit_state=limit_state,
    inputs=inputs,
    reference=reference,
    pf=0.0155484225617,
    error=6.2e-14,
    how="product rule over four inputs, of the tail of the Frechet variable",
)
