"""Decision diagrams: when a system fails, for any monotone structure.

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

from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
from functools import lru_cache, reduce
from typing import TypeAlias

import numpy as np

from uqfold.checks import refused
from uqfold.problems.expression import Expression, Gate, Term, read
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
"""A structure whose building takes more nodes than this is refused."""
_FEW_NODES = 20_000
"""So many are tried first, in each order of the units."""
_MOST_VALUES = 1 << 22
"""Values of nodes held at once: bounds memory."""

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


def diagram(structure: SystemStructure, names: tuple[str, ...]) -> Diagram:
    """Build the diagram of a structure of units with these names.

    Raises
    ------
    ValueError
        If it takes more than `MOST_NODES` nodes.
    """
    found = _built(structure, names)
    if found is None:
        raise refused(
            "structure",
            structure,
            f"it needs a decision diagram of more than {MOST_NODES:,} nodes; name first the units "
            "that many parts have in common, or let the model of one unit return what a part "
            "makes of its responses",
        )
    return found


@lru_cache(maxsize=16)
def _built(structure: SystemStructure, names: tuple[str, ...]) -> Diagram | None:
    """Try every order of the units, with few nodes first: the size hangs on it."""
    expression = _expression(structure, names)
    orders = dict.fromkeys(expression.order(units_first=first) for first in (True, False))
    for most in (min(_FEW_NODES, MOST_NODES), MOST_NODES):
        for order in orders:
            try:
                return _Builder(order, most).built(expression, names)
            except _TooManyNodesError:
                continue
    return None


def _expression(structure: SystemStructure, names: tuple[str, ...]) -> Expression:
    """Write a structure as gates."""
    if isinstance(structure, CutSets | PathSets):
        cuts = isinstance(structure, CutSets)
        sets = sorted(sorted(one) for one in structure.sets)
        parts = [tuple(names[i] for i in one) for one in sets]
        gates = [Gate(1 if cuts else len(one), one) for one in parts]
        every = Gate(len(gates) if cuts else 1, tuple(range(len(gates))))
        return Expression((*gates, every), len(gates))
    if isinstance(structure, Series | Parallel | KOutOfN):
        few = structure.k if isinstance(structure, KOutOfN) else 1
        return Expression((Gate(len(names) if isinstance(structure, Series) else few, names),), 0)
    return read(structure.expression)


class _TooManyNodesError(Exception):
    """A diagram grows beyond what was allowed."""


class _Builder:
    """Nodes of diagrams over the same order of units, each kept once."""

    def __init__(self, order: Sequence[str], most: int) -> None:
        self.order, self.most = order, most
        # level, next node if the unit works, and if it fails; the ends lie below all levels
        self.nodes: list[tuple[int, int, int]] = [(1 << 62, 0, 0), (1 << 62, 1, 1)]
        self.known: dict[tuple[int, int, int], int] = {}

    def built(self, expression: Expression, names: Sequence[str]) -> Diagram:
        """Build each gate once, and return the diagram of the system."""
        levels = {name: level for level, name in enumerate(self.order)}
        found: list[int] = []

        def top(part: Term) -> int:
            return self.node(levels[part], WORKS, FAILS) if isinstance(part, str) else found[part]

        for k, parts in ((gate.k, gate.parts) for gate in expression.gates):
            units = sorted({levels[one] for one in parts if isinstance(one, str)})
            alone = len(units) == len(parts)
            found.append(self.units(k, units) if alone else self.joined(k, map(top, parts)))
        index = {name: unit for unit, name in enumerate(names)}
        return self.diagram(top(expression.system), [index[name] for name in self.order])

    def node(self, level: int, if_works: int, if_fails: int) -> int:
        if if_works == if_fails:
            return if_works
        key = (level, if_works, if_fails)
        if key not in self.known:
            if len(self.nodes) >= self.most:
                raise _TooManyNodesError
            self.known[key] = len(self.nodes)
            self.nodes.append(key)
        return self.known[key]

    def units(self, k: int, levels: Sequence[int]) -> int:
        """Fails unless k of the units at these levels, which rise, work."""
        # row[j]: the units from here on must still give j that work
        row = [WORKS] + [FAILS] * k
        for above in reversed(range(len(levels))):
            # no more of them can be left, nor so few that those above cannot have worked
            for j in range(min(k, len(levels) - above), max(0, k - above - 1), -1):
                row[j] = self.node(levels[above], row[j - 1], row[j])
        return row[k]

    def joined(self, k: int, parts: Iterable[int]) -> int:
        """Fails unless k of the parts work.

        The lowest ones are joined first, so that an earlier unit goes on top of what is there.
        """
        tops = sorted(parts, key=lambda one: self.nodes[one][0], reverse=True)
        if k in (1, len(tops)):
            return reduce(lambda below, one: self._pair(one, below, k > 1), tops)
        row = [WORKS] + [FAILS] * k
        for part in tops:
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
