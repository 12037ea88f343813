"""How the units of a system combine: which of them may fail.

The records only name the structure; the algebra that turns it into a probability is in
`uqfold.system`. All of them speak of one mission, and a system has to survive each of its
missions. A synchronization threshold needs `Series`.
"""

from __future__ import annotations

import ast
from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from typing import TypeAlias

from uqfold.checks import keep, listed, refused, text, whole


@dataclass(frozen=True)
class Series:
    """The system works when every unit works."""


@dataclass(frozen=True)
class Parallel:
    """The system works when at least one unit works."""


@dataclass(frozen=True)
class KOutOfN:
    """The system works when at least `k` of its units work."""

    k: int

    def __post_init__(self) -> None:
        keep(self, "k", whole, at_least=1)


@dataclass(frozen=True, init=False)
class CutSets:
    """The system fails when all units of at least one set (of unit indices from 0) fail."""

    sets: tuple[frozenset[int], ...]

    def __init__(self, sets: Iterable[Iterable[int]]) -> None:
        object.__setattr__(self, "sets", _sets_of_units(sets))


@dataclass(frozen=True, init=False)
class PathSets:
    """The system works when all units of at least one set (of unit indices from 0) work."""

    sets: tuple[frozenset[int], ...]

    def __init__(self, sets: Iterable[Iterable[int]]) -> None:
        object.__setattr__(self, "sets", _sets_of_units(sets))


@dataclass(frozen=True)
class Structure:
    """The system works when an expression of unit names is true, a name standing for "it works".

    ``&`` (or ``and``) joins what must work together, ``|`` (or ``or``) what can stand in for each
    other; ``&`` binds more tightly. ``at_least(k, a, b, ...)`` is true when k of its parts are. A
    unit without a name is called by its index: ``u0``, ``u1``, ... A unit may stand in several
    places; one that stands nowhere does not matter.

    Attributes
    ----------
    expression
        For instance ``"pump_a & pump_b | valve"``: both pumps must work, or the valve.

    Raises
    ------
    ValueError
        If the text is no such expression. There is no "not": a system that works because a unit
        fails has no place here.

    Examples
    --------
    >>> Structure("pump_a & pump_b | valve").names
    ('pump_a', 'pump_b', 'valve')
    """

    expression: str

    def __post_init__(self) -> None:
        keep(self, "expression", text)
        if "#" in self.expression:
            raise refused("expression", self.expression, "leave out #: no part may be a comment")
        try:
            list(_names_in(self))
        except (SyntaxError, RecursionError, MemoryError):
            why = "it cannot be read"
        except ValueError as error:
            why = str(error)
        else:
            return
        remedy = "give names joined by & and |, or at_least(k, ...), as in 'a & b | c'"
        raise refused("expression", self.expression, f"{why}; {remedy}")

    @property
    def names(self) -> tuple[str, ...]:
        """The units that it names, each once, in order of appearance."""
        return tuple(dict.fromkeys(_names_in(self)))


def syntax_tree(structure: Structure) -> ast.expr:
    """Return the expression as a tree of names and of what `branches` takes apart."""
    return ast.parse(structure.expression.strip(), mode="eval").body


def branches(node: ast.expr) -> tuple[int, list[ast.expr]]:
    """Return how many of the parts of a node must work, and these parts.

    Raises
    ------
    ValueError
        If it joins no parts as the expression of a `Structure` may.
    """
    if isinstance(node, ast.BinOp) and isinstance(node.op, ast.BitAnd | ast.BitOr):
        parts, joint = [], type(node.op)
        while isinstance(node, ast.BinOp) and isinstance(node.op, joint):
            parts.append(node.right)
            node = node.left
        parts.append(node)
        return (len(parts) if joint is ast.BitAnd else 1), parts[::-1]
    if isinstance(node, ast.BoolOp):
        return (len(node.values) if isinstance(node.op, ast.And) else 1), node.values
    if isinstance(node, ast.Call) and ast.unparse(node.func) == "at_least":
        if len(node.args) < 2 or node.keywords or not isinstance(node.args[0], ast.Constant):
            raise ValueError("at_least takes a number and the parts that it counts")
        k, *parts = node.args[0].value, *node.args[1:]
        if type(k) is not int or not 1 <= k <= len(parts):
            raise ValueError(f"at_least({k!r}, ...) counts {len(parts)} parts")
        return k, parts
    raise ValueError(f"{ast.unparse(node)!r} is no unit name")


def _names_in(structure: Structure) -> Iterator[str]:
    """Yield the units of an expression as often as they stand in it, from left to right."""
    waiting = [syntax_tree(structure)]
    while waiting:
        node = waiting.pop()
        if isinstance(node, ast.Name):
            yield node.id
        else:
            waiting.extend(reversed(branches(node)[1]))


SystemStructure: TypeAlias = Series | Parallel | KOutOfN | CutSets | PathSets | Structure


def checked_structure(structure: SystemStructure, names: tuple[str, ...]) -> SystemStructure:
    """Return a structure that fits units of these names.

    Raises
    ------
    TypeError, ValueError
        If it is none, or names units that the system does not have.
    """
    kinds = (Series, Parallel, KOutOfN, CutSets, PathSets, Structure)
    wanted = "give Series(), Parallel(), KOutOfN(k), CutSets(sets), PathSets(sets) or "
    if not isinstance(structure, kinds):
        raise refused("structure", structure, f"{wanted}Structure(expression)", TypeError)
    units = len(names)
    if isinstance(structure, KOutOfN) and structure.k > units:
        raise refused("structure", structure, f"it cannot hold for a system of {units} units")
    if isinstance(structure, CutSets | PathSets):
        largest = max(max(one) for one in structure.sets)
        if largest >= units:
            remedy = f"it names unit {largest}, but the system has {units} units, from 0"
            raise refused("structure", structure, remedy)
    if isinstance(structure, Structure):
        unknown = [name for name in structure.names if names.count(name) != 1]
        if unknown:
            remedy = f"{unknown[0]} is the name of {names.count(unknown[0])} units"
            raise refused("structure", structure, f"{remedy}; there are {', '.join(names)}")
    return structure


def _sets_of_units(sets: Iterable[Iterable[int]]) -> tuple[frozenset[int], ...]:
    frozen = tuple(
        frozenset(
            whole(f"a unit of sets[{i}]", unit, at_least=0)
            for unit in listed(f"sets[{i}]", one, what="set of unit indices", sets=True)
        )
        for i, one in enumerate(listed("sets", sets, what="list of sets", sets=True))
    )
    if not frozen or not all(frozen):
        raise refused("sets", sets, "give at least one set, none of them empty")
    return frozen
