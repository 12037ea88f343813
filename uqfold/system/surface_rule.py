"""Where a cheap surface is evaluated to integrate it over standard-normal space.

Shared variables take quadrature nodes, and the same lines over the individual variables start at
each of them (`uqfold.system.lines`).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import TypeAlias

import numpy as np

from uqfold.system.conditional_response import ConditionalResponse
from uqfold.system.lines import LineRule
from uqfold.system.refinement import Surface
from uqfold.system.shared_lines import OnLines, SharedLines
from uqfold.typing import FloatArray, IntArray

__all__ = ["MAX_POINTS", "Surface", "SurfaceRule", "joined"]

AtNodes: TypeAlias = Sequence[ConditionalResponse] | OnLines
"""Conditional responses of one kind at all shared nodes, or what they are made of."""

MAX_POINTS = 400_000
"""Points at which a surface is evaluated unless the caller says otherwise."""

# Error of a normal score that is accepted when points are scarce: 2 % of pf at 1e-9, less above.
ACCEPTABLE = 3e-3


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
    confirmed
        Whether lines and rays drawn at random, which err by more, do not contradict it.
    shared_lines
        Lines of which the shared nodes are the stations; None where nodes stand for themselves.
    """

    shared_nodes: FloatArray
    weights: FloatArray
    lines: LineRule
    error: float
    confirmed: bool = False
    shared_lines: SharedLines | None = None

    @property
    def resolved(self) -> bool:
        """Whether the error is known: it is acceptable, or confirmed."""
        return self.confirmed or self.error <= ACCEPTABLE

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
    ) -> AtNodes:
        """Return one conditional response per shared node; see `LineRule.response`.

        At the stations of shared lines, return what such responses are made of.

        Parameters
        ----------
        values, outcomes
            Of all points, in their order.
        noise
            Standard deviation of an independent normal disturbance of every response.
        """
        rows = values.reshape(self.weights.size, -1)
        kinds = None if outcomes is None else outcomes.reshape(rows.shape)
        if self.shared_lines is not None:
            return OnLines(self.lines, rows, kinds, noise)
        if kinds is None:
            return [self.lines.response(row, None, noise) for row in rows]
        pairs = zip(rows, kinds, strict=True)
        return [self.lines.response(row, kind, noise) for row, kind in pairs]


def joined(shared: FloatArray, individual: FloatArray) -> FloatArray:
    """All points (K n, d): each of n individual parts at each of K shared ones."""
    outer = np.repeat(shared, individual.shape[0], axis=0)
    return np.hstack([outer, np.tile(individual, (shared.shape[0], 1))])
