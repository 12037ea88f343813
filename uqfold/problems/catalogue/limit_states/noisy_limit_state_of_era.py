"""Linear limit state of six lognormals with waves on four of them, a hundred times higher.

As `noisy_limit_state`, with other deviations and 0.1 sin(100 x) on the first four inputs.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable

import numpy as np

from uqfold.problems.catalogue.distributions import lognormal, lognormal_of
from uqfold.problems.catalogue.integrals import of_sum
from uqfold.problems.catalogue.record import Entry
from uqfold.problems.catalogue.sources import ERA, LIU_DER_KIUREGHIAN
from uqfold.typing import FloatArray

FACTORS = (1.0, 2.0, 2.0, 1.0, -5.0, -5.0)
MOMENTS = ((120.0, 8.0),) * 4 + ((50.0, 10.0), (40.0, 8.0))
WAVES = (0.1, 0.1, 0.1, 0.1, 0.0, 0.0)


def limit_state(x: FloatArray) -> FloatArray:
    """Return g (n,) of X (n, 6)."""
    return np.asarray(x @ np.array(FACTORS) + np.sin(100.0 * x) @ np.array(WAVES))


def reference() -> tuple[float, float]:
    """Return pf and its error."""

    def term(
        factor: float, moments: tuple[float, float], wave: float
    ) -> Callable[[FloatArray], FloatArray]:
        def value(u: FloatArray) -> FloatArray:
            x = lognormal_of(u, *moments)
            return np.asarray(factor * x + wave * np.sin(100.0 * x))

        return value

    alike = Counter(zip(FACTORS, MOMENTS, WAVES, strict=True))
    return of_sum(0.0, [(term(*one), times) for one, times in alike.items()], nodes=12_001)


ENTRY = Entry(
    source=f"{LIU_DER_KIUREGHIAN}, as in {ERA}, combination line sampling, example 2",
    kinds=("rough",),
    limit_state=limit_state,
    inputs=lambda: {f"x{i}": lognormal(*two) for i, two in enumerate(MOMENTS, 1)},
    reference=reference,
    pf=0.000529490188951,
    error=1.4e-15,
    how="inversion of the characteristic function of g",
    published={"ERA-Software": "5.29e-4"},
)
