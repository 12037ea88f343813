"""The interface of every reliability method.

A method is a frozen record of settings plus one hook, `_solve`. Counting, budget, seeds, failed
runs, time and status belong to the base, so that all methods treat them alike; so does it who makes
the runs: `estimate` calls the model, a session of `start` asks its caller for them.
"""

from __future__ import annotations

import math
import re
import time
from abc import ABC, abstractmethod
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from os import PathLike
from typing import Any, ClassVar, Literal, TypeAlias, TypeVar, cast, final

from uqfold.algebra import one_blas_thread
from uqfold.checks import instance, or_none, raised
from uqfold.checks import path as checked_path
from uqfold.evaluation import (
    BudgetExceededError,
    EngineError,
    EvaluationSession,
    Evaluator,
    FailedRunError,
)
from uqfold.methods import session_file
from uqfold.methods.arguments import (
    CriteriaLike,
    checked_budget,
    checked_criteria,
    checked_evaluator,
    checked_problem,
)
from uqfold.methods.ask_tell_session import AskTellSession, Elsewhere
from uqfold.methods.result import (
    NO_ANSWER,
    STATUSES,
    TARGET_COV,
    Estimate,
    ReliabilityResult,
    RunCost,
    finished_row,
)
from uqfold.methods.seeding import RandomSource, reduced_seed
from uqfold.methods.task import Solution, Task
from uqfold.methods.theory import Theory
from uqfold.methods.value_by_value import value_by_value
from uqfold.problems.base import WITHOUT_MODEL, Problem, run_elsewhere
from uqfold.problems.criterion import Criteria, Criterion
from uqfold.problems.held_values import HeldValues, held_values
from uqfold.problems.structure import Series
from uqfold.system.structure import SystemUnits
from uqfold.time_limit import time_checked_by
from uqfold.typing import Model

T = TypeVar("T")
UnitsMayDiffer: TypeAlias = Literal["never", "by offset", "in all"]


@dataclass(frozen=True)
class OpenRun:
    """An estimate under way.

    Attributes
    ----------
    asked
        All criteria of the caller.
    reasons
        For each of them why the method cannot answer it, or None.
    task
        What the hook gets: the criteria that it can answer.
    """

    asked: Criteria
    reasons: tuple[str | None, ...]
    task: Task


class _NameOfClass:
    """The name of a method that sets none: that of its class, in lower case."""

    def __get__(self, _: object, owner: type) -> str:
        return re.sub(r"(?<=[a-z0-9])(?=[A-Z])", "-", owner.__name__).lower()


