"""Two four-bar linkages that share their crank (section 4.2, Table 4, Eq. 50).

Two four-bar linkages turn with one crank, R_1, held at theta = 100.5 deg. In each of them a
coupler (R_2) joins the crank to a rocker (R_3), which is pivoted on the ground (R_4); the response
is the angle phi of that rocker in degrees, Eq. (50) ::

    phi = 2 atan((D +- sqrt(D^2 + E^2 - F^2)) / (E + F))
    D = -2 R_1 R_3 sin(theta)
    E = 2 R_3 (R_4 - R_1 cos(theta))
    F = R_2^2 - R_1^2 - R_3^2 - R_4^2 + 2 R_1 R_4 cos(theta)

A unit works when phi <= T; under a synchronization threshold tau the two rockers of a mission may
not differ by more than that. After each mission all rods but the shared crank are replaced.

Where the numbers come from:

- Lengths (mm) and standard deviations are those of Table 4 for the first linkage: 53 for the
  crank, 122 for coupler and ground, 66.5 for the rocker, 1 for every standard deviation.
- The second linkage (R_5, R_6, R_7) is taken to be the same. As printed, its ground R_7 would have
  a mean of 66.5 mm; its rocker would then stand 50 deg away from that of the first linkage (or the
  linkage would not close), and the difference between the two would mean nothing. So R_7 ~ N(122,
  1) is read as what Table 4 means.
- The sign of the root is not given either: + is the open linkage (phi near 99.0 deg), - the
  crossed one (near -142.2 deg). On the open branch the crank carries a quarter of a percent of
  the variance of phi, so that the two units are nearly independent; on the crossed one it
  carries about a third.
- T and tau are not given: the default thresholds span failure probabilities from about 0.5 to
  1e-6 for one mission. At the default tau the failure probability falls with T to a plateau, of
  3.7e-3 (open) or 6e-4 (crossed).

A negative radicand means that the rods cannot be assembled: there is no angle, neither a small nor
a large one, and the response is NaN, a failed run. With the lengths of Table 4 that takes a
deviation of dozens of standard deviations.

The references come from integration without sampling: given the crank, phi is monotone in the
coupler, so its conditional distribution is an integral over rocker and ground. Their bounds are
below 1e-10 of the value. They are made by ``python validation/references/four_bar.py``.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal, get_args

import numpy as np

from uqfold.checks import choice, keep
from uqfold.inputs import normal
from uqfold.problems.base import Problem
from uqfold.problems.criterion import criteria
from uqfold.problems.reference import load_references
from uqfold.typing import FloatArray

Branch = Literal["open", "crossed"]

THETA = np.deg2rad(100.5)
"""Angle of the crank (rad)."""

# Table 4, first linkage, in mm: name -> (mean, standard deviation)
TABLE_4_SHARED = {"R_1": (53.0, 1.0)}
TABLE_4_INDIVIDUAL = {"R_2": (122.0, 1.0), "R_3": (66.5, 1.0), "R_4": (122.0, 1.0)}

DEFAULT_THRESHOLDS = {
    "open": (99.5, 100.0, 101.0, 102.0, 103.0, 104.0, 105.0),
    "crossed": (-141.5, -141.0, -140.0, -139.0, -138.0, -137.0, -136.0),
}
DEFAULT_TAU = (None, 5.0)


@dataclass(frozen=True)
class RockerAngle:
    """Rocker angle of a four-bar linkage, Eq. (50).

    Attributes
    ----------
    branch
        ``open``: + in Eq. (50); ``crossed``: -.
    """

    branch: Branch = "open"

    def __post_init__(self) -> None:
        keep(self, "branch", choice, get_args(Branch))

    def __call__(self, x: FloatArray) -> FloatArray:
        """Return the angles.

        Parameters
        ----------
        x
            Lengths (n, 4) in mm: crank R_1, coupler R_2, rocker R_3, ground R_4.

        Returns
        -------
        FloatArray
            Rocker angles phi (n,) in degrees, in (-180, 180]; NaN where the rods cannot be
            assembled.
        """
        r_1, r_2, r_3, r_4 = x.T
        d = -2.0 * r_1 * r_3 * np.sin(THETA)
        e = 2.0 * r_3 * (r_4 - r_1 * np.cos(THETA))
        f = r_2**2 - r_1**2 - r_3**2 - r_4**2 + 2.0 * r_1 * r_4 * np.cos(THETA)
        sign = 1.0 if self.branch == "open" else -1.0
        # invalid: cannot be assembled, NaN on purpose; divide: phi = 180 deg, whose half has an
        # infinite tangent
        with np.errstate(invalid="ignore", divide="ignore"):
            tangent = (d + sign * np.sqrt(d**2 + e**2 - f**2)) / (e + f)
        return np.asarray(np.rad2deg(2.0 * np.arctan(tangent)))


def four_bar(branch: Branch = "open") -> Problem:
    """Return the system of two four-bar linkages of Table 4.

    Parameters
    ----------
    branch
        Which way the linkages are assembled: ``open`` (+ in Eq. 50) or ``crossed`` (-).

    Returns
    -------
    Problem
        Two units; shared input R_1 (crank, mm), individual inputs R_2 (coupler), R_3 (rocker) and
        R_4 (ground), all mm; the response is the rocker angle in degrees.

    Raises
    ------
    ValueError
        If there is no such branch.
    """
    branch = choice("branch", branch, get_args(Branch))
    suffix = "" if branch == "open" else "-crossed"
    return Problem(
        RockerAngle(branch),
        shared={name: normal(*table) for name, table in TABLE_4_SHARED.items()},
        individual={name: normal(*table) for name, table in TABLE_4_INDIVIDUAL.items()},
        units=2,
        name=f"four-bar{suffix}",
        version=f"example-2-{branch}",
        response="rocker angle",
        response_unit="deg",
        input_units=("mm",) * 4,
        default_criteria=criteria(threshold=DEFAULT_THRESHOLDS[branch], tau=DEFAULT_TAU),
        references=load_references(f"four_bar{suffix.replace('-', '_')}"),
    )
