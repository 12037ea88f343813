"""One answer without choosing a method: a surface first, simulation where it is not enough."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any, ClassVar

from uqfold.checks import keep, real, whole
from uqfold.evaluation import Evaluator
from uqfold.inputs import JointInputs
from uqfold.methods.arguments import CriteriaLike
from uqfold.methods.base import ReliabilityMethod, Solution, Task, UnitsMayDiffer
from uqfold.methods.importance_sampling import ImportanceSampling
from uqfold.methods.kriging import Kriging, KrigingDetails
from uqfold.methods.multifidelity_monte_carlo import MultifidelityMonteCarlo
from uqfold.methods.result import NO_ANSWER, NORMAL_95, Estimate, ReliabilityResult
from uqfold.methods.seeding import RandomSource
from uqfold.methods.subset_simulation import SubsetSimulation
from uqfold.methods.weighted_sums import BY_WEIGHTS
from uqfold.problems.base import Problem
from uqfold.problems.criterion import Criterion
from uqfold.typing import FloatArray

WITHOUT_A_BUDGET = 6_000
"""Evaluations where none are given."""
SURFACE_SHARE, MOST_OF_SURFACE = 3, 600
"""A surface gets one part in so many of the budget, if that is enough for it, and at most this."""
FEWEST_OF_SURFACE = 100
FEWEST_OF_SIMULATION = 1_000
"""With fewer runs left nothing is simulated: the error bar would say nothing."""
FREQUENT = 50.0
"""Failures among the runs that are left, from which a surface helps to simulate them."""
MOST_DIRECTIONS, MOST_ALONE = 4, 3
"""Units times missions, and criteria, up to which importance sampling is the sampler."""
SOUND = frozenset({"converged", "budget_exhausted"})
AGREE = 3.5
"""Joint standard errors by which a surface and its check may differ."""


@dataclass(frozen=True)
class MethodTried:
    """One method that was tried.

    Attributes
    ----------
    method
        The method, with its settings.
    purpose
        Why: ``answer``, or ``check`` of the answers of a surface.
    criteria
        What it was asked.
    estimates
        What it said, one for each.
    n_evals
        Evaluations that it spent.
    """

    method: ReliabilityMethod
    purpose: str
    criteria: tuple[Criterion, ...]
    estimates: tuple[Estimate, ...]
    n_evals: int


@dataclass(frozen=True)
class AutomaticDetails:
    """The way to the answers.

    Attributes
    ----------
    attempts
        What was tried, in order.
    """

    attempts: tuple[MethodTried, ...]

    @property
    def n_evals_of_checks(self) -> int:
        """Evaluations that served to check answers only."""
        return sum(one.n_evals for one in self.attempts if one.purpose == "check")


@dataclass(frozen=True)
class Automatic(ReliabilityMethod):
    """One answer without choosing a method.

    A Kriging surface answers what it can with a few runs. What it answers within the target is
    checked by simulation of rare events on the model itself, which shares nothing with the surface;
    what it doubts, or answers less sharply, is simulated with all runs that are left. Two answers
    that contradict each other are never ``converged``, and the message of a row says what was
    believed and why.

    Attributes
    ----------
    target_cov
        Stated error, relative to pf, that is aimed for: a row that states more is ``doubtful``.
    check_runs
        Evaluations for the check, as far as the budget allows; 0: none is made.

    Raises
    ------
    ValueError
        If a setting is out of range.

    Notes
    -----
    Without a budget 6,000 runs may be made. A message tells how many more would bring a row to the
    target, if runs are what is missing. `AutomaticDetails` has all that was tried.
    """

    name: ClassVar[str] = "auto"
    title: ClassVar[str] = "Surface, checked by simulation"
    bounds_failed_runs: ClassVar[bool] = True
    any_structure: ClassVar[bool] = True
    units_may_differ: ClassVar[UnitsMayDiffer] = "in all"
    adaptive: ClassVar[bool] = True

    target_cov: float = 0.05
    check_runs: int = 2_000

    def __post_init__(self) -> None:
        keep(self, "target_cov", real, above=0.0)
        keep(self, "check_runs", whole, at_least=0)

    @property
    def stochastic(self) -> bool:
        """Whether seeds matter: another one draws other samples."""
        return True

    def supports(self, problem: Problem, criterion: Criterion) -> str | None:
        """Return why not, or None: one of the methods that are tried has to support it."""
        reasons = [one.supports(problem, criterion) for one in (Kriging(), SubsetSimulation())]
        return None if None in reasons else "; ".join(map(str, reasons))

    def _solve(self, task: Task) -> Solution:
        budget = task.session.remaining
        if task.session.max_evals is None:
            budget = WITHOUT_A_BUDGET
        everything = range(len(task.criteria))
        with task.session.share(budget) as session:
            course = _Course(replace(task, session=session))
            surface = Kriging(target_cov=self.target_cov)
            most = min(budget, max(FEWEST_OF_SURFACE, budget // SURFACE_SHARE), MOST_OF_SURFACE)
            found = course.ask(surface, everything, most, "answer")
            answered = [i for i in everything if course.status(i) == "converged"]
            most = min(self.check_runs, session.remaining)
            if answered and most >= FEWEST_OF_SIMULATION:
                checked = course.hardest(answered)
                sampler = self._simulation(task, checked)
                course.ask(sampler, checked, most, "check")
            rest = [i for i in everything if i not in answered or course.contradicted(i)]
            partner = _as_partner(found.details, task.problem)
            frequent = [i for i in rest if course.pf(i) * session.remaining > FREQUENT]
            if partner is not None and frequent and session.remaining >= FEWEST_OF_SIMULATION:
                helped = MultifidelityMonteCarlo(target_cov=self.target_cov)
                course.ask(helped, frequent, session.remaining, "answer", partner)
                rest = [i for i in rest if course.status(i) != "converged"]
            if rest and session.remaining >= FEWEST_OF_SIMULATION:
                course.ask(self._simulation(task, rest), rest, session.remaining, "answer")
            answers = [course.answer(i, self.target_cov) for i in everything]
        return Solution(answers, AutomaticDetails(tuple(course.attempts)))

    def _simulation(self, task: Task, rows: Sequence[int]) -> ReliabilityMethod:
        """Return the sampler: a density cannot be fitted to many directions of failure."""
        directions = task.problem.n_units * max(task.criteria[i].max_missions for i in rows)
        if directions <= MOST_DIRECTIONS and len(rows) <= MOST_ALONE:
            return ImportanceSampling(target_cov=self.target_cov)
        return SubsetSimulation(target_cov=self.target_cov)


@dataclass(frozen=True)
class _SurfaceModel:
    """A surface over standard-normal space as a model of the inputs."""

    surface: Any
    inputs: JointInputs

    def __call__(self, x: FloatArray) -> FloatArray:
        y: FloatArray = self.surface.mean(self.inputs.to_standard_normal(x))
        return y


def _as_partner(details: object, problem: Problem) -> Problem | None:
    """Return the problem with a surface as its partner; None where there is not one for all."""
    if not isinstance(details, KrigingDetails) or details.of_other_kinds:
        return None
    model = _SurfaceModel(details.surface, problem.inputs)
    return replace(problem, low_fidelity=model)


class _Course:
    """The attempts at one task so far, and what they add up to."""

    def __init__(self, task: Task) -> None:
        self.task = task
        self.attempts: list[MethodTried] = []
        self._found: list[list[tuple[MethodTried, Estimate]]] = [[] for _ in task.criteria]
        self._sound: list[list[Estimate]] = [[] for _ in task.criteria]

    def ask(
        self,
        method: ReliabilityMethod,
        rows: Sequence[int],
        most: int,
        purpose: str,
        problem: Problem | None = None,
    ) -> Solution:
        """Let a method answer some criteria with some of the runs."""
        task = self.task if problem is None else replace(self.task, problem=problem)
        asked = [i for i in rows if method.supports(task.problem, task.criteria[i]) is None]
        criteria = tuple(task.criteria[i] for i in asked)
        with task.session.share(most) as session:
            seed = int(task.generator(len(self.attempts)).integers(2**63))
            own = replace(task, criteria=criteria, session=session, seed=seed)
            solution = method._guarded(own, lambda: method._solve(own))
            estimates = [method._checked(one, session) for one in solution.estimates]
            made = session.n_evals
        attempt = MethodTried(method, purpose, criteria, tuple(estimates), made)
        self.attempts.append(attempt)
        for i, own_view, estimate in zip(asked, solution.estimates, estimates, strict=True):
            self._found[i].append((attempt, estimate))
            # one that is only wide may speak against another all the same, but the answer of a
            # density is compared with what found it only where it is not
            by_density = own_view.ci_kind == BY_WEIGHTS
            sound = estimate if by_density else own_view
            if sound.status in SOUND and estimate.states_an_error:
                self._sound[i].append(estimate)
        return solution

    def status(self, row: int) -> str:
        """Return what the last answer to a criterion says of itself."""
        return self._found[row][-1][1].status if self._found[row] else "unsupported"

    def pf(self, row: int) -> float:
        """Return the last answer to a criterion; 0 without one."""
        pf = self._found[row][-1][1].pf if self._found[row] else 0.0
        return 0.0 if math.isnan(pf) else pf

    def contradicted(self, row: int) -> bool:
        """Whether two answers to a criterion differ by more than their errors allow."""
        sound = self._sound[row]
        return any(_differ(one, two) for one in sound for two in sound)

    def hardest(self, rows: Sequence[int]) -> list[int]:
        """Return which of the answers of one surface are to be checked.

        Criteria that differ in T alone, all of them where one sampler answers them together;
        otherwise the rarest.
        """
        criteria, problem = self.task.criteria, self.task.problem
        simple = [i for i in rows if criteria[i].tau is None] or [*rows]
        if problem.n_units * max(criteria[i].max_missions for i in simple) > MOST_DIRECTIONS:
            return simple
        return [min(simple, key=self.pf)]

    def answer(self, row: int, target_cov: float) -> Estimate:
        """Return the best answer to a criterion, and say what it rests on."""
        told = [(attempt, one) for attempt, one in self._found[row] if one.status not in NO_ANSWER]
        if not told:
            messages = [f"{a.method.name}: {one.message}" for a, one in self._found[row]]
            return Estimate.without_answer("failed", "; ".join(messages))
        own = [pair for pair in told if pair[0].purpose == "answer"] or told
        # what states nothing of its error is not believed against an interval
        bounds = [one for _, one in told if one.states_an_error]
        possible = [pair for pair in own if not any(_excludes(one, pair[1]) for one in bounds)]
        attempt, best = min(possible or own, key=lambda pair: _merit(pair[1]))
        others = [pair for pair in told if pair[1] is not best]
        said = [f"{a.method.name} found {_stated(one)}" for a, one in others]
        status = best.status
        if self.contradicted(row):
            status = "doubtful"
            said.insert(0, "answers contradict each other")
        messages = [f"by {attempt.method.name}", *([best.message] if best.message else []), *said]
        if status != "converged" and best.error_kind == "sampling":
            wide = best.stated_error / (target_cov * best.pf) if best.pf > 0.0 else math.inf
            if 1.0 < wide < math.inf:
                messages.append(f"about {attempt.n_evals * wide**2:,.0f} runs would be enough")
        return replace(best, status=status, message="; ".join(messages), n_evals_row=None)


def _differ(one: Estimate, two: Estimate) -> bool:
    """Whether two answers lie further apart than what both leave open on the side of the other."""
    low, high = (one, two) if one.pf <= two.pf else (two, one)
    open_above, open_below = low.ci_high - low.pf, high.pf - high.ci_low
    return high.pf - low.pf > AGREE / NORMAL_95 * math.hypot(open_above, open_below)


def _excludes(bound: Estimate, other: Estimate) -> bool:
    """Whether an answer without an error lies outside the interval of another."""
    return not (other.states_an_error or bound.ci_low <= other.pf <= bound.ci_high)


def _merit(estimate: Estimate) -> tuple[bool, float]:
    """Return what sorts answers: the best comes first."""
    wide = estimate.stated_error / estimate.pf if estimate.pf > 0.0 else math.inf
    return estimate.status != "converged", wide if math.isfinite(wide) else math.inf


def _stated(estimate: Estimate) -> str:
    if estimate.std_error > 0.0:
        return f"{estimate.pf:.4g} +- {estimate.std_error:.2g}"
    if estimate.states_an_error:
        return f"{estimate.pf:.4g} in {estimate.ci_low:.2g} .. {estimate.ci_high:.2g}"
    return f"{estimate.pf:.4g} without an error"


def estimate(
    problem: Problem,
    criteria: CriteriaLike = None,
    target: float = 0.05,
    *,
    max_evals: int | None = None,
    rng: RandomSource = None,
    evaluator: Evaluator | None = None,
) -> ReliabilityResult:
    """Estimate failure probabilities without choosing a method; see `Automatic`.

    Parameters
    ----------
    problem, criteria, max_evals, rng, evaluator
        As in `ReliabilityMethod.estimate`; without `max_evals` 6,000 runs may be made.
    target
        Stated error, relative to pf, that is aimed for; rows that state more are ``doubtful``.

    Raises
    ------
    ValueError, TypeError
        For wrong arguments, before any run is spent.

    Examples
    --------
    >>> import uqfold
    >>> result = uqfold.estimate(uqfold.problems.series(), uqfold.criteria(2.0), rng=1)
    >>> print(f"{result[0].pf:.3f} {result[0].status}")
    0.017 converged
    """
    method = Automatic(target_cov=real("target", target, above=0.0))
    return method.estimate(problem, criteria, max_evals=max_evals, rng=rng, evaluator=evaluator)
