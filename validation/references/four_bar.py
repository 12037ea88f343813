"""References of Example 2 (section 4.2, Eq. 50) by integration, without sampling.

Seen from the rocker's pivot, the coupler's length is the third side of a triangle whose angle is
that between the rocker and the line to the crank pin: on one branch it is monotone in the rocker
angle phi. So, given crank, rocker and ground, "phi <= t" is a condition on the coupler in closed
form, and the conditional distribution of phi given the crank is an integral over rocker and
ground. What follows for the system is in `order_statistics.py`.

    python validation/references/four_bar.py            writes four_bar.json, four_bar_crossed.json
                                                        into uqfold/problems/references
    python validation/references/four_bar.py --check    recomputes and compares
"""

from __future__ import annotations

import sys
from dataclasses import dataclass
from functools import partial
from typing import Literal

import numpy as np
from order_statistics import Grid, Resolution, rows, standard_normal_rule
from scipy.special import ndtr
from tables import BINOMIAL_PROFILES, as_text, integration_command

from uqfold.typing import FloatArray

Branch = Literal["open", "crossed"]

# Table 4 in mm: mean, standard deviation; the ground of the second loop as that of the first
CRANK = (53.0, 1.0)
COUPLER = (122.0, 1.0)
ROCKER = (66.5, 1.0)
GROUND = (122.0, 1.0)
THETA = np.deg2rad(100.5)

PROFILES = (1, 2, 3, 5, 8, 10, *BINOMIAL_PROFILES)
GRIDS: dict[Branch, Grid] = {
    "open": Grid(
        start=88.0,
        width=0.25,
        thresholds=np.arange(98.0, 107.25, 0.25).tolist(),
        taus=(None, 1.0, 2.0, 3.0, 4.0, 5.0, 6.0),
        profiles=PROFILES,
        n_units=2,
    ),
    "crossed": Grid(
        start=-156.0,
        width=0.25,
        thresholds=np.arange(-144.0, -133.5, 0.5).tolist(),
        taus=(None, 1.0, 2.0, 3.0, 4.0, 5.0, 6.0),
        profiles=PROFILES,
        n_units=2,
    ),
}
COARSE = Resolution(reach=9.0, shared_step=0.375, individual_step=0.5, panel_nodes=4)
FINE = Resolution(reach=9.6, shared_step=0.3, individual_step=0.4, panel_nodes=6)
HOW = (
    "Integration without sampling: distribution of one rocker angle (deg) given the crank by "
    "trapezoidal rules over rocker and ground, exact in the coupler; order-statistics integral "
    "over the largest angle; trapezoidal rule over the crank. The error is a bound: the change "
    "from a coarser resolution plus rounding."
)
COMMAND = "python validation/references/four_bar.py"


@dataclass(frozen=True)
class FourBarUnit:
    """One loop of Example 2 given the crank."""

    branch: Branch

    def distribution(
        self, t: FloatArray, u: float, resolution: Resolution
    ) -> tuple[FloatArray, FloatArray, FloatArray]:
        """Give H, 1 - H and h (1/deg) at angles t (deg), given the crank's standardised length."""
        v, w = standard_normal_rule(resolution.reach, resolution.individual_step)
        rocker = np.repeat(ROCKER[0] + ROCKER[1] * v, v.size)
        ground = np.tile(GROUND[0] + GROUND[1] * v, v.size)
        weights = np.outer(w, w).ravel()
        crank = CRANK[0] + CRANK[1] * u
        # crank pin seen from the rocker's pivot: distance and direction
        x, y = crank * np.cos(THETA) - ground, crank * np.sin(THETA)
        distance, direction = np.hypot(x, y), np.arctan2(y, x)
        # the angle between rocker and that line: below the line on the open branch, above it on
        # the crossed one, where phi is reported as phi - 360 deg
        sign = -1.0 if self.branch == "open" else 1.0
        turn = 0.0 if self.branch == "open" else 2.0 * np.pi
        angle = sign * (np.deg2rad(t)[:, None] + turn - direction)
        if not (np.all(angle > 0.0) and np.all(angle < np.pi)):
            raise ValueError("an angle of the grid lies beyond the reach of the linkage")
        coupler = np.sqrt(
            rocker * rocker + distance * distance - 2.0 * rocker * distance * np.cos(angle)
        )
        slope = rocker * distance * np.sin(angle) / coupler  # of the coupler along `angle`
        # open: phi <= t  <=>  longer coupler; crossed: phi <= t  <=>  shorter coupler
        z = sign * (coupler - COUPLER[0]) / COUPLER[1]
        density = np.exp(-0.5 * z * z) * slope * np.deg2rad(1.0) / np.sqrt(2.0 * np.pi) / COUPLER[1]
        return ndtr(z) @ weights, ndtr(-z) @ weights, density @ weights


def compute(branch: Branch) -> str:
    """Give the text of the reference file of one branch."""
    name = "four-bar" if branch == "open" else "four-bar-crossed"
    table = rows(FourBarUnit(branch), GRIDS[branch], COARSE, FINE)
    return as_text(name, "integration", HOW, COMMAND, table)


FILES = [
    ("four_bar.json", partial(compute, "open")),
    ("four_bar_crossed.json", partial(compute, "crossed")),
]

if __name__ == "__main__":
    sys.exit(integration_command(__doc__, FILES))
