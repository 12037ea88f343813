"""How the units of a system combine: which of them may fail.

The records only name the structure; the algebra that turns it into a probability is in
`uqfold.system`. All of them speak of one mission, and a system has to survive each of its
missions. A synchronization threshold needs `Series`.
"""

from __future__ import annotations

import os
from collections.abc import Iterable
from dataclasses import dataclass
from typing import TypeAlias

from uqfold.checks import keep, listed, refused, text, whole
from uqfold.problems.expression import read


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
    r"""The system works when an expression of unit names is true, a name standing for "it works".

    ``&`` (or ``and``) joins what must work together, ``|`` (or ``or``) what can stand in for each
    other; ``&`` binds more tightly. ``at_least(k, a, b, ...)`` is true when k of its parts are. A
    unit without a name is called by its index: ``u0``, ``u1``, ... A unit may stand in several
    places; one that stands nowhere does not matter. Lines ``name = expression`` above the last one
    name parts of it, which may stand in several places too.

    Attributes
    ----------
    expression
        For instance ``"pump_a & pump_b | valve"``: both pumps must work, or the valve.

    Raises
    ------
    ValueError
        If the text is not such an expression. There is no "not": a system that works because a unit
        fails has no place here.

    Examples
    --------
    >>> Structure("pump_a & pump_b | valve").names
    ('pump_a', 'pump_b', 'valve')
    >>> Structure("pumps = at_least(2, a, b, c)\npumps & valve | pumps & hatch").names
    ('a', 'b', 'c', 'valve', 'hatch')
    """

    expression: str

    def __post_init__(self) -> None:
        keep(self, "expression", text)
        try:
            read(self.expression)
        except ValueError as error:
            remedy = "give names joined by & and |, or at_least(k, ...), as in 'a & b | c'"
            raise refused("expression", self.expression, f"{error}; {remedy}") from None

    @property
    def names(self) -> tuple[str, ...]:
        """The units on which it depends, each once, in order of appearance."""
        return read(self.expression).names

    @classmethod
    def from_open_psa(cls, path: str | os.PathLike[str], top: str | None = None) -> Structure:
        """Read a fault tree in the Open-PSA Model Exchange Format.

        Basic events become units, whose models and inputs say how they fail: probabilities in the
        file are not read. A gate that fails by ``or`` works by ``&``, and so on; house events take
        their value. Names that Python cannot read as names get ``_`` for what is in the way.

        Parameters
        ----------
        path
            The XML file.
        top
            Name of the gate that is the failure of the system; None if there is one gate alone
            that no other uses.

        Raises
        ------
        ValueError
            If the file is not such a fault tree, has a gate that is not monotone (``not``, ``xor``,
            ...), uses a gate within itself, or leaves open which gate is meant.
        OSError
            If it cannot be read.

        Warns
        -----
        UserWarning
            If the file has groups of common-cause failures, which are not read: what units share
            belongs into ``shared=``.

        References
        ----------
        Epstein S, Rauzy A. Open-PSA Model Exchange Format, version 2.0 (2008).
        """
        from uqfold.problems.fault_tree import read_open_psa

        return cls(read_open_psa(path, top))


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
        both = sorted(read(structure.expression).named.keys() & set(names))
        if both:
            raise refused("structure", structure, f"{both[0]!r} is a part of it and a unit")
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
