"""Subset simulation: a rare failure as a chain of less rare ones, with an error that holds."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from uqfold.checks import keep, or_none, real, whole
from uqfold.evaluation import BudgetExceededError, RunningEstimate, TimeLimitError
from uqfold.methods.counted import counted
from uqfold.methods.rare_event import NestedCriteria, RareEventMethod, Running
from uqfold.methods.repetitions import Repetitions, combined
from uqfold.methods.result import TARGET_COV, Estimate, Status
from uqfold.methods.subset_climb import Climbs, Pilot, Rung, climbs, piloted, rung_of
from uqfold.methods.system_sample import BLOCK_VALUES
from uqfold.methods.theory import Theory
from uqfold.methods.theory_of_simulation import SUBSET_SIMULATION
from uqfold.problems.criterion import Criterion
from uqfold.typing import FloatArray

WISHED = 20
"""Climbs that a small budget is divided into, by smaller populations."""
FEWEST = 10
"""With a budget for fewer climbs than this the highest levels are left out."""
SMALLEST_POPULATION = 100
ROUND = 10
"""Climbs made side by side: what is lost when the time ends."""
PILOT = 50
"""The pilot's population takes one part in so many of the budget."""
RESERVE = 1.1
"""With a random number of missions a round may cost so much more than expected."""
LAZY = 0.05
"""Where fewer proposals than this are taken, the chains hardly move."""


@dataclass(frozen=True)
class SubsetClimb:
    """How the criteria that nest were answered.

    Attributes
    ----------
    criteria
        These criteria.
    heights
        The levels (L,): responses of the system, or margins for a criterion with tau.
    probabilities
        Estimated probability (L,) of each.
    sigma, acceptance
        Step of the chains (L,) at each, and the share of proposals that were taken.
    size
        Samples of a climb at each level.
    pf
        What each climb found for each criterion (R, C).
    note
        Why the pilot ended before failures were frequent; empty if they are.
    """

    criteria: tuple[Criterion, ...]
    heights: FloatArray
    probabilities: FloatArray
    sigma: FloatArray
    acceptance: FloatArray
    size: int
    pf: FloatArray
    note: str


