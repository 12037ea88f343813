"""Where lines pass: points of a plane at right angles to them, and runs between lines."""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np

from uqfold.evaluation import BudgetExceededError
from uqfold.methods.crossings import Lines
from uqfold.methods.line_neighbours import Traces
from uqfold.methods.rare_event import Running
from uqfold.typing import FloatArray, IntArray

MOST_EVEN = 100
"""Directions of a plane up to which its points lie evenly."""
BESIDE = 5
"""Lines beside a run that tell what is to be expected of it."""
FOLLOWED = 8
"""Runs between lines that are followed at most, as lines of their own."""


@dataclass(eq=False)
class PlanePoints:
    """Points of a plane through the origin, one sequence that lies evenly along its directions.

    They are those of a scrambled Sobol' sequence, each by itself standard-normal: a ridge of one
    input that holds one line in n is met by about n of them.

    Attributes
    ----------
    normal
        Unit vector (d,).
    rng
        Source of the scrambling, or of the points in many directions.
    """

    normal: FloatArray
    rng: np.random.Generator
    _sequence: Any = field(init=False, default=None)

    def points(self, number: int) -> FloatArray:
        """Return the next points (n, d)."""
        from scipy.special import ndtri
        from scipy.stats.qmc import Sobol

        d = self.normal.size
        if not 1 < d <= MOST_EVEN:
            base = self.rng.standard_normal((number, d))
            return base - np.outer(base @ self.normal, self.normal)
        shares = np.empty((0, d - 1))
        if self._sequence is None:
            self._sequence = Sobol(d - 1, scramble=True, rng=self.rng)
            # its first point alone, so that any number may follow
            shares = self._sequence.random(1)[:number]
        shares = np.concatenate([shares, self._sequence.random(number - len(shares))])
        # the axis nearest to the normal is mirrored onto it, the others into the plane
        axis = int(np.argmax(np.abs(self.normal)))
        mirror = np.eye(d)[axis] + np.copysign(1.0, self.normal[axis]) * self.normal
        points = np.insert(ndtri(np.clip(shares, 1e-15, 1.0 - 1e-15)), axis, 0.0, axis=1)
        return np.asarray(points - np.outer(points @ mirror, mirror) * (2.0 / (mirror @ mirror)))


def overlooked(
    lines: Lines, start: FloatArray, traces: Traces, near: float, rng: np.random.Generator
) -> Running[float]:
    """Run one place of each line, between those that were followed; see `Bundles.between`.

    Parameters
    ----------
    lines, start
        New lines, and where each becomes its direction's own (N,).
    traces
        Lines that were followed.
    near
        Half of the places are there; the others lie evenly before.
    rng
        Source of randomness.

    Returns
    -------
    float
        Probability that the lines beside them overlook, summed over the new lines.
    """
    from scipy.spatial import cKDTree

    number = len(lines)
    share = (rng.permutation(number) + rng.random(number)) / max(number, 1)
    spread = np.arange(number) % 2 == 1
    at = np.where(spread, lines.first + (near - lines.first) * share, near)
    chosen = np.flatnonzero(lines.first < near)
    if not chosen.size:
        return 0.0
    found = yield from lines.run(chosen, at[chosen])
    fails = found.line[found.state > 0]
    if not fails.size:
        return 0.0
    tree, most = cKDTree(traces.whereabouts), min(BESIDE, len(traces.whereabouts))
    here = np.hstack([lines.base, lines.along])[fails]
    beside = tree.query(here, k=range(1, 1 + most))[1]
    known = traces.segments.state_at(beside.ravel(), np.repeat(at[fails], most))
    new = (known.reshape(beside.shape) == 0).all(axis=1)
    fails, beside = fails[new], beside[new]
    even = fails[spread[fails]]
    # each stands for its kind with the inverse of how densely places lie
    weight = 2.0 * lines.law.density(at[even]) * (near - lines.first[even])
    ahead = ~spread[fails]
    more = yield from _higher(lines, start, traces, fails[ahead], beside[ahead], at)
    return float(weight.sum()) + 2.0 * more


def _higher(
    lines: Lines,
    start: FloatArray,
    traces: Traces,
    some: IntArray,
    beside: IntArray,
    at: FloatArray,
) -> Running[float]:
    """Return by how much lines that fail ahead of those beside them fail more, summed over them."""
    few = some[:FOLLOWED]
    if not few.size:
        return 0.0
    own = replace(
        lines, base=lines.base[few], along=lines.along[few], first=lines.first[few],
        last=lines.last[few],
    )  # fmt: skip
    everywhere = np.full(len(traces.whereabouts), np.inf)
    every = replace(lines, base=traces.whereabouts)
    others = every.masses(traces.segments, -everywhere, everywhere)[1]
    try:
        found = yield from own.followed(at[few][:, None])
        mass = own.masses(found.segments, start[few], np.full(few.size, np.inf))[1]
    except BudgetExceededError:
        # at least what lies beyond
        mass = lines.law.above(at[few])
    more = np.maximum(0.0, mass - others[beside[: few.size]].max(axis=1))
    return float(more.mean()) * some.size
