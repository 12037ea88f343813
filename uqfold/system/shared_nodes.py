"""How many shared nodes a system needs, beyond what the distribution of one unit does.

What many units make of their failures is a steeper function of the shared variables than the
failure of one: twenty units of which ten must work fail all but surely on one side of a narrow
strip, which may lie far out. So the answers themselves are looked at, on few lines, along one
shared direction after the other.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from uqfold.problems.criterion import Criterion
from uqfold.system.cross_rules import GAUSS, LADDER, ladder_rule
from uqfold.system.refinement import TOLERANCE, Need
from uqfold.system.structure import SystemUnits
from uqfold.system.surface import SurfaceSystem
from uqfold.system.surface_plan import SurfacePlan
from uqfold.system.surface_rule import Surface
from uqfold.typing import FloatArray

# The rung that coarser ones are held against: equal steps of half a standard deviation.
_HELD_AGAINST = len(GAUSS) + 1
# Where the other shared directions stand meanwhile, in standard deviations.
_PLACES = (0.0, 1.5)


def with_shared_nodes(
    plans: Sequence[SurfacePlan],
    surfaces: Sequence[Surface],
    units: SystemUnits,
    criteria: Sequence[Criterion],
    asked: Sequence[FloatArray],
) -> list[SurfacePlan]:
    """Return the plans with as many shared nodes as the answers to the criteria need.

    Parameters
    ----------
    plans, surfaces, asked
        Of each kind of units, as in `rules_of_kinds`.
    units
        The units and their structure.
    criteria
        Some of the questions, without tau.
    """
    look = _Look(plans, surfaces, units, criteria, asked)
    needs = list(plans[0].across)
    for direction in range(plans[0].n_shared):
        for place in _PLACES[: 1 if plans[0].n_shared == 1 else 2]:
            needs[direction] = look.need(direction, place, needs[direction])
    found = tuple(needs[: plans[0].n_shared])
    return [replace(one, across=(*found, *one.across[len(found) :])) for one in plans]


class _Look:
    """Reliability indices on few lines, for nodes along one shared direction."""

    def __init__(
        self,
        plans: Sequence[SurfacePlan],
        surfaces: Sequence[Surface],
        units: SystemUnits,
        criteria: Sequence[Criterion],
        asked: Sequence[FloatArray],
    ) -> None:
        self.plans = plans
        self.surfaces = surfaces
        self.units = units
        self.criteria = criteria
        self.asked = asked

    def need(self, direction: int, place: float, planned: Need) -> Need:
        """Return the rung that a direction needs, at least the planned one."""
        if planned.level + 1 >= len(LADDER):
            return planned
        against = self.indices(direction, place, max(planned.level + 1, _HELD_AGAINST))
        change = _change(self.indices(direction, place, planned.level), against)
        if change <= TOLERANCE:
            return planned
        level, errors = planned.level, [change]
        coarser = self.indices(direction, place, level + 1)
        while errors[-1] > TOLERANCE and level + 2 < len(LADDER):
            level += 1
            finer = self.indices(direction, place, level + 1)
            errors.append(_change(coarser, finer))
            coarser = finer
        if errors[-1] > TOLERANCE:
            level += 1
            errors.append(errors[-1])
        known = [max(one, change) for one in planned.errors[: planned.level]]
        return planned.together(Need(level, (*known, *errors)))

    def indices(self, direction: int, place: float, level: int) -> FloatArray:
        """Reliability indices (C,) from a rung along a direction, the others at one place."""
        positions, weights = ladder_rule(level)
        nodes = np.full((len(weights), self.plans[0].n_shared), place)
        nodes[:, direction] = positions
        rules = tuple(
            plan.coarse_rule(own, (nodes, weights))
            for plan, own in zip(self.plans, self.asked, strict=True)
        )
        system = SurfaceSystem(rules, rules, self.units, together=False)
        return system.indices(self.surfaces, self.criteria)


def _change(one: FloatArray, other: FloatArray) -> float:
    """Largest change of an index."""
    return float(np.abs(one - other).max())
