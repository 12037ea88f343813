"""Deflection of a diving board: bounded and dependent inputs, and a rare event.

The tip may sink by 0.30 m. Given all else failure is F >= 0.9 E I / L^3, with a lognormal load.
Length and moment of inertia depend by a normal copula, whose Spearman correlation is -0.2.
"""

from __future__ import annotations

import math
from typing import Any

import numpy as np
from scipy.special import betaincinv, ndtr

from uqfold.inputs.assembly import normal_copula
from uqfold.problems.catalogue.distributions import lognormal, lognormal_parameters
from uqfold.problems.catalogue.integrals import over_normals
from uqfold.problems.catalogue.record import Entry
from uqfold.problems.catalogue.sources import OPENTURNS
from uqfold.typing import FloatArray

LIMIT = 0.30
CORRELATION = 2.0 * math.sin(math.pi * -0.2 / 6.0)


def limit_state(x: FloatArray) -> FloatArray:
    """Return g (n,), in m, of X (n, 4)."""
    modulus, load, length, inertia = x.T
    return np.asarray(LIMIT - load * length**3 / (3.0 * modulus * inertia))


def inputs() -> Any:
    """Return modulus, load, length and moment of inertia."""
    from scipy.stats import beta, uniform

    correlation = np.eye(4)
    correlation[2, 3] = correlation[3, 2] = CORRELATION
    marginals = {
        "E": beta(0.9, 3.5, 65e9, 10e9),
        "F": lognormal(300.0, 30.0),
        "L": uniform(2.5, 0.1),
        "I": beta(2.5, 4.0, 1.3e-7, 0.4e-7),
    }
    return normal_copula(marginals, correlation)


def reference() -> tuple[float, float]:
    """Return pf and its error."""
    mu, sigma = lognormal_parameters(300.0, 30.0)

    def given(e: FloatArray, length: FloatArray, own: FloatArray) -> FloatArray:
        modulus = 65e9 + 10e9 * betaincinv(0.9, 3.5, ndtr(e))
        both = CORRELATION * length + math.sqrt(1.0 - CORRELATION**2) * own
        inertia = 1.3e-7 + 0.4e-7 * betaincinv(2.5, 4.0, ndtr(both))
        load = 3.0 * LIMIT * modulus * inertia / (2.5 + 0.1 * ndtr(length)) ** 3
        return np.asarray(ndtr((mu - np.log(load)) / sigma))

    return over_normals(given, 3)


ENTRY = Entry(
    source=f"{OPENTURNS}, use case: the cantilever beam model",
    kinds=("bounded", "dependent", "rare"),
    limit_state=limit_state,
    inputs=inputs,
    reference=reference,
    pf=4.65778466921e-07,
    error=5.4e-19,
    how="product rule over modulus, length and inertia, of the tail of the load",
    units={"E": "Pa", "F": "N", "L": "m", "I": "m4"},
)
