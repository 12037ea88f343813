"""Monte Carlo with two models: a cheap partner says where runs of the dear one decide."""

from __future__ import annotations

import math
from collections.abc import Generator
from dataclasses import dataclass, replace
from typing import ClassVar

import numpy as np

from uqfold.checks import keep, or_none, real, whole
from uqfold.evaluation import EvaluationSession, TimeLimitError
from uqfold.methods.base import UnitsMayDiffer
from uqfold.methods.partner_allocation import MarginFit, NearestFirst, Plan, parts_of, planned
from uqfold.methods.partner_sample import Partner, PartnerError, without_partner
from uqfold.methods.partner_sums import PartnerSums
from uqfold.methods.result import TARGET_COV, Estimate
from uqfold.methods.steps import SequentialMethod, Steps
from uqfold.methods.system_sample import BLOCK_VALUES, RUNS_WITHOUT_A_BUDGET, too_large
from uqfold.methods.task import Solution, Task
from uqfold.methods.theory import Theory
from uqfold.methods.theory_of_simulation import MULTIFIDELITY
from uqfold.problems.base import Problem
from uqfold.problems.criterion import Criterion
from uqfold.typing import FloatArray, IntArray

WITHOUT_A_BUDGET = 10_000
"""Systems for the model when neither a number nor a budget is given."""
LARGEST_PILOT = 5
"""The pilot takes one part in so many of the systems that the model gets, at most."""
FEWEST_PILOT, FEWEST_SYSTEMS = 10, 40
"""With a smaller pilot, or fewer systems in all, the partner is not asked."""
PARTNER_PILOT, MOST_PARTNER_PILOT = 20, 50_000
"""The partner's part of the pilot costs one part in so many of the whole; and its most systems."""
ROUNDS, FEWEST_OF_ROUND = 10, 100
"""The systems are chosen in so many rounds, unless they are few."""
WORTH = 1.5
"""A partner that divides the variance by less than this is of no use."""


@dataclass(frozen=True)
class MultifidelityDetails:
    """What the partner was asked, and how often it was wrong.

    Attributes
    ----------
    partner_evals, partner_failed
        Runs of the partner, and how many of them failed. They do not count as evaluations.
    partner_systems, systems
        Systems judged by the partner, and those of them judged by the model, without the pilot.
    pilot_systems
        Systems of the pilot judged by the model.
    partner_pf
        Failure probabilities (n_criteria,) by the partner alone; NaN if it was not used.
    missed, invented
        Systems (n_criteria,) seen to fail by the model alone, and by the partner alone.
    gain
        How many times the variance of crude Monte Carlo with as many runs of the model was expected
        to be the variance of this estimate, from the pilot; NaN where it could not tell.
    """

    partner_evals: int
    partner_failed: int
    partner_systems: int
    systems: int
    pilot_systems: int
    partner_pf: FloatArray
    missed: IntArray
    invented: IntArray
    gain: float


