"""Conditional Monte Carlo: many responses for each draw of the shared inputs."""

from __future__ import annotations

import math
from collections import deque
from collections.abc import Iterator
from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from uqfold.checks import keep, or_none, whole
from uqfold.evaluation import TimeLimitError
from uqfold.methods.base import ReliabilityMethod, Solution, Task
from uqfold.methods.clopper_pearson import clopper_pearson
from uqfold.methods.result import Estimate, Status
from uqfold.methods.theory import Theory
from uqfold.methods.theory_of_simulation import CONDITIONAL_MONTE_CARLO
from uqfold.problems.criterion import Criterion
from uqfold.system.event import mission_fails
from uqfold.system.failure_counts import failure_by_count
from uqfold.typing import FloatArray, IntArray

BLOCK_DRAWS = 16
"""Shared draws of one block, stratified among themselves; part of the meaning of a seed."""
CHUNK_BLOCKS = 32
"""Blocks that are run together; has no influence on any number."""
WITHOUT_A_BUDGET = 256
"""Blocks when neither a number nor a budget is given."""
ARRANGEMENTS = 6
"""Ways in which the responses of a draw are put together to missions under tau."""
FEW = 10
"""Failures in fewer shared draws than this leave the stated error uncertain itself."""
ENOUGH_DRAWS = 25.0
"""Shared draws that an interval takes, as a multiple of the squared skewness of the draws."""
LEVEL = 0.95


@dataclass(frozen=True)
class ConditionalMonteCarloDetails:
    """What was drawn.

    Attributes
    ----------
    blocks
        Blocks, of `BLOCK_DRAWS` shared draws each.
    missions_per_draw
        Missions simulated for each shared draw.
    failing_draws
        Shared draws (n_criteria,) with at least one failure.
    """

    blocks: int
    missions_per_draw: int
    failing_draws: IntArray


@dataclass(frozen=True)
class ConditionalMonteCarlo(ReliabilityMethod):
    """Monte Carlo on the real model that uses the structure of the system, and nothing else.

    Units and missions are independent given the shared inputs. So each draw of the shared inputs
    gets several missions of responses, and all ways to choose among them the responses of one
    system are averaged (see `uqfold.system.failure_counts`), without bias and without a model of
    their distribution. Within a block the shared draws are stratified (Latin hypercube).

    Attributes
    ----------
    blocks
        Blocks of 16 shared draws; `max_evals` may allow fewer, then the status is
        ``budget_exhausted``. None: as many as `max_evals` pays for, 256 without a budget.
    missions_per_draw
        Missions simulated for each shared draw: at least this many, and at least as many as the
        criteria name.

    Raises
    ------
    ValueError
        If a setting is out of range.

    Notes
    -----
    The standard error comes from the spread of the block means, and the interval from Student's
    distribution, so that stratification is accounted for. The status is ``doubtful`` with failures
    in fewer than ten shared draws, or none, and where few draws carry pf or the reliability: draws
    too skewed for the interval of a mean. The interval then goes on to what shared inputs that no
    draw has shown may add, by the bound of Clopper and Pearson for as many systems as there are
    shared draws.
    """

    name: ClassVar[str] = "conditional-mc"
    title: ClassVar[str] = "Conditional Monte Carlo"
    theory: ClassVar[Theory] = CONDITIONAL_MONTE_CARLO
    bounds_failed_runs: ClassVar[bool] = True

    blocks: int | None = None
    missions_per_draw: int = 4

    def __post_init__(self) -> None:
        keep(self, "blocks", or_none, whole, at_least=2)
        keep(self, "missions_per_draw", whole, at_least=1)

    @property
    def stochastic(self) -> bool:
        """True: another seed draws other systems."""
        return True

    def _solve(self, task: Task) -> Solution:
        missions = max(self.missions_per_draw, *(c.max_missions for c in task.criteria))
        per_block = BLOCK_DRAWS * missions * task.problem.n_units
        affordable = task.session.remaining // per_block
        wanted = self.blocks
        if wanted is None:
            wanted = WITHOUT_A_BUDGET if task.max_evals is None else int(affordable)
        planned = int(min(wanted, affordable))
        if planned < 2:
            message = (
                f"two blocks, the fewest with a standard error, cost {2 * per_block} runs, "
                f"max_evals = {task.max_evals}: lower missions_per_draw or raise the budget"
            )
            return Solution([Estimate.without_answer("failed", message)] * len(task.criteria))
        task.expect(planned * per_block)
        sums = _Sums(task, missions)
        arrangements: deque[IntArray] = deque()

        def rows() -> Iterator[FloatArray]:
            for first in range(0, planned, CHUNK_BLOCKS):
                chunk = range(first, min(first + CHUNK_BLOCKS, planned))
                drawn = [_draw(task, missions, block) for block in chunk]
                arrangements.append(np.stack([ways for _, ways in drawn]))
                yield np.concatenate([x for x, _ in drawn])

        missing, stopped = wanted - planned, ""
        try:
            for y in task.session.stream(rows()):
                sums.add(y, arrangements.popleft())
        except TimeLimitError as error:
            if sums.blocks < 2:
                raise
            missing, stopped = wanted - sums.blocks, str(error)
        estimates = [sums.estimate(i, missing, stopped) for i in range(len(task.criteria))]
        details = ConditionalMonteCarloDetails(sums.blocks, missions, sums.failing)
        return Solution(estimates, details)


