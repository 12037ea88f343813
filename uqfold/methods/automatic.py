"""One answer without choosing a method: a surface first, simulation where it is not enough."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import ClassVar

from uqfold.checks import keep, real, whole
from uqfold.evaluation import Evaluator
from uqfold.methods.arguments import CriteriaLike
from uqfold.methods.automatic_check import (
    SURFACES,
    THRESHOLDS,
    as_partner,
    check_of_one_unit,
)
from uqfold.methods.automatic_course import Course, MethodTried
from uqfold.methods.base import ReliabilityMethod, UnitsMayDiffer
from uqfold.methods.directional_sampling import DirectionalSampling
from uqfold.methods.guided_sampling import GuidedSampling
from uqfold.methods.importance_sampling import ImportanceSampling
from uqfold.methods.kriging import Kriging
from uqfold.methods.line_sampling import LineSampling
from uqfold.methods.monte_carlo import MonteCarlo
from uqfold.methods.multifidelity_monte_carlo import MultifidelityMonteCarlo
from uqfold.methods.polynomial_chaos import PolynomialChaos
from uqfold.methods.result import ReliabilityResult
from uqfold.methods.seeding import RandomSource
from uqfold.methods.subset_simulation import SubsetSimulation
from uqfold.methods.task import Solution, Task
from uqfold.methods.theory import Theory
from uqfold.methods.theory_of_surfaces import AUTOMATIC
from uqfold.problems.base import Problem
from uqfold.problems.criterion import Criterion

WITHOUT_A_BUDGET = 6_000
"""Evaluations where none are given."""
SURFACE_SHARE, MOST_OF_SURFACE = 3, 600
"""A surface gets one part in so many of the budget, if that is enough for it, and at most this."""
FEWEST_OF_SURFACE, RUNS_OF_INPUT = 100, 20
"""Polynomials of many inputs may have so many runs for each of them."""
FEWEST_OF_SIMULATION = 1_000
"""With fewer runs left nothing is simulated without a surface: the error bar would say nothing."""
FEWEST_GUIDED = 50
"""With fewer runs left nothing is sampled where a surface says that failures are."""
FREQUENT, ENOUGH_FAILURES = 50.0, 150.0
"""Failures among the runs that are left, from which a surface helps to simulate them: of many
criteria, or directions, and of few."""
MOST_DIRECTIONS, MOST_ALONE = 4, 3
"""Units times missions, and criteria, up to which importance sampling is the sampler."""
MANY_INPUTS, PART_OF_LINES = 10, 3
"""With more inputs lines are tried before a surface guides, and rays after it, each by one part in
so many of what is left."""
SEEN_FAILURES = 20.0
"""Failures that a check of whole systems is expected to see, or it is not made."""


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

    A Kriging surface answers what it can with a few runs, and polynomial chaos what that doubts.
    What they answer within the target is checked by runs of the model where the surface says that
    it fails; what they doubt, or answer less sharply, is sampled on the model with the surface as a
    guide, or by simulation of rare events with all runs that are left. Two answers that contradict
    each other are never ``converged``, an answer that no check has seen is ``unchecked``, and the
    message of a row says what was believed and why.

    Attributes
    ----------
    target_cov
        Stated error, relative to pf, that is aimed for: a row that states more is ``doubtful``.
    check_runs
        Evaluations for the check at most, as far as the budget allows; 0: none is made, and none is
        missed.

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
    theory: ClassVar[Theory] = AUTOMATIC
    bounds_failed_runs: ClassVar[bool] = True
    any_structure: ClassVar[bool] = True
    units_may_differ: ClassVar[UnitsMayDiffer] = "in all"
    adaptive: ClassVar[bool] = True
    most_values: ClassVar[int] = 4

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
            course = Course(replace(task, session=session))
            partner = self._surfaces(course, budget)
            answered = [i for i in everything if course.status(i) == "converged"]
            unseen = self._check(course, answered, partner)
            rest = [
                i
                for i in everything
                if i not in answered or i in unseen or course.contradicted(i)
                # no other method sees infinite responses where the runs of the surface have not
                if math.isfinite(task.criteria[i].threshold) or 0.0 < course.pf(i) < 1.0
            ]
            rest = self._along_lines(course, self._helped(course, rest, partner), partner)
            if rest and session.remaining >= FEWEST_OF_SIMULATION:
                course.ask(self._simulation(task, rest), rest, session.remaining, "answer")
            nothing = 0 < session.n_failed == session.n_evals
            if rest := [i for i in rest if course.best(i) is None and not nothing]:
                course.ask(MonteCarlo(), rest, session.remaining, "answer")
            wanted = self.check_runs > 0
            answers = [course.answer(i, self.target_cov, check_wanted=wanted) for i in everything]
        return Solution(answers, AutomaticDetails(tuple(course.attempts)))

    def _surfaces(self, course: Course, budget: int) -> Problem | None:
        """Answer by a surface, and what it doubts by another; return the better one as partner.

        A process that learns the length of every input is soon lost among many of them, where few
        polynomials may be all there is, in the inputs' own distributions above all.
        """
        task, everything = course.task, range(len(course.task.criteria))
        share = budget // SURFACE_SHARE
        most = min(budget, max(FEWEST_OF_SURFACE, share), MOST_OF_SURFACE)
        surface = Kriging(target_cov=self.target_cov)
        details = course.ask(surface, everything, most, "answer").details
        doubted = [i for i in everything if course.status(i) in ("doubtful", "budget_exhausted")]
        most = max(most, min(share, RUNS_OF_INPUT * task.problem.kinds.dimension))
        if doubted and task.session.remaining >= most + FEWEST_OF_SIMULATION:
            polynomials = PolynomialChaos(target_cov=self.target_cov)
            other = course.ask(polynomials, doubted, most, "answer").details
            details = min((details, other), key=_misfit)
        return as_partner(details, course.task.problem)

    def _check(self, course: Course, answered: list[int], partner: Problem | None) -> list[int]:
        """Check what a surface has answered; return what runs of the model have not seen."""
        if self.check_runs == 0:
            return []
        task, session = course.task, course.task.session
        everything = [i for i in answered if 0.0 < course.pf(i) < 1.0]
        rows = [i for i in everything if task.criteria[i].tau is None] or everything
        before = session.n_evals

        def left() -> int:
            return min(self.check_runs - (session.n_evals - before), session.remaining)

        unseen, equal = list(rows), task.problem.exchangeable
        most = 1 if equal else MOST_DIRECTIONS
        few = [i for i in rows if _directions(task, [i]) <= most]
        for i in sorted(few, key=course.pf)[:THRESHOLDS] if partner is not None else []:
            if left() >= FEWEST_GUIDED:
                method = GuidedSampling(target_cov=self.target_cov, refined=False)
                course.ask(method, [i], left(), "check", partner)
            if course.is_checked(i):
                unseen.remove(i)
                if not course.contradicted(i):
                    # the same surface answers them, closer to its runs
                    said = f"the surface holds at {task.criteria[i]}"
                    for other in unseen:
                        course.held(other, said)
                    unseen = []
                    break
        if partner is not None and equal and unseen and left() >= FEWEST_GUIDED:
            unseen = check_of_one_unit(course, unseen, partner, left(), self.target_cov)
        many = [i for i in rows if i not in few]
        systems = left() // max(1, _directions(task, many))
        if seen := [i for i in many if course.pf(i) * systems >= SEEN_FAILURES]:
            course.ask(MonteCarlo(), seen, left(), "check")
        if all(course.is_checked(i) and not course.contradicted(i) for i in rows):
            for i in everything:
                if i not in rows:
                    course.held(i, "the surface holds without tau")
        return [i for i in everything if not course.is_checked(i)]

    def _helped(self, course: Course, rest: list[int], partner: Problem | None) -> list[int]:
        """Simulate rows with a surface as partner; return those that are still open."""
        task, session = course.task, course.task.session
        if partner is None:
            return rest
        few = _few(task, rest)
        wanted = ENOUGH_FAILURES if few else FREQUENT
        frequent = [i for i in rest if course.pf(i) * session.remaining > wanted]
        if frequent and session.remaining >= FEWEST_OF_SIMULATION:
            helped = MultifidelityMonteCarlo(target_cov=self.target_cov)
            course.ask(helped, frequent, session.remaining, "answer", partner)
            rest = [i for i in rest if course.status(i) != "converged"]
        elif not _many(task):
            rest = self._guided(course, rest, partner)
        return rest

    def _guided(self, course: Course, rest: list[int], partner: Problem | None) -> list[int]:
        """Sample rows where a surface says that they fail; return those that are still open."""
        left = course.task.session.remaining
        if partner is None or not rest or not _few(course.task, rest) or left < FEWEST_GUIDED:
            return rest
        course.ask(GuidedSampling(target_cov=self.target_cov), rest, left, "answer", partner)
        return [i for i in rest if course.status(i) != "converged"]

    def _along_lines(self, course: Course, rest: list[int], partner: Problem | None) -> list[int]:
        """Answer rows of many inputs along lines or rays; return those that are still open.

        A direction, or all of them alike, may be all that matters: what a density of many
        variables is fitted to with much effort, lines find with a few hundred runs, or not at all.
        """
        task, session = course.task, course.task.session
        if not _many(task) or not _few(task, rest):
            return rest
        lines = LineSampling(target_cov=self.target_cov)
        rays = DirectionalSampling(target_cov=self.target_cov)
        for method in (lines, rays):
            if method is rays:
                rest = self._guided(course, rest, partner)
            if rest and session.remaining >= FEWEST_OF_SIMULATION:
                course.ask(method, rest, session.remaining // PART_OF_LINES, "answer")
                rest = [i for i in rest if course.status(i) != "converged"]
        return rest

    def _simulation(self, task: Task, rows: Sequence[int]) -> ReliabilityMethod:
        """Return the sampler: a density cannot be fitted to many directions of failure."""
        if _few(task, rows):
            return ImportanceSampling(target_cov=self.target_cov)
        return SubsetSimulation(target_cov=self.target_cov)


def _misfit(details: object) -> float:
    return details.relative_error if isinstance(details, SURFACES) else math.inf


def _many(task: Task) -> bool:
    return task.problem.kinds.dimension > MANY_INPUTS


def _few(task: Task, rows: Sequence[int]) -> bool:
    """Whether each row may have runs of its own, and a density that is fitted to its failures."""
    return _directions(task, rows) <= MOST_DIRECTIONS and len(rows) <= MOST_ALONE


def _directions(task: Task, rows: Sequence[int]) -> int:
    """Units times missions: each of them may fail in a direction of its own."""
    return task.problem.n_units * max((task.criteria[i].max_missions for i in rows), default=0)


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
