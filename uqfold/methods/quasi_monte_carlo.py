"""Randomised quasi-Monte Carlo: whole systems at points spread evenly, several times over."""

from __future__ import annotations

import math
from collections import deque
from collections.abc import Iterator
from dataclasses import dataclass, field
from functools import cached_property
from typing import TYPE_CHECKING, ClassVar

import numpy as np

from uqfold.checks import keep, or_none, real, whole
from uqfold.evaluation import RunningEstimate, TimeLimitError
from uqfold.methods.base import ReliabilityMethod, UnitsMayDiffer
from uqfold.methods.repetitions import FEWEST
from uqfold.methods.result import TARGET_COV, Estimate
from uqfold.methods.scrambled_counts import ScrambledCounts
from uqfold.methods.system_sample import (
    BLOCK_SYSTEMS,
    RUNS_WITHOUT_A_BUDGET,
    SystemBlock,
    block_systems,
    draw_systems,
    too_large,
)
from uqfold.methods.task import Solution, Task
from uqfold.methods.theory import Theory
from uqfold.methods.theory_of_repetitions import QUASI_MONTE_CARLO
from uqfold.problems.base import Problem
from uqfold.problems.criterion import Binomial, Criterion
from uqfold.typing import FloatArray

if TYPE_CHECKING:
    from scipy.stats.qmc import Sobol

WITHOUT_A_BUDGET = 2**12
"""Points of a randomisation where neither a number, a budget nor a target is given."""
FIRST = 2**7
"""Points of a randomisation to begin with; they are doubled until they are enough."""
BITS = 40
"""Binary digits of a point: with the half of a cell added, tails are drawn to 1e-12."""


@dataclass(frozen=True)
class QuasiMonteCarloDetails:
    """What each randomisation found.

    Attributes
    ----------
    points
        Systems of each.
    dimension
        Numbers that a point consists of.
    pf
        Estimates (R, n_criteria), open systems (failed runs) counted as failed.
    """

    points: int
    dimension: int
    pf: FloatArray


