"""Importance sampling on the model, where a cheap partner says that failures are."""

from __future__ import annotations

import sys
from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import ClassVar

import numpy as np

from uqfold.checks import flag, keep, real
from uqfold.evaluation import BudgetExceededError, Evaluator, TimeLimitError
from uqfold.methods.guided_sums import PATIENCE, GuidedSums
from uqfold.methods.importance_search import ImportanceSearch
from uqfold.methods.partner_sample import without_partner
from uqfold.methods.rare_event import NestedCriteria, RareEventMethod, Running, T
from uqfold.methods.result import Estimate
from uqfold.methods.subset_climb import piloted
from uqfold.problems.base import Problem
from uqfold.problems.criterion import Criterion
from uqfold.typing import FloatArray

PARTNER_RUNS = 40_000
"""Runs of the partner that lead to its failures, and as many again for their number."""
LEVEL_PROBABILITY, PILOT = 0.1, 1_000
BLOCK, FEWEST = 100, 200
"""Samples for the model in one go, and in all at least."""
AIM = 0.6
"""An answer goes on to so much of its target, since whoever stops as soon as an error looks small
stops where it looks smaller than it is."""


@dataclass(frozen=True)
class GuidedDetails:
    """What the partner led to.

    Attributes
    ----------
    criterion
        The criterion.
    partner_evals
        Runs of the partner. They do not count as evaluations.
    partner_pf, partner_error
        Its failure probability, from the same density, and its standard error.
    samples, hits
        Samples run on the model for the answer, and how many of them failed.
    missed, invented
        How many of them fail by the model alone, and by the partner alone.
    """

    criterion: Criterion
    partner_evals: int
    partner_pf: float
    partner_error: float
    samples: int
    hits: int
    missed: int
    invented: int


@dataclass(frozen=True)
class GuidedSampling(RareEventMethod):
    """Importance sampling whose density comes from the failures of a cheap partner.

    The climbs that `ImportanceSampling` makes on the model are made on the problem's `low_fidelity`
    partner, at no cost. A tenth of the samples goes elsewhere, so that the answer has no bias
    whatever the partner is. Where both models agree on who fails, the partner is a control variate:
    the error is then that of the few samples on which they differ.

    Attributes
    ----------
    target_cov
        Stop once the relative standard error is at most this. A row with a larger one is
        ``doubtful``.
    refined
        Whether the density is first fitted to failures of the model, by rounds of runs that do not
        count for the answer; without a failure worth fitting there is no answer.

    Raises
    ------
    ValueError
        If a setting is out of range.
    """

    name: ClassVar[str] = "guided-sampling"
    title: ClassVar[str] = "Importance sampling, guided by a partner"
    each_alone: ClassVar[bool] = True

    target_cov: float = 0.05
    refined: bool = True

    def __post_init__(self) -> None:
        keep(self, "target_cov", real, above=0.0)
        keep(self, "refined", flag)

    def supports(self, problem: Problem, criterion: Criterion) -> str | None:
        """Return why not, or None: the reasons of the base, and a missing partner."""
        return super().supports(problem, criterion) or without_partner(self.name, problem)

    def _answered(
        self, asked: NestedCriteria, rng: np.random.Generator
    ) -> Running[tuple[list[Estimate], GuidedDetails | None]]:
        kinds = asked.event.problem.kinds
        assert kinds.partner is not None
        session = Evaluator().session(kinds.partner, kinds.columns, None)
        by_partner = replace(asked, session=session, most=PARTNER_RUNS)
        guide = ImportanceSearch(by_partner, rng, float(asked.event.max_evals_per_sample))
        if note := _driven(_found(guide), session.evaluate):
            return [Estimate.without_answer("failed", f"by the partner: {note}")], None
        search = replace(guide, asked=asked, rounds=[])
        if self.refined and search.mixture is not None:
            yield from search.refine()
            if note := self._useless(search):
                return [Estimate.without_answer("failed", note)], None
        sums = GuidedSums()
        guide = replace(search, asked=replace(by_partner, most=session.n_evals + PARTNER_RUNS))
        while not sums.partner_precise(self._aim) and guide.affordable:
            size = min(guide.affordable, guide.most_at_once, PARTNER_RUNS // 4)
            sums.add_partner(_driven(guide.drawn(size), session.evaluate))
        by_partner = replace(by_partner, most=sys.maxsize)
        short = yield from self._summed(search, by_partner, sums, session.evaluate)
        overlooked = search.overlooked(sums.largest)
        return [sums.estimate(overlooked, short)], GuidedDetails(
            criterion=asked.criteria[0],
            partner_evals=session.n_evals,
            partner_pf=sums.partner_pf,
            partner_error=sums.partner_error,
            samples=sums.n,
            hits=sums.hits,
            missed=sums.missed,
            invented=sums.invented,
        )

    @property
    def _aim(self) -> float:
        return AIM * self.target_cov if self.refined else self.target_cov

    def _useless(self, search: ImportanceSearch) -> str:
        """Return why the density is none to sample from, or nothing."""
        # with few runs no round is made: all of them go to the answer
        if not search.rounds:
            return ""
        alike = search.rounds[-1]
        if alike * self.target_cov**2 * search.affordable * PATIENCE < 1.0:
            return f"of the samples where the partner fails only {alike:.2g} count for the model"
        return ""

    def _summed(
        self,
        search: ImportanceSearch,
        by_partner: NestedCriteria,
        sums: GuidedSums,
        evaluate: Callable[[FloatArray], FloatArray],
    ) -> Running[list[str]]:
        """Run samples on the model and on the partner; also tell why they are fewer than wanted."""
        asked = search.asked
        try:
            while sums.n < FEWEST or not sums.precise(self._aim):
                if self.refined and sums.hopeless(self.target_cov, search.affordable):
                    break
                size = min(BLOCK, asked.left // asked.event.max_evals_per_sample)
                if size == 0:
                    break
                drawn = yield from search.drawn(size)
                u = drawn.u[:, : asked.event.dimension]
                heights = _driven(by_partner.heights(u), evaluate)
                sums.add(drawn, by_partner.fail(heights[1])[0])
        except (TimeLimitError, BudgetExceededError) as error:
            if sums.n < FEWEST:
                raise
            return [str(error)]
        if sums.n == 0:
            raise BudgetExceededError("no runs are left for samples")
        return []


def _found(guide: ImportanceSearch) -> Running[str]:
    """Fit the density to the failures of the partner; return why there are none, or nothing."""
    size = min(PILOT, guide.most_at_once, max(1, guide.affordable // 20))
    pilot = yield from piloted(
        guide.asked, size, LEVEL_PROBABILITY, guide.affordable // 2, guide.rng
    )
    note = pilot.note
    if pilot.levels and not note:
        note = yield from guide.find(pilot)
    if guide.mixture is not None:
        yield from guide.refine()
    return note


def _driven(steps: Running[T], evaluate: Callable[[FloatArray], FloatArray]) -> T:
    """Run steps to their end with a model at hand."""
    try:
        x = next(steps)
        while True:
            x = steps.send(evaluate(x))
    except StopIteration as stop:
        found: T = stop.value
        return found
