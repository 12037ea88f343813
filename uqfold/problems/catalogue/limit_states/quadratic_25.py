"""Resistance against 25 squares of ever smaller weight.

R - sum S_i^2 / i: the distribution of g follows from 26 characteristic functions.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np

from uqfold.inputs import normal
from uqfold.problems.catalogue.integrals import of_sum
from uqfold.problems.catalogue.record import Entry
from uqfold.problems.catalogue.sources import WAARTS
from uqfold.typing import FloatArray


def limit_state(x: FloatArray) -> FloatArray:
    """Return g (n,) of X (n, 26)."""
    return np.asarray(x[:, 0] - x[:, 1:] ** 2 @ (1.0 / np.arange(1, 26)))


def inputs() -> dict[str, Any]:
    """Return R and S1 to S25."""
    return {"R": normal(0.5, 0.1)} | {f"S{i}": normal(0.2, 0.1) for i in range(1, 26)}


def reference() -> tuple[float, float]:
    """Return pf and its error."""

    def square(i: int) -> Callable[[FloatArray], FloatArray]:
        return lambda u: -((0.2 + 0.1 * u) ** 2) / i

    def resistance(u: FloatArray) -> FloatArray:
        return 0.5 + 0.1 * u

    return of_sum(0.0, [(resistance, 1), *((square(i), 1) for i in range(1, 26))])


ENTRY = Entry(
    source=f"{WAARTS}: limit state with 25 quadratic terms",
    kinds=("high dimension",),
    limit_state=limit_state,
    inputs=inputs,
    reference=reference,
    pf=0.00437041839244,
    error=4.6e-15,
    how="inversion of the characteristic function of g",
)