def _draw(task: Task, missions: int, block: int) -> tuple[FloatArray, IntArray]:
    """Draw one block: inputs (rows, d), and arrangements (ARRANGEMENTS, K) of K responses."""
    from scipy.special import ndtri

    inputs, rng = task.problem.inputs, task.generator(block)
    per_draw = missions * task.problem.n_units
    strata = np.empty((BLOCK_DRAWS, inputs.n_shared))
    for column in strata.T:
        column[:] = rng.permutation(BLOCK_DRAWS)
    level = (strata + rng.random(strata.shape)) / BLOCK_DRAWS
    # random() may give 0
    shared = ndtri(np.maximum(level, np.finfo(np.float64).tiny))
    individual = rng.standard_normal((BLOCK_DRAWS * per_draw, inputs.n_individual))
    u = np.hstack([np.repeat(shared, per_draw, axis=0), individual])
    ways = np.stack([rng.permutation(per_draw) for _ in range(ARRANGEMENTS)])
    return inputs.from_standard_normal(u), ways


class _Sums:
    """Running mean and spread (2, n_criteria) of the block estimates.

    The first row counts failed runs as failures, the second as safe.
    """

    def __init__(self, task: Task, missions: int) -> None:
        self.criteria, self.units, self.missions = task.criteria, task.problem.n_units, missions
        self.blocks = 0
        self.mean = np.zeros((2, len(self.criteria)))
        self.squares = np.zeros_like(self.mean)
        self.failing = np.zeros(len(self.criteria), dtype=np.int64)
        # over all draws, of pf given the shared inputs (0) and of what it lacks of its largest (1)
        self.powers = np.zeros((2, 3, len(self.criteria)))
        self.lowest = np.full(len(self.criteria), np.inf)
        self.highest = np.full(len(self.criteria), -np.inf)
        self.tables = [
            failure_by_count(missions * self.units, self.units, c.missions)
            if c.tau is None
            else failure_by_count(missions, 1, c.missions)
            for c in self.criteria
        ]

    def add(self, responses: FloatArray, ways: IntArray) -> None:
        """Take in the responses of some blocks, and the arrangements of these."""
        y = responses.reshape(len(ways), BLOCK_DRAWS, -1)
        known: dict[tuple[float, float | None, bool], IntArray] = {}
        estimates = np.empty((2, len(self.criteria), len(ways)))
        for i, criterion in enumerate(self.criteria):
            for j, missing_fails in enumerate((True, False)):
                key = (criterion.threshold, criterion.tau, missing_fails)
                if key not in known:
                    known[key] = self._failures(y, ways, criterion, missing_fails)
                # (blocks, arrangements, draws)
                found = self.tables[i][known[key]]
                estimates[j, i] = found.mean(axis=(1, 2))
                if missing_fails:
                    self.failing[i] += int((found > 0.0).any(axis=1).sum())
                    self.lowest[i] = min(self.lowest[i], found.min())
                    self.highest[i] = max(self.highest[i], found.max())
                    fails = found.mean(axis=1)
                    for k, part in enumerate((fails, self.tables[i][-1] - fails)):
                        self.powers[k, :, i] += [(part**power).sum() for power in (1, 2, 3)]
        before, self.blocks = self.blocks, self.blocks + len(ways)
        share = len(ways) / self.blocks
        own = estimates.mean(axis=2)
        change = own - self.mean
        self.squares += ((estimates - own[:, :, None]) ** 2).sum(axis=2)
        self.squares += change**2 * before * share
        self.mean += change * share

    def _failures(
        self, y: FloatArray, ways: IntArray, criterion: Criterion, missing_fails: bool
    ) -> IntArray:
        """Count failed responses, or under tau failed missions: (blocks, arrangements, draws)."""
        threshold, tau = criterion.threshold, criterion.tau
        if tau is None:
            alone = y[:, None, :, :, None]
            fails = mission_fails(alone, threshold, None, missing_fails=missing_fails)
        else:
            arranged = np.take_along_axis(y[:, None], ways[:, :, None, :], axis=-1)
            shape = (*arranged.shape[:-1], self.missions, self.units)
            fails = mission_fails(
                arranged.reshape(shape), threshold, tau, missing_fails=missing_fails
            )
        return np.asarray(fails.sum(axis=-1))

    def _uneven(self, i: int) -> tuple[str, float]:
        """What rests on so few of the shared draws that the stated error is not to be believed.

        Where few draws carry nearly all of the sum, a sample without them looks even, and states
        a small error. Cochran's rule for the interval of a mean asks for more than 25 times the
        squared skewness of the draws (Sampling Techniques, 1977, 2.15). That a system which flies
        no mission works is the same for every draw, and does not count.

        Returns
        -------
        tuple[str, float]
            ``"pf"``, ``"the reliability"`` or empty, and how many draws that are alike would
            scatter like these: Kish's effective size (Survey Sampling, 1965).
        """
        n = self.blocks * BLOCK_DRAWS
        rare = int(self.powers[1, 0, i] < self.powers[0, 0, i])
        total, squares, cubes = self.powers[rare, :, i].tolist()
        mean, square = total / n, squares / n
        variance = square - mean**2
        third = cubes / n - 3.0 * mean * square + 2.0 * mean**3
        if n * max(variance, 0.0) ** 3 >= ENOUGH_DRAWS * third**2:
            return "", math.inf
        if third < 0.0:
            rare = 1 - rare
            total, squares = self.powers[rare, :2, i].tolist()
        return ("pf", "the reliability")[rare], total**2 / squares

    def estimate(self, i: int, missing: int, stopped: str) -> Estimate:
        """Answer one criterion."""
        from scipy.special import stdtrit

        n, draws = self.blocks, self.blocks * BLOCK_DRAWS
        pf, pf_low = (float(mean) for mean in self.mean[:, i])
        std_error, spread_low = np.sqrt(self.squares[:, i] / (n * (n - 1))).tolist()
        status: Status = "converged"
        messages = []
        if missing > 0:
            status = "budget_exhausted"
            messages.append(f"{n} of {n + missing} blocks")
        if stopped:
            messages.append(stopped)
        reach = float(stdtrit(n - 1, 0.5 + 0.5 * LEVEL))
        ci_low = max(0.0, pf_low - reach * spread_low)
        ci_high = min(1.0, pf + reach * std_error)
        kind = "student 95 %"
        failing, most = int(self.failing[i]), float(self.tables[i][-1])
        rests, alike = self._uneven(i)
        # with 95 % confidence what no draw has shown has at most this probability
        unseen = clopper_pearson(0, draws, LEVEL)[1]
        if self.lowest[i] == self.highest[i]:
            # without both outcomes the sample says nothing about its own spread
            pf = float(self.highest[i])
            std_error, kind, status = math.nan, "clopper-pearson 95 % one-sided", "doubtful"
            ci_low = pf_low if pf == 0.0 else pf_low * (1.0 - unseen)
            ci_high = pf + unseen * (most - pf)
            messages.append(f"{'only' if pf > 0.0 else 'no'} failures in {draws} shared draws")
        elif failing < FEW:
            status, rests = "doubtful", "pf"
            messages.append(f"failures in {failing} of {draws} shared draws")
        elif rests:
            status = "doubtful"
            messages.append(f"{rests} rests on about {alike:.2g} of {draws} shared draws")
        if rests:
            kind = "student 95 %, and unseen draws"
            if rests == "pf":
                ci_high = max(ci_high, pf + unseen * (most - pf))
            else:
                ci_low = min(ci_low, pf_low * (1.0 - unseen))
        return Estimate(
            pf=pf,
            reliability=1.0 - pf,
            std_error=std_error,
            ci_low=min(ci_low, pf_low),
            ci_high=max(ci_high, pf),
            ci_kind=kind,
            pf_low=pf_low,
            pf_high=pf,
            error_kind="sampling",
            status=status,
            message="; ".join(messages),
        )
