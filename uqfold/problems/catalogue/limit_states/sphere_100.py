"""Outside a sphere around the origin, in a hundred standard normals.

The squared distance is a chi-square variable of 100 degrees of freedom. No direction is nearer to
failure than another, and the gradient at the origin is zero.
"""

from __future__ import annotations

import numpy as np
from scipy.special import gammaincc

from uqfold.problems.catalogue.distributions import standard_normals
from uqfold.problems.catalogue.integrals import closed
from uqfold.problems.catalogue.record import Entry
from uqfold.problems.catalogue.sources import WAARTS
from uqfold.typing import FloatArray

SQUARE = 182.127


def limit_state(x: FloatArray) -> FloatArray:
    """Return g (n,) of X (n, 100)."""
    return np.asarray(SQUARE - (x**2).sum(axis=1))


def reference() -> tuple[float, float]:
    """Return pf and its error."""
    return closed(gammaincc(50.0, SQUARE / 2.0))


ENTRY = Entry(
    source=f"{WAARTS}: oblate spheroid, made round and in a hundred inputs, with a level of ours",
    kinds=("high dimension", "flat", "curved", "rare"),
    limit_state=limit_state,
    inputs=lambda: standard_normals(100),
    reference=reference,
    pf=9.99947222925e-07,
    error=1.1e-18,
    how="closed form: incomplete gamma function",
)
