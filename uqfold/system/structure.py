"""From the failure of units to the failure of their system, for any monotone structure.

Whether the system fails is written as a binary decision diagram: a node asks whether one unit
fails and goes on to one of two others, until the answer is known. Every structure is built from
two operations on diagrams, "fails if either fails" and "fails only if both fail", and k-out-of-n
directly as a grid, whose evaluation is the recursion of Barlow and Heidtmann. The value of a node
is

    failure(node) = f_i failure(node if i fails) + w_i failure(node if i works),

with f_i and w_i = 1 - f_i both given, and the reliability follows from the same rule with the two
ends exchanged. All terms are positive, so that neither number ever loses digits to a difference.

References
----------
Bryant RE. Graph-based algorithms for Boolean function manipulation. IEEE Trans. Comput. C-35
(1986) 677-691.
Rauzy A. New algorithms for fault trees analysis. Reliab. Eng. Syst. Saf. 40 (1993) 203-211.
Barlow RE, Heidtmann KD. Computing k-out-of-n system reliability. IEEE Trans. Reliab. R-33 (1984)
322-323.
"""

from __future__ import annotations

import ast
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass, field
from functools import lru_cache, reduce
from typing import TypeAlias

import numpy as np
from numpy.typing import ArrayLike

from uqfold.checks import shown
from uqfold.problems.base import Problem
from uqfold.problems.expression import Expression, branches, read
from uqfold.problems.structure import (
    CutSets,
    KOutOfN,
    Parallel,
    PathSets,
    Series,
    SystemStructure,
)
from uqfold.time_limit import check_time
from uqfold.typing import FloatArray, IntArray

WORKS, FAILS = 0, 1
"""The two ends of every diagram."""
MOST_NODES = 500_000
"""A structure that needs more nodes than this is refused."""
_MOST_VALUES = 1 << 22
"""Values of nodes held at once: bounds memory."""
_TINY = 1e-300
"""Stands for 0 in a logarithm."""

Level: TypeAlias = tuple[int, IntArray, IntArray, IntArray]
_Rule: TypeAlias = Callable[[int, FloatArray, FloatArray], FloatArray]
"""Values of the nodes of a unit, from where they go if it works and if it fails."""


