"""Importance sampling on the model, where a cheap partner says that failures are."""

from __future__ import annotations

import sys
from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import ClassVar, Protocol, runtime_checkable

import numpy as np

from uqfold.checks import flag, keep, real
from uqfold.evaluation import BudgetExceededError, Evaluator, TimeLimitError
from uqfold.methods.guided_look import MOST_SEEN, UNKNOWN, all_around, beside, share_lost
from uqfold.methods.guided_sums import PATIENCE, GuidedSums
from uqfold.methods.importance_search import ImportanceSearch
from uqfold.methods.partner_sample import without_partner
from uqfold.methods.rare_event import NestedCriteria, RareEventMethod, Running, T
from uqfold.methods.result import Estimate
from uqfold.methods.subset_climb import piloted
from uqfold.problems.base import Problem
from uqfold.problems.criterion import Criterion
from uqfold.typing import FloatArray, Model

PARTNER_RUNS = 40_000
"""Runs of the partner that lead to its failures, and as many again for their number."""
LEVEL_PROBABILITY, PILOT = 0.1, 1_000
BLOCK, FEWEST = 100, 200
"""Samples for the model in one go, and in all at least."""
AIM = 0.6
"""An answer goes on to so much of its target, since whoever stops as soon as an error looks small
stops where it looks smaller than it is."""

LESSONS, LESSON, PART_OF_LESSON = 3, 100, 8
"""A partner that can learn gets so many lessons of so many runs, each one part in so many of the
runs that are left at most."""
KNOWN = 0.05
"""A partner that is wrong about no more than this share of the failures learns no more."""
LOOK = 2
"""With up to `MOST_SEEN` variables a lesson has half as many runs again elsewhere, as far out."""
GOOD_GUIDE = 0.5
"""Where it is wrong about more than this share, the density is fitted to failures of the model."""


@runtime_checkable
class Learner(Protocol):
    """A partner that can learn from runs of the model."""

    def __call__(self, x: FloatArray) -> FloatArray:
        """Return responses (n,) to inputs X (n, d)."""
        ...

    def learned(self, x: FloatArray, y: FloatArray, rng: np.random.Generator) -> Learner | None:
        """Return what it has become by responses y (n,) of the model; None: it learns no more."""
        ...


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
        Whether runs that do not count for the answer are made first: they teach a partner that can
        learn, and where it is wrong all the same, the density is fitted to failures of the model.
        Without a failure worth fitting there is no answer.

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
        guide, note = _guide(asked, kinds.partner, rng)
        if note:
            return [Estimate.without_answer("failed", f"by the partner: {note}")], None
        good = True
        if self.refined:
            guide, good, note = yield from self._taught(asked, guide)
            if note:
                return [Estimate.without_answer("failed", f"the partner: {note}")], None
        by_partner, session = guide.asked, guide.asked.session
        search = replace(guide, asked=asked, rounds=[])
        if search.mixture is not None and not good:
            yield from search.refine()
            if note := self._useless(search):
                return [Estimate.without_answer("failed", note)], None
        doubts: list[str] = []
        if self.refined and search.mixture is not None:
            note, doubts = yield from beside(search)
            if note:
                return [Estimate.without_answer("failed", f"the partner: {note}")], None
        sums = GuidedSums()
        guide = replace(search, asked=replace(by_partner, most=session.n_evals + PARTNER_RUNS))
        while not sums.partner_precise(self._aim) and guide.affordable:
            size = min(guide.affordable, guide.most_at_once, PARTNER_RUNS // 4)
            sums.add_partner(driven(guide.drawn(size), session.evaluate))
        if self.refined and sums.partner_error > self.target_cov * sums.partner_pf:
            why = "what the partner fails is not sampled well enough by the density fitted to it"
            return [Estimate.without_answer("failed", why)], None
        by_partner = replace(by_partner, most=sys.maxsize)
        short = yield from self._summed(search, by_partner, sums, session.evaluate)
        overlooked = search.overlooked(sums.largest)
        return [sums.estimate(overlooked, doubts, short)], GuidedDetails(
            criterion=asked.criteria[0],
            partner_evals=session.n_evals,
            partner_pf=sums.partner_pf,
            partner_error=sums.partner_error,
            samples=sums.n,
            hits=sums.hits,
            missed=sums.missed,
            invented=sums.invented,
        )

    def _taught(
        self, asked: NestedCriteria, guide: ImportanceSearch
    ) -> Running[tuple[ImportanceSearch, bool, str]]:
        """Compare model and partner where the partner fails, and let one that can learn do so.

        Also return whether it is a good guide, and why it is none at all.
        """
        partner = asked.event.problem.kinds.partner
        size = LESSON // asked.event.max_evals_per_sample
        good, note = True, ""
        for _ in range(LESSONS):
            few = size == 0 or asked.left < LESSON * PART_OF_LESSON
            if few or guide.mixture is None:
                break
            drawn = guide.mixture.draw(size, guide.rng)
            if asked.event.dimension <= MOST_SEEN:
                drawn = np.concatenate([drawn, all_around(drawn, size // LOOK, guide.rng)])
            u = drawn[:, : asked.event.dimension]
            known = driven(guide.asked.heights(u), guide.asked.session.evaluate)[1]
            x = asked.event.rows(u)
            y = yield x
            fails = asked.fail(asked.event.bounds_of(u, y)[1])[0]
            wrong = np.count_nonzero(fails != asked.fail(known)[0])
            unknown = share_lost(guide.mixture.log_ratio(drawn), fails, size) > UNKNOWN
            hits = np.count_nonzero(fails)
            good = bool(wrong <= GOOD_GUIDE * hits)
            note = "it knows nothing of failures elsewhere" if unknown else ""
            knows = wrong <= KNOWN * hits and not unknown
            if knows or not isinstance(partner, Learner):
                break
            partner = partner.learned(x, y, guide.rng)
            if partner is None:
                break
            taught, lost = _guide(asked, partner, guide.rng)
            if lost:
                break
            guide = taught
        return guide, good, note

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
                heights = driven(by_partner.heights(u), evaluate)
                sums.add(drawn, by_partner.fail(heights[1])[0])
        except (TimeLimitError, BudgetExceededError) as error:
            if sums.n < FEWEST:
                raise
            return [str(error)]
        if sums.n == 0:
            raise BudgetExceededError("no runs are left for samples")
        return []


def _guide(
    asked: NestedCriteria, partner: Model, rng: np.random.Generator
) -> tuple[ImportanceSearch, str]:
    """Return the density that follows the failures of a partner, and why there is none."""
    session = Evaluator().session(partner, asked.event.problem.kinds.columns, None)
    by_partner = replace(asked, session=session, most=PARTNER_RUNS)
    guide = ImportanceSearch(by_partner, rng, float(asked.event.max_evals_per_sample))
    return guide, driven(_found(guide), session.evaluate)


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


def driven(steps: Running[T], evaluate: Callable[[FloatArray], FloatArray]) -> T:
    """Run steps to their end with a model at hand."""
    try:
        x = next(steps)
        while True:
            x = steps.send(evaluate(x))
    except StopIteration as stop:
        found: T = stop.value
        return found
