"""Bending of a pipe with a crack through its wall.

g = 4 t sigma_f R^2 (cos(theta / 2) - sin(theta) / 2) - M: linear in the flow stress.
"""

from __future__ import annotations

import numpy as np

from uqfold.inputs import normal
from uqfold.problems.catalogue.integrals import normal_cdf, over_normal
from uqfold.problems.catalogue.record import Entry
from uqfold.problems.catalogue.sources import LI_2018
from uqfold.typing import FloatArray

RADIUS, THICKNESS, MOMENT = 0.3377, 0.03377, 3.0


def strength(theta: FloatArray) -> FloatArray:
    """Return the moment (m3) that the pipe carries per stress, of the half angle of the crack."""
    return np.asarray(4.0 * THICKNESS * RADIUS**2 * (np.cos(theta / 2.0) - np.sin(theta) / 2.0))


def limit_state(x: FloatArray) -> FloatArray:
    """Return g (n,), in MN m, of X (n, 2)."""
    return np.asarray(strength(x[:, 1]) * x[:, 0] - MOMENT)


def reference() -> tuple[float, float]:
    """Return pf and its error."""

    def given(u: float) -> float:
        needed = MOMENT / float(strength(np.array(0.503 + 0.049 * u)))
        return normal_cdf((needed - 301.079) / 14.78)

    return over_normal(given)


ENTRY = Entry(
    source="Verma AK, Ajit S, Karanki DR (2016), Reliability and Safety Engineering, Springer, "
    f"chapter 8, example 5; {LI_2018}, as in uqtestfuns",
    kinds=(),
    limit_state=limit_state,
    inputs=lambda: {"sigma_f": normal(301.079, 14.78), "theta": normal(0.503, 0.049)},
    reference=reference,
    pf=0.0341991452097,
    error=5.3e-14,
    how="integral over the angle, of the distribution of the flow stress",
    units={"sigma_f": "MPa", "theta": "rad"},
)
