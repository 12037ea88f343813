"""Whether the planes at the units' design points still hold where the system fails.

Units that stand in for each other fail together mostly where what they share is far out, further
than at the design point of one unit. There the responses are run as well: at places of the shared
inputs that are drawn where the system of planes fails, or nearly does, each unit is followed along
its own part of its design direction to where it fails, at a random place beside that line. Given
the shared inputs the units are independent, so that the structure makes of these conditional
probabilities that of the system; how far it is from what the planes say, averaged over the places,
is what the planes miss. If that is too much, planes that touch limit states there may do better.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from contextlib import suppress
from dataclasses import dataclass, replace

import numpy as np

from uqfold.methods.design_point import Search
from uqfold.methods.standard_space import SEARCH_RADIUS, NoGradientError, StandardSpaceResponse
from uqfold.problems.criterion import Missions
from uqfold.system.linearised_units import Planes, PlanesGiven, failure_of_planes
from uqfold.system.structure import SystemUnits
from uqfold.typing import FloatArray

NOTICED = 0.1
"""Share of the system's probability from which a common cause of its own is looked for."""
BEYOND, OTHER_RAYS = 0.5, 8
"""So much further out (in standard deviations), since the cause need not lie along an axis; and
rays that are drawn beside the axes, for each shared input but the first."""
PLACES = 32
"""Places of the shared inputs that are looked at."""
BESIDE = 3
"""Most lines of one sort of units at each place, one for each of its units."""
NEARLY = 0.5
"""Half of the places are where the system fails with all planes so much nearer."""
LEAST_OWN = 0.3
"""A unit with less of its own than this is looked at as if it had so much: else it would fail at a
place or not, and a small distance between the two would mostly go unseen."""
STRAIGHT = 0.02
"""A line is followed further if the response leaves the plane by more than this (in standard
deviations of what is the unit's own)."""
FURTHER = 3
TOUCHED = 2
"""Linearisations, each where the plane before says that a unit fails."""


@dataclass(frozen=True, eq=False)
class SystemLook:
    """What runs where the system fails show of the planes of its units.

    Attributes
    ----------
    departure
        What the planes miss there, relative to the smaller probability: their mean distance from
        what is seen, and two standard errors of it.
    centre
        The middle (s,) of where shared inputs lie when the system of planes fails.
    """

    departure: float
    centre: FloatArray


