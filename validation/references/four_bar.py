"""References of Example 2 (section 4.2, Eq. 50) by integration, without sampling.

Seen from the rocker's pivot, the coupler's length is the third side of a triangle whose angle is
that between the rocker and the line to the crank pin: on one branch it is monotone in the rocker
angle phi. So, given crank, rocker and ground, "phi <= t" is a condition on the coupler in closed
form, and the conditional distribution of phi given the crank is an integral over rocker and
ground. What follows for the system is in `order_statistics.py`.

    python validation/references/four_bar.py            writes four_bar.json, four_bar_crossed.json
                                                        into uqfold/problems/references
"""

from __future__ import annotations

from dataclasses import replace
from functools import partial

import numpy as np
from order_statistics import Distribution, Rules, below_bound, references, standard_normal_rule
from tables import BINOMIAL_PROFILES, Grid, write

from uqfold.typing import FloatArray

# Table 4 in mm: mean, standard deviation; the ground of the second loop as that of the first
CRANK = (53.0, 1.0)
COUPLER = (122.0, 1.0)
ROCKER = (66.5, 1.0)
GROUND = (122.0, 1.0)
THETA = np.deg2rad(100.5)

OPEN = Grid(
    thresholds=np.arange(98.0, 107.25, 0.25).tolist(),
    taus=(None, 1.0, 2.0, 3.0, 4.0, 5.0, 6.0),
    profiles=(1, 2, 3, 5, 8, 10, *BINOMIAL_PROFILES),
    units=2,
)
GRIDS: dict[str, Grid] = {
    "open": OPEN,
    "crossed": replace(OPEN, thresholds=np.arange(-144.0, -133.5, 0.5).tolist()),
}
START: dict[str, float] = {"open": 88.0, "crossed": -156.0}
FINE = Rules(
    start=START["open"], width=0.25, panel_nodes=6, reach=9.6, shared_step=0.3, individual_step=0.4
)
COARSE = replace(FINE, panel_nodes=4, reach=9.0, shared_step=0.375, individual_step=0.5)
HOW = (
    "Integration without sampling: distribution of one rocker angle (deg) given the crank by "
    "trapezoidal rules over rocker and ground, exact in the coupler; order-statistics integral "
    "over the largest angle; trapezoidal rule over the crank. The error is a bound: the change "
    "from a coarser resolution plus rounding."
)


def unit(branch: str, t: FloatArray, u: float, rules: Rules) -> Distribution:
    """Return the distribution of one angle (deg), given the crank's standardised length u."""
    v, w = standard_normal_rule(rules.reach, rules.individual_step)
    rocker = np.repeat(ROCKER[0] + ROCKER[1] * v, v.size)
    ground = np.tile(GROUND[0] + GROUND[1] * v, v.size)
    crank = CRANK[0] + CRANK[1] * u
    # crank pin seen from the rocker's pivot: distance and direction
    x, y = crank * np.cos(THETA) - ground, crank * np.sin(THETA)
    distance, direction = np.hypot(x, y), np.arctan2(y, x)
    # the angle between rocker and that line: below the line on the open branch, above it on
    # the crossed one, where phi is reported as phi - 360 deg
    sign, turn = (-1.0, 0.0) if branch == "open" else (1.0, 2.0 * np.pi)
    angle = sign * (np.deg2rad(t)[:, None] + turn - direction)
    if not (np.all(angle > 0.0) and np.all(angle < np.pi)):
        raise ValueError("an angle of the grid lies beyond the reach of the linkage")
    coupler = np.sqrt(
        rocker * rocker + distance * distance - 2.0 * rocker * distance * np.cos(angle)
    )
    slope = rocker * distance * np.sin(angle) / coupler  # of the coupler along `angle`
    # open: phi <= t  <=>  longer coupler; crossed: phi <= t  <=>  shorter coupler
    z = sign * (coupler - COUPLER[0]) / COUPLER[1]
    return below_bound(z, slope * np.deg2rad(1.0) / COUPLER[1], np.outer(w, w).ravel())


if __name__ == "__main__":
    for branch, stem in (("open", "four_bar"), ("crossed", "four_bar_crossed")):
        coarse, fine = (replace(rules, start=START[branch]) for rules in (COARSE, FINE))
        found = references(partial(unit, branch), GRIDS[branch], coarse, fine)
        write(stem, HOW, "python validation/references/four_bar.py", found)
