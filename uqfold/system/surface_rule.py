"""Where a cheap surface is evaluated to integrate it over standard-normal space.

Shared variables take quadrature nodes, and the same lines over the individual variables start at
each of them (`uqfold.system.lines`). All rules are laid along the principal directions of the
surface's gradient, as finely as each of them needs (`uqfold.system.refinement`).
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import numpy as np

from uqfold.system.conditional_response import ConditionalResponse
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
from uqfold.system.refinement import STATIONS, Axes, Compared, Need, Surface, refined
from uqfold.typing import FloatArray, IntArray

__all__ = ["MAX_POINTS", "Surface", "SurfacePlan", "SurfaceRule", "plan_surface"]

MAX_POINTS = 400_000
"""Points at which a surface is evaluated unless the caller says otherwise."""

# Error of a normal score that is accepted when points are scarce: 2 % of pf at 1e-9, less above.
_ACCEPTABLE = 3e-3
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
class SurfaceRule:
    """Where a surface is to be evaluated, and how its values become conditional responses.

    Attributes
    ----------
    shared_nodes
        Nodes (K, d_shared) in standard-normal space.
    weights
        Their weights (K,).
    lines
        Lines in the space of the individual variables, the same at every shared node.
    error
        Error of a normal score that the rule leaves, as far as refinement has shown.
    """

    shared_nodes: FloatArray
    weights: FloatArray
    lines: LineRule
    error: float

    @property
    def resolved(self) -> bool:
        """Whether the number of points sufficed for an acceptable accuracy."""
        return self.error <= _ACCEPTABLE

    @property
    def points(self) -> FloatArray:
        """All points (K * lines * stations, d)."""
        return joined(self.shared_nodes, self.lines.points)

    def parts(self, count: int) -> list[tuple[SurfaceRule, IntArray]]:
        """Rules of every count-th line each, and which of all points they take."""
        lines, stations = self.lines.weights.size, self.lines.stations.size
        place = np.arange(self.weights.size * lines * stations).reshape(-1, lines, stations)
        return [
            (replace(self, lines=self.lines.every(count, i)), place[:, i::count].ravel())
            for i in range(count)
        ]

    def thinned(self) -> tuple[SurfaceRule, IntArray]:
        """The rule with every second station of all lines, and which of all points it takes."""
        place = np.arange(self.points.shape[0]).reshape(-1, self.lines.stations.size)
        return replace(self, lines=self.lines.thinned()), place[:, ::2].ravel()

    def responses(
        self, values: FloatArray, outcomes: IntArray | None = None, noise: float = 0.0
    ) -> list[ConditionalResponse]:
        """Return one conditional response per shared node; see `LineRule.response`.

        Parameters
        ----------
        values, outcomes
            Of all points, in their order.
        noise
            Standard deviation of an independent normal disturbance of every response.
        """
        rows = values.reshape(self.weights.size, -1)
        if outcomes is None:
            return [self.lines.response(row, None, noise) for row in rows]
        kinds = outcomes.reshape(rows.shape)
        pairs = zip(rows, kinds, strict=True)
        return [self.lines.response(row, kind, noise) for row, kind in pairs]


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

    def rule(self, max_points: int = MAX_POINTS, asked: FloatArray | None = None) -> SurfaceRule:
        """Lay out the points, at most `max_points` of them, for the thresholds that are asked.

        If the needs add up to more, what loses least is coarsened, again and again; where too much
        is lost, quasi-random lines take the place of a product.
        """
        levels, error = self.levels(max_points)
        n_shared = self.axes.shared.shape[0]
        own = len(self.across) - n_shared
        if error > _TOO_COARSE and own > 2:
            levels = self._few_shared()
            stations = STATIONS[0]
            lines = quasi_random_rule(own, max(1, max_points // (_nodes(levels) * stations)))
        else:
            stations = STATIONS[levels.pop()]
            lines = product_rule([ladder_rule(level) for level in levels[n_shared:]])
        shared = product_rule([ladder_rule(level) for level in levels[:n_shared]])
        return self._laid_out(shared, lines, stations, error=error, asked=asked)

    def levels(self, max_points: int) -> tuple[list[int], float]:
        """Rungs that `max_points` allow, and the error of a normal score that they leave."""
        needs = [*self.across, self.along]
        levels = _cut(needs, _size, max_points)
        left = [need.errors[level] for need, level in zip(needs, levels, strict=True)]
        return levels, math.hypot(*left)

    def shared_rule(self, most: int = MOST_SHARED) -> Rule:
        """Nodes (K, d_shared) and weights of the shared variables, at most so many."""
        levels = self._few_shared(most)
        nodes, weights = product_rule([ladder_rule(level) for level in levels])
        return nodes @ self.axes.shared.T, weights

    def _few_shared(self, most: int = MOST_SHARED) -> list[int]:
        return _cut(self.across[: self.axes.shared.shape[0]], _nodes, most)

    def coarse_rule(self, asked: FloatArray | None = None) -> SurfaceRule:
        """Lay out few points: enough to see how the answer moves when the surface does."""
        sizes = [_COARSE[min(need.level, len(_COARSE) - 1)] for need in self.across]
        n_shared = self.axes.shared.shape[0]
        shared, lines = (
            product_rule([gauss_rule(size) for size in part])
            if math.prod(part) <= _COARSE_NODES
            else quasi_random_rule(len(part), _COARSE_NODES)
            for part in (sizes[:n_shared], sizes[n_shared:])
        )
        return self._laid_out(
            shared, lines, _COARSE_STATIONS, error=math.inf, short=True, asked=asked
        )

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

    Raises
    ------
    ValueError
        If there is no individual variable to integrate over.
    """
    if not 0 <= n_shared < dimension:
        raise ValueError(f"{n_shared} shared of {dimension} variables: one must be individual")
    compared = Compared() if compared is None else compared
    principal = Axes.of(surface, dimension, n_shared)
    plans = []
    own = dimension - n_shared
    for first in range(own if own <= _MOST_LED else 1):
        axes = principal.led_by(first)
        across, along = refined(surface, axes, together, compared, _HOPELESS * max_points)
        plan = SurfacePlan(axes, tuple(across), along)
        error = plan.levels(max_points)[1]
        plans.append((error, first, plan))
        if error <= _ACCEPTABLE:
            break
    return min(plans)[2]


def joined(shared: FloatArray, individual: FloatArray) -> FloatArray:
    """All points (K n, d): each of n individual parts at each of K shared ones."""
    outer = np.repeat(shared, individual.shape[0], axis=0)
    return np.hstack([outer, np.tile(individual, (shared.shape[0], 1))])


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


def _size(levels: Sequence[int]) -> int:
    """Number of points of rules across, and last of the points along each line."""
    return _nodes(levels[:-1]) * STATIONS[levels[-1]]
