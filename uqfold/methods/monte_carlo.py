"""Crude Monte Carlo: whole systems are drawn and simulated, mission by mission and unit by unit."""

from __future__ import annotations

import math
from collections import deque
from collections.abc import Iterator
from dataclasses import dataclass, field
from typing import ClassVar

import numpy as np

from uqfold.checks import keep, or_none, real, whole
from uqfold.evaluation import RunningEstimate, TimeLimitError
from uqfold.methods.base import ReliabilityMethod, UnitsMayDiffer
from uqfold.methods.clopper_pearson import clopper_pearson
from uqfold.methods.counted import LEVEL, counted
from uqfold.methods.result import Estimate, Status
from uqfold.methods.system_sample import (
    RUNS_WITHOUT_A_BUDGET,
    SystemBlock,
    block_systems,
    draw_systems,
    too_large,
)
from uqfold.methods.task import Solution, Task
from uqfold.methods.theory import Theory
from uqfold.methods.theory_of_simulation import MONTE_CARLO
from uqfold.problems.base import Problem
from uqfold.problems.criterion import Criterion
from uqfold.typing import FloatArray, IntArray

WITHOUT_A_BUDGET = 100_000
"""Systems to simulate when neither a number nor a budget is given."""


@dataclass(frozen=True)
class MonteCarloDetails:
    """What Monte Carlo counted.

    Attributes
    ----------
    n_systems
        Systems simulated.
    failures
        Failed systems of each criterion (n_criteria,), open ones (failed runs) counted as failed.
    history_systems, history_failures
        The same counts after each block: (n_blocks,) and (n_blocks, n_criteria).
    """

    n_systems: int
    failures: IntArray
    history_systems: IntArray
    history_failures: IntArray


