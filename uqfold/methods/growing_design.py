"""Designs that grow, as far as the budget allows and the stated error asks for it."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, field

import numpy as np

from uqfold.evaluation import TimeLimitError
from uqfold.methods.base import Solution, Task
from uqfold.methods.design_runs import DesignRuns, affordable_runs, design_runs
from uqfold.methods.steps import Steps
from uqfold.surrogates.designs import space_filling_design

FEWEST_RUNS, RUNS_PER_INPUT = 100, 5
"""The first design where the settings leave it open: so many runs, or so many for each input."""
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
    answered: Callable[[DesignRuns], tuple[Solution, float]],
) -> Steps:
    """Answer from a space-filling design, which is doubled while that may help.

    Parameters
    ----------
    task
        Problem, criteria and budget.
    asked
        Runs, exactly; None: as many as the inputs need, and more as far as a given budget allows.
    ceiling
        Most runs that a surface can bear.
    spread
        Standard deviation of the points.
    answered
        Answers the task from the runs, and tells how many times its target the error is.
    """
    dimension = task.problem.inputs.dimension
    first, least = first_runs(asked, dimension, ceiling), 2 * dimension + 2
    size = affordable_runs(task, first, least)
    growth = Growth.of(task, asked, size, ceiling)
    u = space_filling_design(size, dimension, task.generator(), spread)
    runs = yield from design_runs(task, u, first, least)
    while True:
        if not runs.fittable:
            return runs.without_surface(task)
        solution, shortfall = answered(runs)
        more = growth.next_size(runs.y.size, shortfall)
        if runs.stopped or not runs.complete or more is None:
            return solution
        task.session.expect(more)
        # the same seed: the smaller design is the beginning of the larger one
        u = space_filling_design(more, dimension, task.generator(), spread)
        try:
            y = yield task.problem.inputs.from_standard_normal(u[runs.y.size :])
        except TimeLimitError:
            return solution
        runs = DesignRuns(u, np.concatenate([runs.y, y]), more)
