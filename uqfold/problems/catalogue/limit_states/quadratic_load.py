"""Resistance minus the square of a load.

Given S failure is R <= S^2: an integral over S.
"""

from __future__ import annotations

import numpy as np

from uqfold.inputs import normal
from uqfold.problems.catalogue.integrals import normal_cdf, over_normal
from uqfold.problems.catalogue.record import Entry
from uqfold.problems.catalogue.sources import WAARTS
from uqfold.typing import FloatArray


def limit_state(x: FloatArray) -> FloatArray:
    """Return g (n,) of X (n, 2)."""
    return np.asarray(x[:, 0] - x[:, 1] ** 2)


def reference() -> tuple[float, float]:
    """Return pf and its error."""
    return over_normal(lambda u: normal_cdf((1.5 + 0.5 * u) ** 2 - 11.0))


ENTRY = Entry(
    source=f"{WAARTS}: resistance-solicitation with one quadratic term",
    kinds=(),
    limit_state=limit_state,
    inputs=lambda: {"R": normal(11.0, 1.0), "S": normal(1.5, 0.5)},
    reference=reference,
    pf=0.000265898793948,
    error=3.2e-16,
    how="integral over S, of the distribution of R",
    published={"uqtestfuns, after Waarts (2000)": "2.7009e-4"},
)
