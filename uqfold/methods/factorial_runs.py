"""Runs of a design of Gauss nodes, and the polynomial through them."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from functools import cache

import numpy as np

from uqfold.checks import check_scatter
from uqfold.evaluation import BudgetExceededError
from uqfold.inputs import JointInputs
from uqfold.inputs.gauss import MAX_GAUSS_NODES
from uqfold.methods.factorial_inner import Grids
from uqfold.methods.factorial_rules import GaussRule, rule_of, rules_of
from uqfold.methods.factorial_surface import FactorialSurface, Patch
from uqfold.methods.task import Task
from uqfold.moments.quadrature import tensor_grid
from uqfold.typing import FloatArray

MORE = 2
"""Nodes that a line has more than the design."""


@dataclass(frozen=True, eq=False)
class KnownRuns:
    """Responses at places in the coordinates of the rules; no place is run twice.

    Attributes
    ----------
    task
        Problem and session.
    kind
        Which kind of units they are of.
    """

    task: Task
    kind: int = 0
    _known: dict[bytes, float] = field(default_factory=dict)

    @property
    def inputs(self) -> JointInputs:
        """The inputs of this kind of units."""
        return self.task.problem.kinds.inputs[self.kind]

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
            inputs, places = self.inputs, points[list(new.values())]
            x = places if inputs.independent else inputs.from_standard_normal(places)
            rows = self.task.problem.kinds.rows_of(self.kind, x)
            found = self.task.session.evaluate(rows)
            check_scatter(found)
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
class DesignPlan:
    """Where a design of one kind of units is run, before it is.

    Attributes
    ----------
    known
        Runs made before.
    outer
        Nodes of each shared input.
    grids
        Products of nodes over the individual inputs: their shares and counts.
    products, points
        For each of them the rules of all inputs, and their nodes (n, d).
    """

    known: KnownRuns
    outer: Sequence[int]
    grids: Grids
    products: list[list[GaussRule]]
    points: list[FloatArray]

    @classmethod
    def of(cls, known: KnownRuns, outer: Sequence[int], grids: Grids) -> DesignPlan:
        """Lay out all nodes over the shared inputs times those over the individual ones."""
        inputs = known.inputs
        shared = rules_of(inputs, outer)
        rule = cache(lambda i, n: rule_of(inputs, inputs.n_shared + i, n))
        products = [[*shared, *(rule(i, n) for i, n in enumerate(counts))] for _, counts in grids]
        points = [tensor_grid(rules)[0] for rules in products]
        return cls(known, outer, grids, products, points)


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
    whole
        Whether the design is one product, which leaves no interaction out.
    """

    known: KnownRuns
    surface: FactorialSurface
    counts: tuple[int, ...]
    outer: tuple[int, ...]
    additive: bool = False
    least: tuple[int, ...] = ()
    whole: bool = True

    @classmethod
    def laid_out(cls, plan: DesignPlan) -> FactorialRuns:
        """Run what is missing of a design.

        Raises
        ------
        ValueError
            If a response is not finite.
        BudgetExceededError, TimeLimitError
            If there is no room for the runs.
        """
        ends = np.cumsum([len(one) for one in plan.points])[:-1]
        found = np.split(plan.known.finite(np.concatenate(plan.points)), ends)
        patches = []
        for (share, counts), rules, y in zip(plan.grids, plan.products, found, strict=True):
            nodes = tuple(places for places, _ in rules)
            patches.append(Patch(share, nodes, y.reshape([*plan.outer, *counts])))
        smallest = min(patches, key=lambda patch: patch.table.size)
        middle = np.array([places[places.size // 2] for places in smallest.nodes])
        several = [counts for _, counts in plan.grids]
        most = tuple(max(of_input) for of_input in zip(*several, strict=True))
        return cls(
            plan.known,
            FactorialSurface(tuple(patches), middle),
            (*plan.outer, *most),
            tuple(plan.outer),
            additive=all(sum(n > 1 for n in counts) <= 1 for counts in several),
            least=most if len(several) == 1 else (3,) * len(most),
            whole=len(several) == 1,
        )

    @classmethod
    def of_product(
        cls, task: Task, counts: Sequence[int], y: FloatArray, kind: int = 0
    ) -> FactorialRuns:
        """Take over the finite responses of one product of nodes, of one kind of units."""
        known = KnownRuns(task, kind)
        rules = rules_of(known.inputs, counts)
        known.add(tensor_grid(rules)[0], y)
        nodes = tuple(places for places, _ in rules)
        surface = FactorialSurface.of_product(nodes, y.reshape(tuple(counts)))
        n_shared = known.inputs.n_shared
        outer, inner = tuple(counts[:n_shared]), tuple(counts[n_shared:])
        return cls(known, surface, tuple(counts), outer, least=inner)


def line_places(
    inputs: JointInputs, surface: FactorialSurface, counts: Sequence[int], axes: Sequence[int]
) -> list[tuple[int, FloatArray]]:
    """Return two nodes more than a design has along each of some inputs, the middle left out.

    Raises
    ------
    ValueError
        If an input has no such rule.
    """
    finer = rules_of(inputs, [min(n + MORE, MAX_GAUSS_NODES) for n in counts])
    lines = []
    for axis in axes:
        places = finer[axis][0]
        elsewhere = np.abs(places - surface.middle[axis]) > 1e-9 * np.ptp(places)
        lines.append((axis, places[elsewhere]))
    return lines


def runs_of_kinds(
    known: Sequence[KnownRuns], outer: Sequence[int], grids: Sequence[Grids]
) -> list[FactorialRuns]:
    """Run the design of each kind of units, all over the same nodes of the shared inputs.

    Parameters
    ----------
    known
        Runs made before, of each kind.
    outer
        Nodes of each shared input.
    grids
        Products of nodes over the individual inputs of each kind: their shares and counts.

    Raises
    ------
    ValueError
        If a response is not finite.
    BudgetExceededError, TimeLimitError
        If there is no room for the runs; none is made then.
    """
    plans = [DesignPlan.of(one, outer, own) for one, own in zip(known, grids, strict=True)]
    session = known[0].task.session
    needed = sum(plan.known.missing(np.concatenate(plan.points)) for plan in plans)
    if needed > session.remaining:
        raise BudgetExceededError(
            f"the design has {needed} nodes, max_evals = {session.max_evals}: choose "
            "fewer, or raise the budget"
        )
    session.expect(session.n_evals + needed)
    return [FactorialRuns.laid_out(plan) for plan in plans]
