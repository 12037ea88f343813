"""Parabola with two design points, one a little nearer than the other.

Given x1 failure is x2 >= 5 - 0.5 (x1 - 0.1)^2: an integral over x1.
"""

from __future__ import annotations

import numpy as np

from uqfold.problems.catalogue.distributions import standard_normals
from uqfold.problems.catalogue.integrals import normal_cdf, over_normal
from uqfold.problems.catalogue.record import Entry
from uqfold.problems.catalogue.sources import ERA, GEYER
from uqfold.typing import FloatArray


def limit_state(x: FloatArray) -> FloatArray:
    """Return g (n,) of X (n, 2)."""
    x1, x2 = x.T
    return np.asarray(5.0 - x2 - 0.5 * (x1 - 0.1) ** 2)


def reference() -> tuple[float, float]:
    """Return pf and its error."""
    return over_normal(lambda x1: normal_cdf(0.5 * (x1 - 0.1) ** 2 - 5.0))


ENTRY = Entry(
    source="Der Kiureghian A, Dakessian T (1998), Multiple design points in first and second-order "
    f"reliability, Struct. Saf. 20, 37-49; {GEYER}, example 2, as in {ERA}",
    kinds=("design points", "curved"),
    limit_state=limit_state,
    inputs=lambda: standard_normals(2),
    reference=reference,
    pf=0.00301631190131,
    error=3.5e-15,
    how="integral over x1, of the tail of x2",
    published={"ERA-Software": "3.01e-3"},
)
