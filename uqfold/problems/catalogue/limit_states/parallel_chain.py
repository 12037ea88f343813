"""Parallel system of four planes, each sharing an input with the next.

Given x2 and x4, x1, x3 and x5 must each exceed a limit, independent of the others.
"""

from __future__ import annotations

import numpy as np
from scipy.special import ndtr

from uqfold.problems.catalogue.distributions import standard_normals
from uqfold.problems.catalogue.integrals import normal_pdf, panel_rule, refined
from uqfold.problems.catalogue.record import Entry
from uqfold.problems.catalogue.sources import WAARTS
from uqfold.typing import FloatArray


def limit_state(x: FloatArray) -> FloatArray:
    """Return g (n,) of X (n, 5)."""
    sums = x[:, :-1] + x[:, 1:]
    return np.asarray((np.array([2.677, 2.5, 2.323, 2.25]) - sums).max(axis=1))


def reference() -> tuple[float, float]:
    """Return pf and its error."""
    return refined(_by_rule, 100, 200)


def _by_rule(panels: int) -> float:
    # x3 must exceed 2.5 - x2 and 2.323 - x4: the kink is where x2 - x4 = 0.177
    x2, weight = panel_rule(-9.0, 9.0, panels)
    v, v_weight = panel_rule(-9.0, 9.0, panels)
    x4 = (x2 - 0.177)[:, None] + v
    inner = ndtr(-(2.677 - x2))[:, None] * ndtr(x4 - 2.25)
    inner = inner * ndtr(-np.maximum((2.5 - x2)[:, None], 2.323 - x4))
    density = normal_pdf(x2)[:, None] * normal_pdf(x4)
    return float(weight @ (inner * density) @ v_weight)


ENTRY = Entry(
    source=f"{WAARTS}: parallel system",
    kinds=("parallel",),
    limit_state=limit_state,
    inputs=lambda: standard_normals(5),
    reference=reference,
    pf=0.000212739430899,
    error=7.1e-16,
    how="product rule over x2 and x4, exact over the others",
)
