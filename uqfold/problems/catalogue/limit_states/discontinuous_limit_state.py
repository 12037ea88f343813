"""Resistance minus load under a root, and constant where the load is the larger.

g = sqrt(R - S) - 0.5 for R >= S, and -0.5 elsewhere: an infinite slope, and then none. Failure is
R - S <= 0.25.
"""

from __future__ import annotations

import math

import numpy as np

from uqfold.inputs import normal
from uqfold.problems.catalogue.integrals import closed, normal_cdf
from uqfold.problems.catalogue.record import Entry
from uqfold.problems.catalogue.sources import WAARTS
from uqfold.typing import FloatArray


def limit_state(x: FloatArray) -> FloatArray:
    """Return g (n,) of X (n, 2)."""
    return np.asarray(np.sqrt(np.maximum(x[:, 0] - x[:, 1], 0.0)) - 0.5)


def reference() -> tuple[float, float]:
    """Return pf and its error."""
    return closed(normal_cdf((0.25 - 10.0) / math.sqrt(2.5**2 + 0.5**2)))


ENTRY = Entry(
    source=f"{WAARTS}: discontinuous limit state",
    kinds=("flat",),
    limit_state=limit_state,
    inputs=lambda: {"R": normal(15.0, 2.5), "S": normal(5.0, 0.5)},
    reference=reference,
    pf=6.55814879633e-05,
    error=8.1e-17,
    how="closed form: normal tail",
)
