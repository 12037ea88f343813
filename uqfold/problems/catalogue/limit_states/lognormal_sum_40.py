"""Sum of forty lognormals three standard deviations above its mean.

g = n + 3 sigma sqrt(n) - sum x_i, where each input has mean 1 and standard deviation sigma = 0.2.
"""

from __future__ import annotations

import math

import numpy as np

from uqfold.problems.catalogue.distributions import lognormal, lognormal_of
from uqfold.problems.catalogue.integrals import of_sum
from uqfold.problems.catalogue.record import Entry
from uqfold.typing import FloatArray

N, SIGMA = 40, 0.2


def limit_state(x: FloatArray) -> FloatArray:
    """Return g (n,) of X (n, 40)."""
    return np.asarray(N + 3.0 * SIGMA * math.sqrt(N) - x.sum(axis=1))


def reference() -> tuple[float, float]:
    """Return pf and its error."""
    level = N + 3.0 * SIGMA * math.sqrt(N)
    return of_sum(-level, [(lambda u: -lognormal_of(u, 1.0, SIGMA), N)])


ENTRY = Entry(
    source="Rackwitz R (2001), Reliability analysis: a review and some perspectives, Struct. Saf. "
    "23, 365-395, with a = 3 and 40 inputs",
    kinds=("high dimension",),
    limit_state=limit_state,
    inputs=lambda: dict.fromkeys((f"x{i}" for i in range(1, N + 1)), lognormal(1.0, SIGMA)),
    reference=reference,
    pf=0.00198138411863,
    error=9.6e-15,
    how="inversion of the characteristic function of the sum",
)
