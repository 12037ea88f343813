"""Conditional Monte Carlo: many responses for each draw of the shared inputs."""

from __future__ import annotations

import math
from collections import deque
from collections.abc import Iterator
from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from uqfold.checks import keep, or_none, real, whole
from uqfold.evaluation import TimeLimitError
from uqfold.methods.base import ReliabilityMethod, UnitsMayDiffer
from uqfold.methods.conditional_sums import BLOCK_DRAWS, ConditionalSums
from uqfold.methods.partner_control import PartnerControl
from uqfold.methods.partner_sample import without_partner
from uqfold.methods.result import Estimate
from uqfold.methods.system_sample import BLOCK_VALUES, RUNS_WITHOUT_A_BUDGET, too_large
from uqfold.methods.task import Solution, Task
from uqfold.methods.theory import Theory
from uqfold.methods.theory_of_simulation import CONDITIONAL_MONTE_CARLO
from uqfold.problems.base import Problem
from uqfold.problems.criterion import Criterion
from uqfold.typing import FloatArray, IntArray

CHUNK_BLOCKS = 32
"""Most blocks that are run together; has no influence on any number."""
WITHOUT_A_BUDGET = 256
"""Blocks when neither a number, a budget nor a target is given."""
FIRST = 8
"""Blocks to begin with where there is a target; they are doubled until it is met."""
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
    partner_evals, partner_failed
        Runs of the partner, and how many of them failed. They do not count as evaluations.
    gain
        How many times the partner has divided the variance (n_criteria,); NaN where it was of no
        use, None where it was not to be asked.
    """

    blocks: int
    missions_per_draw: int
    failing_draws: IntArray
    partner_evals: int = 0
    partner_failed: int = 0
    gain: FloatArray | None = None


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
        ``budget_exhausted``. None: as many as `max_evals` pays for; without a budget 256, or what
        `target_cov` takes, and what takes 5 million runs at most.
    missions_per_draw
        Missions simulated for each shared draw: at least this many, and at least as many as the
        criteria name.
    partner_blocks
        Blocks of the problem's `low_fidelity` partner for each block of the model. The partner also
        answers the model's own blocks, and what it gets wrong there by chance, of which its mean
        over all others tells, is taken off the answer (a control variate). 0: it is not asked.
    target_cov
        Stop early once the relative standard error of every criterion is at most this, for sure;
        None: never. A row with a larger one, or with more than 10 % under None, is ``doubtful``.

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

    With `target_cov` the blocks are doubled until it is met. Where to stop depends on the failures,
    so that pf is then about a tenth of its stated error too large in the mean. A partner is asked
    anew for each doubling, at twice its runs in all at most.

    A partner leaves the answer without bias, whatever it is (``docs/multifidelity.md``); one that
    is of no use costs its runs on the model's own blocks, and the row says so. Its runs are counted
    in `ConditionalMonteCarloDetails`.
    """

    name: ClassVar[str] = "conditional-mc"
    title: ClassVar[str] = "Conditional Monte Carlo"
    theory: ClassVar[Theory] = CONDITIONAL_MONTE_CARLO
    bounds_failed_runs: ClassVar[bool] = True
    any_structure: ClassVar[bool] = True
    units_may_differ: ClassVar[UnitsMayDiffer] = "in all"
    inputs_may_step: ClassVar[bool] = True

    blocks: int | None = None
    missions_per_draw: int = 4
    partner_blocks: int = 0
    target_cov: float | None = None

    def __post_init__(self) -> None:
        keep(self, "blocks", or_none, whole, at_least=2)
        keep(self, "missions_per_draw", whole, at_least=1)
        keep(self, "partner_blocks", whole, at_least=0)
        keep(self, "target_cov", or_none, real, above=0.0)

    @property
    def stochastic(self) -> bool:
        """Whether seeds matter: another one draws other systems."""
        return True

    def supports(self, problem: Problem, criterion: Criterion) -> str | None:
        """Return why not, or None: the base's reasons, large systems, a missing partner."""
        reason = super().supports(problem, criterion) or too_large(self.name, problem, criterion)
        if reason is None and self.partner_blocks > 0:
            return without_partner(f"partner_blocks = {self.partner_blocks}", problem)
        return reason

    def _solve(self, task: Task) -> Solution:
        missions = max(self.missions_per_draw, *(c.max_missions for c in task.criteria))
        per_block = BLOCK_DRAWS * missions * task.problem.n_units
        affordable = task.session.remaining // per_block
        wanted = self.blocks
        if wanted is None:
            most = max(2, RUNS_WITHOUT_A_BUDGET // per_block)
            if self.target_cov is None:
                most = min(most, WITHOUT_A_BUDGET)
            wanted = most if task.session.max_evals is None else int(affordable)
        planned = int(min(wanted, affordable))
        if planned < 2:
            message = (
                f"two blocks, the fewest with a standard error, cost {2 * per_block} runs, "
                f"max_evals = {task.session.max_evals}: lower missions_per_draw or raise the budget"
            )
            return Solution([Estimate.without_answer("failed", message)] * len(task.criteria))
        task.session.expect(planned * per_block)
        drawn = _Blocks(task, missions)
        sums, stopped = drawn.sums, ""
        control: PartnerControl | None = None
        partner_evals = partner_failed = 0

        def with_partner() -> PartnerControl | None:
            nonlocal partner_evals, partner_failed
            if self.partner_blocks == 0:
                return None
            model = np.concatenate(drawn.found, axis=-1)
            asked = PartnerControl.of(task, missions, model, drawn.inputs, self.partner_blocks)
            partner_evals += asked.evals
            partner_failed += asked.failed
            return asked

        def estimates(missing: int, stopped: str) -> list[Estimate]:
            own = [sums.estimate(i, missing, stopped) for i in range(len(task.criteria))]
            return [control.corrected(one, i) for i, one in enumerate(own)] if control else own

        try:
            while sums.blocks < planned:
                # without a target there is nothing to stop for
                more = planned if self.target_cov is None else max(sums.blocks, FIRST)
                drawn.run(min(more, planned - sums.blocks))
                control = with_partner()
                if self._met(estimates(0, ""), sums.blocks):
                    wanted = sums.blocks
                    break
        except TimeLimitError as error:
            drawn.complete(error.responses)
            if sums.blocks < 2:
                raise
            control, stopped = with_partner(), str(error)
        details = ConditionalMonteCarloDetails(
            sums.blocks,
            missions,
            sums.failing,
            partner_evals,
            partner_failed,
            control.gain() if control else None,
        )
        return Solution(estimates(wanted - sums.blocks, stopped), details)

    def _met(self, estimates: list[Estimate], blocks: int) -> bool:
        """Whether the target, if there is one, is met for sure by every criterion.

        The error that a few blocks state is uncertain itself, and those that come out small would
        stop first: it is judged by its upper bound at 90 %.
        """
        from scipy.special import chdtri

        if self.target_cov is None:
            return False
        most = self.target_cov * math.sqrt(float(chdtri(blocks - 1, 0.9)) / (blocks - 1))
        return all(e.status == "converged" and e.std_error <= most * e.pf for e in estimates)


class _Blocks:
    """Blocks that are drawn and run one after the other, and what they sum up to."""

    def __init__(self, task: Task, missions: int) -> None:
        self._task, self._missions = task, missions
        self._rows = BLOCK_DRAWS * missions * task.problem.n_units
        # the responses of a block may be there in every arrangement
        values = self._rows * max(task.problem.kinds.dimension, ARRANGEMENTS)
        self._at_once = max(1, min(CHUNK_BLOCKS, BLOCK_VALUES // values))
        self._arrangements: deque[IntArray] = deque()
        self.sums = ConditionalSums(task, missions)
        self.found: list[FloatArray] = []

    def inputs(self, first: int, count: int) -> Iterator[tuple[FloatArray, IntArray]]:
        """Draw inputs and arrangements of some blocks, several at once."""
        for start in range(first, first + count, self._at_once):
            chunk = range(start, min(start + self._at_once, first + count))
            drawn = (_draw(self._task, self._missions, block) for block in chunk)
            x, ways = zip(*drawn, strict=True)
            yield np.concatenate(x), np.stack(ways)

    def run(self, more: int) -> None:
        """Run the next blocks."""

        def rows() -> Iterator[FloatArray]:
            for x, ways in self.inputs(self.sums.blocks, more):
                self._arrangements.append(ways)
                yield x

        for y in self._task.session.stream(rows()):
            self.found.append(self.sums.add(y, self._arrangements.popleft()))

    def complete(self, responses: FloatArray) -> None:
        """Take in the complete blocks of a call that was ended by the time limit."""
        blocks = responses.size // self._rows
        if blocks:
            ways = self._arrangements.popleft()[:blocks]
            self.found.append(self.sums.add(responses[: blocks * self._rows], ways))


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
