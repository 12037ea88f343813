"""References of Example 1 (section 4.1, Table 2) by integration, without sampling.

Given X1 and X2, the response falls with X3, so that "Y <= t" is "X3 >= a bound in closed form":
the conditional distribution of Y given X1 and its density are integrals over X2 alone. What
follows for the system is in `order_statistics.py`.

    python validation/references/series.py            writes uqfold/problems/references/series.json
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from order_statistics import Distribution, Rules, below_bound, references, standard_normal_rule
from tables import BINOMIAL_PROFILES, Grid, write

from uqfold.typing import FloatArray

# Table 2: mean, standard deviation
X1 = (1.0, 0.05)
X2 = (1.2, 0.05)
X3 = (0.5, 0.1)

GRID = Grid(
    thresholds=(
        *np.arange(-8.0, -2.0).tolist(),
        *np.arange(-2.0, 8.5, 0.5).tolist(),
        9.0,
        10.0,
        11.0,
    ),
    taus=(None, 8.0, 10.0, 12.0, 14.0, 16.0, 18.0, 20.0),
    profiles=(1, 2, 3, 5, 8, 10, *BINOMIAL_PROFILES),
)
FINE = Rules(
    start=-80.0, width=0.5, panel_nodes=7, reach=10.0, shared_step=0.2, individual_step=0.02
)
COARSE = replace(FINE, panel_nodes=5, reach=9.0, shared_step=0.3, individual_step=0.03)
HOW = (
    "Integration without sampling: distribution of one unit given X1 by a trapezoidal rule over "
    "X2, exact in X3; order-statistics integral over the largest response; trapezoidal rule over "
    "X1. The error is a bound: the change from a coarser resolution plus rounding."
)


def unit(t: FloatArray, u: float, rules: Rules) -> Distribution:
    """Return the distribution of one unit given X1 = mean + u standard deviations."""
    v, weights = standard_normal_rule(rules.reach, rules.individual_step)
    x1, x2 = X1[0] + X1[1] * u, X2[0] + X2[1] * v
    without_x3 = np.exp(0.1 * x1 + 0.2) - 4.0 * (x1 + 1.5 * x2 - 1.0) ** 3 + 18.0
    # Y <= t  <=>  exp(0.2 x2 + X3) >= gap  <=>  X3 >= log(gap) - 0.2 x2; sure when gap <= 0
    gap = without_x3 - t[:, None]
    safe = np.where(gap > 0.0, gap, 1.0)
    z = np.where(gap > 0.0, (X3[0] + 0.2 * x2 - np.log(safe)) / X3[1], np.inf)
    return below_bound(z, 1.0 / (X3[1] * safe), weights)


if __name__ == "__main__":
    command = "python validation/references/series.py"
    write("series", HOW, command, references(unit, GRID, COARSE, FINE))
