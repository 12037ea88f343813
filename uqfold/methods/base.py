"""The interface of every reliability method.

A method is a frozen record of settings plus one hook, `_solve`. Counting, budget, seeds, failed
runs, time and status belong to the base, so that all methods treat them alike.
"""

from __future__ import annotations

import math
import time
from abc import ABC, abstractmethod
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass, replace
from typing import Any, ClassVar, final

import numpy as np

from uqfold.evaluation import BudgetExceededError, EvaluationSession, Evaluator, FailedRunError
from uqfold.methods.result import (
    NO_ANSWER,
    CriterionResult,
    Estimate,
    ReliabilityResult,
    RunCost,
    finished_row,
)
from uqfold.methods.seeding import RandomSource, block_generator, reduced_seed
from uqfold.problems.base import Problem
from uqfold.problems.criterion import Criteria, Criterion
from uqfold.problems.structure import Series
from uqfold.typing import FloatArray


@dataclass(frozen=True)
class Task:
    """What the hook of a method gets: the question, counted runs, a budget and a seed.

    Attributes
    ----------
    problem
        The problem; its model is not to be called, `evaluate` is.
    criteria
        The criteria that the method supports, in order.
    seed
        Recorded seed of this run.
    session
        The counted access to the model.
    """

    problem: Problem
    criteria: tuple[Criterion, ...]
    seed: int
    session: EvaluationSession

    def evaluate(self, x: FloatArray) -> FloatArray:
        """Run the model on every row of X (n, d); see `EvaluationSession.evaluate`."""
        return self.session.evaluate(x)

    @property
    def max_evals(self) -> int | None:
        """The budget, or None."""
        return self.session.max_evals

    def expect(self, n_evals: int) -> None:
        """Tell the progress display how many runs this task will need in all."""
        budget = self.session.max_evals
        self.session.expected = n_evals if budget is None else min(n_evals, budget)

    def generator(self, block: int = 0) -> np.random.Generator:
        """Give the random generator of one block of work."""
        return block_generator(self.seed, block)


@dataclass(frozen=True)
class Solution:
    """What the hook of a method returns: one estimate per criterion of the task, and details."""

    estimates: Sequence[Estimate]
    details: Any = None


