"""Defaults of a hundred obligors under one shock: a response that counts.

Obligor i defaults if (0.25 z + e_i) sqrt(12 / w) > 2.5, where z and e_i are standard normals and w
is chi-square with 12 degrees of freedom: the latent variables have a t copula. The loss is the
number of defaults, and failure more than 50 of them. Given z and w, the number is binomial.
"""

from __future__ import annotations

import math
from typing import Any

import numpy as np
from scipy.special import betainc, ndtr

from uqfold.inputs import normal
from uqfold.problems.catalogue.integrals import normal_pdf, panel_rule, refined
from uqfold.problems.catalogue.record import Entry
from uqfold.typing import FloatArray

N, RHO, FREEDOM, THRESHOLD, LOSS = 100, 0.25, 12.0, 2.5, 50


def limit_state(x: FloatArray) -> FloatArray:
    """Return g (n,) of X (n, 102): z, w, e1 to e100."""
    latent = (RHO * x[:, :1] + x[:, 2:]) * np.sqrt(FREEDOM / x[:, 1:2])
    return np.asarray(LOSS + 0.5 - (latent > THRESHOLD).sum(axis=1))


def inputs() -> dict[str, Any]:
    """Return the common factor, the shock, and the own part of each obligor."""
    from scipy.stats import gamma

    own = {f"e{i}": normal(0.0, 1.0) for i in range(1, N + 1)}
    return {"z": normal(0.0, 1.0), "w": gamma(0.5 * FREEDOM, scale=2.0), **own}


def reference() -> tuple[float, float]:
    """Return pf and its error."""
    return refined(_by_rule, 40, 80)


def _by_rule(panels: int) -> float:
    z, z_weight = panel_rule(-8.0, 10.0, panels)
    # the root of w / 12: a chi variable
    root, weight = panel_rule(0.0, 3.0, panels)
    log_density = (FREEDOM - 1.0) * np.log(root) - 0.5 * FREEDOM * root**2
    log_density += math.log(2.0) + 0.5 * FREEDOM * math.log(0.5 * FREEDOM)
    weight = weight * np.exp(log_density - math.lgamma(0.5 * FREEDOM))
    default = ndtr(RHO * z[:, None] - THRESHOLD * root)
    return float((z_weight * normal_pdf(z)) @ betainc(LOSS + 1.0, N - LOSS, default) @ weight)


ENTRY = Entry(
    source="Chan JCC, Kroese DP (2010), Efficient estimation of large portfolio loss probabilities "
    "in t-copula models, Eur. J. Oper. Res. 205, 361-367, with the setting of the package "
    "PortfolioLoss",
    kinds=("rare", "jump", "heavy tail", "high dimension"),
    limit_state=limit_state,
    inputs=inputs,
    reference=reference,
    pf=5.0809914068e-07,
    error=2.8e-16,
    how="product rule over factor and shock, of a binomial tail",
)
