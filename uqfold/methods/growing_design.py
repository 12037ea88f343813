"""Designs that grow, as far as the budget allows and the stated error asks for it."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np

from uqfold.evaluation import TimeLimitError
from uqfold.methods.deciding_points import AT_EACH, deciding_points, thresholds_looked_at
from uqfold.methods.design_runs import (
    DesignRuns,
    affordable_runs,
    design_runs,
    runs_of_kinds,
)
from uqfold.methods.fitted_kind import FittedKind
from uqfold.methods.response_surface import ErrorParts, SurfaceAnswers
from uqfold.methods.steps import Steps
from uqfold.methods.task import Solution, Task
from uqfold.surrogates.designs import space_filling_design
from uqfold.surrogates.warping import Warp
from uqfold.typing import FloatArray

FEWEST_RUNS, RUNS_PER_INPUT = 100, 5
"""The first design where the settings leave it open: so many runs, or so many for each input."""
STREAMS = 1_000
"""Streams of random numbers that a kind of units has to itself."""
# Streams of random numbers of a kind: points at its limits, and draws at them.
_LIMITS_STREAM, _HELD_STREAM = 500, 501
# How far beyond the target the stated error may be foreseen before growing is given up.
_FORESEEN = 3.0


def first_runs(asked: int | None, dimension: int, ceiling: int) -> int:
    """How many runs a design begins with: what is asked for, or what the inputs need."""
    if asked is not None:
        return asked
    return max(FEWEST_RUNS, min(RUNS_PER_INPUT * dimension, ceiling))


@dataclass
class Growth:
    """Doubles the runs of a method while this may bring its stated error to the target.

    Attributes
    ----------
    most
        Runs that there may be.
    """

    most: int
    _sizes: list[int] = field(default_factory=list)
    _shortfalls: list[float] = field(default_factory=list)

    @classmethod
    def of(cls, task: Task, asked: int | None, size: int, ceiling: int) -> Growth:
        """No growth where runs are asked for, nor where no budget is given."""
        budget = task.session.max_evals
        fixed = asked is not None or budget is None
        return cls(size if fixed else max(size, min(ceiling, budget or 0)))

    def next_size(self, runs: int, shortfall: float) -> int | None:
        """Return how many runs there are to be, or None: it is to end here.

        Parameters
        ----------
        runs
            How many there are.
        shortfall
            How many times its target the error is.
        """
        if shortfall <= 1.0:
            return None
        before, earlier = self._sizes[-1:], self._shortfalls[-1:]
        self._sizes.append(runs)
        self._shortfalls.append(shortfall)
        if runs >= self.most or (before and not math.isfinite(shortfall)):
            return None
        if before:
            gain = min(shortfall / earlier[0], 1.0)
            steps = math.log(self.most / runs) / math.log(runs / before[0])
            if shortfall * gain**steps > _FORESEEN:
                return None
        return min(2 * runs, self.most)


@dataclass(frozen=True, eq=False)
class Learned:
    """What was learned from the runs of a design.

    Attributes
    ----------
    task
        The task as the surfaces answer it, thresholds transformed.
    fitted
        The surface of each kind of units.
    answers
        Their answers.
    details
        Details of the solution, from where the stated errors come from.
    warp
        The transformation, or None.
    """

    task: Task
    fitted: Sequence[FittedKind]
    answers: SurfaceAnswers
    details: Callable[[ErrorParts], Any]
    warp: Warp | None = None

    @property
    def solution(self) -> Solution:
        """Answers and details."""
        return Solution(self.answers.estimates, self.details(self.answers.errors))

    def given(self, u: Sequence[FloatArray], y: Sequence[FloatArray]) -> Learned | None:
        """Return what is known with further runs at u (k, d) of each kind that were held out.

        None where a response y (k,) is not one that the surface could have foretold.
        """
        values = [found if self.warp is None else self.warp(found) for found in y]
        if not all(np.isfinite(found).all() for found in values):
            return None
        held = [
            one.held_out(points, found, self.task.generator(kind * STREAMS + _HELD_STREAM))
            for kind, (one, points, found) in enumerate(zip(self.fitted, u, values, strict=True))
        ]
        return replace(self, answers=self.answers.given(held))


def grown(
    task: Task,
    asked: int | None,
    ceiling: int,
    spread: float,
    answered: Callable[[Sequence[DesignRuns]], Learned],
) -> Steps:
    """Answer from space-filling designs, one for each kind of units, doubled while that may help.

    Where a budget allows more runs than are asked for, some are made at the limits that decide the
    answers, and the surfaces, which were not fitted to them, have to foretell them: what they are
    missed by is a part of the stated error. If that is then above its target, they join the design.

    Parameters
    ----------
    task
        Problem, criteria and budget.
    asked
        Runs, exactly, of all kinds together; None: as many as the inputs need, and more as far as a
        given budget allows.
    ceiling
        Most runs that a surface can bear.
    spread
        Standard deviation of the points.
    answered
        Learns from the runs of each kind.
    """
    kinds = task.problem.kinds
    dimensions = [inputs.dimension for inputs in kinds.inputs]
    needed = [first_runs(None, d, ceiling) for d in dimensions]
    least = [2 * d + 2 for d in dimensions]
    first = sum(needed) if asked is None else asked
    size = affordable_runs(task, first, sum(least))
    growth = Growth.of(task, asked, size, ceiling * len(dimensions))
    budget = task.session.max_evals
    checks = asked is None and budget is not None
    if checks:
        reserve = AT_EACH * len(thresholds_looked_at(task.criteria)) * len(dimensions)
        growth.most = max(size, min(growth.most, (budget or 0) - reserve))

    def designs(total: int) -> list[FloatArray]:
        # the same seeds: a smaller design is the beginning of a larger one
        return [
            space_filling_design(share, d, task.generator(kind * STREAMS), spread)
            for kind, (share, d) in enumerate(
                zip(divided(total, needed, least), dimensions, strict=True)
            )
        ]

    first_design = divided(first, needed, least)
    runs = yield from design_runs(task, designs(size), first_design, least)
    held = [DesignRuns(np.empty((0, d)), np.empty(0), 0) for d in dimensions]
    while True:
        for kind, one in enumerate(runs):
            if not one.fittable:
                return one.without_surface(task, kinds.said(kind, task.problem.unit_names))
        learned = answered(_together(runs, held))
        finished = any(one.stopped or not one.complete for one in runs)
        spent = sum(one.y.size for one in (*runs, *held))
        satisfied = learned.answers.shortfall <= 1.0
        more = None if finished else growth.next_size(spent, learned.answers.shortfall)
        if more is None and checks and not finished:
            u = _limits(task, learned)
            try:
                y = yield from runs_of_kinds(task, u)
            except TimeLimitError:
                return learned.solution
            held = [one.with_more(*own) for one, *own in zip(held, u, y, strict=True)]
            checked = learned.given(u, y)
            if checked is None:
                return answered(_together(runs, held)).solution
            learned, spent = checked, spent + sum(found.size for found in y)
            if satisfied:
                more = growth.next_size(spent, learned.answers.shortfall)
        size = (more or 0) - sum(one.y.size for one in held)
        if more is None or size < sum(one.y.size for one in runs) + len(runs):
            return learned.solution
        task.session.expect(more)
        u = designs(size)
        try:
            y = yield from runs_of_kinds(
                task, [points[one.y.size :] for points, one in zip(u, runs, strict=True)]
            )
        except TimeLimitError:
            return learned.solution
        runs = [
            DesignRuns(points, np.concatenate([one.y, new]), len(points))
            for points, one, new in zip(u, runs, y, strict=True)
        ]


def _together(runs: Sequence[DesignRuns], held: Sequence[DesignRuns]) -> list[DesignRuns]:
    return [one.with_more(more.u, more.y) for one, more in zip(runs, held, strict=True)]


def _limits(task: Task, learned: Learned) -> list[FloatArray]:
    """Points (k, d) of each kind, at the limits that decide the answers."""
    u = deciding_points(
        learned.task,
        learned.fitted,
        learned.answers.estimates,
        task.session.remaining,
        learned.task.generator(_LIMITS_STREAM),
    )
    task.session.expect(task.session.n_evals + sum(map(len, u)))
    return u


def divided(total: int, needed: Sequence[int], least: Sequence[int]) -> list[int]:
    """Return the runs of each kind of units: the least, and of the rest its share by need.

    A larger total gives no kind fewer runs; less than one run for each kind is left over.
    """
    rest = max(0, total - sum(least))
    return [few + rest * need // sum(needed) for few, need in zip(least, needed, strict=True)]
