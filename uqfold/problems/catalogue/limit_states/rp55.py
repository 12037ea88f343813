"""Two walls and two outer strips in two uniform inputs (RP55).

All four limit states depend on d = x1 - x2 alone, whose tail is P(|d| >= c) = (1 - c / 2)^2. The
walls hold between the roots of 0.2 + 0.6 d^4 = |d| / sqrt(2), the strips beyond 5 / sqrt(2) - 2.2.
"""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from uqfold.problems.catalogue.integrals import closed
from uqfold.problems.catalogue.record import Entry
from uqfold.problems.catalogue.sources import RPREPO
from uqfold.typing import FloatArray

STRIP = 5.0 / math.sqrt(2.0) - 2.2


def limit_state(x: FloatArray) -> FloatArray:
    """Return g (n,) of X (n, 2)."""
    distance = np.abs(x[:, 0] - x[:, 1])
    return np.asarray(
        np.minimum(0.2 + 0.6 * distance**4 - distance / math.sqrt(2.0), STRIP - distance)
    )


def inputs() -> dict[str, Any]:
    """Return x1 and x2, uniform between -1 and 1."""
    from scipy.stats import uniform

    return {"x1": uniform(-1.0, 2.0), "x2": uniform(-1.0, 2.0)}


def reference() -> tuple[float, float]:
    """Return pf and its error."""
    roots = np.roots([0.6, 0.0, 0.0, -1.0 / math.sqrt(2.0), 0.2])
    first, last = sorted(roots[np.abs(roots.imag) < 1e-9].real)

    def beyond(c: float) -> float:
        return (1.0 - c / 2.0) ** 2

    return closed(beyond(first) - beyond(last) + beyond(STRIP))


ENTRY = Entry(
    source=f"RP55 of {RPREPO}",
    kinds=("frequent", "bounded", "series", "design points"),
    limit_state=limit_state,
    inputs=inputs,
    reference=reference,
    pf=0.560014428286,
    error=9.4e-13,
    how="closed form, from the roots of a quartic",
    published={"otbenchmark": "0.560014428286370380", "Reliability problems repository": "0.36"},
)