@dataclass(frozen=True)
class QuasiMonteCarlo(ReliabilityMethod):
    """Monte Carlo on the system itself with scrambled Sobol' points in the place of random numbers.

    A system is a point in the unit cube of all its numbers: shared inputs, individual inputs of
    every unit and mission, and those that say how many missions are flown. Points of a Sobol'
    sequence fill the cube evenly; each of several independent scramblings makes one estimate
    without bias, and their spread is the error of the mean. All criteria are read off the same
    systems.

    Attributes
    ----------
    points
        Systems of each randomisation, rounded up to a power of two; `max_evals` may allow fewer,
        then the status is ``budget_exhausted``. None: as many as `max_evals` pays for; without a
        budget 4,096, or what `target_cov` takes.
    randomisations
        Independent scramblings; up to twice as many where a budget pays for them, but not for
        twice the points.
    target_cov
        Stop early once the relative standard error of every criterion is at most this, for sure;
        None: never. A row with a larger one, or with more than 10 % under None, is ``doubtful``.

    Raises
    ------
    ValueError
        If a setting is out of range.

    Notes
    -----
    The interval is that of Student's t for the logarithm of pf, or of the reliability where that
    is smaller; the spread is taken as half a system in each randomisation at least. With fewer
    than ten failures, or systems that work, it is that of Clopper and Pearson, and the row is
    ``doubtful``. So it is where the randomisations do not scatter like normal numbers. A system of
    more than 21,201 numbers, the dimensions of the sequence, is ``unsupported``.
    """

    name: ClassVar[str] = "qmc"
    title: ClassVar[str] = "Quasi-Monte Carlo"
    theory: ClassVar[Theory] = QUASI_MONTE_CARLO
    bounds_failed_runs: ClassVar[bool] = True
    any_structure: ClassVar[bool] = True
    units_may_differ: ClassVar[UnitsMayDiffer] = "in all"
    inputs_may_step: ClassVar[bool] = True
    stochastic: ClassVar[bool] = True

    points: int | None = None
    randomisations: int = 16
    target_cov: float | None = None

    def __post_init__(self) -> None:
        keep(self, "points", or_none, whole, at_least=1)
        keep(self, "randomisations", whole, at_least=FEWEST)
        keep(self, "target_cov", or_none, real, above=0.0)

    def supports(self, problem: Problem, criterion: Criterion) -> str | None:
        """Return why not, or None: the reasons of the base, and more numbers than dimensions."""
        from scipy.stats.qmc import Sobol

        reason = super().supports(problem, criterion) or too_large(self.name, problem, criterion)
        numbers = dimension_of(problem, [criterion])
        if reason is None and numbers > Sobol.MAXDIM:
            return (
                f"a system takes {numbers:,} numbers, a Sobol' point has {Sobol.MAXDIM:,} at most"
            )
        return reason

    def _solve(self, task: Task) -> Solution:
        session, per_system = task.session, self._runs_per_system(task)
        wanted, planned, repeats = self._sizes(task)
        if planned < 1:
            message = (
                f"{self.randomisations} systems, one of each randomisation, cost "
                f"{self.randomisations * per_system} runs, max_evals = {session.max_evals}"
            )
            return Solution([Estimate.without_answer("failed", message)] * len(task.criteria))
        session.expect(planned * repeats * per_system)
        counts = np.zeros((2, repeats, len(task.criteria)))
        sequences = [Scrambled(task, repeat) for repeat in range(repeats)]
        points, stopped = 0, ""
        try:
            while points < planned:
                more = min(planned - points, max(points, FIRST))
                counts = counts + self._counted(task, sequences, more)
                points += more
                sums = [
                    ScrambledCounts(points, counts[0, :, i], counts[1, :, i])
                    for i in range(counts.shape[2])
                ]
                if session.watched:
                    session.report(_running(task, sums))
                if self.target_cov is not None and all(s.precise(self.target_cov) for s in sums):
                    wanted = points
                    break
        except TimeLimitError as error:
            if points == 0:
                raise
            stopped = str(error)
        short = [stopped] if stopped else []
        if points < wanted:
            short.insert(0, f"{points} of {wanted} points of each randomisation")
        target = TARGET_COV if self.target_cov is None else self.target_cov
        estimates = [one.estimate(target, short) for one in sums]
        dimension = dimension_of(task.problem, task.criteria)
        return Solution(estimates, QuasiMonteCarloDetails(points, dimension, counts[0] / points))

    def _runs_per_system(self, task: Task) -> int:
        return task.problem.n_units * max(c.max_missions for c in task.criteria)

    def _sizes(self, task: Task) -> tuple[int, int, int]:
        """Points wanted of each randomisation, points planned, and randomisations."""
        budget, repeats = task.session.max_evals, self.randomisations
        most = RUNS_WITHOUT_A_BUDGET if budget is None else task.session.remaining
        systems = most // self._runs_per_system(task)
        affordable = _power_of_two(systems // repeats)
        if self.points is not None:
            wanted = 1 << math.ceil(math.log2(self.points))
            return wanted, min(wanted, affordable if budget is not None else wanted), repeats
        if budget is None and self.target_cov is None:
            affordable = min(affordable, WITHOUT_A_BUDGET)
        elif self.target_cov is None and affordable:
            repeats = min(2 * repeats - 1, systems // affordable)
        return affordable, affordable, repeats

    def _counted(self, task: Task, sequences: list[Scrambled], more: int) -> FloatArray:
        """Count the failures (2, R, n_criteria) among the next points of each randomisation."""
        found = np.zeros((2, len(sequences), len(task.criteria)))
        drawn: deque[tuple[int, SystemBlock]] = deque()

        def rows() -> Iterator[FloatArray]:
            for repeat, sequence in enumerate(sequences):
                for block in sequence.blocks(more):
                    drawn.append((repeat, block))
                    yield block.x

        for y in task.session.stream(rows()):
            repeat, block = drawn.popleft()
            _, high, low = block.counts(y)
            found[0, repeat] += high
            found[1, repeat] += low
        return found


def dimension_of(problem: Problem, criteria: list[Criterion] | tuple[Criterion, ...]) -> int:
    """Return how many numbers make a system that serves some criteria."""
    missions, kinds = max(c.max_missions for c in criteria), problem.kinds
    flown = missions if any(isinstance(c.missions, Binomial) for c in criteria) else 0
    return kinds.n_shared + missions * problem.n_units * kinds.n_individual + flown


class Scrambled:
    """Systems of one randomisation, one block after the other.

    Parameters
    ----------
    task
        Problem, criteria and seed.
    repeat
        Number of the randomisation.
    """

    def __init__(self, task: Task, repeat: int) -> None:
        self._task, self._repeat = task, repeat

    @cached_property
    def _sequence(self) -> Sobol:
        from scipy.stats.qmc import Sobol

        dimension = max(1, dimension_of(self._task.problem, self._task.criteria))
        return Sobol(dimension, bits=BITS, rng=self._task.generator(self._repeat))

    def blocks(self, more: int) -> Iterator[SystemBlock]:
        """Yield the next systems."""
        problem, criteria = self._task.problem, self._task.criteria
        at_once = _power_of_two(min(BLOCK_SYSTEMS, block_systems(problem, criteria)))
        for start in range(0, more, at_once):
            self._task.session.check_time()
            size = min(at_once, more - start)
            numbers = Numbers(self._sequence.random(size) + 0.5 * 0.5**BITS)
            yield draw_systems(problem, criteria, numbers, size)


@dataclass(eq=False)
class Numbers:
    """Points (N, D) of the open unit cube, handed out column by column as random numbers."""

    points: FloatArray
    _used: int = field(default=0, init=False)

    def random(self, shape: tuple[int, ...]) -> FloatArray:
        """Return the next numbers (N, ...) between 0 and 1; zeros when none are left."""
        width = math.prod(shape[1:])
        found = self.points[:, self._used : self._used + width]
        self._used += width
        return found.reshape(shape) if found.shape[1] == width else np.zeros(shape)

    def standard_normal(self, shape: tuple[int, ...]) -> FloatArray:
        """Return the next numbers (N, ...) as standard-normal ones."""
        from scipy.special import ndtri

        return np.asarray(ndtri(self.random(shape)))


def _power_of_two(most: int) -> int:
    """Return the largest power of two that is not more; 0 if there is none."""
    return 1 << (most.bit_length() - 1) if most > 0 else 0


def _running(task: Task, sums: list[ScrambledCounts]) -> RunningEstimate:
    """Return the state of the criterion with the fewest failures."""
    i = min(range(len(sums)), key=lambda i: sums[i].fewest)
    one = sums[i].estimate(TARGET_COV, [])
    return RunningEstimate(str(task.criteria[i]), one.pf, one.ci_low, one.ci_high)
