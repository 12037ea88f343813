"""Importance sampling: many samples where failure is, each with the weight that it deserves."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from uqfold.checks import keep, or_none, real, whole
from uqfold.evaluation import BudgetExceededError, RunningEstimate, TimeLimitError
from uqfold.methods.counted import counted
from uqfold.methods.importance_search import ImportanceSearch
from uqfold.methods.rare_event import NestedCriteria, RareEventMethod, Running
from uqfold.methods.repetitions import Repetitions
from uqfold.methods.result import TARGET_COV, Estimate, Status
from uqfold.methods.subset_climb import Pilot, piloted
from uqfold.methods.theory import Theory
from uqfold.methods.theory_of_simulation import IMPORTANCE_SAMPLING
from uqfold.methods.weighted_sums import WeightedSums
from uqfold.problems.criterion import Criterion
from uqfold.typing import FloatArray

WITHOUT_A_BUDGET = 20_000
"""Samples to weigh where neither a number nor a budget is given."""
LEVEL_PROBABILITY = 0.1
PILOT, SMALLEST_PILOT, LARGEST_PILOT = 50, 100, 1_000
"""The pilot's population takes one part in so many of the budget; its least and most samples."""
UNSEEN, PART_OF_TARGET = 0.0075, 0.3
"""Part of pf that the climbs may miss in the mean: where there is no target, else of the target."""
FEWEST = 100
"""Samples to be weighed at least."""
MOST_OF_TARGET = 0.9
"""Where more of the target than this goes to what the climbs may miss, no samples reach it."""
BLOCK = 20_000
"""Samples weighed in one go at most: what is lost when the time ends."""


@dataclass(frozen=True)
class ImportanceDetails:
    """How one criterion was answered.

    Attributes
    ----------
    criterion
        The criterion.
    climbs
        Estimates of pf (R,) by the climbs that found the first failures.
    rounds
        Share of equally weighted samples in each round of fitting.
    components
        Components of the density that the answer comes from; 0: crude Monte Carlo.
    samples, hits
        Samples of the answer, and how many of them failed.
    alike
        How many samples of equal weight would scatter like those that failed (Kish).
    """

    criterion: Criterion
    climbs: FloatArray
    rounds: FloatArray
    components: int
    samples: int
    hits: int
    alike: float


