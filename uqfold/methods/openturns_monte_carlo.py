"""Monte Carlo by OpenTURNS' own simulation algorithm, on the system as one event."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from functools import partial
from typing import Any, ClassVar

import numpy as np

from uqfold.checks import keep, real, whole
from uqfold.evaluation import TimeLimitError
from uqfold.inputs.engine import openturns
from uqfold.inputs.interrupts import DeferredInterrupt
from uqfold.methods.base import ReliabilityMethod, UnitsMayDiffer
from uqfold.methods.counted import counted
from uqfold.methods.openturns_stream import RandomStream
from uqfold.methods.result import Estimate
from uqfold.methods.system_sample import BLOCK_VALUES, too_large
from uqfold.methods.task import Solution, Task, attempt
from uqfold.methods.theory import Theory
from uqfold.methods.theory_of_simulation import OPENTURNS_MONTE_CARLO
from uqfold.problems.base import Problem
from uqfold.problems.criterion import Binomial, Criterion
from uqfold.system.event import SystemEvent

BLOCKS_OF_RANDOM_COST = 8
"""With a random number of missions a budget is cut into at least this many blocks, because only a
block that fits even if all its missions are flown can be started."""


@dataclass(frozen=True)
class SimulationRun:
    """What OpenTURNS simulated for one criterion.

    Attributes
    ----------
    criterion
        The criterion.
    n_samples
        Systems simulated.
    failures, open_samples
        How many of them failed, and how many a failed run left open (these are among `failures`).
    block_size
        Systems per block, after which the stopping rule is tested.
    """

    criterion: Criterion
    n_samples: int
    failures: int
    open_samples: int
    block_size: int


@dataclass(frozen=True)
class SimulationDetails:
    """The runs of all criteria that could be simulated, in order."""

    runs: tuple[SimulationRun, ...]


@dataclass(frozen=True)
class OpenTURNSMonteCarlo(ReliabilityMethod):
    """Monte Carlo simulation of the system event by OpenTURNS, with its own stopping rule.

    Each criterion is simulated by itself (`ProbabilitySimulationAlgorithm` with
    `MonteCarloExperiment`) until the coefficient of variation of pf falls to `target_cov` or the
    samples run out; as long as all samples have the same outcome, OpenTURNS goes on. The random
    stream depends on the seed and on the criterion alone, not on its neighbours in the grid.

    What is left of `max_evals` is split into equal shares for the criteria that are left, so that
    an easy criterion leaves more for the later ones. The blocks are shortened until they fill the
    share; with a random number of missions, a new block starts only if it fits in the worst case.

    Attributes
    ----------
    target_cov
        Stop once the coefficient of variation is at most this; a row with more is ``doubtful``.
    block_size
        Systems per block; the stopping rule is tested after each block.
    max_samples
        Most systems per criterion where no budget is given. With a budget, the budget rules.

    Raises
    ------
    ValueError
        If a setting is out of range.

    Notes
    -----
    The interval is that of Clopper and Pearson (Biometrika 26 (1934) 404-413) at 95 %, a
    one-sided bound if all samples have the same outcome. It holds for a number of samples fixed
    beforehand; the stopping rule looks at the failures, so the interval is approximate, and so
    is the standard error. Where failed runs leave samples open, pf counts them as failed, and
    `pf_low` as safe.
    """

    name: ClassVar[str] = "openturns-mc"
    title: ClassVar[str] = "Monte Carlo (OpenTURNS)"
    theory: ClassVar[Theory] = OPENTURNS_MONTE_CARLO
    stochastic: ClassVar[bool] = True
    bounds_failed_runs: ClassVar[bool] = True
    any_structure: ClassVar[bool] = True
    units_may_differ: ClassVar[UnitsMayDiffer] = "in all"
    inputs_may_step: ClassVar[bool] = True

    target_cov: float = 0.1
    block_size: int = 200
    max_samples: int = 10_000

    def __post_init__(self) -> None:
        keep(self, "target_cov", real, above=0.0)
        keep(self, "block_size", whole, at_least=1)
        keep(self, "max_samples", whole, at_least=1)

    def supports(self, problem: Problem, criterion: Criterion) -> str | None:
        """Return why not, or None: the reasons of the base, and systems too large to be drawn."""
        return super().supports(problem, criterion) or too_large(self.name, problem, criterion)

    def _solve(self, task: Task) -> Solution:
        events = [SystemEvent(task.problem, criterion) for criterion in task.criteria]
        task.session.expect(sum(self.max_samples * event.max_evals_per_sample for event in events))
        runs: list[SimulationRun] = []

        def answer(event: SystemEvent, criteria_left: int) -> Estimate:
            session = task.session
            session.check_deadline()
            before = session.n_evals
            share = None if session.max_evals is None else session.remaining // criteria_left
            block_size, blocks = self._blocks(event, share)
            if block_size == 0:
                return Estimate.without_answer(
                    "failed",
                    f"one system can cost {event.max_evals_per_sample} runs, but the share of "
                    f"this criterion is {share}",
                )
            run, stopped = self._simulate(task, event, block_size, blocks, share)
            runs.append(run)
            return self._estimate(run, stopped, session.n_evals - before)

        estimates = [
            attempt(partial(answer, event, len(events) - i)) for i, event in enumerate(events)
        ]
        return Solution(estimates, SimulationDetails(tuple(runs)))

    def _blocks(self, event: SystemEvent, share: int | None) -> tuple[int, int]:
        """Size and largest number of blocks that a share of the budget allows."""
        values = event.max_evals_per_sample * event.problem.kinds.dimension
        longest = min(self.block_size, max(1, BLOCK_VALUES // values))
        if share is None:
            samples, most = self.max_samples, longest
        elif event.random_missions:
            # what a sample costs is not known beforehand: `_simulate` ends when the share does
            affordable = share // event.max_evals_per_sample
            samples, most = share, min(longest, -(-affordable // BLOCKS_OF_RANDOM_COST))
        else:
            samples, most = share // event.max_evals_per_sample, longest
        if samples == 0 or most == 0:
            return 0, 0
        blocks = -(-samples // most)
        return samples // blocks, blocks

    def _simulate(
        self, task: Task, event: SystemEvent, block_size: int, blocks: int, share: int | None
    ) -> tuple[SimulationRun, str]:
        """Run OpenTURNS on one event; also tell what cut it short."""
        ot = openturns()
        session = task.session
        limit = math.inf if share is None else session.n_evals + share
        n = failures = open_samples = 0
        raised: list[BaseException] = []
        deferred = DeferredInterrupt()
        stream = RandomStream(_seed(task.seed, event.criterion))

        def margins(u: Any) -> list[list[float]]:
            nonlocal n, failures, open_samples
            try:
                with stream.put_aside(), deferred.let_in():
                    low, high = event.margin_bounds(np.array(u), task.session.evaluate)
            except BaseException as error:
                # OpenTURNS turns it into a RuntimeError of its own
                raised.append(error)
                raise
            n += high.size
            failures += int((high > 0.0).sum())
            open_samples += int(((high > 0.0) & ~(low > 0.0)).sum())
            return [[value] for value in high.tolist()]

        def worst_block_does_not_fit() -> bool:
            return session.n_evals + block_size * event.max_evals_per_sample > limit

        with deferred:
            function = ot.PythonFunction(event.dimension, 1, func_sample=margins)
            inputs = ot.RandomVector(ot.JointDistribution([ot.Normal()] * event.dimension))
            algorithm = ot.ProbabilitySimulationAlgorithm(
                ot.ThresholdEvent(ot.CompositeRandomVector(function, inputs), ot.Greater(), 0.0),
                ot.MonteCarloExperiment(),
            )
            algorithm.setMaximumCoefficientOfVariation(self.target_cov)
            algorithm.setMaximumStandardDeviation(0.0)
            algorithm.setBlockSize(block_size)
            algorithm.setMaximumOuterSampling(blocks)
            algorithm.setStopCallback(worst_block_does_not_fit)
            with stream.drawn_from():
                try:
                    algorithm.run()
                except RuntimeError:
                    if not raised:
                        raise
                    if n == 0 or not isinstance(raised[0], TimeLimitError):
                        raise raised[0] from None
        run = SimulationRun(event.criterion, n, failures, open_samples, block_size)
        if raised:
            # the blocks before the wall-clock limit are an answer
            return run, str(raised[0])
        reported = algorithm.getResult().getProbabilityEstimate()
        if n == 0 or abs(reported - failures / n) > 1e-9:
            raise RuntimeError(
                f"OpenTURNS reports pf = {reported}, but {failures} of {n} samples failed"
            )
        return run, ""

    def _estimate(self, run: SimulationRun, stopped: str, n_evals: int) -> Estimate:
        high, low = run.failures, run.failures - run.open_samples
        said = [stopped] if stopped else []
        return replace(counted(run.n_samples, high, low, "converged", said), n_evals_row=n_evals)


def _seed(seed: int, criterion: Criterion) -> int:
    """Derive the 32-bit seed of one criterion's stream from the recorded seed."""
    missions = criterion.missions
    planned, p = (
        (missions.planned, missions.p) if isinstance(missions, Binomial) else (missions, -1.0)
    )
    tau = -1.0 if criterion.tau is None else criterion.tau
    # adding zero gives -0.0 the bits of 0.0
    key = np.array([criterion.threshold, tau, planned, p]) + 0.0
    sequence = np.random.SeedSequence(seed, spawn_key=tuple(key.view(np.uint32).tolist()))
    return int(sequence.generate_state(1)[0])
