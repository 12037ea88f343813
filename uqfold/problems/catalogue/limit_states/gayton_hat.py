"""A hat: failure beyond a cubic brim far from the origin.

Given x1 failure is (x2 - 5)^3 >= ((x1 - 2)^2 - 6) / 3: an integral over x1.
"""

from __future__ import annotations

import math

import numpy as np

from uqfold.problems.catalogue.distributions import standard_normals
from uqfold.problems.catalogue.integrals import normal_cdf, over_normal
from uqfold.problems.catalogue.record import Entry
from uqfold.typing import FloatArray


def limit_state(x: FloatArray) -> FloatArray:
    """Return g (n,) of X (n, 2)."""
    x1, x2 = x.T
    return np.asarray(0.5 * (x1 - 2.0) ** 2 - 1.5 * (x2 - 5.0) ** 3 - 3.0)


def reference() -> tuple[float, float]:
    """Return pf and its error."""
    kinks = 2.0 - math.sqrt(6.0), 2.0 + math.sqrt(6.0)
    return over_normal(
        lambda x1: normal_cdf(-5.0 - float(np.cbrt(((x1 - 2.0) ** 2 - 6.0) / 3.0))), *kinks
    )


ENTRY = Entry(
    source="Echard B, Gayton N, Lemaire M, Relun N (2013), A combined importance sampling and "
    "Kriging reliability method for small failure probabilities with time-demanding numerical "
    "models, Reliab. Eng. Syst. Saf. 111, 232-240, as in uqtestfuns",
    kinds=("curved",),
    limit_state=limit_state,
    inputs=lambda: standard_normals(2),
    reference=reference,
    pf=2.87453760915e-05,
    error=5.6e-17,
    how="integral over x1, of the tail of x2",
)
