"""What the hook of a method gets, and what it returns."""

from __future__ import annotations

import warnings
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any, TypeVar

import numpy as np

from uqfold.checks import instance, keep, raised, several
from uqfold.evaluation import (
    BudgetExceededError,
    EngineError,
    EvaluationSession,
    Evaluator,
    FailedRunError,
    TimeLimitError,
)
from uqfold.methods.result import Estimate
from uqfold.methods.seeding import block_generator
from uqfold.problems.base import Problem
from uqfold.problems.criterion import Criterion

T = TypeVar("T")


@dataclass(frozen=True)
class Task:
    """What the hook of a method gets: the question, counted runs, a budget and a seed.

    Attributes
    ----------
    problem
        The problem; its model is not to be called, `session.evaluate` is.
    criteria
        The criteria that the method supports, in order.
    seed
        Recorded seed of this run.
    session
        The counted access to the model, with the budget, the time and the progress display.
    evaluator
        How the runs are made.
    """

    problem: Problem
    criteria: tuple[Criterion, ...]
    seed: int
    session: EvaluationSession
    evaluator: Evaluator = field(default_factory=Evaluator)

    def summed_up(self, work: Callable[[str], T]) -> T:
        """Do work that makes an answer of the runs there are, also when the time ends meanwhile.

        It is then done once more, within the time for summing up.

        Parameters
        ----------
        work
            Takes why it has to hurry, empty where it need not.

        Raises
        ------
        TimeLimitError
            If that time is over too.
        """
        try:
            return work("")
        except TimeLimitError as error:
            return work(str(error))

    def generator(self, block: int = 0) -> np.random.Generator:
        """Return the random generator of one block of work."""
        return block_generator(self.seed, block)

    if not TYPE_CHECKING:

        def __getattr__(self, name: str) -> Any:
            """Return what has moved to the session; these names go with the next release."""
            if name not in {"evaluate", "max_evals", "expect", "check_time"}:
                raise AttributeError(f"a Task has no attribute {name!r}", name=name, obj=self)
            moved = f"task.{name} is task.session.{name} now"
            warnings.warn(moved, DeprecationWarning, stacklevel=2)
            return getattr(self.session, name)


@dataclass(frozen=True)
class Solution:
    """What the hook of a method returns: one estimate per criterion of the task, and details."""

    estimates: Sequence[Estimate]
    details: Any = None

    def __post_init__(self) -> None:
        keep(self, "estimates", several, instance, Estimate, "give an Estimate")


def attempt(answer: Callable[[], Estimate]) -> Estimate:
    """Answer one criterion so that its failure leaves the other criteria alone.

    For hooks that work criterion by criterion. `FailedRunError` passes, since it concerns the
    model, and `EngineError`, which concerns store or executor; running out of budget and any other
    exception become the row's status.
    """
    try:
        return answer()
    except (FailedRunError, EngineError):
        raise
    except BudgetExceededError as error:
        return Estimate.without_answer("failed", f"out of budget before an answer: {error}")
    except Exception as error:
        return Estimate.without_answer("failed", raised(error))
