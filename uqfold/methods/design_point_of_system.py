"""Whether the plane at one unit's design point still holds where the system fails.

Units that stand in for each other fail together mostly where what they share is far out, further
than at the design point of one unit. So the response is looked at there as well.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from uqfold.methods.design_point import Search
from uqfold.methods.standard_space import SEARCH_RADIUS, NoGradientError, StandardSpaceResponse
from uqfold.problems.criterion import Missions
from uqfold.system.linearised import common_factor, linearised_failure
from uqfold.system.structure import SystemUnits
from uqfold.typing import FloatArray

NOTICED = 0.1
"""Share of the system's probability from which a common cause of its own is looked for."""


@dataclass(frozen=True)
class SystemPlace:
    """The plane of one unit as it is seen where the system fails, or works.

    Attributes
    ----------
    weight
        Share of that event which the place stands for.
    beta, rho
        Reliability index of the unit, and correlation of two units; NaN where there is no plane.
    """

    weight: float
    beta: float
    rho: float


def places_of_system(
    response: StandardSpaceResponse,
    search: Search,
    n_shared: int,
    units: SystemUnits,
    missions: Missions,
) -> list[SystemPlace]:
    """Look at three places where the rarer of failure and success of a system comes from.

    They are the nodes of three-point Gauss quadrature over what units share along the design
    direction; what is a unit's own takes it to its limit state. Before, the axes of shared inputs
    are looked at as far out as a cause of failure may begin that all units have in common. Takes
    2 (d + d_shared) + 3 runs; none for units in series, which fail near the design point of one.

    Raises
    ------
    BudgetExceededError
        If the runs do not fit.
    """
    from scipy.special import ndtri

    best = search.best
    beta, alpha = best.beta(search.threshold), best.alpha
    rho = float(np.sum(alpha[:n_shared] ** 2))
    if units.diagram is None or n_shared == 0:
        return []
    rho = min(1.0, rho)
    pf, reliability = linearised_failure(beta, rho, units, missions)
    side = 1.0 if pf <= reliability else -1.0
    share = NOTICED * min(pf, reliability) / (2 * n_shared)
    far = min(SEARCH_RADIUS, -float(ndtri(share))) * np.eye(n_shared, alpha.size)
    axes = np.vstack([far, -far])
    by_plane = side * (axes @ alpha - beta)
    seen = side * (response.values(axes) - search.threshold)
    if ((seen > 0.0) & (by_plane < 0.0)).any():
        return [SystemPlace(1.0, math.nan, rho)]
    if not 1e-9 < rho < 1.0 - 1e-9:
        return []
    mean, std = common_factor(beta, rho, units, missions, fails=pf <= reliability)

    def point(z: float) -> FloatArray:
        own = (beta - math.sqrt(rho) * z) / (1.0 - rho)
        return np.concatenate([z / math.sqrt(rho) * alpha[:n_shared], own * alpha[n_shared:]])

    try:
        centre = response.linearise(point(mean))
    except NoGradientError:
        return [SystemPlace(1.0, math.nan, rho)]
    here = min(1.0, float(np.sum(centre.alpha[:n_shared] ** 2)))
    spread = math.sqrt(3.0) * std
    sides = response.values(np.array([point(mean - spread), point(mean + spread)]))
    indices = beta - (sides - search.threshold) / best.slope
    return [
        SystemPlace(2.0 / 3.0, centre.beta(search.threshold), here),
        *(SystemPlace(1.0 / 6.0, index, rho) for index in indices.tolist()),
    ]
