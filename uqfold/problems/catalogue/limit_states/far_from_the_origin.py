"""Distance of two normals from the origin.

The squared distance over the variance is a noncentral chi-square variable of two degrees of
freedom.
"""

from __future__ import annotations

import math

import numpy as np

from uqfold.inputs import normal
from uqfold.problems.catalogue.integrals import normal_cdf, over_normal
from uqfold.problems.catalogue.record import Entry
from uqfold.problems.catalogue.sources import ERA
from uqfold.typing import FloatArray


def limit_state(x: FloatArray) -> FloatArray:
    """Return g (n,) of X (n, 2)."""
    return np.asarray(10.0 - np.sqrt((x**2).sum(axis=1)))


def reference() -> tuple[float, float]:
    """Return pf and its error."""

    def given(u: float) -> float:
        x1 = 5.0 + 2.0 * u
        if abs(x1) >= 10.0:
            return 1.0
        half = math.sqrt(100.0 - x1 * x1)
        return normal_cdf((-half - 2.0) / 2.0) + normal_cdf((2.0 - half) / 2.0)

    return over_normal(given, 2.5, -7.5)


ENTRY = Entry(
    source="de Angelis M, Patelli E, Beer M (2015), Advanced line sampling for efficient robust "
    f"reliability analysis, Struct. Saf. 52, 170-182, as in {ERA}, combination line sampling, "
    "example 1",
    kinds=("curved",),
    limit_state=limit_state,
    inputs=lambda: {"x1": normal(5.0, 2.0), "x2": normal(2.0, 2.0)},
    reference=reference,
    pf=0.0149383247455,
    error=4.6e-14,
    how="integral over x1, of the tails of x2",
    published={"ERA-Software": "1.49e-2"},
)
