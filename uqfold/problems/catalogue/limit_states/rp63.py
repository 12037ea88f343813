"""Paraboloid in a hundred standard normals, failure on its axis (RP63).

The sum of the squares of x2 to x100 is a chi-square variable of 99 degrees of freedom: an integral
over x1.
"""

from __future__ import annotations

import numpy as np
from scipy.special import gammainc

from uqfold.problems.catalogue.distributions import standard_normals
from uqfold.problems.catalogue.integrals import over_normal
from uqfold.problems.catalogue.record import Entry
from uqfold.problems.catalogue.sources import RPREPO
from uqfold.typing import FloatArray


def limit_state(x: FloatArray) -> FloatArray:
    """Return g (n,) of X (n, 100)."""
    return np.asarray(0.1 * (x[:, 1:] ** 2).sum(axis=1) - x[:, 0] - 4.5)


def reference() -> tuple[float, float]:
    """Return pf and its error."""
    return over_normal(lambda x1: gammainc(99.0 / 2.0, max(5.0 * (4.5 + x1), 0.0)))


ENTRY = Entry(
    source=f"RP63 of {RPREPO}",
    kinds=("high dimension", "curved"),
    limit_state=limit_state,
    inputs=lambda: standard_normals(100),
    reference=reference,
    pf=0.000376943611833,
    error=4.3e-16,
    how="integral over x1, of the distribution of chi-square",
    published={"otbenchmark": "0.000379"},
)
