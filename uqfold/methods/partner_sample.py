"""A sample of systems chosen by what a cheap partner says of them.

Of the systems drawn, a fixed number is chosen with unequal probabilities by priority sampling: a
system of size s gets the priority s / u with a uniform u, and those with the highest priorities
are chosen. With the highest priority t that is not chosen, min(1, s / t) takes the place of the
probability of being chosen: sums over the sample weighted by its reciprocal are without bias, and
the errors of different systems are uncorrelated. Systems are drawn and judged block by block, and
no more are held than twice those that are wanted.

References
----------
Duffield N., Lund C., Thorup M. Priority sampling for estimation of arbitrary subset sums. Journal
of the ACM 54 (2007) 32.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace

import numpy as np

from uqfold.evaluation import EvaluationSession, FailedRunError, ModelError
from uqfold.methods.system_sample import SystemBlock, block_systems, draw_systems
from uqfold.methods.task import Task
from uqfold.problems.base import Problem
from uqfold.time_limit import check_time
from uqfold.typing import BoolArray, FloatArray


@dataclass(frozen=True, eq=False)
class ChosenSystems:
    """The systems chosen for the model.

    Attributes
    ----------
    block
        The systems, k of them.
    margins
        The partner's (n_criteria, k); -inf where it was not asked.
    chance
        The probability with which each was chosen (k,).
    population
        From how many systems.
    failing
        How many of them fail by the partner, under each criterion (n_criteria,).
    least
        Smallest probability (2, n_criteria) of a system that works, and that fails, by the partner;
        one where there is none.
    """

    block: SystemBlock
    margins: FloatArray
    chance: FloatArray
    population: int
    failing: FloatArray
    least: FloatArray

    @property
    def fails(self) -> BoolArray:
        """What the partner says of each system (n_criteria, k)."""
        return self.margins > 0.0


@dataclass(frozen=True, eq=False)
class _Candidates:
    block: SystemBlock
    margins: FloatArray
    sizes: FloatArray
    priority: FloatArray

    def take(self, which: BoolArray) -> _Candidates:
        chosen = np.flatnonzero(which)
        return _Candidates(
            self.block.take(chosen),
            self.margins[:, chosen],
            self.sizes[chosen],
            self.priority[chosen],
        )


class PartnerError(RuntimeError):
    """The partner cannot be run, or its first runs all fail."""


def without_partner(name: str, problem: Problem) -> str | None:
    """Return why a method that asks the partner of every model cannot answer, or None.

    Parameters
    ----------
    name
        Name of the method, or of its setting.
    problem
        What is asked about.
    """
    if problem.kinds.partner is not None:
        return None
    own = len(problem.kinds.models) > 1
    wanted = "Unit(low_fidelity=...) beside its own model" if own else "low_fidelity="
    return f"{name} needs a cheaper partner of every model: give {wanted}"


class Partner:
    """The partner of a problem's model, and the systems drawn to be judged by it.

    Parameters
    ----------
    task
        The question.
    """

    def __init__(self, task: Task) -> None:
        kinds = task.problem.kinds
        assert kinds.partner is not None
        # the same executor and limits on time; what fails here is no failed run of the estimate
        settings = replace(task.evaluator, failed_runs="bound", store=None, progress=None)
        self.session: EvaluationSession = settings.session(kinds.partner, kinds.columns, None)
        self._task = task
        self._streams = 0

    def margins(self, block: SystemBlock) -> FloatArray:
        """Margins (n_criteria, size) by the partner; a failed run of it is a unit that fails.

        Raises
        ------
        PartnerError, TimeLimitError
            As `responses` does.
        """
        return block.margins(self.responses(block.x), missing_fails=True)

    def responses(self, x: FloatArray) -> FloatArray:
        """Return the partner's responses (n,) to rows (n, d); NaN marks its failed runs.

        Raises
        ------
        PartnerError
            If it cannot be run, or its first runs all fail.
        TimeLimitError
            If the time is over.
        """
        try:
            return self.session.evaluate(x)
        except (FailedRunError, ModelError) as error:
            raise PartnerError(f"the partner failed: {error}") from error

    def margins_at_random(self, population: int) -> FloatArray:
        """Margins (n_criteria, population) of systems drawn at random."""
        return np.concatenate(
            [self.margins(self._draw(size)[0]) for size in self._sizes(population)], axis=1
        )

    def _sizes(self, population: int) -> Iterator[int]:
        """Sizes of the blocks in which systems are drawn."""
        most = block_systems(self._task.problem, self._task.criteria)
        for start in range(0, population, most):
            check_time()
            yield min(most, population - start)

    def _draw(self, size: int) -> tuple[SystemBlock, FloatArray]:
        """Draw systems from the next random stream, and a number in (0, 1] for each of them."""
        rng = self._task.generator(self._streams)
        self._streams += 1
        block = draw_systems(self._task.problem, self._task.criteria, rng, size)
        return block, 1.0 - rng.random(size)

    def chosen(
        self, population: int, wanted: int, sizes: Callable[[FloatArray], FloatArray] | None
    ) -> ChosenSystems:
        """Draw systems and choose some of them.

        Parameters
        ----------
        population
            How many are drawn.
        wanted
            How many are chosen.
        sizes
            To what (n,) the probability of a system is proportional, by the partner's margins
            (n_criteria, n); None: all are chosen, and the partner is not asked.
        """
        count = len(self._task.criteria)
        failing, smallest = np.zeros(count), np.full((2, count), np.inf)
        held: list[_Candidates] = []
        least, holding = 0.0, 0
        for drawn in self._sizes(population):
            block, chance = self._draw(drawn)
            if sizes is None:
                margins, size = np.full((count, chance.size), -np.inf), np.ones(chance.size)
            else:
                margins = self.margins(block)
                size = sizes(margins)
                fails = margins > 0.0
                failing += fails.sum(axis=1)
                for row, own in zip(smallest, (~fails, fails), strict=True):
                    np.minimum(row, np.where(own, size, np.inf).min(axis=1), out=row)
            candidates = _Candidates(block, margins, size, size / chance)
            held.append(candidates.take(candidates.priority >= least))
            holding += held[-1].sizes.size
            if holding > 2 * wanted:
                held = [_best(held, wanted + 1)]
                holding, least = wanted + 1, float(held[0].priority.min())
        best = _best(held, wanted + 1)
        bound = 0.0
        if best.sizes.size > wanted:
            bound = float(best.priority.min())
            best = best.take(best.priority > bound)
        with np.errstate(divide="ignore"):
            probability, lowest = (np.minimum(1.0, one / bound) for one in (best.sizes, smallest))
        return ChosenSystems(best.block, best.margins, probability, population, failing, lowest)


def _best(held: list[_Candidates], wanted: int) -> _Candidates:
    """Return the candidates of the highest priorities, in the order in which they were drawn."""
    every = _Candidates(
        SystemBlock.joined([one.block for one in held]),
        np.concatenate([one.margins for one in held], axis=1),
        np.concatenate([one.sizes for one in held]),
        np.concatenate([one.priority for one in held]),
    )
    if every.sizes.size <= wanted:
        return every
    chosen = np.zeros(every.sizes.size, dtype=bool)
    chosen[np.argsort(-every.priority, kind="stable")[:wanted]] = True
    return every.take(chosen)