@dataclass(frozen=True)
class ReliabilityMethod(ABC):
    """A reliability method: settings, and the one verb `estimate`.

    A subclass is a frozen dataclass whose fields are its settings, all with defaults and checked
    when built. It fills in `_solve`; where it cannot answer a criterion it says so in `supports`.
    Nothing is kept between runs.
    """

    name: ClassVar[str] = cast(str, _NameOfClass())
    """Name in the registry, in tables and records; unless set, ``first-order`` of `FirstOrder`."""
    title: ClassVar[str] = ""
    """A few words for tables and legends."""
    bounds_failed_runs: ClassVar[bool] = False
    """Whether the hook bounds pf (`pf_low`, `pf_high`) when responses are NaN."""
    any_structure: ClassVar[bool] = False
    """Whether structures other than `Series` are answered."""
    units_may_differ: ClassVar[UnitsMayDiffer] = "never"
    """Whether units that differ are answered: by their offsets alone, or in every way."""
    answers_tau: ClassVar[bool] = True
    """Whether a synchronization threshold is answered, which one unit alone does not tell."""
    inputs_may_step: ClassVar[bool] = False
    """Whether discrete inputs are answered as they are, although the response has steps then."""
    most_values: ClassVar[int] = 50
    """If not, values of discrete inputs at most for which answers are summed up: shared ones, and
    all of a single unit over a single mission."""
    adaptive: ClassVar[bool] = False
    """Whether what it has seen decides where it runs the model next. Rounding then decides between
    places that promise the same, so that another machine may take another sample."""
    theory: ClassVar[Theory] = Theory()
    """Idea, equations and references, for the methods section of reports."""

    @property
    def stochastic(self) -> bool:
        """Whether another seed gives another answer; False unless a subclass says otherwise."""
        return False

    @property
    def target_cov(self) -> float | None:
        """Largest stated error, relative to pf, of a row that is not ``doubtful``; None: 10 %.

        A setting of methods that estimate an error.
        """
        return None

    def supports(self, problem: Problem, criterion: Criterion) -> str | None:
        """Return why the method cannot answer this criterion, or None if it can.

        This default goes by the class variables `any_structure`, `units_may_differ`, `answers_tau`
        and `inputs_may_step`; tau needs a series. A subclass with further reasons calls it first.
        """
        checked_problem(problem)
        instance("criterion", criterion, Criterion, "give a Criterion")
        structure, kinds = problem.structure, problem.kinds
        if criterion.tau is not None and not self.answers_tau:
            return f"{self.name} has no answer under a synchronization threshold tau"
        if not kinds.equal and self.units_may_differ == "never":
            return f"{self.name} needs exchangeable units (units=<number>)"
        if len(kinds.models) > 1 and self.units_may_differ != "in all":
            return f"{self.name} needs units of one model with the same inputs"
        if not isinstance(structure, Series) and not self.any_structure:
            return f"{self.name} needs a series structure, not {structure}"
        if criterion.tau is not None and not isinstance(structure, Series):
            return f"tau compares all units of a mission: it needs Series(), not {structure}"
        if isinstance(held := self._held(problem, [criterion]), str):
            return f"{self.name} needs continuous inputs: {held}"
        try:
            SystemUnits.of(problem)
        except ValueError as error:
            return str(error)
        return None

    @abstractmethod
    def _solve(self, task: Task) -> Solution:
        """Answer the criteria of `task`, calling the model only through `task.session.evaluate`."""

    @final
    def estimate(
        self,
        problem: Problem,
        criteria: CriteriaLike = None,
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
            Most evaluations that may be spent, each being one run of the model at one x; None: as
            many as the method's settings ask for.
        rng
            Seed, `numpy.random.SeedSequence` or `Generator`; reduced to the recorded seed.
        evaluator
            How runs are made: policy for failed runs, store, executor, limits on time, progress.

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
        EngineError
            If store or executor fail.
        """
        started = time.perf_counter()
        settings = checked_evaluator(evaluator)
        run = self._opened(problem, criteria, max_evals, rng, settings)
        solution = self._guarded(run.task, lambda: self._solution(run.task))
        return self._finished(run, solution, time.perf_counter() - started)

    @final
    def start(
        self,
        problem: Problem,
        criteria: CriteriaLike = None,
        *,
        max_evals: int | None = None,
        rng: RandomSource = None,
        evaluator: Evaluator | None = None,
    ) -> AskTellSession:
        """Start an estimate whose evaluations the caller makes.

        Parameters as in `estimate`. The problem's own model is never called; of the evaluator,
        the policy for failed runs, the rows asked for at once and the progress display are used.

        Returns
        -------
        AskTellSession
            Ask it for rows, tell it their responses, and take its result when it is done.
        """
        elsewhere = Elsewhere()
        settings = checked_evaluator(evaluator)
        run = self._opened(problem, criteria, max_evals, rng, settings, model=elsewhere)
        task = run.task
        return AskTellSession(
            elsewhere,
            task.session,
            session_file.header(self, problem, run.asked, task.seed, task.session),
            lambda: self._guarded(task, lambda: self._solution(task)),
            lambda solution, seconds: self._finished(run, solution, seconds),
        )

    @final
    def resume(
        self,
        path: str | PathLike[str],
        problem: Problem,
        criteria: CriteriaLike = None,
        *,
        max_evals: int | None = None,
        rng: RandomSource = None,
        evaluator: Evaluator | None = None,
    ) -> AskTellSession:
        """Go on with a session saved by `AskTellSession.save`, by replaying its responses.

        Parameters
        ----------
        path
            The file.
        problem, criteria, evaluator
            As in `start`; they are compared with what the file recorded.
        max_evals, rng
            None takes both from the file. Other values must be those of the file.

        Raises
        ------
        SessionFileError
            If the file is damaged, is not a session file, or belongs to another method, problem,
            criteria, budget, seed or policy for failed runs.
        """
        checked_problem(problem)
        checked_criteria(problem, criteria)
        saved = session_file.read(checked_path("path", path))
        session = self.start(
            problem,
            criteria,
            max_evals=saved.header["max_evals"] if max_evals is None else max_evals,
            rng=saved.header["seed"] if rng is None else rng,
            evaluator=evaluator,
        )
        session.replay(saved)
        return session

    def _opened(
        self,
        problem: Problem,
        criteria: CriteriaLike,
        max_evals: int | None,
        rng: RandomSource,
        settings: Evaluator,
        model: Model | None = None,
    ) -> OpenRun:
        """Check the arguments of `estimate`; `model` stands in for the problem's own."""
        asked = checked_criteria(problem, criteria)
        budget = checked_budget(max_evals)
        seed = reduced_seed(rng)
        if model is None:
            if problem.model is run_elsewhere:
                raise ValueError(WITHOUT_MODEL)
            session = settings.open(problem, budget)
        else:
            session = settings.session_of_told(model, problem.kinds.columns, budget)
        session.slopes = problem.kinds.gradients
        reasons = tuple(self.supports(problem, criterion) for criterion in asked)
        supported = tuple(c for c, reason in zip(asked, reasons, strict=True) if reason is None)
        return OpenRun(asked, reasons, Task(problem, supported, seed, session, settings))

    def _finished(self, run: OpenRun, solution: Solution, seconds: float) -> ReliabilityResult:
        """Join the answers of the hook with the unsupported criteria, and with the cost."""
        session = run.task.session
        answers = iter(solution.estimates)
        estimates = [
            self._checked(next(answers), session)
            if reason is None
            else Estimate.without_answer("unsupported", reason)
            for reason in run.reasons
        ]
        if session.n_gradients > 0:
            beside = f"{session.n_gradients:,} gradients beside the runs"
            estimates = [
                one
                if one.status == "unsupported"
                else replace(one, message="; ".join(filter(None, [one.message, beside])))
                for one in estimates
            ]
        cost = RunCost(
            n_evals=session.n_evals,
            n_reused=session.n_reused,
            n_failed=session.n_failed,
            seconds=seconds,
            method=self.name,
            seed=run.task.seed,
        )
        rows = tuple(
            finished_row(criterion, estimate, cost)
            for criterion, estimate in zip(run.asked, estimates, strict=True)
        )
        problem, samples = run.task.problem, None
        if session.samples is not None:
            samples = session.samples.frame(problem.kinds.column_names)
        return ReliabilityResult(
            tuple(run.asked),
            rows,
            solution.details,
            problem.name,
            problem.system_digest,
            session.n_gradients,
            samples,
        )

    def _held(self, problem: Problem, criteria: Sequence[Criterion]) -> HeldValues | str | None:
        """Return values of discrete inputs to be held, why not, or None: nothing is to be held."""
        if self.inputs_may_step or not problem.kinds.with_steps:
            return None
        return held_values(problem, criteria, self.most_values)

    @final
    def _solution(self, task: Task) -> Solution:
        """Answer the criteria of `task`: for each value of discrete inputs, if need be."""
        held = self._held(task.problem, task.criteria)
        if not isinstance(held, HeldValues):
            return self._solve(task)

        def solve(row: int, problem: Problem, session: EvaluationSession) -> tuple[Any, Any]:
            seed = int(task.generator(row).integers(2**63))
            own = replace(task, problem=problem, session=session, seed=seed)
            solution = self._guarded(own, lambda: self._solve(own))
            return solution.estimates, solution.details

        return Solution(*value_by_value(task.problem, held, task.session, solve))

    def _guarded(self, task: Task, solve: Callable[[], Solution]) -> Solution:
        """Run the hook; whatever it raises becomes the status of every criterion."""
        if not task.criteria:
            return Solution([])
        try:
            with one_blas_thread(), time_checked_by(task.session.check_time):
                solution = solve()
            if len(solution.estimates) != len(task.criteria):
                raise ValueError(
                    f"{self.name} gave {len(solution.estimates)} answers to "
                    f"{len(task.criteria)} criteria"
                )
        except Exception as error:
            return self._failed(task, error)
        return solution

    def _failed(self, task: Task, error: Exception) -> Solution:
        """Turn an exception of the hook into a status, or raise it under the policy ``raise``."""
        message = raised(error)
        if isinstance(error, EngineError):
            raise error
        if isinstance(error, FailedRunError):
            if task.session.failed_runs == "raise":
                raise error
            message = str(error)
        elif isinstance(error, BudgetExceededError):
            message = f"out of budget before an answer: {error}"
        return Solution([Estimate.without_answer("failed", message)] * len(task.criteria))

    def _checked(self, estimate: Estimate, session: EvaluationSession) -> Estimate:
        """Hold an estimate to the promises that every row makes."""
        if estimate.status not in STATUSES:
            message = f"status {estimate.status!r} is not one of {', '.join(STATUSES)}"
            return Estimate.without_answer("failed", message)
        if estimate.status in NO_ANSWER:
            return replace(estimate, pf=math.nan, reliability=None)
        if not 0.0 <= estimate.pf <= 1.0:
            return Estimate.without_answer("failed", f"pf = {estimate.pf} is not a probability")
        if estimate.status == "converged" and not estimate.states_an_error:
            estimate = replace(estimate, status="unchecked")
        target = TARGET_COV if self.target_cov is None else self.target_cov
        answered = estimate.status in ("converged", "budget_exhausted")
        if answered and estimate.stated_error > target * estimate.pf:
            wide = f"the stated error is above {100.0 * target:.3g}% of pf"
            said = f"{estimate.message}; {wide}" if estimate.message else wide
            estimate = replace(estimate, status="doubtful", message=said)
        if session.n_failed == 0 or session.failed_runs == "count-as-failure":
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
        if estimate.pf_high > estimate.pf_low:
            status = "doubtful"
        return replace(estimate, status=status, message=message)


def checked_method(method: ReliabilityMethod | None) -> ReliabilityMethod | None:
    """Return the method, or None.

    Raises
    ------
    TypeError
        If it is not a `ReliabilityMethod`, for example the class instead of a method built from it.
    """
    wanted = "give a method such as uqfold.methods.Kriging()"
    return or_none("method", method, instance, (ReliabilityMethod,), wanted)
