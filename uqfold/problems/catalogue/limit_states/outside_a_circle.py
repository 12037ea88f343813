"""Outside a circle, by a limit state that is not a circle elsewhere.

g = 1 - R^2 - (x1 / r) (1 - R) / (1 + R) with R = |x| / r: zero exactly where R = 1, negative
beyond.
"""

from __future__ import annotations

import math

import numpy as np

from uqfold.problems.catalogue.distributions import standard_normals
from uqfold.problems.catalogue.integrals import closed
from uqfold.problems.catalogue.record import Entry
from uqfold.problems.catalogue.sources import ERA, GEYER
from uqfold.typing import FloatArray

RADIUS = 5.26


def limit_state(x: FloatArray) -> FloatArray:
    """Return g (n,) of X (n, 2)."""
    distance = np.sqrt((x**2).sum(axis=1)) / RADIUS
    return np.asarray(1.0 - distance**2 - x[:, 0] / RADIUS * (1.0 - distance) / (1.0 + distance))


def reference() -> tuple[float, float]:
    """Return pf and its error."""
    return closed(math.exp(-0.5 * RADIUS**2))


ENTRY = Entry(
    source=f"Betz W (2017), Bayesian inference of engineering models, thesis, TU Munich; {GEYER}, "
    f"example 5, as in {ERA}, subset simulation, example 6",
    kinds=("rare", "design points"),
    limit_state=limit_state,
    inputs=lambda: standard_normals(2),
    reference=reference,
    pf=9.81876794807e-07,
    error=1.2e-18,
    how="closed form: tail of the Rayleigh distribution",
    published={"ERA-Software, subset simulation": "1e-6"},
)
