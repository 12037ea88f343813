"""A mathematical series system (section 4.1, Table 2).

Four units in series share the input X1; each has inputs X2 and X3 of its own (the paper numbers
them X2 to X9). The response of every unit is ::

    Y = exp(0.1 X1 + 0.2) - exp(0.2 X2 + X3) - 4 (X1 + 1.5 X2 - 1)^3 + 18

which is also what Eq. (48), missing from the text, stands for. A unit works when Y <= T; under a
synchronization threshold tau the largest and the smallest response of a mission may not lie
further apart than that. X1 stays what it was in the first mission; X2 and X3 are drawn anew. All
quantities are without unit.

The paper gives no values of T and tau. The default thresholds span failure probabilities from 0.5
to 3e-7 for one mission; at the default tau = 16 the failure probability falls with T to a plateau
of 1.2e-3, reached near T = 6.

The references come from integration without sampling: given X1 and X2 the response falls with X3,
so its conditional distribution is an integral over X2 alone. Their bounds are below 1e-7 of the
value, and below 1e-10 of it where the failure probability exceeds 1e-8. They are made by
``python validation/references/series.py``.
"""

from __future__ import annotations

import numpy as np

from uqfold.inputs import normal
from uqfold.problems.base import Problem
from uqfold.problems.criterion import criteria
from uqfold.problems.reference import load_references
from uqfold.typing import FloatArray

# Table 2: name -> (mean, standard deviation)
TABLE_2_SHARED = {"X1": (1.0, 0.05)}
TABLE_2_INDIVIDUAL = {"X2": (1.2, 0.05), "X3": (0.5, 0.1)}

DEFAULT_THRESHOLDS = (-3.0, -1.0, 0.0, 2.0, 4.0, 6.0, 8.0)
DEFAULT_TAU = (None, 16.0)


def series() -> Problem:
    """Return the mathematical series system of Table 2.

    Returns
    -------
    Problem
        Four units; shared input X1, individual inputs X2 and X3, none with a unit.
    """
    return Problem(
        series_response,
        shared={name: normal(*table) for name, table in TABLE_2_SHARED.items()},
        individual={name: normal(*table) for name, table in TABLE_2_INDIVIDUAL.items()},
        units=4,
        name="series",
        version="example-1",
        response="Y",
        default_criteria=criteria(threshold=DEFAULT_THRESHOLDS, tau=DEFAULT_TAU),
        references=load_references("series"),
    )


def series_response(x: FloatArray) -> FloatArray:
    """Response of one unit.

    Parameters
    ----------
    x
        Inputs (n, 3): X1, X2, X3.

    Returns
    -------
    FloatArray
        Responses Y (n,).
    """
    x1, x2, x3 = x.T
    return np.asarray(
        np.exp(0.1 * x1 + 0.2) - np.exp(0.2 * x2 + x3) - 4.0 * (x1 + 1.5 * x2 - 1.0) ** 3 + 18.0
    )
