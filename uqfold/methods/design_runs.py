"""The runs behind a response surface: as many as settings, budget and time allow."""

from __future__ import annotations

from collections.abc import Generator
from dataclasses import dataclass

import numpy as np

from uqfold.evaluation import BudgetExceededError, TimeLimitError
from uqfold.methods.base import Solution, Task
from uqfold.methods.result import Estimate
from uqfold.problems.criterion import Criterion
from uqfold.system.conditional import system_failures
from uqfold.system.conditional_response import ConditionalResponse
from uqfold.system.lines import ALWAYS, FINITE, MISSING, NEVER
from uqfold.time_limit import check_time
from uqfold.typing import BoolArray, FloatArray, IntArray

_BLOCK = 8192
"""Points whose nearest run is sought between two looks at the clock."""


@dataclass(frozen=True, eq=False)
class DesignRuns:
    """Evaluations at the points of a design.

    Attributes
    ----------
    u
        Points (n, d) in standard-normal space.
    y
        Responses (n,): +-inf are valid, NaN are failed runs.
    asked
        How many runs the settings ask for.
    stopped
        Why there are fewer than planned, or less was made of them; empty if nothing stopped it.
    """

    u: FloatArray
    y: FloatArray
    asked: int
    stopped: str = ""

    @property
    def finite(self) -> BoolArray:
        """Which responses are finite (n,)."""
        return np.asarray(np.isfinite(self.y), dtype=bool)

    @property
    def complete(self) -> bool:
        """Whether all of them are."""
        return bool(self.finite.all())

    @property
    def failed(self) -> bool:
        """Whether a run failed: any response there, and with it any surface, is possible."""
        return bool(np.isnan(self.y).any())

    @property
    def fittable(self) -> bool:
        """Whether there are enough finite responses to fit a surface to."""
        return int(self.finite.sum()) > int(self.u.shape[1]) + 1

    def without_surface(self, task: Task) -> Solution:
        """Answer where hardly any response is finite; if all are the same infinity, it decides."""
        if np.isinf(self.y).all() and np.unique(self.y).size == 1:
            return Solution([_infinite(criterion, self) for criterion in task.criteria])
        message = (
            f"only {int(self.finite.sum())} of {self.y.size} responses are finite: too few for a "
            f"surface over {self.u.shape[1]} inputs"
        )
        if task.session.first_failure:
            message = f"{message}; {task.session.first_failure}"
        return Solution([Estimate.without_answer("failed", message)] * len(task.criteria))

    def outcomes(self, u: FloatArray) -> IntArray:
        """Kind of outcome at u (m, d): that of the nearest run."""
        from scipy.spatial import cKDTree

        kinds = np.select(
            [self.finite, np.isposinf(self.y), np.isneginf(self.y)],
            [FINITE, NEVER, ALWAYS],
            default=MISSING,
        )
        tree, nearest = cKDTree(self.u), np.empty(u.shape[0], dtype=np.int64)
        for start in range(0, u.shape[0], _BLOCK):
            check_time()
            nearest[start : start + _BLOCK] = tree.query(u[start : start + _BLOCK])[1]
        return np.asarray(kinds[nearest])


def affordable_runs(task: Task, asked: int, least: int) -> int:
    """How many runs a design may have: what is asked for, or what the budget allows.

    Raises
    ------
    BudgetExceededError
        If the budget does not allow the `least` runs that a fit needs.
    """
    allowed = min(asked, task.session.remaining)
    if allowed < least:
        limit = f"max_evals = {task.session.max_evals}" if asked >= least else f"runs = {asked}"
        raise BudgetExceededError(
            f"{limit}, but a surface over {task.problem.inputs.dimension} inputs needs at least "
            f"{least} runs: raise it"
        )
    task.session.expect(allowed)
    return allowed


def design_runs(
    task: Task, u: FloatArray, asked: int, least: int
) -> Generator[FloatArray, FloatArray, DesignRuns]:
    """Ask for the runs of a design whose first points are a smaller design of the same kind.

    Parameters
    ----------
    task
        Problem and session.
    u
        Points (n, d) in standard-normal space.
    asked
        How many runs the settings ask for.
    least
        Runs that a fit needs.

    Raises
    ------
    TimeLimitError
        If the wall-clock limit leaves fewer runs than that.
    """
    try:
        y = yield task.problem.inputs.from_standard_normal(u)
    except TimeLimitError as error:
        y = error.responses
        if y.size < least:
            raise
        return DesignRuns(u[: y.size], y, asked, str(error))
    return DesignRuns(u, y, asked)


def _infinite(criterion: Criterion, runs: DesignRuns) -> Estimate:
    """Answer where the model gave nothing but +inf, or nothing but -inf."""
    never = bool(runs.y[0] > 0.0)
    response = ConditionalResponse(None, p_never=float(never), p_always=float(not never))
    found = system_failures([response], [1.0], 1, [criterion])[0]
    return Estimate(
        pf=found.pf,
        reliability=found.reliability,
        status="doubtful",
        message=f"all {runs.y.size} responses are {runs.y[0]:+}",
    )
