"""The runs behind a response surface: as many as settings, budget and time allow."""

from __future__ import annotations

from collections.abc import Generator, Sequence
from dataclasses import dataclass, replace

import numpy as np

from uqfold.evaluation import BudgetExceededError, TimeLimitError
from uqfold.methods.result import Estimate
from uqfold.methods.task import Solution, Task
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

    def with_more(self, u: FloatArray, y: FloatArray) -> DesignRuns:
        """Return the same with further runs that were asked for."""
        return replace(
            self,
            u=np.concatenate([self.u, u]),
            y=np.concatenate([self.y, y]),
            asked=self.asked + y.size,
        )

    def without_surface(self, task: Task, of_units: str = "") -> Solution:
        """Answer where hardly any response is finite; if all are the same infinity, it decides.

        Of units among others, which are named, it does not decide.
        """
        if np.isinf(self.y).all() and np.unique(self.y).size == 1 and not of_units:
            return Solution([_infinite(criterion, self) for criterion in task.criteria])
        message = (
            f"{of_units}only {int(self.finite.sum())} of {self.y.size} responses are finite: too "
            f"few for a surface over {self.u.shape[1]} inputs"
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
    """How many runs the designs may have: what is asked for, or what the budget allows.

    Raises
    ------
    BudgetExceededError
        If the budget does not allow the `least` runs that the fits need.
    """
    allowed = min(asked, task.session.remaining)
    if allowed < least:
        limit = f"max_evals = {task.session.max_evals}" if asked >= least else f"runs = {asked}"
        counts = " and ".join(str(inputs.dimension) for inputs in task.problem.kinds.inputs)
        surfaces = "a surface" if len(task.problem.kinds.models) == 1 else "surfaces"
        raise BudgetExceededError(
            f"{limit}, but {surfaces} over {counts} inputs needs at least {least} runs: raise it"
        )
    task.session.expect(allowed)
    return allowed


def design_runs(
    task: Task, u: Sequence[FloatArray], asked: Sequence[int], least: Sequence[int]
) -> Generator[FloatArray, FloatArray, list[DesignRuns]]:
    """Ask for the runs of designs whose first points are smaller designs of the same sort.

    Parameters
    ----------
    task
        Problem and session.
    u
        Points (n, d) in standard-normal space, of each kind of units.
    asked
        How many runs the settings ask for, of each kind.
    least
        Runs that a fit needs, of each kind.

    Raises
    ------
    TimeLimitError
        If the wall-clock limit leaves fewer runs than that.
    """
    stopped = ""
    try:
        y = yield from runs_of_kinds(task, u)
    except TimeLimitError as error:
        stopped, y = str(error), sorted_out(u, error.responses)
        if any(found.size < few for found, few in zip(y, least, strict=True)):
            raise
    return [
        DesignRuns(points[: found.size], found, count, stopped)
        for points, found, count in zip(u, y, asked, strict=True)
    ]


def runs_of_kinds(
    task: Task, u: Sequence[FloatArray]
) -> Generator[FloatArray, FloatArray, list[FloatArray]]:
    """Ask for the responses (n,) at points (n, d) of each kind of units, all at once.

    The kinds take turns, so that the first runs are as many of each as its share.

    Raises
    ------
    TimeLimitError
        If the wall-clock limit is over before the last of them.
    """
    kinds = task.problem.kinds
    x = np.concatenate(
        [
            kinds.rows_of(kind, inputs.from_standard_normal(points))
            for kind, (inputs, points) in enumerate(zip(kinds.inputs, u, strict=True))
        ]
    )
    y = yield x[_turns(u)]
    return sorted_out(u, y)


def _turns(u: Sequence[FloatArray]) -> IntArray:
    """Order in which the joined points of all kinds are run."""
    shares = [(np.arange(len(points)) + 0.5) / max(len(points), 1) for points in u]
    return np.argsort(np.concatenate(shares), kind="stable")


def sorted_out(u: Sequence[FloatArray], y: FloatArray) -> list[FloatArray]:
    """Return the responses of each kind from the first ones of all turns."""
    kinds = np.repeat(np.arange(len(u)), [len(points) for points in u])[_turns(u)]
    return [y[kinds[: y.size] == kind] for kind in range(len(u))]


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
