"""A response that rises towards a corner, and drops to zero beyond it.

y = exp(5 (x1 + ... + x5)) where all inputs are at most 0.5, and 0 elsewhere; failure is y >= T. It
lies in the corner of the box: a simplex of side s = 2.5 - log(T) / 5, of volume s^5 / 120.
"""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from uqfold.problems.catalogue.integrals import closed
from uqfold.problems.catalogue.record import Entry
from uqfold.typing import FloatArray

SIDE = 0.104


def limit_state(x: FloatArray) -> FloatArray:
    """Return g (n,) of X (n, 5), as T - y."""
    y = np.where((x <= 0.5).all(axis=1), np.exp(5.0 * x.sum(axis=1)), 0.0)
    return np.asarray(math.exp(5.0 * (2.5 - SIDE)) - y)


def inputs() -> dict[str, Any]:
    """Return x1 to x5, uniform between 0 and 1."""
    from scipy.stats import uniform

    return {f"x{i}": uniform() for i in range(1, 6)}


def reference() -> tuple[float, float]:
    """Return pf and its error."""
    return closed(SIDE**5 / 120.0)


ENTRY = Entry(
    source="Genz A (1984), Testing multidimensional integration routines, in Tools, Methods and "
    "Languages for Scientific and Engineering Computation, 81-94: discontinuous integrand, as in "
    "uqtestfuns; the level is ours",
    kinds=("jump", "bounded", "rare"),
    limit_state=limit_state,
    inputs=inputs,
    reference=reference,
    pf=1.01387741867e-07,
    error=4.4e-19,
    how="closed form: volume of a simplex",
)