@dataclass(frozen=True)
class ReliabilityMethod(ABC):
    """A reliability method: settings, and the one verb `estimate`.

    A subclass is a frozen dataclass whose fields are its settings, all with defaults and checked
    when built. It sets `name` and fills in `_solve`; where it cannot answer a criterion it says
    so in `supports`. Nothing is kept between runs.
    """

    name: ClassVar[str]
    """Name in the registry, in tables and records."""
    title: ClassVar[str] = ""
    """A few words for tables and legends."""
    bounds_failed_runs: ClassVar[bool] = False
    """Whether the hook bounds pf (`pf_low`, `pf_high`) when responses are NaN."""

    @property
    def stochastic(self) -> bool:
        """Whether another seed gives another answer; False unless a subclass says otherwise."""
        return False

    def supports(self, problem: Problem, criterion: Criterion) -> str | None:
        """Say why the method cannot answer this criterion, or None if it can.

        This default accepts exchangeable units in series. A subclass that adds reasons of its own
        calls it first.
        """
        if not problem.exchangeable:
            return f"{self.name} needs exchangeable units (units=<number>)"
        if not isinstance(problem.structure, Series):
            return f"{self.name} needs a series structure, not {problem.structure}"
        return None

    @abstractmethod
    def _solve(self, task: Task) -> Solution:
        """Answer the criteria of `task`, calling the model only through `task.evaluate`."""

    @final
    def estimate(
        self,
        problem: Problem,
        criteria: Criteria | Criterion | Iterable[Criterion] | None = None,
        *,
        max_evals: int | None = None,
        rng: RandomSource = None,
        evaluator: Evaluator | None = None,
    ) -> ReliabilityResult:
        """Estimate the failure probability of `problem` under each criterion.

        Parameters
        ----------
        problem
            Model, inputs and units.
        criteria
            What "works" means; None takes the problem's own default criteria.
        max_evals
            Most model runs that may be spent, one run being the model at one x; None: as many
            as the method's settings ask for.
        rng
            Seed, `numpy.random.SeedSequence` or `Generator`; reduced to the recorded seed.
        evaluator
            How runs are made: policy for failed runs, batches, progress.

        Returns
        -------
        ReliabilityResult
            One row per criterion. A criterion that the method cannot answer has a status and a
            message instead of a number, and spoils no other.

        Raises
        ------
        ValueError, TypeError
            For wrong arguments, before any run is spent.
        FailedRunError
            Only under the policy ``raise`` for failed runs.
        """
        asked = _as_criteria(problem, criteria)
        if max_evals is not None and (int(max_evals) != max_evals or max_evals < 1):
            raise ValueError(f"max_evals = {max_evals}: give a whole number >= 1, or None")
        seed = reduced_seed(rng)
        settings = Evaluator() if evaluator is None else evaluator
        session = settings.session(
            problem.model, problem.inputs.dimension, None if max_evals is None else int(max_evals)
        )
        started = time.perf_counter()
        reasons = [self.supports(problem, criterion) for criterion in asked]
        supported = [i for i, reason in enumerate(reasons) if reason is None]
        estimates = [Estimate.without_answer("unsupported", reason or "") for reason in reasons]
        details = None
        if supported:
            task = Task(problem, tuple(asked[i] for i in supported), seed, session)
            solution = self._guarded(task, raising=settings.failed_runs == "raise")
            details = solution.details
            for i, estimate in zip(supported, solution.estimates, strict=True):
                estimates[i] = self._checked(estimate, session)
        cost = RunCost(
            n_evals=session.n_evals,
            n_reused=0,
            n_failed=session.n_failed,
            seconds=time.perf_counter() - started,
            method=self.name,
            seed=seed,
        )
        rows: list[CriterionResult] = [
            finished_row(criterion, estimate, cost)
            for criterion, estimate in zip(asked, estimates, strict=True)
        ]
        return ReliabilityResult(tuple(asked), tuple(rows), details)

    def _guarded(self, task: Task, *, raising: bool) -> Solution:
        """Run the hook; whatever it raises becomes the status of every criterion."""
        try:
            solution = self._solve(task)
            if len(solution.estimates) != len(task.criteria):
                raise ValueError(
                    f"{self.name} gave {len(solution.estimates)} answers to "
                    f"{len(task.criteria)} criteria"
                )
        except FailedRunError as error:
            if raising:
                raise
            return self._all_failed(task, str(error))
        except BudgetExceededError as error:
            return self._all_failed(task, f"out of budget before an answer: {error}")
        except Exception as error:
            return self._all_failed(task, f"{type(error).__name__}: {error}")
        return solution

    def _all_failed(self, task: Task, message: str) -> Solution:
        return Solution([Estimate.without_answer("failed", message)] * len(task.criteria))

    def _checked(self, estimate: Estimate, session: EvaluationSession) -> Estimate:
        """Hold an estimate to the promises that every row makes."""
        if estimate.status in NO_ANSWER:
            return replace(estimate, pf=math.nan, reliability=None)
        if not 0.0 <= estimate.pf <= 1.0:
            return Estimate.without_answer("failed", f"pf = {estimate.pf} is not a probability")
        if session.n_failed == 0 or session.settings.failed_runs == "count-as-failure":
            return estimate
        if session.n_failed == session.n_evals:
            return Estimate.without_answer("failed", f"all runs failed; {session.first_failure}")
        lost = f"{session.n_failed} of {session.n_evals} runs failed ({session.first_failure})"
        if estimate.pf_low is None or estimate.pf_high is None:
            return Estimate.without_answer(
                "failed", f"{lost}; {self.name} cannot bound their effect"
            )
        message = f"{estimate.message}; {lost}" if estimate.message else lost
        status = estimate.status
        if status == "converged" and estimate.pf_high > estimate.pf_low:
            status = "doubtful"
        return replace(estimate, status=status, message=message)


def attempt(answer: Callable[[], Estimate]) -> Estimate:
    """Answer one criterion so that its failure leaves the other criteria alone.

    For hooks that work criterion by criterion. `FailedRunError` passes, since it concerns the
    model; running out of budget and any other exception become the row's status.
    """
    try:
        return answer()
    except FailedRunError:
        raise
    except BudgetExceededError as error:
        return Estimate.without_answer("failed", f"out of budget before an answer: {error}")
    except Exception as error:
        return Estimate.without_answer("failed", f"{type(error).__name__}: {error}")


def _as_criteria(
    problem: Problem, criteria: Criteria | Criterion | Iterable[Criterion] | None
) -> Criteria:
    if criteria is None:
        if problem.default_criteria is None:
            raise ValueError(
                f"no criteria given, and problem {problem.name!r} has no default ones: pass "
                "uqfold.criteria(threshold=...)"
            )
        return problem.default_criteria
    if isinstance(criteria, Criterion):
        return Criteria([criteria])
    return criteria if isinstance(criteria, Criteria) else Criteria(criteria)
