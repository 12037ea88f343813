"""Shaft of a speed reducer: strength against bending and torsion (RP14).

The von Mises stress is 32 / (pi D^3) sqrt(F^2 L^2 / 16 + T^2). Given all else, failure is
|T| >= sqrt((S pi D^3 / 32)^2 - F^2 L^2 / 16), or certain where the force alone is enough; what is
left is a product rule over diameter, span, strength and force.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from scipy.special import ndtr

from uqfold.inputs import normal
from uqfold.problems.catalogue.distributions import gumbel, gumbel_parameters
from uqfold.problems.catalogue.integrals import normal_rule, panel_rule, refined
from uqfold.problems.catalogue.record import Entry
from uqfold.problems.catalogue.sources import RPREPO
from uqfold.typing import FloatArray


def limit_state(x: FloatArray) -> FloatArray:
    """Return g (n,), in MPa, of X (n, 5)."""
    strength, diameter, force, span, torque = x.T
    moment = np.sqrt(force**2 * span**2 / 16.0 + torque**2)
    return np.asarray(strength - 32.0 / (np.pi * diameter**3) * moment)


def inputs() -> dict[str, Any]:
    """Return the inputs of Table 11."""
    from scipy.stats import uniform

    return {
        "S": uniform(70.0, 10.0),
        "D": normal(39.0, 0.1),
        "F": gumbel(1500.0, 350.0),
        "L": normal(400.0, 0.1),
        "T": normal(250e3, 35e3),
    }


def reference() -> tuple[float, float]:
    """Return pf and its error."""
    return refined(_by_rule, 150, 300)


def _by_rule(panels: int) -> float:
    d, d_weight = normal_rule(39.0, 0.1, 9)
    span, span_weight = normal_rule(400.0, 0.1, 5)
    s, s_weight = np.polynomial.legendre.leggauss(24)
    strength = 75.0 + 5.0 * s
    mode, scale = gumbel_parameters(1500.0, 350.0)
    z, z_weight = panel_rule(-4.0, 36.0, panels)
    force, f_weight = mode + scale * z, z_weight * np.exp(-z - np.exp(-z))
    allowed = (strength[:, None] * np.pi * d**3 / 32.0) ** 2
    bending = force[:, None] ** 2 * span**2 / 16.0
    left = allowed[:, :, None, None] - bending
    torque = np.sqrt(np.maximum(left, 0.0))
    fails = ndtr(-(torque - 250e3) / 35e3) + ndtr((-torque - 250e3) / 35e3)
    weights = s_weight / 2.0, d_weight, f_weight, span_weight
    return float(np.einsum("sdfl,s,d,f,l->", fails, *weights))


ENTRY = Entry(
    source="Du X, Sudjianto A (2004), First order saddlepoint approximation for reliability "
    f"analysis, AIAA J. 42, Eq. (34) and Table 11; RP14 of {RPREPO}",
    kinds=("bounded",),
    limit_state=limit_state,
    inputs=inputs,
    reference=reference,
    pf=0.000772852388445,
    error=1.2e-15,
    how="exact over the torque, product rule over the rest",
    units={"S": "MPa", "D": "mm", "F": "N", "L": "mm", "T": "N mm"},
    published={"otbenchmark": "0.00077285"},
)
