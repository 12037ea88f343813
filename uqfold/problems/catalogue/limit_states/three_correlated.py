"""Lognormal, normal and uniform input, correlated.

g = 1.7 - X2 / (1000 X3) - (X1 / (200 X3))^2: given X1 and X3, linear in X2. The correlations 0.3,
0.2 and 0.2 hold between the inputs; those of the normal copula behind follow in closed form
(Nataf).
"""

from __future__ import annotations

import math
from typing import Any

import numpy as np
from scipy.special import ndtr, ndtri

from uqfold.inputs import normal
from uqfold.inputs.assembly import normal_copula
from uqfold.problems.catalogue.distributions import lognormal, lognormal_of, lognormal_parameters
from uqfold.problems.catalogue.integrals import over_normals
from uqfold.problems.catalogue.record import Entry
from uqfold.typing import FloatArray


def limit_state(x: FloatArray) -> FloatArray:
    """Return g (n,) of X (n, 3)."""
    x1, x2, x3 = x.T
    return np.asarray(1.7 - x2 / (1000.0 * x3) - (x1 / (200.0 * x3)) ** 2)


def copula() -> FloatArray:
    """Return the correlations (3, 3) of the normal variables behind the inputs."""
    _, sigma = lognormal_parameters(500.0, 100.0)
    lognormal_normal = 0.3 * math.sqrt(math.expm1(sigma**2)) / sigma
    normal_uniform = 0.2 * math.sqrt(math.pi / 3.0)
    # E[exp(s U - s^2 / 2) Phi(V)] = Phi(r s / sqrt(2)) for a correlation r of U and V
    middle = 0.5 + 0.2 * math.sqrt(math.expm1(sigma**2) / 12.0)
    lognormal_uniform = math.sqrt(2.0) / sigma * float(ndtri(middle))
    return np.array(
        [
            [1.0, lognormal_normal, lognormal_uniform],
            [lognormal_normal, 1.0, normal_uniform],
            [lognormal_uniform, normal_uniform, 1.0],
        ]
    )


def inputs() -> Any:
    """Return X1 to X3."""
    from scipy.stats import uniform

    width = 0.5 * math.sqrt(12.0)
    marginals = {
        "X1": lognormal(500.0, 100.0),
        "X2": normal(2000.0, 400.0),
        "X3": uniform(5.0 - 0.5 * width, width),
    }
    return normal_copula(marginals, copula())


def reference() -> tuple[float, float]:
    """Return pf and its error."""
    order = [0, 2, 1]
    root = np.linalg.cholesky(copula()[np.ix_(order, order)])

    def given(first: FloatArray, second: FloatArray) -> FloatArray:
        x1 = lognormal_of(first, 500.0, 100.0)
        x3 = 5.0 + 0.5 * math.sqrt(12.0) * (ndtr(root[1, 0] * first + root[1, 1] * second) - 0.5)
        x2 = 1000.0 * x3 * (1.7 - (x1 / (200.0 * x3)) ** 2)
        z = (x2 - 2000.0) / 400.0 - root[2, 0] * first - root[2, 1] * second
        return np.asarray(ndtr(-z / root[2, 2]))

    return over_normals(given, 2, steps=(0.05, 0.04))


ENTRY = Entry(
    source="PySTRA, as of 2026, example and tests, after FERUM",
    kinds=("bounded", "dependent"),
    limit_state=limit_state,
    inputs=inputs,
    reference=reference,
    pf=6.0463894748e-05,
    error=7.1e-17,
    how="product rule over X1 and X3, of the tail of X2",
)
