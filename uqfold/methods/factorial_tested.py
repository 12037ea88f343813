"""Runs beside a design that test the polynomial through its responses."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from uqfold.evaluation import BudgetExceededError
from uqfold.inputs.gauss import MAX_GAUSS_NODES
from uqfold.methods.factorial_rules import MOST_POINTS, GaussRule, product_of_weights, rules_of
from uqfold.methods.factorial_runs import FactorialRuns, line_places
from uqfold.methods.factorial_surface import FactorialSurface
from uqfold.methods.stratified import stratified_points
from uqfold.problems.criterion import Criterion
from uqfold.system.structure import SystemUnits
from uqfold.typing import FloatArray, IntArray

_LEVELS, _PLACES = 4, 2
"""Thresholds near which the polynomial is tested, and places for each."""
LOOKS = 100
"""Places all around, evenly along each input: a ridge may lie between nodes wherever it is."""
BEHIND = 10
"""Places straight behind the likeliest one near each level, each for a tenth of what lies there."""
_TRIED = np.linspace(0.4, 2.8, 61)
"""Where the polynomial is sought at the level, as multiples of the distance of that place."""
_NEAR = 0.25
"""How near, in standard deviations of the response."""


@dataclass(frozen=True, eq=False)
class TestedSurface:
    """The polynomial through the responses, corrected, and how far runs are from it.

    Attributes
    ----------
    surface
        The polynomial with its corrections along single inputs.
    levels
        Thresholds near which it was tested (L,), increasing.
    misses
        Largest distance of a response from it there (L,).
    miss
        Largest distance where all inputs are one standard-normal unit low, or high: Gauss nodes of
        an input over many decades all lie in the highest ones.
    apart
        Responses all around, less the polynomial (n,).
    astray
        Share of responses behind each level that lie on its other side than the polynomial (L,).
    """

    surface: FactorialSurface
    levels: FloatArray
    misses: FloatArray
    miss: float
    apart: FloatArray
    astray: FloatArray

    def astray_at(self, criteria: Sequence[Criterion]) -> FloatArray:
        """Return the share behind each threshold where the polynomial is on its wrong side (C,)."""
        if not self.levels.size:
            return np.zeros(len(criteria))
        thresholds = np.array([one.threshold for one in criteria])
        return np.asarray(np.interp(thresholds, self.levels, self.astray))

    def misses_at(self, criteria: Sequence[Criterion]) -> FloatArray:
        """Return how far the responses near each threshold may be from the polynomial (C,)."""
        if not self.levels.size:
            return np.full(len(criteria), self.miss)
        thresholds = np.array([one.threshold for one in criteria])
        near = np.interp(thresholds, self.levels, self.misses)
        return np.asarray(np.maximum(near, self.miss))


def tested_surfaces(runs: Sequence[FactorialRuns]) -> list[TestedSurface]:
    """Run the model on lines through the middle of a design, and near the thresholds.

    Parameters
    ----------
    runs
        The design of each kind of units, and its finite responses.

    Raises
    ------
    ValueError
        If an input has no rule with two nodes more, or a response is not finite.
    BudgetExceededError
        If the budget does not hold these runs; none is made then.
    TimeLimitError
        If the time is over.
    """
    task = runs[0].known.task
    units, thresholds = SystemUnits.of(task.problem), [one.threshold for one in task.criteria]
    plans, needed = [], 0
    for one in runs:
        axes = range(one.known.inputs.dimension)
        lines = line_places(one.known.inputs, one.surface, one.counts, axes)
        levels = _levels(units.thresholds(thresholds, one.known.kind))
        needed += one.known.missing(one.surface.on_lines(lines)) + _PLACES * levels.size + 2
        needed += LOOKS + BEHIND * levels.size
        plans.append((one, lines, levels))
    if needed > task.session.remaining:
        raise BudgetExceededError(
            f"max_evals = {task.session.max_evals} has no room for the {needed} runs of the check"
        )
    task.session.expect(task.session.n_evals + needed)
    return [_tested(*plan) for plan in plans]


def _tested(
    runs: FactorialRuns, lines: Sequence[tuple[int, FloatArray]], levels: FloatArray
) -> TestedSurface:
    """Run the lines of one kind of units, and the places near its levels."""
    known, inputs = runs.known, runs.known.inputs
    between = rules_of(inputs, [min(n + 1, MAX_GAUSS_NODES) for n in runs.counts])
    surface = runs.surface.with_lines(lines, known.finite)
    places, of_level = _places_near(surface, between, levels)
    likely = np.outer([-1.0, 1.0], np.ones(inputs.dimension))
    likely = np.concatenate([likely, stratified_points(LOOKS, inputs.dimension, 3, wider=1.0)[0]])
    if inputs.independent:
        likely = inputs.from_standard_normal(likely)
    every = np.concatenate([likely, places])
    apart = known.finite(every) - surface.at(every)
    around, near = np.split(apart, [len(likely)])
    misses = np.zeros(levels.size)
    np.maximum.at(misses, of_level, np.abs(near))
    tested = np.unique(of_level)
    miss = float(np.abs(around[:2]).max())
    astray = _astray(
        runs, surface, levels[tested], places[np.unique(of_level, return_index=True)[1]]
    )
    return TestedSurface(surface, levels[tested], misses[tested], miss, around[2:], astray)


def _astray(
    runs: FactorialRuns, surface: FactorialSurface, levels: FloatArray, places: FloatArray
) -> FloatArray:
    """Run places behind the one near each level (L, d); see `TestedSurface`."""
    from scipy.special import ndtr, ndtri

    inputs = runs.known.inputs
    u = inputs.to_standard_normal(places) if inputs.independent else places
    shares, found = (np.arange(BEHIND) + 0.5) / BEHIND, np.zeros(levels.size)
    spread = float(np.ptp(runs.surface.patches[0].table))

    def along(lengths: FloatArray, towards: FloatArray) -> FloatArray:
        points = np.outer(lengths, towards)
        return inputs.from_standard_normal(points) if inputs.independent else points

    for row, level in enumerate(levels.tolist()):
        radius = float(np.linalg.norm(u[row]))
        if not 0.0 < radius < math.inf:
            continue
        towards = u[row] / radius
        # the polynomial comes to the level near that place
        tried = radius * _TRIED
        above = surface.at(along(tried, towards)) > level
        passes = tried[1:][above[1:] != above[:-1]]
        if passes.size:
            radius = float(passes[np.argmin(np.abs(passes - radius))])
        points = along(-ndtri(shares * ndtr(-radius)), towards)
        y, q = runs.known.finite(points), surface.at(points)
        # beside T the two sides are near each other
        other = ((y > level) != (q > level)) & (np.abs(y - q) > _NEAR * spread)
        found[row] = float(other.mean())
    return found


def _levels(thresholds: FloatArray) -> FloatArray:
    """Return a few thresholds that stand for all finite ones."""
    every = np.unique(thresholds[np.isfinite(thresholds)])
    if every.size == 0:
        return every
    return np.unique(every[np.linspace(0, every.size - 1, _LEVELS).round().astype(int)])


def _places_near(
    surface: FactorialSurface, rules: Sequence[GaussRule], levels: FloatArray
) -> tuple[FloatArray, IntArray]:
    """Return the likeliest places (n, d) at which the polynomial is near each level.

    They are nodes of a product of rules with one node more than the design; with them comes which
    level each belongs to (n,).
    """
    grid = [places for places, _ in rules]
    none = np.empty((0, len(grid))), np.empty(0, dtype=int)
    if math.prod(places.size for places in grid) > MOST_POINTS:
        return none
    values = surface.on_grid(grid).ravel()
    weights = product_of_weights(rules)
    mean = weights @ values
    spread = math.sqrt(weights @ (values - mean) ** 2)
    # rounded, so that rounding does not choose between places that are as likely
    unlikely = -np.round(np.log(np.maximum(weights, 1e-300)), 6)
    chosen: list[int] = []
    of_level: list[int] = []
    for level, wanted in enumerate(levels):
        apart = np.abs(values - wanted)
        reach = max(_NEAR * spread, float(np.partition(apart, 1)[1]))
        close = np.flatnonzero(apart <= reach)
        likely = close[np.lexsort((close, unlikely[close]))][:_PLACES]
        chosen += likely.tolist()
        of_level += [level] * likely.size
    if not chosen:
        return none
    index = np.unravel_index(chosen, [places.size for places in grid])
    points = [places[some] for places, some in zip(grid, index, strict=True)]
    return np.stack(points, axis=1), np.array(of_level)
