"""Peak of an undamped oscillator with a yielding spring under a rectangular pulse.

g = 3 r - |2 F sin(w t / 2) / (c1 + c2)| with w^2 = (c1 + c2) / m. Given c1 + c2, m and t failure is
3 r <= a |F|: two tails of normal variables, which exclude each other but for r < 0, ten standard
deviations away.
"""

from __future__ import annotations

import math
from typing import Any

import numpy as np
from scipy.special import ndtr

from uqfold.inputs import normal
from uqfold.problems.catalogue.integrals import over_normals
from uqfold.problems.catalogue.record import Entry
from uqfold.problems.catalogue.sources import ECHARD_2011, RARE_EVENT_ESTIMATION
from uqfold.typing import FloatArray


def limit_state(x: FloatArray) -> FloatArray:
    """Return g (n,) of X (n, 6)."""
    mass, c1, c2, r, force, duration = x.T
    # a stiffness or a mass below zero, ten deviations away, has no frequency
    frequency = np.sqrt(np.maximum(c1 + c2, 0.0) / np.maximum(mass, 1e-9))
    peak = 2.0 * force / (c1 + c2) * np.sin(0.5 * frequency * duration)
    return np.asarray(3.0 * r - np.abs(peak))


def inputs() -> dict[str, Any]:
    """Return the six normal inputs."""
    return {
        "m": normal(1.0, 0.05),
        "c1": normal(1.0, 0.1),
        "c2": normal(0.1, 0.01),
        "r": normal(0.5, 0.05),
        "F": normal(0.3, 0.2),
        "t": normal(1.0, 0.2),
    }


def reference() -> tuple[float, float]:
    """Return pf and its error."""

    def given(u: FloatArray, v: FloatArray, w: FloatArray) -> FloatArray:
        stiffness = 1.1 + math.hypot(0.1, 0.01) * u
        frequency = np.sqrt(stiffness / (1.0 + 0.05 * v))
        a = 2.0 / stiffness * np.sin(0.5 * frequency * (1.0 + 0.2 * w))
        spread = np.hypot(0.15, 0.2 * a)
        return np.asarray(ndtr(-(1.5 - 0.3 * a) / spread) + ndtr(-(1.5 + 0.3 * a) / spread))

    return over_normals(given, 3)


ENTRY = Entry(
    source=f"{ECHARD_2011}, section 4, example 3, with the load of {RARE_EVENT_ESTIMATION}",
    kinds=("design points",),
    limit_state=limit_state,
    inputs=inputs,
    reference=reference,
    pf=6.39203462892e-06,
    error=7.2e-18,
    how="product rule over mass, stiffness and duration, of normal tails",
    published={"rareeventestimation": "6.43e-6"},
)
