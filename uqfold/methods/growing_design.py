"""Designs that grow, as far as the budget allows and the stated error asks for it."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field

import numpy as np

from uqfold.evaluation import TimeLimitError
from uqfold.methods.base import Solution, Task
from uqfold.methods.design_runs import (
    DesignRuns,
    affordable_runs,
    design_runs,
    runs_of_kinds,
)
from uqfold.methods.steps import Steps
from uqfold.surrogates.designs import space_filling_design
from uqfold.typing import FloatArray

FEWEST_RUNS, RUNS_PER_INPUT = 100, 5
"""The first design where the settings leave it open: so many runs, or so many for each input."""
STREAMS = 1_000
"""Streams of random numbers that a kind of units has to itself."""
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
        before, earlier = self._sizes[-1:], self._shortfalls[-1:]
        self._sizes.append(runs)
        self._shortfalls.append(shortfall)
        if shortfall <= 1.0 or runs >= self.most or (before and not math.isfinite(shortfall)):
            return None
        if before:
            gain = min(shortfall / earlier[0], 1.0)
            steps = math.log(self.most / runs) / math.log(runs / before[0])
            if shortfall * gain**steps > _FORESEEN:
                return None
        return min(2 * runs, self.most)


def grown(
    task: Task,
    asked: int | None,
    ceiling: int,
    spread: float,
    answered: Callable[[Sequence[DesignRuns]], tuple[Solution, float]],
) -> Steps:
    """Answer from space-filling designs, one for each kind of units, doubled while that may help.

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
        Answers the task from the runs of each kind, and tells how many times its target the error
        is.
    """
    kinds = task.problem.kinds
    dimensions = [inputs.dimension for inputs in kinds.inputs]
    needed = [first_runs(None, d, ceiling) for d in dimensions]
    least = [2 * d + 2 for d in dimensions]
    first = sum(needed) if asked is None else asked
    size = affordable_runs(task, first, sum(least))
    growth = Growth.of(task, asked, size, ceiling * len(dimensions))

    def designs(total: int) -> list[FloatArray]:
        # the same seeds: a smaller design is the beginning of a larger one
        return [
            space_filling_design(share, d, task.generator(kind * STREAMS), spread)
            for kind, (share, d) in enumerate(
                zip(divided(total, needed, least), dimensions, strict=True)
            )
        ]

    runs = yield from design_runs(task, designs(size), divided(first, needed, least), least)
    while True:
        for kind, one in enumerate(runs):
            if not one.fittable:
                return one.without_surface(
                    task, task.problem.kinds.said(kind, task.problem.unit_names)
                )
        solution, shortfall = answered(runs)
        spent = sum(one.y.size for one in runs)
        more = growth.next_size(spent, shortfall)
        finished = any(one.stopped or not one.complete for one in runs)
        if finished or more is None or spent + len(runs) > more:
            return solution
        task.session.expect(more)
        u = designs(more)
        try:
            y = yield from runs_of_kinds(
                task, [points[one.y.size :] for points, one in zip(u, runs, strict=True)]
            )
        except TimeLimitError:
            return solution
        runs = [
            DesignRuns(points, np.concatenate([one.y, new]), len(points))
            for points, one, new in zip(u, runs, y, strict=True)
        ]


def divided(total: int, needed: Sequence[int], least: Sequence[int]) -> list[int]:
    """Return the runs of each kind of units: the least, and of the rest its share by need.

    A larger total gives no kind fewer runs; less than one run for each kind is left over.
    """
    rest = max(0, total - sum(least))
    return [few + rest * need // sum(needed) for few, need in zip(least, needed, strict=True)]
