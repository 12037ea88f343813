"""Linear limit state of six lognormal inputs: plastic collapse of a frame (RP8).

Its distribution follows from the characteristic functions of the six terms.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from uqfold.problems.catalogue.distributions import lognormal, lognormal_of
from uqfold.problems.catalogue.integrals import of_sum
from uqfold.problems.catalogue.record import Entry
from uqfold.problems.catalogue.sources import RPREPO
from uqfold.typing import FloatArray

FACTORS = (1.0, 2.0, 2.0, 1.0, -5.0, -5.0)
MOMENTS = ((120.0, 12.0),) * 4 + ((50.0, 10.0), (40.0, 8.0))


def limit_state(x: FloatArray) -> FloatArray:
    """Return g (n,) of X (n, 6)."""
    return np.asarray(x @ np.array(FACTORS))


def reference() -> tuple[float, float]:
    """Return pf and its error."""

    def term(factor: float, mean: float, std: float) -> Callable[[FloatArray], FloatArray]:
        return lambda u: factor * lognormal_of(u, mean, std)

    terms = [(term(a, *moments), 1) for a, moments in zip(FACTORS, MOMENTS, strict=True)]
    return of_sum(0.0, terms)


ENTRY = Entry(
    source=f"RP8 of {RPREPO}",
    kinds=(),
    limit_state=limit_state,
    inputs=lambda: {f"x{i}": lognormal(*two) for i, two in enumerate(MOMENTS, 1)},
    reference=reference,
    pf=0.00078979371001,
    error=1.7e-15,
    how="inversion of the characteristic function of g",
)
