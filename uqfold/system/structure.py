"""From the failure of units to the failure of their system.

What their failures mean for it is a decision diagram (`uqfold.system.decision_diagram`); units
that are alike are told apart by nothing but their number.
"""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
from numpy.typing import ArrayLike

from uqfold.problems.base import Problem
from uqfold.problems.structure import Series
from uqfold.system.decision_diagram import Diagram, diagram
from uqfold.typing import FloatArray, IntArray

_TINY = 1e-300
"""Stands for 0 in a logarithm."""


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
            If the structure needs more than `uqfold.system.decision_diagram.MOST_NODES` nodes.
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
