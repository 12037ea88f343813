"""Runs of a design of Gauss nodes, and runs beside it that test the polynomial through them."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, field
from functools import cache

import numpy as np

from uqfold.evaluation import BudgetExceededError
from uqfold.inputs.gauss import MAX_GAUSS_NODES
from uqfold.methods.base import Task
from uqfold.methods.factorial_rules import (
    MOST_POINTS,
    GaussRule,
    product_of_weights,
    rule_of,
    rules_of,
)
from uqfold.methods.factorial_surface import FactorialSurface, Patch
from uqfold.moments.quadrature import tensor_grid
from uqfold.problems.criterion import Criterion
from uqfold.system.structure import SystemUnits
from uqfold.typing import FloatArray, IntArray

MORE = 2
"""Nodes that a line has more than the design."""
_LEVELS, _PLACES = 4, 2
"""Thresholds near which the polynomial is tested, and places for each."""
_NEAR = 0.25
"""How near, in standard deviations of the response."""


@dataclass(frozen=True, eq=False)
class KnownRuns:
    """Responses at places in the coordinates of the rules; no place is run twice.

    Attributes
    ----------
    task
        Problem and session.
    """

    task: Task
    _known: dict[bytes, float] = field(default_factory=dict)

    def missing(self, points: FloatArray) -> int:
        """Count the places (n, d) that have not been run."""
        return len({key for key in _keys(points) if key not in self._known})

    def at(self, points: FloatArray) -> FloatArray:
        """Return the responses (n,) at places (n, d), NaN and +-inf included.

        Raises
        ------
        BudgetExceededError, TimeLimitError
            If there is no room for the runs.
        """
        keys = _keys(points)
        new: dict[bytes, int] = {}
        for row, key in enumerate(keys):
            if key not in self._known:
                new.setdefault(key, row)
        if new:
            inputs, places = self.task.problem.inputs, points[list(new.values())]
            x = places if inputs.independent else inputs.from_standard_normal(places)
            found = self.task.session.evaluate(x)
            self._known.update(zip(new, found.tolist(), strict=True))
        return np.array([self._known[key] for key in keys])

    def add(self, points: FloatArray, y: FloatArray) -> None:
        """Take over responses (n,) that were run elsewhere."""
        self._known.update(zip(_keys(points), y.tolist(), strict=True))

    def finite(self, points: FloatArray) -> FloatArray:
        """Return the responses as `at` does.

        Raises
        ------
        ValueError
            If one is not finite.
        """
        found = self.at(points)
        lost = int((~np.isfinite(found)).sum())
        if lost:
            raise ValueError(f"{lost} of {found.size} responses are not finite")
        return found


def _keys(points: FloatArray) -> list[bytes]:
    # -0.0 is 0.0
    return [point.tobytes() for point in np.asarray(points, dtype=float) + 0.0]


@dataclass(frozen=True, eq=False)
class FactorialRuns:
    """The runs of a design, and the polynomial through them.

    Attributes
    ----------
    known
        The runs.
    surface
        The polynomial.
    counts
        Nodes of every input in the design, shared inputs first.
    outer
        Nodes over each shared input from which the answer was made.
    additive
        Whether the polynomial has no interactions of individual inputs.
    least
        Nodes that an individual input has at least in rules over the polynomial.
    """

    known: KnownRuns
    surface: FactorialSurface
    counts: tuple[int, ...]
    outer: tuple[int, ...]
    additive: bool = False
    least: tuple[int, ...] = ()

    @classmethod
    def laid_out(
        cls, known: KnownRuns, outer: Sequence[int], grids: Sequence[tuple[float, tuple[int, ...]]]
    ) -> FactorialRuns:
        """Run the design: all nodes over the shared inputs times those over the individual ones.

        Parameters
        ----------
        known
            Runs made before.
        outer
            Nodes of each shared input.
        grids
            Products of nodes over the individual inputs: their shares and counts.

        Raises
        ------
        ValueError
            If a response is not finite.
        BudgetExceededError, TimeLimitError
            If there is no room for the runs; none is made then.
        """
        task, inputs = known.task, known.task.problem.inputs
        shared = rules_of(inputs, outer)
        most = tuple(max(counts[i] for _, counts in grids) for i in range(inputs.n_individual))
        rule = cache(lambda i, n: rule_of(inputs, inputs.n_shared + i, n))
        products = [[*shared, *(rule(i, n) for i, n in enumerate(counts))] for _, counts in grids]
        points = [tensor_grid(rules)[0] for rules in products]
        every = np.concatenate(points)
        needed = known.missing(every)
        if needed > task.session.remaining:
            raise BudgetExceededError(
                f"the design has {needed} nodes, max_evals = {task.session.max_evals}: choose "
                "fewer, or raise the budget"
            )
        task.session.expect(task.session.n_evals + needed)
        found = np.split(known.finite(every), np.cumsum([len(one) for one in points])[:-1])
        patches = []
        for (share, counts), rules, y in zip(grids, products, found, strict=True):
            nodes = tuple(places for places, _ in rules)
            patches.append(Patch(share, nodes, y.reshape([*outer, *counts])))
        smallest = min(patches, key=lambda patch: patch.table.size)
        middle = np.array([places[places.size // 2] for places in smallest.nodes])
        return cls(
            known,
            FactorialSurface(tuple(patches), middle),
            (*outer, *most),
            tuple(outer),
            additive=all(sum(n > 1 for n in counts) <= 1 for _, counts in grids),
            least=most if len(grids) == 1 else (3,) * len(most),
        )

    @classmethod
    def of_product(cls, task: Task, counts: Sequence[int], y: FloatArray) -> FactorialRuns:
        """Take over the finite responses of one product of nodes."""
        rules = rules_of(task.problem.inputs, counts)
        known = KnownRuns(task)
        known.add(tensor_grid(rules)[0], y)
        nodes = tuple(places for places, _ in rules)
        surface = FactorialSurface.of_product(nodes, y.reshape(tuple(counts)))
        n_shared = task.problem.inputs.n_shared
        outer, inner = tuple(counts[:n_shared]), tuple(counts[n_shared:])
        return cls(known, surface, tuple(counts), outer, least=inner)


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
    """

    surface: FactorialSurface
    levels: FloatArray
    misses: FloatArray
    miss: float

    def misses_at(self, criteria: Sequence[Criterion]) -> FloatArray:
        """Return how far the responses near each threshold may be from the polynomial (C,)."""
        if not self.levels.size:
            return np.full(len(criteria), self.miss)
        thresholds = np.array([one.threshold for one in criteria])
        near = np.interp(thresholds, self.levels, self.misses)
        return np.asarray(np.maximum(near, self.miss))


