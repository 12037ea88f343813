"""Whole systems drawn at random, for crude simulation: which rows to run, and who failed.

Each system draws its shared inputs once and its individual inputs for every unit and every
mission. All criteria are read off the same systems.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any, Protocol

import numpy as np

from uqfold.problems.base import Problem
from uqfold.problems.criterion import Binomial, Criterion, Missions
from uqfold.system.event import Worst
from uqfold.system.structure import SystemUnits
from uqfold.typing import BoolArray, FloatArray, IntArray

BLOCK_SYSTEMS = 4096
"""Most systems drawn from one random stream; part of the meaning of a seed."""
BLOCK_VALUES = 2**23
"""Random numbers of one block at most, so that its memory stays below about half a gigabyte; a
block of large systems holds fewer of them. Part of the meaning of a seed."""
LARGEST_SYSTEM = 500_000
"""A system of so many random numbers, or more, is not simulated."""
RUNS_WITHOUT_A_BUDGET = 5_000_000
"""Runs that a simulation may take where neither a size nor a budget is given."""
_FEW_THRESHOLDS = 16
"""Up to so many thresholds are compared one by one; for more of them the systems are sorted."""


def too_large(name: str, problem: Problem, criterion: Criterion) -> str | None:
    """Return why a method that simulates whole systems cannot answer a criterion, or None.

    Parameters
    ----------
    name
        Name of the method.
    problem, criterion
        What is asked.
    """
    missions, units = criterion.max_missions, problem.n_units
    values = missions * units * problem.kinds.dimension
    if values < LARGEST_SYSTEM:
        return None
    return (
        f"{name} would draw {values:,} random numbers for one system ({missions:,} missions of "
        f"{units:,} units), {LARGEST_SYSTEM:,} or more: ask for fewer missions or units, or take a "
        "method whose cost does not depend on them, such as ffni-pearson, kriging or pce"
    )


def block_systems(problem: Problem, criteria: Sequence[Criterion]) -> int:
    """Return how many systems are drawn from one random stream."""
    missions = max(c.max_missions for c in criteria)
    values = missions * problem.n_units * problem.kinds.dimension
    return max(1, min(BLOCK_SYSTEMS, BLOCK_VALUES // values))


@dataclass(frozen=True, eq=False)
class SystemBlock:
    """One block of systems: the rows to run, and what is needed to judge their responses.

    Attributes
    ----------
    criteria
        What is asked of them.
    x
        Inputs (n_rows, d) of the units that some criterion looks at.
    rows
        Which missions (size, missions) these are; each system flies its first ones.
    units
        The units and their structure.
    flown
        How many missions (size,) each mission profile looks at.
    """

    criteria: Sequence[Criterion]
    x: FloatArray
    rows: BoolArray
    units: SystemUnits
    flown: Mapping[Missions, IntArray]

    def first(self, n_rows: int) -> SystemBlock:
        """Return the systems whose rows are all among the first ones, perhaps none."""
        ends = np.cumsum(self.rows.sum(axis=1)) * self.units.count
        return self.take(np.arange(np.searchsorted(ends, n_rows, side="right")))

    def take(self, systems: IntArray) -> SystemBlock:
        """Return some of the systems, by their numbers, which ascend."""
        chosen = np.zeros(len(self.rows), dtype=bool)
        chosen[systems] = True
        x = self.x[np.repeat(chosen, self.rows.sum(axis=1) * self.units.count)]
        flown = {profile: count[systems] for profile, count in self.flown.items()}
        return SystemBlock(self.criteria, x, self.rows[systems], self.units, flown)

    @staticmethod
    def joined(blocks: Sequence[SystemBlock]) -> SystemBlock:
        """Return the systems of several blocks, one block after the other, as one."""
        first = blocks[0]
        x, rows = (np.concatenate([getattr(b, name) for b in blocks]) for name in ("x", "rows"))
        flown = {p: np.concatenate([b.flown[p] for b in blocks]) for p in first.flown}
        return SystemBlock(first.criteria, x, rows, first.units, flown)

    def margins(self, responses: FloatArray, *, missing_fails: bool) -> FloatArray:
        """Margin of each system under each criterion (n_criteria, size), see `Worst.margin`.

        Parameters as in `failed`.
        """
        worst = self._worst(responses, missing_fails)
        return np.array([worst[c.missions].margin(c.threshold, c.tau) for c in self.criteria])

    def failed(self, responses: FloatArray, *, missing_fails: bool) -> BoolArray:
        """Which systems fail each criterion (n_criteria, size).

        Parameters
        ----------
        responses
            Responses (n_rows,) to `x`; NaN marks failed runs.
        missing_fails
            Whether a mission with a failed run counts as failed, see `mission_fails`.
        """
        worst = self._worst(responses, missing_fails)
        return np.array([worst[c.missions].fails(c.threshold, c.tau) for c in self.criteria])

    def counts(self, responses: FloatArray) -> tuple[int, IntArray, IntArray]:
        """Systems, and failures of each criterion: open ones as failed, and as safe."""
        high = self._counted(responses, missing_fails=True)
        low = self._counted(responses, missing_fails=False) if np.isnan(responses).any() else high
        return len(self.rows), high, low

    def _counted(self, responses: FloatArray, *, missing_fails: bool) -> IntArray:
        """Count the failures of each criterion (n_criteria,)."""
        worst = self._worst(responses, missing_fails)
        found = np.empty(len(self.criteria), dtype=np.int64)
        for own in _alike(self.criteria):
            first = self.criteria[own[0]]
            of_system = worst[first.missions]
            if len(own) <= _FEW_THRESHOLDS:
                found[own] = [
                    of_system.fails(self.criteria[i].threshold, first.tau).sum() for i in own
                ]
                continue
            apart = np.zeros(1, dtype=bool)
            if first.tau is not None:
                apart = Worst(np.full_like(of_system.apart, -np.inf), of_system.apart).fails(
                    np.inf, first.tau
                )
            late = np.sort(np.where(apart, np.inf, of_system.late))
            thresholds = [self.criteria[i].threshold for i in own]
            beyond = late.size - np.searchsorted(late, thresholds, side="right")
            found[own] = np.maximum(beyond, np.count_nonzero(late == np.inf))
        return found

    def _worst(self, responses: FloatArray, missing_fails: bool) -> dict[Missions, Worst]:
        """Return the worst of each system (size,) under each mission profile."""
        y = responses.reshape(-1, self.units.count)
        missions = Worst.of_missions(y, missing_fails=missing_fails, units=self.units)
        size, most = self.rows.shape
        system = np.arange(size)
        # column k: the worst of the first k missions
        worst = np.full((2, size, most + 1), -np.inf)
        for running, one in zip(worst, (missions.late, missions.apart), strict=True):
            running[:, 1:][self.rows] = one
            np.maximum.accumulate(running, axis=1, out=running)
        return {profile: Worst(*worst[:, system, count]) for profile, count in self.flown.items()}


class NumberStream(Protocol):
    """Where the numbers of systems come from; `numpy.random.Generator` is one."""

    def standard_normal(self, shape: Any) -> FloatArray:
        """Return standard-normal numbers."""
        ...

    def random(self, shape: Any) -> FloatArray:
        """Return numbers between 0 and 1."""
        ...


def draw_systems(
    problem: Problem, criteria: Sequence[Criterion], rng: NumberStream, size: int
) -> SystemBlock:
    """Draw a block of systems.

    Parameters
    ----------
    problem
        Inputs, units and structure.
    criteria
        What will be asked of the systems; they fly as many missions as the longest of them.
    rng
        Stream of the block; asked for shared numbers, individual ones, and those of missions.
    size
        Number of systems.
    """
    inputs, missions = problem.kinds, max(c.max_missions for c in criteria)
    shape = (size, missions, problem.n_units)
    u = np.empty((*shape, inputs.dimension))
    u[..., : inputs.n_shared] = rng.standard_normal((size, 1, 1, inputs.n_shared))
    u[..., inputs.n_shared :] = rng.standard_normal((*shape, inputs.n_individual))
    chance = rng.random((size, missions))
    flown = {
        profile: _missions_flown(profile, chance)
        for profile in dict.fromkeys(c.missions for c in criteria)
    }
    # missions that no criterion looks at are drawn, to keep the stream in step, but not run
    longest = np.maximum.reduce(list(flown.values()))
    rows = np.arange(missions) < longest[:, None]
    x = inputs.rows(u)[rows].reshape(-1, inputs.columns)
    return SystemBlock(criteria, x, rows, SystemUnits.of(problem), flown)


def _missions_flown(missions: Missions, chance: FloatArray) -> IntArray:
    """Count the missions (size,) that a profile looks at."""
    if isinstance(missions, Binomial):
        return np.asarray((chance[:, : missions.planned] < missions.p).sum(axis=1), dtype=np.int64)
    return np.full(len(chance), missions, dtype=np.int64)


def _alike(criteria: Sequence[Criterion]) -> Iterator[list[int]]:
    """Return the criteria that differ in the threshold alone, by index."""
    groups: dict[tuple[Missions, float | None], list[int]] = {}
    for i, criterion in enumerate(criteria):
        groups.setdefault((criterion.missions, criterion.tau), []).append(i)
    yield from groups.values()
