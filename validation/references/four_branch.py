"""References of the four-branch system (k = 7) by integration, without sampling.

With s = (x1 + x2) / sqrt(2) and t = (x1 - x2) / sqrt(2), independent standard normals, the response
y = -g exceeds T exactly if |s| > 3 + T + 0.2 t^2 or |t| > k / 2 + T / sqrt(2) = a. So

    pf = 2 Phi(-a) + 4 int_0^a phi(t) Phi(-(3 + T + 0.2 t^2)) dt,

an integral of a smooth positive function, by a composite Gauss-Legendre rule.

    python validation/references/four_branch.py            writes references/four_branch.json
"""

from __future__ import annotations

import math

import numpy as np
from order_statistics import gauss_panels
from scipy.special import ndtr
from tables import Grid, write

from uqfold.problems.base import LIMIT_STATE_THRESHOLD
from uqfold.problems.four_branch_system import DEFAULT_K

GRID = Grid(
    thresholds=(LIMIT_STATE_THRESHOLD, 0.5, 1.0, 1.5, 2.0, 3.0), taus=(None,), profiles=(1,)
)
ROUNDING = 1e-13
HOW = (
    "Integration without sampling in the coordinates along and across the branches: exact across, "
    "composite Gauss-Legendre rule along the curved ones. The error is a bound: the change from a "
    "coarser resolution plus rounding."
)


def failure_probability(threshold: float, panels: int) -> float:
    """Return pf at a threshold on y = -g, with ten nodes in each panel."""
    a = DEFAULT_K / 2.0 + threshold / math.sqrt(2.0)
    t, weights = gauss_panels(0.0, a / panels, panels, 10)
    density = np.exp(-0.5 * t * t) / math.sqrt(2.0 * math.pi)
    inside = density * ndtr(-(3.0 + threshold + 0.2 * t * t))
    return float(2.0 * ndtr(-a) + 4.0 * (inside @ weights).sum())


if __name__ == "__main__":
    coarse, pf = (
        np.array([failure_probability(threshold, panels) for threshold in GRID.thresholds])
        for panels in (8, 16)
    )
    found = GRID.references(pf, np.abs(pf - coarse) + ROUNDING * pf)
    write("four_branch", HOW, "python validation/references/four_branch.py", found)