def line_places(
    task: Task, surface: FactorialSurface, counts: Sequence[int], axes: Sequence[int]
) -> list[tuple[int, FloatArray]]:
    """Return two nodes more than a design has along each of some inputs, the middle left out.

    Raises
    ------
    ValueError
        If an input has no such rule.
    """
    finer = rules_of(task.problem.inputs, [min(n + MORE, MAX_GAUSS_NODES) for n in counts])
    lines = []
    for axis in axes:
        places = finer[axis][0]
        elsewhere = np.abs(places - surface.middle[axis]) > 1e-9 * np.ptp(places)
        lines.append((axis, places[elsewhere]))
    return lines


def tested_surface(task: Task, runs: FactorialRuns) -> TestedSurface:
    """Run the model on lines through the middle of a design, and near the thresholds.

    Parameters
    ----------
    task
        Problem, criteria and session.
    runs
        The design and its finite responses.

    Raises
    ------
    ValueError
        If an input has no rule with two nodes more, or a response is not finite.
    BudgetExceededError
        If the budget does not hold these runs; none is made then.
    TimeLimitError
        If the time is over.
    """
    inputs, known, plain = task.problem.inputs, runs.known, runs.surface
    lines = line_places(task, plain, runs.counts, range(inputs.dimension))
    between = rules_of(inputs, [min(n + 1, MAX_GAUSS_NODES) for n in runs.counts])
    asked = SystemUnits.of(task.problem).thresholds([one.threshold for one in task.criteria])
    levels = _levels(asked)
    needed = known.missing(plain.on_lines(lines)) + _PLACES * levels.size + 2
    if needed > task.session.remaining:
        raise BudgetExceededError(
            f"max_evals = {task.session.max_evals} has no room for the {needed} runs of the check"
        )
    task.session.expect(task.session.n_evals + needed)
    surface = plain.with_lines(lines, known.finite)
    places, of_level = _places_near(surface, between, levels)
    likely = np.outer([-1.0, 1.0], np.ones(inputs.dimension))
    if inputs.independent:
        likely = inputs.from_standard_normal(likely)
    every = np.concatenate([likely, places])
    apart = np.abs(known.finite(every) - surface.at(every))
    misses = np.zeros(levels.size)
    np.maximum.at(misses, of_level, apart[2:])
    tested = np.unique(of_level)
    return TestedSurface(surface, levels[tested], misses[tested], float(apart[:2].max()))


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
