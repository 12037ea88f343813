"""Sum of thirty lognormals that depend on each other by one common factor.

log x_i = sqrt(0.9) z + sqrt(0.1) z_i: given the factor z the terms are independent.
"""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from uqfold.inputs.assembly import normal_copula
from uqfold.problems.catalogue.integrals import normal_cdf, of_sums, panel_rule, refined
from uqfold.problems.catalogue.record import Entry
from uqfold.typing import FloatArray

N, RHO, LEVEL = 30, 0.9, 1900.0


def limit_state(x: FloatArray) -> FloatArray:
    """Return g (n,) of X (n, 30)."""
    return np.asarray(LEVEL - x.sum(axis=1))


def inputs() -> Any:
    """Return x1 to x30, standard lognormals with a normal copula of equal correlations."""
    from scipy.stats import lognorm

    correlation = np.full((N, N), RHO) + (1.0 - RHO) * np.eye(N)
    return normal_copula(
        dict.fromkeys((f"x{i}" for i in range(1, N + 1)), lognorm(1.0)), correlation
    )


def reference() -> tuple[float, float]:
    """Return pf and its error."""

    def own(u: FloatArray) -> FloatArray:
        return -np.exp(math.sqrt(1.0 - RHO) * u)

    # below the lowest factor the sum cannot reach the level, above the highest it always does
    low, high = 3.6, 5.6

    def by_rule(panels: int) -> float:
        z, weight = panel_rule(low, high, panels)
        tails, _ = of_sums(-LEVEL * np.exp(-math.sqrt(RHO) * z), [(own, N)])
        return normal_cdf(-high) + float((weight * np.exp(-0.5 * z * z)) @ tails) / math.sqrt(
            2.0 * math.pi
        )

    return refined(by_rule, 20, 40)


ENTRY = Entry(
    source="Dingec KD, Hoermann W, program for right tails of sums of exchangeable lognormals, its "
    "example of 30 terms; Asmussen S, Rojas-Nandayapa L (2006), Sums of dependent lognormal random "
    "variables: asymptotics and simulation, Aarhus University, Research Report 469",
    kinds=("heavy tail", "dependent", "high dimension"),
    limit_state=limit_state,
    inputs=inputs,
    reference=reference,
    pf=8.03197173e-06,
    error=1.9e-13,
    how="integral over the common factor, of the inverted characteristic function of the sum",
)
