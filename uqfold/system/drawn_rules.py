"""Rules of lines or rays drawn at random, beside quadrature over the shared variables."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from uqfold.system.cross_rules import Rule
from uqfold.system.directions import DirectionMixture
from uqfold.system.lines import REACH, LineRule
from uqfold.system.places import Places
from uqfold.system.refinement import STATIONS
from uqfold.system.sampled_rule import (
    SAMPLED_STATIONS,
    Values,
    failure_directions,
    places_of_failure,
    random_lines,
    random_rays,
)
from uqfold.system.surface_plan import SurfacePlan
from uqfold.system.surface_rule import Surface, SurfaceRule, joined
from uqfold.typing import FloatArray

# Shared nodes from which directions of failure are looked for.
_SHARED_TRIED = 4
_FEWEST = 16


@dataclass(frozen=True, eq=False)
class DrawnRules:
    """What is needed to draw lines and rays for a surface.

    Attributes
    ----------
    shared_nodes, weights
        Nodes (K, d_shared) of the shared variables, and their weights (K,).
    fewer
        About half as many nodes and their weights, in order to tell the error of the others.
    axes
        Principal directions of the individual variables, in columns.
    directions
        Where rays lead to failure; None of a single individual variable, along which one line is
        all there is.
    values
        The surface at some of the shared nodes, as a function of the individual variables.
    asked
        Thresholds (T,) that tables are to hold exactly.
    short
        Whether tables of a third of the usual length will do.
    rng
        Source of lines and rays.
    """

    shared_nodes: FloatArray
    weights: FloatArray
    fewer: Rule
    axes: FloatArray
    directions: DirectionMixture | None
    values: Values
    asked: FloatArray
    short: bool
    rng: np.random.Generator

    @classmethod
    def of(
        cls, surface: Surface, plan: SurfacePlan, asked: FloatArray, *, short: bool
    ) -> DrawnRules:
        """Find the directions of failure of a surface; the same surface gives the same ones."""
        nodes, weights = plan.shared_rule()
        fewer = plan.shared_rule(weights.size // 2)
        rng = np.random.default_rng(0)
        some = min(weights.size, _SHARED_TRIED)
        few = nodes[rng.choice(weights.size, some, p=weights, replace=False)]

        def values(individual: FloatArray) -> FloatArray:
            return surface(joined(few, individual)).reshape(some, -1)

        axes = plan.axes.individual
        if axes.shape[0] == 1:
            return cls(nodes, weights, fewer, axes, None, values, asked, short, rng)
        directions = failure_directions(values, axes.shape[0], asked, rng)
        return cls(nodes, weights, fewer, axes, directions, values, asked, short, rng)

    @cached_property
    def places(self) -> Places:
        """Where lines lead to failure."""
        along, across = self.axes[:, 0], self.axes[:, 1:]
        return places_of_failure(self.values, along, across, self.asked, np.random.default_rng(1))

    @property
    def _single(self) -> LineRule:
        stations = np.linspace(-REACH, REACH, STATIONS[-1])
        return LineRule(stations[:, None] * self.axes[:, 0], np.ones(1), stations, asked=self.asked)

    def rule(self, most: int, *, rays: bool, stations: int = SAMPLED_STATIONS[0]) -> SurfaceRule:
        """Draw about as many lines or rays as `most` points allow."""
        size = max(_FEWEST, most // (self.weights.size * stations))
        if self.directions is None:
            lines = self._single
        elif rays:
            lines = random_rays(self.directions, size, stations, self.asked, self.rng)
        else:
            along, across = self.axes[:, 0], self.axes[:, 1:]
            lines = random_lines(along, across, self.places, size, stations, self.asked, self.rng)
        lines = replace(lines, short=self.short)
        return SurfaceRule(self.shared_nodes, self.weights, lines, error=0.0)