@dataclass(frozen=True)
class ImportanceSampling(RareEventMethod):
    """Importance sampling on the real model, from a density fitted to failures.

    A few short climbs of subset simulation find failures. A mixture of directions and distances
    (von Mises-Fisher-Nakagami) is fitted to them, and then, round by round, to weighted samples
    drawn from it (cross-entropy method). The answer comes from fresh samples of the last mixture
    alone. A share of them goes elsewhere: in all directions, and by the law of the inputs.

    Every criterion has runs of its own; what is left of `max_evals` is split into equal shares for
    the criteria that are left.

    Attributes
    ----------
    samples
        Samples that the answer comes from; `max_evals` may allow fewer, then the status is
        ``budget_exhausted``. None: as many as `max_evals` pays for; without a budget 20,000, or
        what `target_cov` takes.
    target_cov
        Stop early once the relative standard error is at most this; None: never. A row with a
        larger one, or with more than 10 % under None, is ``doubtful``.

    Raises
    ------
    ValueError
        If a setting is out of range.

    Notes
    -----
    The interval is that of Fay and Feuer (1997) for weighted counts. A frequent failure is counted
    without weights. A region of failure that the climbs have missed may be missed by the samples,
    too: standard error and the upper end of the interval contain the part of pf that the number of
    their samples leaves open. They do not know of a small region near the origin whose response
    rises much more steeply than that of others. The row is ``doubtful`` where no failure is found,
    where one sample makes more than a fiftieth of pf, and where the answer does not agree with that
    of the climbs. A system of half a million random numbers or more is ``unsupported``.
    """

    name: ClassVar[str] = "importance-sampling"
    title: ClassVar[str] = "Importance sampling"
    theory: ClassVar[Theory] = IMPORTANCE_SAMPLING
    each_alone: ClassVar[bool] = True
    inputs_may_step: ClassVar[bool] = True

    samples: int | None = None
    target_cov: float | None = None

    def __post_init__(self) -> None:
        keep(self, "samples", or_none, whole, at_least=FEWEST)
        keep(self, "target_cov", or_none, real, above=0.0)

    def _answered(
        self, asked: NestedCriteria, rng: np.random.Generator
    ) -> Running[tuple[list[Estimate], ImportanceDetails]]:
        cost = float(asked.event.max_evals_per_sample)
        target = TARGET_COV if self.target_cov is None else self.target_cov
        aim = UNSEEN if self.target_cov is None else PART_OF_TARGET * target
        search = ImportanceSearch(asked, rng, cost, aim=aim)
        affordable = search.affordable
        size = min(max(affordable // PILOT, SMALLEST_PILOT), LARGEST_PILOT, search.most_at_once)
        pilot = Pilot((), 0, "the budget is too small to look for failures")
        if affordable >= 2 * size:
            before = asked.session.n_evals
            pilot = yield from piloted(asked, size, LEVEL_PROBABILITY, affordable // 2, rng)
            search.cost = (asked.session.n_evals - before) / pilot.n_samples
        note = pilot.note
        if pilot.levels and not note:
            note = yield from search.find(pilot)
        if search.mixture is not None:
            yield from search.refine()
        sums, short = yield from self._weighed(search)
        if search.mixture is not None:
            estimate = sums.estimate(
                target,
                Repetitions(search.climbs),
                overlooked=search.overlooked(sums.largest),
                unseen=search.unseen,
                short=short,
            )
        else:
            status: Status = "budget_exhausted" if short else "converged"
            said = [note] if note and not sums.hits else []
            estimate = counted(sums.n, sums.hits, sums.sure, status, [*short, *said])
        return [estimate], ImportanceDetails(
            criterion=asked.criteria[0],
            climbs=search.climbs,
            rounds=np.array(search.rounds),
            components=search.components,
            samples=sums.n,
            hits=sums.hits,
            alike=sums.alike,
        )

    def _weighed(self, search: ImportanceSearch) -> Running[tuple[WeightedSums, list[str]]]:
        """Weigh the samples of the answer; also tell why they are fewer than wanted."""
        session, sums, short = search.asked.session, WeightedSums(), []
        wanted = search.affordable if self.samples is None else self.samples
        if self.samples is None and session.max_evals is None and self.target_cov is None:
            wanted = WITHOUT_A_BUDGET
        try:
            while sums.n < wanted and not self._precise(sums, search):
                size = min(wanted - sums.n, BLOCK, search.most_at_once)
                # at most so many: with a random number of missions these may be few
                size = min(size, search.asked.left // search.asked.event.max_evals_per_sample)
                if size == 0:
                    break
                sums.add((yield from search.drawn(size)))
                if session.watched and sums.hits:
                    low, high = sums.ends()
                    named = str(search.asked.criteria[0])
                    session.report(RunningEstimate(named, sums.pf, low, high))
        except (TimeLimitError, BudgetExceededError) as error:
            if sums.n < FEWEST:
                raise
            short.append(str(error))
        if sums.n == 0:
            raise BudgetExceededError("the search for failures has left no runs")
        if self.samples is not None and sums.n < wanted and not self._precise(sums, search):
            short.insert(0, f"{sums.n} of {wanted} samples")
        return sums, short

    def _precise(self, sums: WeightedSums, search: ImportanceSearch) -> bool:
        """Whether the target, if there is one, is met, or as near as more samples could come."""
        if self.target_cov is None or sums.n < FEWEST:
            return False
        unseen = min(search.unseen, MOST_OF_TARGET * self.target_cov) if search.mixture else 0.0
        return math.hypot(sums.cov, unseen) <= self.target_cov