@dataclass(frozen=True)
class MultifidelityMonteCarlo(SequentialMethod):
    """Monte Carlo that runs the model where its cheap partner leaves the verdict open.

    The problem's `low_fidelity` partner judges many systems, the model a chosen few of them, and
    these correct what the partner gets wrong. A pilot shows how the two differ near the limits of
    the criteria; the systems for the model are then chosen with probabilities that follow from the
    partner's margin and are nowhere zero. So the estimate is without bias whatever the partner is,
    and the better the partner, the smaller the error. Where the pilot shows no use in it, the rest
    is crude Monte Carlo, and a message says so.

    Attributes
    ----------
    systems
        Systems that the model is run on, besides the pilot; `max_evals` may allow fewer, then the
        status is ``budget_exhausted``. None: as many as `max_evals` pays for; without a budget
        10,000, or what takes 5 million runs.
    partner_systems
        Systems that the partner is run on. None: as many as make variance times cost least.
    cost_ratio
        How many runs of the partner cost as much as one of the model. If `partner_systems` is None,
        the partner gets at most as much work as the model.
    pilot
        Systems of the pilot; a fifth of all systems at most.
    target_cov
        Stop early once the standard error of every criterion is at most this, relative to pf; None:
        never. A row with a larger one, or with more than 10 % under None, is ``doubtful``.

    Raises
    ------
    ValueError
        If a setting is out of range.

    Notes
    -----
    Runs of the partner are not evaluations: they are counted in `MultifidelityDetails`. They are
    made here or by the evaluator's executor, also in an ask-and-tell session, and not stored.
    The interval holds what the partner may hide where no system of the sample has shown it wrong;
    where that is the most of it, the status is ``doubtful``: the standard error alone is that of
    what was seen. So it is with fewer than ten failures among the partner's systems. A problem
    without a partner, or a system of half a million random numbers, is ``unsupported``.
    """

    name: ClassVar[str] = "multifidelity-mc"
    title: ClassVar[str] = "Multifidelity Monte Carlo"
    theory: ClassVar[Theory] = MULTIFIDELITY
    bounds_failed_runs: ClassVar[bool] = True
    any_structure: ClassVar[bool] = True
    units_may_differ: ClassVar[UnitsMayDiffer] = "in all"
    inputs_may_step: ClassVar[bool] = True

    systems: int | None = None
    partner_systems: int | None = None
    cost_ratio: float = 50.0
    pilot: int = 100
    target_cov: float | None = None

    def __post_init__(self) -> None:
        keep(self, "systems", or_none, whole, at_least=1)
        keep(self, "partner_systems", or_none, whole, at_least=1)
        keep(self, "cost_ratio", real, at_least=1.0)
        keep(self, "pilot", whole, at_least=FEWEST_PILOT)
        keep(self, "target_cov", or_none, real, above=0.0)

    @property
    def stochastic(self) -> bool:
        """Whether seeds matter: another one draws other systems."""
        return True

    def supports(self, problem: Problem, criterion: Criterion) -> str | None:
        """Return why not, or None: the reasons of the base, a missing partner, large systems."""
        reason = super().supports(problem, criterion) or too_large(self.name, problem, criterion)
        return reason or without_partner(self.name, problem)

    def _steps(self, task: Task) -> Steps:
        session = task.session
        per_system = task.problem.n_units * max(c.max_missions for c in task.criteria)
        wanted, affordable = self._wanted(session, per_system)
        pilot = min(self.pilot, min(wanted, affordable) // LARGEST_PILOT)
        if self.systems is None and session.max_evals is not None:
            # what the budget pays for is for both
            wanted -= pilot
        systems = min(wanted, affordable - pilot)
        if systems < 1:
            message = (
                f"one system costs {per_system} runs, max_evals = {session.max_evals} allows none"
            )
            return Solution([Estimate.without_answer("failed", message)] * len(task.criteria))
        if pilot < FEWEST_PILOT or systems < FEWEST_SYSTEMS:
            pilot = 0
        session.expect((pilot + systems) * per_system)
        partner = Partner(task)
        plan, note = yield from self._planned(task, partner, pilot, systems)
        sums, stopped = yield from self._summed(task, partner, plan)
        done = self.target_cov is not None and sums.precise(self.target_cov)
        short = [stopped] if stopped else []
        if sums.systems < wanted and not done:
            short.insert(0, f"{sums.systems} of {wanted} systems")
        target = TARGET_COV if self.target_cov is None else self.target_cov
        answers = [sums.estimate(i, target, short, note) for i in range(len(task.criteria))]
        used = plan.allocation is not None
        by_partner = sums.by_partner / sums.population
        details = MultifidelityDetails(
            partner_evals=partner.session.n_evals,
            partner_failed=partner.session.n_failed,
            partner_systems=sums.population if used else 0,
            systems=sums.systems,
            pilot_systems=pilot,
            partner_pf=by_partner if used else np.full_like(by_partner, math.nan),
            missed=sums.wrong[0],
            invented=sums.wrong[1],
            gain=plan.gain,
        )
        return Solution(answers, details)

    def _wanted(self, session: EvaluationSession, per_system: int) -> tuple[int, int]:
        """How many systems are wanted from the model, and how many can be paid for."""
        affordable = session.remaining // per_system
        if self.systems is not None:
            return self.systems, affordable
        most = min(WITHOUT_A_BUDGET, max(1, RUNS_WITHOUT_A_BUDGET // per_system))
        return (most if session.max_evals is None else affordable), affordable

    def _planned(
        self, task: Task, partner: Partner, pilot: int, systems: int
    ) -> Generator[FloatArray, FloatArray, tuple[Plan, str]]:
        """Run the pilot and plan the rest; also say why it is to be crude Monte Carlo, if it is."""
        crude = Plan(systems, systems, None, math.nan)
        if pilot == 0:
            return crude, f"{systems} systems are too few to ask the partner: crude Monte Carlo"
        most = max(systems, int(self.cost_ratio * systems))
        asked = most if self.partner_systems is None else self.partner_systems
        asked = max(asked // PARTNER_PILOT, int(self.cost_ratio * pilot))
        asked = max(pilot + 1, min(asked, MOST_PARTNER_PILOT))
        try:
            margins = partner.margins_at_random(asked)
            nearest = NearestFirst(np.sort(np.abs(margins), axis=1), asked / pilot)
            chosen = partner.chosen(asked, pilot, nearest.sizes)
        except PartnerError as error:
            return crude, f"{error}: crude Monte Carlo"
        y = yield chosen.block.x
        fit = MarginFit.of(chosen.margins, chosen.block.margins(y, missing_fails=True))
        plan = planned(fit, margins, systems, self.partner_systems, most)
        if plan.gain < WORTH:
            return replace(crude, gain=plan.gain), (
                f"the partner is of no use: by a pilot of {pilot} systems it would divide the "
                f"variance by {plan.gain:.2g}, so the rest is crude Monte Carlo"
            )
        return plan, ""

    def _summed(
        self, task: Task, partner: Partner, plan: Plan
    ) -> Generator[FloatArray, FloatArray, tuple[PartnerSums, str]]:
        """Run the plan round by round; also say why it ended early, if it did."""
        session, sums = task.session, PartnerSums(task)
        sizes = None if plan.allocation is None else plan.allocation.sizes
        values = plan.systems * max(c.max_missions for c in task.criteria)
        values *= task.problem.n_units * task.problem.kinds.dimension
        rounds = min(ROUNDS, max(1, plan.systems // FEWEST_OF_ROUND))
        # a round holds up to three times what it runs
        rounds = min(plan.systems, max(rounds, 3 * values // BLOCK_VALUES))
        pairs = zip(
            parts_of(plan.systems, rounds), parts_of(plan.partner_systems, rounds), strict=True
        )
        for systems, population in pairs:
            try:
                chosen = partner.chosen(int(population), int(systems), sizes)
                y = yield chosen.block.x
            except TimeLimitError as error:
                if sums.systems == 0:
                    raise
                return sums, str(error)
            sums.add(chosen, y)
            if session.watched:
                session.report(sums.running())
            if self.target_cov is not None and sums.precise(self.target_cov):
                break
        return sums, ""