def look_at_system(
    responses: Sequence[StandardSpaceResponse],
    searches: Sequence[Search],
    n_shared: int,
    units: SystemUnits,
    missions: Missions,
) -> SystemLook:
    """Look at the planes of units where their system fails, or works if that is rarer.

    Before, the axes of shared inputs and other rays are looked at as far out as a cause of failure
    may begin that units have in common; where one does, the departure is infinite. Nothing is asked
    of units in series, which fail near the design points of one.

    Parameters
    ----------
    responses, searches
        Of each sort of units (J,).
    n_shared
        Number of shared inputs.
    units, missions
        The system.

    Raises
    ------
    BudgetExceededError
        If the runs do not fit.
    """
    nowhere = np.zeros(n_shared)
    if units.diagram is None:
        return SystemLook(0.0, nowhere)
    betas = np.array([one.best.beta(one.threshold) for one in searches])
    shared = np.array([one.best.alpha[:n_shared] for one in searches])
    own = np.sqrt(np.maximum(0.0, 1.0 - (shared**2).sum(axis=1)))
    length = np.hypot(np.linalg.norm(shared, axis=1), np.maximum(own, LEAST_OWN))
    planes = Planes(betas / length, shared / length[:, None])
    found = failure_of_planes(planes, units, missions)
    rarer = 0 if found.pf <= found.reliability else 1
    small = (found.pf, found.reliability)[rarer]
    side = 1.0 - 2.0 * rarer
    if small == 0.0:
        return SystemLook(math.inf, nowhere)
    if _common_cause(responses, searches, n_shared, units, NOTICED * small, rarer):
        return SystemLook(math.inf, nowhere)
    nearer = planes.with_betas(planes.betas - side * NEARLY)
    more = failure_of_planes(nearer, units, missions)
    both = small, (more.pf, more.reliability)[rarer]
    rng = np.random.default_rng(0)
    given = [PlanesGiven(one, units, missions) for one in (planes, nearer)]
    places = np.concatenate([one.drawn(rarer, PLACES // 2, rng) for one in given])
    if given[0].n_factors and len(np.unique(places @ given[0].span.T, axis=0)) < PLACES // 2:
        # hardly any of the places that were tried lies where the system fails
        return SystemLook(math.inf, nowhere)
    by_planes = [one.at(places)[rarer] for one in given]
    density = sum(chance / whole for chance, whole in zip(by_planes, both, strict=True)) / 2.0
    indices = [
        _indices(response, search, places, count, rng)
        for response, search, count in zip(responses, searches, units.counts, strict=True)
    ]
    seen = given[0].of_indices(indices)[rarer]
    changes = (seen - by_planes[0]) / density / small
    departure = float(abs(changes.mean()) + 2.0 * changes.std(ddof=1) / math.sqrt(PLACES))
    return SystemLook(departure, places[: PLACES // 2].mean(axis=0))


def planes_at(
    responses: Sequence[StandardSpaceResponse], searches: Sequence[Search], centre: FloatArray
) -> list[Search]:
    """Return searches (J,) whose planes touch where each unit fails, given shared inputs (s,)."""
    found = []
    for response, search in zip(responses, searches, strict=True):
        plane = search.best
        with suppress(NoGradientError):
            for _ in range(TOUCHED):
                shared, individual = np.split(plane.alpha, [centre.size])
                own = float(individual @ individual)
                gap = plane.beta(search.threshold) - centre @ shared
                ahead = gap / own * individual if own >= LEAST_OWN**2 else 0.0 * individual
                point = np.concatenate([centre, ahead])
                if math.hypot(*point) > SEARCH_RADIUS:
                    break
                plane = response.linearise(point)
        found.append(replace(search, trace=[(plane, "")]))
    return found


def _common_cause(
    responses: Sequence[StandardSpaceResponse],
    searches: Sequence[Search],
    n_shared: int,
    units: SystemUnits,
    noticed: float,
    rarer: int,
) -> bool:
    """Whether the system fails far out for what units share, where the planes let it work.

    The other way round if it is rarer (1) that it works. Units have nothing of their own there.
    """
    from scipy.special import ndtri

    if n_shared == 0:
        return False
    drawn = np.random.default_rng(0).standard_normal((OTHER_RAYS * (n_shared - 1), n_shared))
    drawn /= np.linalg.norm(drawn, axis=1, keepdims=True)
    rays = np.vstack([np.eye(n_shared), -np.eye(n_shared), drawn])
    reach = min(SEARCH_RADIUS, BEYOND - float(ndtri(noticed / (2 * n_shared))))
    by_planes, seen = [], []
    for response, search in zip(responses, searches, strict=True):
        best = search.best
        points = np.zeros((len(rays), best.alpha.size))
        points[:, :n_shared] = reach * rays
        by_planes.append(points @ best.alpha > best.beta(search.threshold))
        seen.append(response.values(points) > search.threshold)
    of_planes, of_system = (
        units.mission(np.array(fails, float), 1.0 - np.array(fails, float))[rarer]
        for fails in (by_planes, seen)
    )
    return bool((of_system > of_planes).any())


def _indices(
    response: StandardSpaceResponse,
    search: Search,
    places: FloatArray,
    count: int,
    rng: np.random.Generator,
) -> FloatArray:
    """Reliability indices (lines, K) of a unit at places (K, s) of what is shared."""
    best, n_shared = search.best, places.shape[1]
    beta = best.beta(search.threshold)
    shared, individual = np.split(best.alpha, [n_shared])
    own = float(np.linalg.norm(individual))
    along = individual / own if own > 0.0 else individual
    lines = min(count, BESIDE) if individual.size > 1 else 1
    places = np.tile(places, (lines, 1))
    gap = beta - places @ shared
    beside = rng.standard_normal((len(places), individual.size))
    followed = own >= LEAST_OWN
    ahead = gap / own if followed else beside @ along
    beside -= np.outer(beside @ along, along)
    room = SEARCH_RADIUS**2 - (places**2).sum(axis=1) - (beside**2).sum(axis=1)
    most = np.sqrt(np.maximum(0.0, room))
    index, active = gap / max(own, LEAST_OWN), np.arange(len(places))
    for _ in range(1 + FURTHER * followed):
        steps = np.clip(ahead[active], -most[active], most[active])
        u = np.hstack([places[active], np.outer(steps, along) + beside[active]])
        margin = best.beyond(response.values(u), search.threshold)
        left = margin - (own * steps - gap[active])
        former = index[active]
        index[active] = (gap[active] - left) / max(own, LEAST_OWN)
        ahead = index
        active = active[np.abs(index[active] - former) > STRAIGHT]
        if not active.size:
            break
    return index.reshape(lines, -1)