@dataclass(frozen=True, eq=False)
class Diagram:
    """A reduced, ordered binary decision diagram of "the system fails".

    Attributes
    ----------
    size
        Number of nodes, the two ends included.
    top
        The node at which to begin.
    levels
        Unit, and its nodes with where each of them goes if the unit works and if it fails; a level
        goes to earlier ones only.
    """

    size: int
    top: int
    levels: tuple[Level, ...]

    def probabilities(self, fails: FloatArray, works: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Failure and success (...) of independent units that fail and work with these (n, ...)."""
        shape = fails.shape[1:]
        both = np.stack([fails, works]).reshape(2, len(fails), -1)
        found = [np.empty(both.shape[2]), np.empty(both.shape[2])]
        columns, step = both, max(1, _MOST_VALUES // self.size)
        for start in range(0, columns.shape[2], step):
            check_time()
            both = columns[:, :, start : start + step]
            for one, ends in zip(found, ((0.0, 1.0), (1.0, 0.0)), strict=True):
                value = self._values(ends, both.shape[2], _by_chance(*both))
                one[start : start + step] = value[self.top]
        failure, success = (np.asarray(one.reshape(shape)) for one in found)
        return failure, success

    def with_derivatives(
        self, fails: FloatArray, works: FloatArray
    ) -> tuple[FloatArray, FloatArray]:
        """Failure (m,) of independent units, and how it changes with the failure of each (n, m).

        Parameters
        ----------
        fails, works
            How likely units fail and work (n, m).
        """
        failure, changes = np.empty(fails.shape[1]), np.zeros(fails.shape)
        step = max(1, _MOST_VALUES // self.size)
        for start in range(0, failure.size, step):
            check_time()
            some = slice(start, start + step)
            both = fails[:, some], works[:, some]
            value = self._values((0.0, 1.0), both[0].shape[1], _by_chance(*both))
            failure[some] = value[self.top]
            # how the top answers to each node, from the top down
            weight = np.zeros_like(value)
            weight[self.top] = 1.0
            for unit, nodes, if_works, if_fails in reversed(self.levels):
                own = weight[nodes]
                changes[unit, some] += (own * (value[if_fails] - value[if_works])).sum(axis=0)
                np.add.at(weight, if_fails, both[0][unit] * own)
                np.add.at(weight, if_works, both[1][unit] * own)
        return failure, changes

    def response(self, y: FloatArray) -> FloatArray:
        """Response (...) of the system to the responses (n, ...) of its units.

        It exceeds a threshold exactly when the units whose responses do make the system fail.
        """

        def by_order(unit: int, if_works: FloatArray, if_fails: FloatArray) -> FloatArray:
            return np.asarray(np.maximum(if_works, np.minimum(block[unit], if_fails)))

        columns = y.reshape(len(y), -1)
        found = np.empty(columns.shape[1])
        step = max(1, _MOST_VALUES // self.size)
        for start in range(0, found.size, step):
            block = columns[:, start : start + step]
            ends = (-np.inf, np.inf)
            found[start : start + step] = self._values(ends, block.shape[1], by_order)[self.top]
        return np.asarray(found.reshape(y.shape[1:]))

    def _values(self, ends: tuple[float, float], columns: int, rule: _Rule) -> FloatArray:
        """Values (size, columns) of all nodes."""
        value = np.empty((self.size, columns))
        value[WORKS], value[FAILS] = ends
        for unit, nodes, if_works, if_fails in self.levels:
            value[nodes] = rule(unit, value[if_works], value[if_fails])
        return value


def _by_chance(fails: FloatArray, works: FloatArray) -> _Rule:
    """The rule of probabilities, from those (n, columns) of the units."""

    def rule(unit: int, if_works: FloatArray, if_fails: FloatArray) -> FloatArray:
        return np.asarray(works[unit] * if_works + fails[unit] * if_fails)

    return rule


@dataclass(frozen=True, eq=False)
class SystemUnits:
    """Units of one system: how many, and what their failures mean for the system.

    Attributes
    ----------
    count
        Number of units n.
    diagram
        When the system fails; None where every unit must work, which needs no diagram.
    offsets
        What is added to the response of the units of each sort (J,): units of one kind, which have
        model and inputs in common, and with the same offset are of one sort.
    of_kinds
        The kind of each sort (J,).
    of_sorts
        The sort of each unit (n,); None where all are alike.
    """

    count: int
    diagram: Diagram | None = None
    offsets: FloatArray = field(default_factory=lambda: np.zeros(1))
    of_kinds: IntArray = field(default_factory=lambda: np.zeros(1, dtype=np.int64))
    of_sorts: IntArray | None = None

    def __post_init__(self) -> None:
        if self.count < 1:
            raise ValueError(f"units = {self.count}: a system needs at least one unit")

    @classmethod
    def of(cls, problem: Problem | SystemUnits | int) -> SystemUnits:
        """Return the units of a problem; of a number, so many in series.

        Raises
        ------
        ValueError
            If the structure needs more than `MOST_NODES` nodes.
        """
        if isinstance(problem, SystemUnits):
            return problem
        if isinstance(problem, int):
            return cls(problem)
        in_series = isinstance(problem.structure, Series)
        found = None if in_series else diagram(problem.structure, problem.unit_names)
        if problem.exchangeable:
            return cls(problem.n_units, found)
        kinds = problem.kinds
        assert kinds.of_units is not None
        assert kinds.offsets is not None
        pairs = np.stack([kinds.of_units, kinds.offsets])
        (of_kinds, offsets), of_sorts = np.unique(pairs, axis=1, return_inverse=True)
        return cls(problem.n_units, found, offsets, of_kinds.astype(np.int64), of_sorts.ravel())

    @property
    def counts(self) -> list[int]:
        """How many units are of each sort (J,)."""
        return [self.count] if self.of_sorts is None else np.bincount(self.of_sorts).tolist()

    @property
    def n_kinds(self) -> int:
        """How many kinds there are."""
        return int(self.of_kinds.max()) + 1

    def thresholds(self, thresholds: ArrayLike, kind: int | None = None) -> FloatArray:
        """Response (J, ...) without offset at which units of each sort fail, from T (...).

        Of one kind alone, if it is given.
        """
        asked = np.asarray(thresholds, dtype=float)
        offsets = self.offsets if kind is None else self.offsets[self.of_kinds == kind]
        return asked - offsets.reshape(-1, *[1] * asked.ndim)

    def mission(self, fails: FloatArray, works: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Failure and success (...) of one mission, from those (J, ...) of units of each sort.

        Both are used, each where it is the accurate one.
        """
        index = self.of_sorts
        if self.diagram is not None:
            if index is not None:
                return self.diagram.probabilities(fails[index], works[index])
            shape = (self.count, *fails.shape[1:])
            return self.diagram.probabilities(
                np.broadcast_to(fails, shape), np.broadcast_to(works, shape)
            )
        with np.errstate(divide="ignore"):
            log_works = np.where(fails < 0.5, np.log1p(-np.minimum(fails, 0.5)), np.log(works))
        whole = sum(count * one for count, one in zip(self.counts, log_works, strict=True))
        return -np.expm1(whole), np.exp(whole)

    def with_derivatives(
        self, fails: FloatArray, works: FloatArray
    ) -> tuple[FloatArray, FloatArray]:
        """Failure (m,) of one mission, and how it changes with that (J, m) of all of a sort.

        Parameters are those of `mission`.
        """
        index = np.zeros(self.count, dtype=int) if self.of_sorts is None else self.of_sorts
        if self.diagram is None:
            # finite, so that the product of all others is a difference
            logs = np.where(
                fails < 0.5, np.log1p(-np.minimum(fails, 0.5)), np.log(np.maximum(works, _TINY))
            )
            counts = np.array(self.counts)[:, None]
            whole = (counts * logs).sum(axis=0)
            return -np.expm1(whole), counts * np.exp(whole - logs)
        failure, of_units = self.diagram.with_derivatives(fails[index], works[index])
        changes = np.zeros(fails.shape)
        np.add.at(changes, index, of_units)
        return failure, changes

    def shifted(self, y: FloatArray) -> FloatArray:
        """Responses (..., n) of units with their offsets added."""
        return y if self.of_sorts is None else y + self.offsets[self.of_sorts]

    def response(self, y: FloatArray) -> FloatArray:
        """Response (...) of the system to those (..., n) of its units, none of them NaN."""
        if self.diagram is None:
            return np.asarray(y.max(axis=-1))
        return self.diagram.response(np.moveaxis(y, -1, 0))

    @property
    def shift(self) -> float:
        """Offset of the system where all units give one and the same response."""
        return 0.0 if self.of_sorts is None else float(self.response(self.offsets[self.of_sorts]))


@lru_cache(maxsize=16)
def diagram(structure: SystemStructure, names: tuple[str, ...]) -> Diagram:
    """Build the diagram of a structure of units with these names.

    Raises
    ------
    ValueError
        If it takes more than `MOST_NODES` nodes.
    """
    n = len(names)
    builder = _Builder(structure)
    if isinstance(structure, Series | Parallel | KOutOfN):
        k = structure.k if isinstance(structure, KOutOfN) else 1
        top = builder.at_least(n if isinstance(structure, Series) else k, range(n))
    elif isinstance(structure, CutSets):
        cuts = sorted(sorted(one) for one in structure.sets)
        top = builder.joined((builder.at_least(1, one) for one in cuts), either=True)
    elif isinstance(structure, PathSets):
        paths = sorted(sorted(one) for one in structure.sets)
        top = builder.joined((builder.at_least(len(one), one) for one in paths), either=False)
    else:
        expression = read(structure.expression)
        top = builder.expression(expression)
        return builder.diagram(top, [names.index(name) for name in expression.names])
    return builder.diagram(top, range(n))


class _Builder:
    """Nodes of diagrams over the same order of units, each kept once."""

    def __init__(self, structure: SystemStructure) -> None:
        self.structure = structure
        # level, next node if the unit works, and if it fails; the ends lie below all levels
        self.nodes: list[tuple[int, int, int]] = [(1 << 62, 0, 0), (1 << 62, 1, 1)]
        self.known: dict[tuple[int, int, int], int] = {}

    def node(self, level: int, if_works: int, if_fails: int) -> int:
        if if_works == if_fails:
            return if_works
        key = (level, if_works, if_fails)
        if key not in self.known:
            if len(self.nodes) >= MOST_NODES:
                raise ValueError(
                    f"structure = {shown(self.structure)}: it needs a decision diagram of more "
                    f"than {MOST_NODES:,} nodes"
                )
            self.known[key] = len(self.nodes)
            self.nodes.append(key)
        return self.known[key]

    def at_least(self, k: int, levels: Sequence[int]) -> int:
        """Fails unless k of the units at these levels, which rise, work."""
        # row[j]: the units from here on must still give j that work
        row = [WORKS] + [FAILS] * k
        for level in reversed(levels):
            row = [WORKS] + [self.node(level, row[j - 1], row[j]) for j in range(1, k + 1)]
        return row[k]

    def joined(self, parts: Iterable[int], *, either: bool) -> int:
        """Fails if one of the parts fails (either), or only if all of them do.

        The last ones are joined first, so that an earlier unit goes on top of what is there.
        """
        return reduce(lambda below, one: self._pair(one, below, either), reversed(list(parts)))

    def expression(self, expression: Expression) -> int:
        """Fails as the last line of an expression says; its parts are built once."""
        known = {
            name: self.node(level, WORKS, FAILS) for level, name in enumerate(expression.names)
        }
        for name, part in expression.parts.items():
            known[name] = self._node_of(part, known)
        return self._node_of(expression.system, known)

    def _node_of(self, node: ast.expr, known: dict[str, int]) -> int:
        if isinstance(node, ast.Name):
            return known[node.id]
        k, below = branches(node)
        parts = [self._node_of(one, known) for one in below]
        if k in (1, len(parts)):
            return self.joined(parts, either=k > 1)
        row = [WORKS] + [FAILS] * k
        for part in reversed(parts):
            # j more must work: either this part does, or all of them are still to come
            row = [WORKS] + [
                self._pair(self._pair(part, row[j], False), row[j - 1], True)
                for j in range(1, k + 1)
            ]
        return row[k]

    def _pair(self, first: int, second: int, either: bool) -> int:
        """Join two diagrams, without recursion since they may have many levels."""
        decided, passed = (FAILS, WORKS) if either else (WORKS, FAILS)
        found: dict[tuple[int, int], int] = {}

        def known(a: int, b: int) -> int | None:
            if decided in (a, b):
                return decided
            if b in (a, passed):
                return a
            return b if a == passed else found.get((min(a, b), max(a, b)))

        waiting = [(first, second)]
        while waiting:
            a, b = waiting[-1]
            if known(a, b) is None:
                level = min(self.nodes[a][0], self.nodes[b][0])
                ways = [self._next(a, level), self._next(b, level)]
                below = list(zip(*ways, strict=True))
                results = [known(*pair) for pair in below]
                if None in results:
                    waiting.extend(pair for pair in below if known(*pair) is None)
                    continue
                if_works, if_fails = results
                assert if_works is not None
                assert if_fails is not None
                found[min(a, b), max(a, b)] = self.node(level, if_works, if_fails)
            waiting.pop()
        joined = known(first, second)
        assert joined is not None
        return joined

    def _next(self, node: int, level: int) -> tuple[int, int]:
        own, if_works, if_fails = self.nodes[node]
        return (if_works, if_fails) if own == level else (node, node)

    def diagram(self, top: int, units: Sequence[int]) -> Diagram:
        """Return what can be reached from a node; `units` are those of the levels."""
        reached = {WORKS: WORKS, FAILS: FAILS}
        waiting = [top]
        while waiting:
            node = waiting.pop()
            if node not in reached:
                reached[node] = len(reached)
                waiting.extend(self.nodes[node][1:])
        by_level: dict[int, list[int]] = {}
        for node in reached:
            if node > FAILS:
                by_level.setdefault(self.nodes[node][0], []).append(node)
        levels = tuple(
            (
                units[level],
                np.array([reached[node] for node in by_level[level]]),
                np.array([reached[self.nodes[node][1]] for node in by_level[level]]),
                np.array([reached[self.nodes[node][2]] for node in by_level[level]]),
            )
            for level in sorted(by_level, reverse=True)
        )
        return Diagram(len(reached), reached[top], levels)
