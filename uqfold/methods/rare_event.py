"""What methods for rare events have in common: which criteria go together, and their runs."""

from __future__ import annotations

from abc import abstractmethod
from collections.abc import Generator
from dataclasses import dataclass, field
from typing import Any, ClassVar, TypeAlias, TypeVar, final

import numpy as np

from uqfold.checks import raised
from uqfold.evaluation import (
    BudgetExceededError,
    EngineError,
    EvaluationSession,
    FailedRunError,
    TimeLimitError,
)
from uqfold.evaluation.samples import Label
from uqfold.methods.base import UnitsMayDiffer
from uqfold.methods.result import Estimate
from uqfold.methods.steps import SequentialMethod, Steps
from uqfold.methods.system_sample import RUNS_WITHOUT_A_BUDGET, too_large
from uqfold.methods.task import Solution, Task
from uqfold.problems.base import Problem
from uqfold.problems.criterion import Criterion, Missions
from uqfold.system.event import SystemEvent
from uqfold.typing import BoolArray, FloatArray

T = TypeVar("T")
Running: TypeAlias = Generator[FloatArray, FloatArray, T]
"""Yields rows X to run, is sent their responses, returns T."""


@dataclass(frozen=True, eq=False)
class NestedCriteria:
    """Criteria whose failures lie one inside the other: how far does one height rise?

    Without tau, criteria of the same missions differ in T alone, and the height is the response of
    the system. A criterion with tau stands alone, and the height is its margin.

    Attributes
    ----------
    event
        Gives the height of a sample as its margin.
    criteria
        The criteria (C).
    places
        Their positions in the task.
    limits
        Height (C,) above which the system fails; +inf: only an infinite response does.
    session
        Counted access to the model.
    most
        Runs that may have been made in all (`session.n_evals`).
    """

    event: SystemEvent
    criteria: tuple[Criterion, ...]
    places: tuple[int, ...]
    limits: FloatArray
    session: EvaluationSession
    most: int
    _working: list[float] = field(default_factory=list)

    @property
    def flat(self) -> bool:
        """Whether all samples that worked had one height: nothing in it leads to failure."""
        return len(self._working) > 0 and min(self._working) == max(self._working)

    @property
    def left(self) -> int:
        """Runs that are left."""
        return self.most - self.session.n_evals

    def heights(self, u: FloatArray, **labels: Label) -> Running[tuple[FloatArray, FloatArray]]:
        """Run the samples u (N, d): heights (N,), failed runs as safe (low), as failures (high).

        What is said of the samples is kept with their runs, see `EvaluationSession.label`.

        Raises
        ------
        BudgetExceededError
            If they cost more runs than are left, which can only be with a random number of
            missions.
        """
        x = self.event.rows(u)
        if len(x) > self.left:
            raise BudgetExceededError(f"{len(x)} more runs asked for, but only {self.left} left")
        if self.session.samples is not None:
            runs = self.event.evals(u)
            for name, label in labels.items():
                labels[name] = np.repeat(label, runs) if isinstance(label, np.ndarray) else label
            self.session.label(sample=np.repeat(np.arange(len(u)), runs), **labels)
        y = yield x
        low, high = self.event.bounds_of(u, y)
        if (working := high[high <= self.limits.min()]).size:
            seen = np.concatenate([self._working, working])
            self._working[:] = [float(seen.min()), float(seen.max())]
        return low, high

    def fail(self, height: FloatArray) -> BoolArray:
        """Whether samples of some heights (N,) fail under each criterion: (C, N)."""
        return np.asarray((height > self.limits[:, None]) | (height == np.inf))


@dataclass(frozen=True)
class RareEventDetails:
    """How a sampler of rare events went: one record for each set of criteria that nest."""

    sets: tuple[Any, ...]


@dataclass(frozen=True)
class RareEventMethod(SequentialMethod):
    """A sampler of rare events: answers sets of criteria that nest, each with its own runs.

    What is left of `max_evals` is split into equal shares for the sets that are left.
    """

    each_alone: ClassVar[bool] = False
    """Whether every criterion has runs of its own."""
    bounds_failed_runs: ClassVar[bool] = True
    any_structure: ClassVar[bool] = True
    units_may_differ: ClassVar[UnitsMayDiffer] = "in all"
    adaptive: ClassVar[bool] = True

    @property
    def stochastic(self) -> bool:
        """Whether seeds matter: another one draws other samples."""
        return True

    def supports(self, problem: Problem, criterion: Criterion) -> str | None:
        """Return why not, or None: the reasons of the base, and systems too large to be drawn."""
        return super().supports(problem, criterion) or too_large(self.name, problem, criterion)

    @abstractmethod
    def _answered(
        self, asked: NestedCriteria, rng: np.random.Generator
    ) -> Running[tuple[list[Estimate], Any]]:
        """Answer criteria that nest, and tell how; there are runs for one sample at least."""

    @final
    def _steps(self, task: Task) -> Steps:
        session = task.session
        groups: dict[tuple[Missions, int | None], list[int]] = {}
        for i, criterion in enumerate(task.criteria):
            alone = i if self.each_alone or criterion.tau is not None else None
            groups.setdefault((criterion.missions, alone), []).append(i)
        answers: dict[int, Estimate] = {}
        details = []
        for i, places in enumerate(groups.values()):
            share = RUNS_WITHOUT_A_BUDGET // len(groups)
            if session.max_evals is not None:
                share = session.remaining // (len(groups) - i)
            asked = _nested(task, tuple(places), session.n_evals + share)
            try:
                found, told = yield from self._within(asked, task.generator(i))
                details.append(told)
            except (FailedRunError, EngineError):
                raise
            except TimeLimitError as error:
                found = _without_answer(asked, f"out of time before an answer: {error}")
            except BudgetExceededError as error:
                found = _without_answer(asked, f"out of budget before an answer: {error}")
            except Exception as error:
                found = _without_answer(asked, raised(error))
            answers.update(zip(places, found, strict=True))
        sets = tuple(one for one in details if one is not None)
        return Solution([answers[i] for i in range(len(answers))], RareEventDetails(sets))

    def _within(
        self, asked: NestedCriteria, rng: np.random.Generator
    ) -> Running[tuple[list[Estimate], Any]]:
        """Answer criteria that nest, if the runs suffice for one sample."""
        cost = asked.event.max_evals_per_sample
        if asked.left < cost:
            why = f"one system can cost {cost} runs, and {asked.left} are left for it"
            return _without_answer(asked, why), None
        answer = yield from self._answered(asked, rng)
        return answer


def _nested(task: Task, places: tuple[int, ...], most: int) -> NestedCriteria:
    criteria = tuple(task.criteria[i] for i in places)
    if criteria[0].tau is None:
        event = SystemEvent(task.problem, Criterion(0.0, missions=criteria[0].missions))
        limits = np.array([criterion.threshold for criterion in criteria])
    else:
        event, limits = SystemEvent(task.problem, criteria[0]), np.zeros(1)
    return NestedCriteria(event, criteria, places, limits, task.session, most)


def _without_answer(asked: NestedCriteria, why: str) -> list[Estimate]:
    return [Estimate.without_answer("failed", why)] * len(asked.places)