@dataclass(frozen=True)
class SubsetSimulation(RareEventMethod):
    """Subset simulation on the real model, for any number of inputs and rare failures.

    A pilot settles levels of the response, each exceeded by a share `level_probability` of what
    exceeds the one before. Several climbs over these levels follow, independent of the pilot and of
    each other, by Markov chains in standard-normal space (adaptive conditional sampling). Each is
    without bias to first order, so that their spread is the error of their mean, correlated chains
    and all.

    Criteria that differ in T alone are answered together; one with tau has climbs of its own. What
    is left of `max_evals` is split into equal shares for those that are left.

    Attributes
    ----------
    samples
        Samples of a climb at each level; fewer where the budget would pay for less than 20 climbs.
    repetitions
        Climbs to make; `max_evals` may allow fewer, then the status is ``budget_exhausted``. None:
        as many as `max_evals` pays for; without a budget 20, or what `target_cov` takes.
    level_probability
        Share of one level's samples that exceed the next.
    target_cov
        Stop early once the relative standard error of every criterion is at most this; None: never.
        A row with a larger one, or with more than 10 % under None, is ``doubtful``.

    Raises
    ------
    ValueError
        If a setting is out of range.

    Notes
    -----
    A failure frequent enough is counted, with the interval of Clopper and Pearson. Where no failure
    is seen, as with a response that is constant until it fails, the row is ``doubtful`` and its
    interval an upper bound. So it is where fewer than ten climbs saw failures, or where the chains
    hardly move. A system of half a million random numbers or more is ``unsupported``.
    """

    name: ClassVar[str] = "subset-simulation"
    title: ClassVar[str] = "Subset simulation"
    theory: ClassVar[Theory] = SUBSET_SIMULATION
    inputs_may_step: ClassVar[bool] = True

    samples: int = 1_000
    repetitions: int | None = None
    level_probability: float = 0.1
    target_cov: float | None = None

    def __post_init__(self) -> None:
        keep(self, "samples", whole, at_least=SMALLEST_POPULATION)
        keep(self, "repetitions", or_none, whole, at_least=2)
        keep(self, "level_probability", real, at_least=0.02, at_most=0.5)
        keep(self, "target_cov", or_none, real, above=0.0)

    def _answered(
        self, asked: NestedCriteria, rng: np.random.Generator
    ) -> Running[tuple[list[Estimate], SubsetClimb]]:
        start, cost = asked.session.n_evals, float(asked.event.max_evals_per_sample)
        affordable, largest = int(asked.left // cost), max(1, BLOCK_VALUES // asked.event.dimension)
        size = min(self.samples, largest, max(SMALLEST_POPULATION, affordable // PILOT))
        pilot = Pilot((), 0, "the budget is too small for levels")
        if affordable >= 2 * size:
            pilot = yield from piloted(asked, size, self.level_probability, affordable // 2, rng)
            cost = (asked.session.n_evals - start) / pilot.n_samples
        levels, size = self._planned(pilot.levels, asked.left / cost, largest)
        parts: list[Climbs] = []
        messages = []
        try:
            while number := self._next_round(asked, parts, levels, size, cost):
                made = yield from climbs(asked, levels, number, size, rng)
                parts.append(made)
                if asked.session.watched:
                    asked.session.report(_running(asked, Climbs.together(parts)))
        except (TimeLimitError, BudgetExceededError) as error:
            if not parts:
                raise
            messages.append(str(error))
        made = Climbs.together(parts)
        if self.repetitions is not None and len(made.high) < self.repetitions:
            messages.insert(0, f"{len(made.high)} of {self.repetitions} climbs")
        target = TARGET_COV if self.target_cov is None else self.target_cov
        answers = [
            _estimate(asked, made, i, target, pilot.note, messages)
            for i in range(len(asked.limits))
        ]
        return answers, SubsetClimb(
            criteria=asked.criteria,
            heights=np.array([level.height for level in levels]),
            probabilities=made.shares.mean(axis=0)[1:],
            sigma=np.array([level.sigma for level in levels]),
            acceptance=made.acceptance,
            size=size,
            pf=made.high,
            note=pilot.note,
        )

    def _planned(
        self, levels: tuple[Rung, ...], samples: float, largest: int
    ) -> tuple[tuple[Rung, ...], int]:
        """Return the levels and the population for which some samples in all suffice."""
        for number in range(len(levels), 0, -1):
            per_climb = self._samples_per_climb(number)
            size = min(self.samples, int(samples / (per_climb * WISHED)))
            size = min(largest, max(SMALLEST_POPULATION, size))
            if samples >= per_climb * size * FEWEST:
                return levels[:number], size
        blocks = -(-samples // min(self.samples, largest))
        return (), max(1, int(samples // blocks))

    def _samples_per_climb(self, levels: int) -> float:
        """Samples of a climb for each of its population: seeds are not run again."""
        return 1.0 + levels * (1.0 - self.level_probability)

    def _next_round(
        self,
        asked: NestedCriteria,
        parts: list[Climbs],
        levels: tuple[Rung, ...],
        size: int,
        cost: float,
    ) -> int:
        """Return how many climbs to make next; 0: no more."""
        made = sum(len(part.high) for part in parts)
        wanted = ROUND
        if self.repetitions is not None:
            wanted = min(ROUND, self.repetitions - made)
        elif asked.session.max_evals is None and self.target_cov is None:
            wanted = min(ROUND, WISHED - made)
        if self.target_cov is not None and made >= WISHED:
            whole, target = Climbs.together(parts), self.target_cov
            so_far = [_estimate(asked, whole, i, target) for i in range(len(asked.limits))]
            if all(x.status == "converged" and x.std_error <= target * x.pf for x in so_far):
                return 0
        if asked.event.random_missions:
            per_climb = RESERVE * cost * size * self._samples_per_climb(len(levels))
        else:
            per_climb = cost * size * (1 + len(levels))
        at_once = max(1, BLOCK_VALUES // (size * asked.event.dimension))
        return max(0, min(wanted, at_once, int(asked.left // per_climb)))


def _estimate(
    asked: NestedCriteria,
    made: Climbs,
    i: int,
    target: float,
    note: str = "",
    short: Sequence[str] = (),
) -> Estimate:
    """Return the answer to one criterion; `short` says why the run was cut short, if it was."""
    status: Status = "budget_exhausted" if short else "converged"
    messages = list(short)
    rung = rung_of(made.levels, asked.limits[i])
    high, low = made.high[:, i], made.low[:, i]
    if note and not high.any():
        messages = [*messages, note]
    if rung == 0:
        failures, sure = (round(float(values.sum()) * made.size) for values in (high, low))
        return counted(len(high) * made.size, failures, sure, status, messages)
    if len(high) < 2:
        return Estimate.without_answer("failed", f"one climb tells no error; {'; '.join(messages)}")
    lazy = int(np.count_nonzero(made.acceptance[:rung] < LAZY))
    if lazy:
        status = "doubtful"
        messages = [*messages, f"at {lazy} of {rung} levels the chains hardly move"]
    above = Repetitions(made.shares[:, rung])
    return combined(Repetitions(high), Repetitions(low), above, target, status, messages)


def _running(asked: NestedCriteria, made: Climbs) -> RunningEstimate:
    """Return the state of the rarest criterion."""
    i = int(np.argmax(asked.limits))
    one = _estimate(asked, made, i, TARGET_COV)
    return RunningEstimate(str(asked.criteria[i]), one.pf, one.ci_low, one.ci_high)
