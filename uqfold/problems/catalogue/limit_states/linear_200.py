"""Plane in two hundred standard normals, six standard deviations away."""

from __future__ import annotations

import math

import numpy as np

from uqfold.problems.catalogue.distributions import standard_normals
from uqfold.problems.catalogue.integrals import closed, normal_cdf
from uqfold.problems.catalogue.record import Entry
from uqfold.problems.catalogue.sources import RARE_EVENT_ESTIMATION
from uqfold.typing import FloatArray


def limit_state(x: FloatArray) -> FloatArray:
    """Return g (n,) of X (n, 200)."""
    return np.asarray(6.0 - x.sum(axis=1) / math.sqrt(200.0))


def reference() -> tuple[float, float]:
    """Return pf and its error."""
    return closed(normal_cdf(-6.0))


ENTRY = Entry(
    source="UncertaintyQuantification.jl, as of 2025, benchmark of subset simulation in high "
    f"dimension; {RARE_EVENT_ESTIMATION}, linear problem (d = 200), there 3.5 deviations away",
    kinds=("high dimension", "rare"),
    limit_state=limit_state,
    inputs=lambda: standard_normals(200),
    reference=reference,
    pf=9.86587645038e-10,
    error=1.3e-21,
    how="closed form: normal tail",
)
