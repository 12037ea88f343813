"""Where failures lie that no design point explains: before the point, or anywhere else.

FORM and SORM see the limit state around design points, to which slopes lead. A bump on the way to
a point, a ball or a slab has no slope that is felt further off. So runs lie evenly on the ray
from the origin to each point, and evenly along each input all around.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from uqfold.methods.design_point_check import AROUND, EXPLAINED, Surroundings
from uqfold.methods.stratified import stratified_points
from uqfold.typing import BoolArray, FloatArray

BEFORE = 20
"""Points on the ray from the origin to a design point."""


def unexplained(points: Sequence[Surroundings]) -> float:
    """Probability of failures that no design point explains, as a share of that behind the first.

    Takes `BEFORE` runs for each point; those all around have been made.

    Raises
    ------
    BudgetExceededError
        If the runs do not fit.
    """
    first = points[0]
    u, weights = stratified_points(AROUND, first.towards.size, 2)
    fails = first.margin(u) > 0.0
    fails[fails] = ~np.any([_explains(one, u[fails]) for one in points], axis=0)
    around = float(weights[fails].sum()) / AROUND / first.probability
    return around + sum(_before(one) / first.probability for one in points)


def _explains(one: Surroundings, u: FloatArray) -> BoolArray:
    """Whether points (n, d) lie beyond, or nearly beyond, the plane or paraboloid of a point."""
    tangents, near, far, _ = one.curvatures()
    across = u @ tangents.T
    bends = [
        np.einsum("ni,ij,nj->n", across, np.nan_to_num(kappa), across) for kappa in (near, far)
    ]
    nearer = np.minimum(0.0, 0.5 * np.minimum(*bends))
    return np.asarray(u @ one.towards >= EXPLAINED * one.radius + nearer)


def _before(one: Surroundings) -> float:
    """Return the probability of failures on the ray to a point, as if it were that of a plane."""
    step = one.radius / BEFORE
    places = step * (np.arange(-1, BEFORE + 1) + 0.5)
    margin = one.margin(np.outer(places[1:-1], one.towards))
    here = np.concatenate([[-np.inf], margin, [-np.inf]])
    with np.errstate(invalid="ignore", divide="ignore"):
        slope, bend = here[2:] - here[:-2], here[2:] - 2.0 * margin + here[:-2]
        top = margin - slope**2 / (8.0 * bend)
    # between three points where the middle one is the highest, a parabola may come to T
    turns = (bend < 0.0) & (np.abs(slope) < -bend) & (top > 0.0)
    fails = (margin > 0.0) | turns
    density = np.exp(-0.5 * places[1:-1] ** 2) / np.sqrt(2.0 * np.pi)
    return float(step * density[fails].sum())
