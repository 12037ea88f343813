"""Exponential inputs in normal dress: -sum log Phi(-x_i) below a level, in fifty inputs.

Each term is exponential with mean 1, so that the sum is a gamma variable of shape 50.
"""

from __future__ import annotations

import numpy as np
from scipy.special import gammainc, log_ndtr

from uqfold.problems.catalogue.distributions import standard_normals
from uqfold.problems.catalogue.integrals import closed
from uqfold.problems.catalogue.record import Entry
from uqfold.problems.catalogue.sources import RARE_EVENT_ESTIMATION
from uqfold.typing import FloatArray

LEVEL = 27.8623


def limit_state(x: FloatArray) -> FloatArray:
    """Return g (n,) of X (n, 50)."""
    return np.asarray(-log_ndtr(-x).sum(axis=1) - LEVEL)


def reference() -> tuple[float, float]:
    """Return pf and its error."""
    return closed(gammainc(50.0, LEVEL))


ENTRY = Entry(
    source=f"Fujita M, Rackwitz R (1988), as in {RARE_EVENT_ESTIMATION}, Fujita Rackwitz problem, "
    "whose level follows from pf = 1e-4 (rounded here)",
    kinds=("high dimension",),
    limit_state=limit_state,
    inputs=lambda: standard_normals(50),
    reference=reference,
    pf=0.000100000064631,
    error=6e-16,
    how="closed form: incomplete gamma function",
)
