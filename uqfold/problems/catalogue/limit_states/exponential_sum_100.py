"""Sum of a hundred exponential inputs above a level.

The sum is a gamma variable of shape 100.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from scipy.special import gammaincc

from uqfold.problems.catalogue.integrals import closed
from uqfold.problems.catalogue.record import Entry
from uqfold.problems.catalogue.sources import ERA
from uqfold.typing import FloatArray

LEVEL = 140.0


def limit_state(x: FloatArray) -> FloatArray:
    """Return g (n,) of X (n, 100)."""
    return np.asarray(LEVEL - x.sum(axis=1))


def inputs() -> dict[str, Any]:
    """Return x1 to x100, exponential with mean 1."""
    from scipy.stats import expon

    return dict.fromkeys((f"x{i}" for i in range(1, 101)), expon())


def reference() -> tuple[float, float]:
    """Return pf and its error."""
    return closed(gammaincc(100.0, LEVEL))


ENTRY = Entry(
    source="Papaioannou I, Betz W, Zwirglmaier K, Straub D (2015), MCMC algorithms for subset "
    f"simulation, Probab. Eng. Mech. 41, 89-103, as in {ERA}, FORM, example 2",
    kinds=("high dimension",),
    limit_state=limit_state,
    inputs=inputs,
    reference=reference,
    pf=0.000161057174713,
    error=6.1e-16,
    how="closed form: incomplete gamma function",
)
