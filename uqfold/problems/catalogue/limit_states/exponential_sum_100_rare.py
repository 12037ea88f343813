"""Sum of a hundred exponential inputs, with the level that it exceeds once in ten million.

As `exponential_sum_100`, whose source varies the level; this one is ours.
"""

from __future__ import annotations

import numpy as np
from scipy.special import gammaincc

from uqfold.problems.catalogue.integrals import closed
from uqfold.problems.catalogue.limit_states.exponential_sum_100 import inputs
from uqfold.problems.catalogue.record import Entry
from uqfold.typing import FloatArray

LEVEL = 160.933


def limit_state(x: FloatArray) -> FloatArray:
    """Return g (n,) of X (n, 100)."""
    return np.asarray(LEVEL - x.sum(axis=1))


def reference() -> tuple[float, float]:
    """Return pf and its error."""
    return closed(gammaincc(100.0, LEVEL))


ENTRY = Entry(
    source="Papaioannou I, Betz W, Zwirglmaier K, Straub D (2015), MCMC algorithms for subset "
    "simulation, Probab. Eng. Mech. 41, 89-103, with another level",
    kinds=("high dimension", "rare"),
    limit_state=limit_state,
    inputs=inputs,
    reference=reference,
    pf=9.99979879008e-08,
    error=1.4e-19,
    how="closed form: incomplete gamma function",
)
