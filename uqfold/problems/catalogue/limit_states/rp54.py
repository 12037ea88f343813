"""Sum of twenty exponential inputs below a level (RP54).

The sum is a gamma variable of shape 20.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from scipy.special import gammainc

from uqfold.problems.catalogue.integrals import closed
from uqfold.problems.catalogue.record import Entry
from uqfold.problems.catalogue.sources import RPREPO
from uqfold.typing import FloatArray

LEVEL = 8.951


def limit_state(x: FloatArray) -> FloatArray:
    """Return g (n,) of X (n, 20)."""
    return np.asarray(x.sum(axis=1) - LEVEL)


def inputs() -> dict[str, Any]:
    """Return x1 to x20, exponential with mean 1."""
    from scipy.stats import expon

    return dict.fromkeys((f"x{i}" for i in range(1, 21)), expon())


def reference() -> tuple[float, float]:
    """Return pf and its error."""
    return closed(gammainc(20.0, LEVEL))


ENTRY = Entry(
    source=f"RP54 of {RPREPO}",
    kinds=("high dimension",),
    limit_state=limit_state,
    inputs=inputs,
    reference=reference,
    pf=0.000990603072517,
    error=1.3e-15,
    how="closed form: incomplete gamma function",
    published={"otbenchmark": "0.000998"},
)
