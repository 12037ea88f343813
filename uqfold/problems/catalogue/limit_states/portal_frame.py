"""Portal frame with correlated moments: series of two mechanisms, in parallel with three bounds.

With A = M1 + M2 + M4 + M5, B = M2 + 2 M3 + M4 and C = M1 + 2 M3 + 2 M4 + M5, failure is A <= 5 H or
B <= 5 V, together with A >= 400, B >= 350 and C >= 750. Given A and B, C is normal, and the loads H
and V are independent of all.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from scipy.special import ndtr

from uqfold.inputs import normal
from uqfold.inputs.assembly import normal_copula
from uqfold.problems.catalogue.integrals import normal_pdf, panel_rule, refined
from uqfold.problems.catalogue.record import Entry
from uqfold.problems.catalogue.sources import OPENTURNS
from uqfold.typing import FloatArray

FACTORS = np.array([[1, 1, 0, 1, 1], [0, 1, 2, 1, 0], [1, 0, 2, 2, 1]], dtype=float)


def limit_state(x: FloatArray) -> FloatArray:
    """Return g (n,), in kN m, of X (n, 7)."""
    a, b, c = FACTORS @ x[:, :5].T
    mechanisms = np.minimum(a - 5.0 * x[:, 5], b - 5.0 * x[:, 6])
    return np.asarray(np.max([mechanisms, 400.0 - a, 350.0 - b, 750.0 - c], axis=0))


def inputs() -> Any:
    """Return five moments, of correlation 1/2, and two loads."""
    marginals = {f"M{i}": normal(200.0, 30.0) for i in range(1, 6)}
    correlation = np.eye(7)
    correlation[:5, :5] += 0.5 - 0.5 * np.eye(5)
    return normal_copula(
        {**marginals, "H": normal(60.0, 30.0), "V": normal(60.0, 15.0)}, correlation
    )


def reference() -> tuple[float, float]:
    """Return pf and its error."""
    return refined(_by_rule, 60, 120)


def _by_rule(panels: int) -> float:
    mean = FACTORS @ np.full(5, 200.0)
    covariance = FACTORS @ (450.0 * (np.ones((5, 5)) + np.eye(5))) @ FACTORS.T
    root = np.linalg.cholesky(covariance)
    u, weight = panel_rule((400.0 - mean[0]) / root[0, 0], 9.0, panels)
    a = mean[0] + root[0, 0] * u
    # from the least B on
    own, own_weight = panel_rule(0.0, 18.0, panels)
    low = (350.0 - mean[1] - root[1, 0] * u) / root[1, 1]
    v = low[:, None] + own
    b = (mean[1] + root[1, 0] * u)[:, None] + root[1, 1] * v
    c = mean[2] + (root[2, 0] * u)[:, None] + root[2, 1] * v
    stand = ndtr((a / 5.0 - 60.0) / 30.0)[:, None] * ndtr((b / 5.0 - 60.0) / 15.0)
    inside = (1.0 - stand) * ndtr((c - 750.0) / root[2, 2]) * normal_pdf(v)
    return float((weight * normal_pdf(u)) @ inside @ own_weight)


ENTRY = Entry(
    source=f"{OPENTURNS}, test of SystemFORM",
    kinds=("series", "parallel", "dependent"),
    limit_state=limit_state,
    inputs=inputs,
    reference=reference,
    pf=0.00234961188235,
    error=4.3e-15,
    how="product rule over two sums of moments, exact over the rest",
)
