"""Linear limit state of six lognormals with fine waves on it.

Each input enters by a term of its own, a x + 0.001 sin(100 x), so that the distribution of g
follows from six characteristic functions.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable

import numpy as np

from uqfold.problems.catalogue.distributions import lognormal, lognormal_of
from uqfold.problems.catalogue.integrals import of_sum
from uqfold.problems.catalogue.record import Entry
from uqfold.problems.catalogue.sources import LIU_DER_KIUREGHIAN, WAARTS
from uqfold.typing import FloatArray

FACTORS = (1.0, 2.0, 2.0, 1.0, -5.0, -5.0)
MOMENTS = ((120.0, 12.0),) * 4 + ((50.0, 15.0), (40.0, 12.0))


def limit_state(x: FloatArray) -> FloatArray:
    """Return g (n,) of X (n, 6)."""
    return np.asarray(x @ np.array(FACTORS) + 0.001 * np.sin(100.0 * x).sum(axis=1))


def reference() -> tuple[float, float]:
    """Return pf and its error."""

    def term(factor: float, mean: float, std: float) -> Callable[[FloatArray], FloatArray]:
        def value(u: FloatArray) -> FloatArray:
            x = lognormal_of(u, mean, std)
            return np.asarray(factor * x + 0.001 * np.sin(100.0 * x))

        return value

    alike = Counter(zip(FACTORS, MOMENTS, strict=True))
    return of_sum(0.0, [(term(a, *two), times) for (a, two), times in alike.items()], nodes=12_001)


ENTRY = Entry(
    source=f"{LIU_DER_KIUREGHIAN}; {WAARTS}: noisy limit state",
    kinds=("rough",),
    limit_state=limit_state,
    inputs=lambda: {f"x{i}": lognormal(*two) for i, two in enumerate(MOMENTS, 1)},
    reference=reference,
    pf=0.0122051831381,
    error=2.6e-14,
    how="inversion of the characteristic function of g",
)
