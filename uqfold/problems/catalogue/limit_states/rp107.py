"""Plane in ten standard normals, five standard deviations away (RP107)."""

from __future__ import annotations

import math

import numpy as np

from uqfold.problems.catalogue.distributions import standard_normals
from uqfold.problems.catalogue.integrals import closed, normal_cdf
from uqfold.problems.catalogue.record import Entry
from uqfold.problems.catalogue.sources import RPREPO
from uqfold.typing import FloatArray


def limit_state(x: FloatArray) -> FloatArray:
    """Return g (n,) of X (n, 10)."""
    return np.asarray(5.0 * math.sqrt(10.0) - x.sum(axis=1))


def reference() -> tuple[float, float]:
    """Return pf and its error."""
    return closed(normal_cdf(-5.0))


ENTRY = Entry(
    source=f"RP107 of {RPREPO}",
    kinds=("rare",),
    limit_state=limit_state,
    inputs=lambda: standard_normals(10),
    reference=reference,
    pf=2.86651571879e-07,
    error=4.8e-19,
    how="closed form: normal tail",
    published={"otbenchmark": "2.92e-7"},
)
