"""How finely cheap surfaces are laid out: as many points in each direction as it needs.

All rules are laid along the principal directions of the surface's gradient, as finely as each of
them needs (`uqfold.system.refinement`).
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import reduce

import numpy as np

from uqfold.system.cross_rules import (
    GAUSS,
    LADDER,
    Rule,
    gauss_rule,
    ladder_rule,
    product_rule,
    quasi_random_rule,
)
from uqfold.system.lines import REACH, LineRule
from uqfold.system.refinement import (
    STATIONS,
    Axes,
    Compared,
    Need,
    Surface,
    refined,
    shared_axes,
)
from uqfold.system.shared_lines import SharedLines
from uqfold.system.surface_rule import ACCEPTABLE, MAX_POINTS, SurfaceRule
from uqfold.typing import FloatArray

# Errors beyond which quasi-random lines are better than a product that was cut down.
_TOO_COARSE = 0.1
MOST_SHARED = 33
"""Shared nodes beside lines that do not form a product."""
# Rules that need so many times the points that there are will not be cut down to them.
_HOPELESS = 10.0
# Individual variables up to which every direction is tried for lines.
_MOST_LED = 3
# The first rung of equal steps.
_FOR_OUTCOMES = len(GAUSS)
# Sizes of the first three rungs, and of all others, where only changes of the answer matter.
_COARSE = (1, 3, 3, 5)
_COARSE_STATIONS, _COARSE_NODES = 33, 64


@dataclass(frozen=True, eq=False)
class SurfacePlan:
    """Directions of a surface, and how many nodes each of them needs.

    Attributes
    ----------
    axes
        Principal directions.
    across
        Rules across, one per direction, shared ones first.
    along
        Points along each line, a rung of `STATIONS`.
    """

    axes: Axes
    across: tuple[Need, ...]
    along: Need

    def for_outcomes(self) -> SurfacePlan:
        """Plan for a surface with holes, where responses are infinite or runs fail.

        Their borders have nothing to do with the surface and its directions.
        """
        return replace(self, across=tuple(need.at_least(_FOR_OUTCOMES) for need in self.across))

    def finest(self) -> SurfacePlan:
        """Plan for a surface of which refinement has not seen what matters."""
        return replace(
            self,
            across=tuple(Need.of_all(len(LADDER)) for _ in self.across),
            along=Need.of_all(len(STATIONS)),
        )

    def grid(self, size: int, asked: FloatArray) -> SurfaceRule:
        """Lay out lines and stations in equal steps, so many of each, over two variables."""
        lines = product_rule([ladder_rule(LADDER.index(size))])
        return self._laid_out(product_rule([]), lines, size, error=0.0, asked=asked)

    @property
    def n_shared(self) -> int:
        """Number of shared variables."""
        return int(self.axes.shared.shape[0])

    @property
    def n_individual(self) -> int:
        """Number of the others."""
        return int(self.axes.individual.shape[0])

    def rule(self, max_points: int = MAX_POINTS, asked: FloatArray | None = None) -> SurfaceRule:
        """Lay out the points of a single surface; see `rules_of_kinds`."""
        return rules_of_kinds([self], max_points, [np.empty(0) if asked is None else asked])[0]

    def shared_rule(self, most: int = MOST_SHARED) -> Rule:
        """Nodes (K, d_shared) and weights of the shared variables, at most so many."""
        levels = self._few_shared(most)
        nodes, weights = product_rule([ladder_rule(level) for level in levels])
        return nodes @ self.axes.shared.T, weights

    def _few_shared(self, most: int = MOST_SHARED) -> list[int]:
        return _cut(self.across[: self.n_shared], _nodes, most)

    def coarse_rule(
        self, asked: FloatArray | None = None, nodes: Rule | None = None
    ) -> SurfaceRule:
        """Lay out few points: enough to see how the answer moves when the surface does.

        `nodes` (K, d_shared) along the shared directions take the place of few ones.
        """
        sizes = [_COARSE[min(need.level, len(_COARSE) - 1)] for need in self.across]
        shared, lines = (
            product_rule([gauss_rule(size) for size in part])
            if math.prod(part) <= _COARSE_NODES
            else quasi_random_rule(len(part), _COARSE_NODES)
            for part in (sizes[: self.n_shared], sizes[self.n_shared :])
        )
        return self._laid_out(
            shared if nodes is None else nodes, lines, _COARSE_STATIONS, error=math.inf,
            short=True, asked=asked,
        )  # fmt: skip

    def on_shared_lines(
        self, shared: SharedLines, most: int, asked: FloatArray, *, coarse: bool = False
    ) -> SurfaceRule:
        """Lay out at most so many points beside the stations of shared lines, or few.

        The lines must run along the shared directions of the plan.
        """
        nodes = shared.coordinates, shared.node_weights
        if coarse:
            return replace(self.coarse_rule(asked, nodes), shared_lines=shared)
        needs = [*self.across[self.n_shared :], self.along]
        most //= shared.node_weights.size
        *across, along = levels = _cut(
            needs, lambda one: _nodes(one[:-1]) * STATIONS[one[-1]], most
        )
        error = math.hypot(*(need.errors[i] for need, i in zip(needs, levels, strict=True)))
        stations = STATIONS[along]
        if error > _TOO_COARSE and len(across) > 2:
            lines = quasi_random_rule(len(across), max(1, most // stations))
        else:
            lines = product_rule([ladder_rule(level) for level in across])
        rule = self._laid_out(nodes, lines, stations, error=error, asked=asked)
        return replace(rule, shared_lines=shared)

    def _laid_out(
        self,
        shared: Rule,
        across: Rule,
        stations: int,
        *,
        error: float,
        short: bool = False,
        asked: FloatArray | None = None,
    ) -> SurfaceRule:
        positions = np.linspace(-REACH, REACH, stations)
        own = self.axes.individual
        starts = across[0] @ own[:, 1:].T
        points = (starts[:, None, :] + positions[:, None] * own[:, 0]).reshape(-1, own.shape[0])
        lines = LineRule(
            points, across[1], positions, short, np.empty(0) if asked is None else asked
        )
        return SurfaceRule(shared[0] @ self.axes.shared.T, shared[1], lines, error)


def plan_surface(
    surface: Surface,
    dimension: int,
    n_shared: int,
    together: int = 1,
    *,
    compared: Compared | None = None,
    max_points: int = MAX_POINTS,
    shared: FloatArray | None = None,
) -> SurfacePlan:
    """Find out how finely a surface must be known.

    Lines run along the direction in which the surface changes most, or along another one where
    this leaves less of an error.

    Parameters
    ----------
    surface
        The surface; it is evaluated at some ten thousand points to see how it behaves.
    dimension
        Number of variables d.
    n_shared
        How many of them, the first ones, are shared; fewer than d.
    together
        How many responses, units times missions, a system takes.
    compared
        Where changes count; None: over the whole distribution.
    max_points
        Points that a rule may have.
    shared
        Directions (s, s) of the shared variables; None: the principal ones of this surface.

    Raises
    ------
    ValueError
        If there is no individual variable to integrate over.
    """
    if not 0 <= n_shared < dimension:
        raise ValueError(f"{n_shared} shared of {dimension} variables: one must be individual")
    compared = Compared() if compared is None else compared
    principal = Axes.of(surface, dimension, n_shared, shared)
    plans = []
    own = dimension - n_shared
    for first in range(own if own <= _MOST_LED else 1):
        axes = principal.led_by(first)
        across, along = refined(surface, axes, together, compared, _HOPELESS * max_points)
        plan = SurfacePlan(axes, tuple(across), along)
        error = _levels([plan], max_points)[2]
        plans.append((error, first, plan))
        if error <= ACCEPTABLE:
            break
    return min(plans)[2]


def plans_of_kinds(
    surfaces: Sequence[Surface],
    dimensions: Sequence[int],
    n_shared: int,
    together: int,
    compared: Sequence[Compared],
    max_points: int,
) -> list[SurfacePlan]:
    """Plan for surfaces of several kinds of units, whose shared nodes are to be the same.

    Shared directions are those of all surfaces together, and get the finest rule that one of them
    needs. Parameters are those of `plan_surface`, for each kind.
    """
    shared = shared_axes(surfaces, dimensions, n_shared) if len(surfaces) > 1 else None
    plans = [
        plan_surface(
            surface, dimension, n_shared, together, compared=own,
            max_points=max_points // len(surfaces), shared=shared,
        )
        for surface, dimension, own in zip(surfaces, dimensions, compared, strict=True)
    ]  # fmt: skip
    needs = [
        reduce(Need.together, every)
        for every in zip(*(plan.across[:n_shared] for plan in plans), strict=True)
    ]
    return [replace(one, across=(*needs, *one.across[n_shared:])) for one in plans]


def rules_of_kinds(
    plans: Sequence[SurfacePlan], max_points: int, asked: Sequence[FloatArray]
) -> tuple[SurfaceRule, ...]:
    """Lay out the points of all kinds, at most `max_points` of them, on the same shared nodes.

    If the needs add up to more, what loses least is coarsened, again and again; where too much
    is lost, quasi-random lines take the place of a product.

    Parameters
    ----------
    plans
        From `plans_of_kinds`.
    max_points
        Most points in all.
    asked
        Thresholds of each kind.
    """
    shared, own, error = _levels(plans, max_points)
    scarce = error > _TOO_COARSE and any(len(levels) > 3 for levels in own)
    if scarce:
        shared = plans[0]._few_shared()
    nodes = product_rule([ladder_rule(level) for level in shared])
    rules = []
    for plan, (*across, along), thresholds in zip(plans, own, asked, strict=True):
        if scarce and len(across) > 2:
            stations = STATIONS[0]
            size = max_points // len(plans) // (_nodes(shared) * stations)
            lines = quasi_random_rule(len(across), max(1, size))
        else:
            stations = STATIONS[along]
            lines = product_rule([ladder_rule(level) for level in across])
        rules.append(plan._laid_out(nodes, lines, stations, error=error, asked=thresholds))
    return tuple(rules)


def _levels(
    plans: Sequence[SurfacePlan], max_points: int
) -> tuple[list[int], list[list[int]], float]:
    """Rungs that `max_points` allow, and the error of a normal score that they leave.

    Those of the shared directions come first, then for each plan those across and along its lines.
    """
    n_shared = plans[0].n_shared
    own = [[*plan.across[n_shared:], plan.along] for plan in plans]
    ends = np.cumsum([n_shared, *map(len, own)]).tolist()

    def parts(levels: Sequence[int]) -> list[Sequence[int]]:
        return [levels[low:high] for low, high in itertools.pairwise(ends)]

    def size(levels: Sequence[int]) -> int:
        lines = sum(_nodes(one[:-1]) * STATIONS[one[-1]] for one in parts(levels))
        return _nodes(levels[:n_shared]) * lines

    needs = [*plans[0].across[:n_shared], *itertools.chain(*own)]
    levels = _cut(needs, size, max_points)
    left = [need.errors[level] for need, level in zip(needs, levels, strict=True)]
    return levels[:n_shared], [list(one) for one in parts(levels)], math.hypot(*left)


def _cut(needs: Sequence[Need], size: Callable[[Sequence[int]], int], most: int) -> list[int]:
    """Rungs of all needs, what loses least coarsened again and again until the size is allowed."""
    levels = [need.level for need in needs]
    while size(levels) > most and any(levels):
        losses = [
            need.errors[level - 1] if level > 0 else math.inf
            for need, level in zip(needs, levels, strict=True)
        ]
        levels[int(np.argmin(losses))] -= 1
    return levels


def _nodes(levels: Sequence[int]) -> int:
    return math.prod(LADDER[level] for level in levels)