@dataclass(frozen=True)
class MonteCarlo(ReliabilityMethod):
    """Crude Monte Carlo on the system itself; no approximation but sampling.

    Each system draws its shared inputs once and its individual inputs for every unit and every
    mission. All criteria of the grid are read off the same systems; a criterion of m missions
    uses the first m of them, a binomial one as many as its own draw says.

    Attributes
    ----------
    systems
        Systems to simulate; `max_evals` may allow fewer, then the status is
        ``budget_exhausted``. None: as many as `max_evals` pays for; without a budget 100,000, or
        what takes 5 million runs. One system costs n units times the most missions of the grid.
    target_cov
        Stop early once the coefficient of variation of every criterion is at most this; None:
        never. A row with a larger one, or with more than 10 % under None, is ``doubtful``.

    Raises
    ------
    ValueError
        If a setting is out of range.

    Notes
    -----
    The status is ``doubtful`` with fewer than ten failures, or fewer than ten systems that work.
    The interval is that of Clopper and Pearson (Biometrika 26 (1934) 404-413) at 95 %; without a
    failure it is the one-sided upper bound. With `target_cov` the stopping time depends on the
    failures, so the interval is then approximate. When the wall-clock limit of the evaluator is
    over, the systems that are complete make the answer.
    A system of half a million random numbers or more (missions x units x inputs) is
    ``unsupported``.
    """

    name: ClassVar[str] = "mc"
    title: ClassVar[str] = "Monte Carlo"
    theory: ClassVar[Theory] = MONTE_CARLO
    bounds_failed_runs: ClassVar[bool] = True
    any_structure: ClassVar[bool] = True
    units_may_differ: ClassVar[UnitsMayDiffer] = "in all"
    inputs_may_step: ClassVar[bool] = True

    systems: int | None = None
    target_cov: float | None = None

    def __post_init__(self) -> None:
        keep(self, "systems", or_none, whole, at_least=1)
        keep(self, "target_cov", or_none, real, above=0.0)

    @property
    def stochastic(self) -> bool:
        """Whether seeds matter: another one draws other systems."""
        return True

    def supports(self, problem: Problem, criterion: Criterion) -> str | None:
        """Return why not, or None: the reasons of the base, and systems too large to be drawn."""
        return super().supports(problem, criterion) or too_large(self.name, problem, criterion)

    def _solve(self, task: Task) -> Solution:
        session = task.session
        missions = max(c.max_missions for c in task.criteria)
        per_system = task.problem.n_units * missions
        affordable = session.remaining // per_system
        wanted = self.systems
        if wanted is None:
            most = min(WITHOUT_A_BUDGET, max(1, RUNS_WITHOUT_A_BUDGET // per_system))
            wanted = most if session.max_evals is None else affordable
        planned = min(wanted, affordable)
        if planned == 0:
            message = (
                f"one system costs {per_system} runs, max_evals = {session.max_evals} allows none"
            )
            return Solution([Estimate.without_answer("failed", message)] * len(task.criteria))
        session.expect(planned * per_system)
        counts = _Counts(len(task.criteria))
        drawn: deque[SystemBlock] = deque()

        def rows() -> Iterator[FloatArray]:
            most_at_once = block_systems(task.problem, task.criteria)
            for block, start in enumerate(range(0, planned, most_at_once)):
                session.check_time()
                size = min(most_at_once, planned - start)
                drawn.append(draw_systems(task.problem, task.criteria, task.generator(block), size))
                yield drawn[-1].x

        missing, stopped = wanted - planned, ""
        try:
            for y in session.stream(rows()):
                counts.add(*drawn.popleft().counts(y))
                if session.watched:
                    session.report(_running(task, counts))
                if self.target_cov is not None and counts.worst_cov() <= self.target_cov:
                    missing = 0
                    break
        except TimeLimitError as error:
            if drawn:  # of the block under way, the systems that are complete
                part = drawn.popleft().first(error.responses.size)
                if len(part.x):
                    counts.add(*part.counts(error.responses[: len(part.x)]))
            if counts.systems == 0:
                raise
            missing, stopped = wanted - counts.systems, str(error)
        estimates = [self._estimate(counts, i, missing, stopped) for i in range(len(task.criteria))]
        return Solution(estimates, counts.details())

    def _estimate(self, counts: _Counts, i: int, missing: int, stopped: str) -> Estimate:
        status: Status = "converged"
        messages = []
        if missing > 0:
            status = "budget_exhausted"
            messages.append(f"{counts.systems} of {counts.systems + missing} systems")
        if stopped:
            messages.append(stopped)
        return counted(counts.systems, int(counts.high[i]), int(counts.low[i]), status, messages)


@dataclass
class _Counts:
    """Running failure counts; `high` counts open systems as failed, `low` as safe."""

    n_criteria: int
    systems: int = 0
    high: IntArray = field(init=False)
    low: IntArray = field(init=False)
    history: list[tuple[int, IntArray]] = field(default_factory=list)

    def __post_init__(self) -> None:
        self.high = np.zeros(self.n_criteria, dtype=np.int64)
        self.low = np.zeros(self.n_criteria, dtype=np.int64)

    def add(self, size: int, high: IntArray, low: IntArray) -> None:
        self.systems += size
        self.high = self.high + high
        self.low = self.low + low
        self.history.append((self.systems, self.high))

    def cov(self, i: int) -> float:
        k, n = int(self.high[i]), self.systems
        return math.inf if k == 0 else math.sqrt((n - k) / (k * n))

    def worst_cov(self) -> float:
        return max(self.cov(i) for i in range(self.n_criteria))

    def details(self) -> MonteCarloDetails:
        return MonteCarloDetails(
            n_systems=self.systems,
            failures=self.high,
            history_systems=np.array([n for n, _ in self.history], dtype=np.int64),
            history_failures=np.array([k for _, k in self.history], dtype=np.int64),
        )


def _running(task: Task, counts: _Counts) -> RunningEstimate:
    """Return the state of the criterion that is least certain so far."""
    i = max(range(counts.n_criteria), key=counts.cov)
    n = counts.systems
    return RunningEstimate(
        criterion=str(task.criteria[i]),
        pf=int(counts.high[i]) / n,
        ci_low=clopper_pearson(int(counts.low[i]), n, LEVEL)[0],
        ci_high=clopper_pearson(int(counts.high[i]), n, LEVEL)[1],
    )
