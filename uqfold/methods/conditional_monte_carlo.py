"""Conditional Monte Carlo: many responses for each draw of the shared inputs."""

from __future__ import annotations

from collections import deque
from collections.abc import Iterator
from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from uqfold.checks import keep, or_none, real, whole
from uqfold.evaluation import TimeLimitError
from uqfold.methods.base import ReliabilityMethod, Solution, Task, UnitsMayDiffer
from uqfold.methods.conditional_sums import BLOCK_DRAWS, ConditionalSums
from uqfold.methods.result import TARGET_COV, Estimate
from uqfold.methods.system_sample import BLOCK_VALUES, RUNS_WITHOUT_A_BUDGET, too_large
from uqfold.methods.theory import Theory
from uqfold.methods.theory_of_simulation import CONDITIONAL_MONTE_CARLO
from uqfold.problems.base import Problem
from uqfold.problems.criterion import Criterion
from uqfold.typing import FloatArray, IntArray

CHUNK_BLOCKS = 32
"""Most blocks that are run together; has no influence on any number."""
WITHOUT_A_BUDGET = 256
"""Blocks when neither a number nor a budget is given."""
ARRANGEMENTS = 6
"""Ways in which the responses of a draw are put together to missions, where missions count."""


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
    gets several missions of responses. In series of equal units all ways to choose among them the
    responses of one system are averaged (see `uqfold.system.failure_counts`); in all other
    systems, and under a synchronization threshold, the missions that fail are counted in six
    random arrangements. Both are without bias and without a model of the distribution. Within a
    block the shared draws are stratified (Latin hypercube).

    Attributes
    ----------
    blocks
        Blocks of 16 shared draws; `max_evals` may allow fewer, then the status is
        ``budget_exhausted``. None: as many as `max_evals` pays for; without a budget 256, or
        what takes 5 million runs.
    missions_per_draw
        Missions simulated for each shared draw: at least this many, and at least as many as the
        criteria name.
    target_cov
        Largest standard error, relative to pf, of a row that is not ``doubtful``.

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
    any_structure: ClassVar[bool] = True
    units_may_differ: ClassVar[UnitsMayDiffer] = "in all"

    blocks: int | None = None
    missions_per_draw: int = 4
    target_cov: float = TARGET_COV

    def __post_init__(self) -> None:
        keep(self, "blocks", or_none, whole, at_least=2)
        keep(self, "missions_per_draw", whole, at_least=1)
        keep(self, "target_cov", real, above=0.0)

    @property
    def stochastic(self) -> bool:
        """Whether seeds matter: another one draws other systems."""
        return True

    def supports(self, problem: Problem, criterion: Criterion) -> str | None:
        """Return why not, or None: the reasons of the base, and systems too large to be drawn."""
        return super().supports(problem, criterion) or too_large(self.name, problem, criterion)

    def _solve(self, task: Task) -> Solution:
        missions = max(self.missions_per_draw, *(c.max_missions for c in task.criteria))
        per_block = BLOCK_DRAWS * missions * task.problem.n_units
        affordable = task.session.remaining // per_block
        wanted = self.blocks
        if wanted is None:
            most = min(WITHOUT_A_BUDGET, max(2, RUNS_WITHOUT_A_BUDGET // per_block))
            wanted = most if task.session.max_evals is None else int(affordable)
        planned = int(min(wanted, affordable))
        if planned < 2:
            message = (
                f"two blocks, the fewest with a standard error, cost {2 * per_block} runs, "
                f"max_evals = {task.session.max_evals}: lower missions_per_draw or raise the budget"
            )
            return Solution([Estimate.without_answer("failed", message)] * len(task.criteria))
        task.session.expect(planned * per_block)
        sums = ConditionalSums(task, missions)
        arrangements: deque[IntArray] = deque()

        # the responses of a block may be there in every arrangement
        values = per_block * max(task.problem.kinds.dimension, ARRANGEMENTS)
        at_once = max(1, min(CHUNK_BLOCKS, BLOCK_VALUES // values))

        def rows() -> Iterator[FloatArray]:
            for first in range(0, planned, at_once):
                chunk = range(first, min(first + at_once, planned))
                drawn = [_draw(task, missions, block) for block in chunk]
                arrangements.append(np.stack([ways for _, ways in drawn]))
                yield np.concatenate([x for x, _ in drawn])

        missing, stopped = wanted - planned, ""
        try:
            for y in task.session.stream(rows()):
                sums.add(y, arrangements.popleft())
        except TimeLimitError as error:
            complete = error.responses.size // per_block
            if complete:
                ways = arrangements.popleft()[:complete]
                sums.add(error.responses[: complete * per_block], ways)
            if sums.blocks < 2:
                raise
            missing, stopped = wanted - sums.blocks, str(error)
        estimates = [sums.estimate(i, missing, stopped) for i in range(len(task.criteria))]
        details = ConditionalMonteCarloDetails(sums.blocks, missions, sums.failing)
        return Solution(estimates, details)


def _draw(task: Task, missions: int, block: int) -> tuple[FloatArray, IntArray]:
    """Draw one block: inputs (rows, d), and arrangements (ARRANGEMENTS, K) of K responses."""
    from scipy.special import ndtri

    task.session.check_time()
    inputs, rng, n = task.problem.kinds, task.generator(block), task.problem.n_units
    per_draw = missions * n
    strata = np.empty((BLOCK_DRAWS, inputs.n_shared))
    for column in strata.T:
        column[:] = rng.permutation(BLOCK_DRAWS)
    level = (strata + rng.random(strata.shape)) / BLOCK_DRAWS
    # random() may give 0
    shared = ndtri(np.maximum(level, np.finfo(np.float64).tiny))
    individual = rng.standard_normal((BLOCK_DRAWS * per_draw, inputs.n_individual))
    u = np.hstack([np.repeat(shared, per_draw, axis=0), individual])
    if inputs.equal:
        ways = np.stack([rng.permutation(per_draw) for _ in range(ARRANGEMENTS)])
    else:
        # each unit keeps its own responses, and meets others of theirs
        mission = np.tile(np.arange(missions)[:, None], (ARRANGEMENTS, 1, n))
        ways = (rng.permuted(mission, axis=1) * n + np.arange(n)).reshape(ARRANGEMENTS, -1)
    return inputs.rows(u.reshape(-1, n, inputs.dimension)).reshape(-1, inputs.columns), ways
