"""What several methods that are tried on one task add up to."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, field, replace

from uqfold.methods.base import ReliabilityMethod
from uqfold.methods.result import NO_ANSWER, NORMAL_95, Estimate
from uqfold.methods.task import Solution, Task
from uqfold.methods.weighted_sums import BY_WEIGHTS
from uqfold.problems.base import Problem
from uqfold.problems.criterion import Criterion

SOUND = frozenset({"converged", "budget_exhausted"})
AGREE = 3.5
"""Joint standard errors by which two answers may differ."""
SEEN = 0.25
"""A check whose stated error is more than this share of pf has not seen the surface."""
WIDE = 0.25
"""A doubtful simulation that is wider than this knows less than a surface within its interval."""

HARDLY = 0.5
"""One that is wider than this, and in doubt for other reasons, knows hardly anything."""


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
class _Told:
    """What one method said to one criterion.

    `sound` is what it may hold against other answers, or None; `only_wide`: nothing but its width
    is in doubt.
    """

    attempt: MethodTried
    estimate: Estimate
    sound: Estimate | None
    only_wide: bool

    @property
    def bounds(self) -> bool:
        """Whether it says on the model itself where pf can be, however wide."""
        one = self.estimate
        counted = one.ci_kind.startswith(("clopper-pearson", "upper bound"))
        return one.error_kind == "sampling" and (counted or self.sound is not None)


@dataclass
class _Row:
    """What is known of one criterion: answers and checks by methods, and what checks have shown."""

    told: list[_Told] = field(default_factory=list)
    checked: bool = False
    refuted: bool = False
    said: list[str] = field(default_factory=list)


class Course:
    """The attempts at one task so far, and what they add up to.

    Attributes
    ----------
    task
        The task.
    attempts
        What was tried, in order.
    """

    def __init__(self, task: Task) -> None:
        self.task = task
        self.attempts: list[MethodTried] = []
        self._rows = [_Row() for _ in task.criteria]

    def ask(
        self,
        method: ReliabilityMethod,
        rows: Sequence[int],
        most: int,
        purpose: str,
        problem: Problem | None = None,
    ) -> Solution:
        """Let a method answer some criteria with some of the runs."""
        problem = self.task.problem if problem is None else problem
        criteria = self.task.criteria
        asked = [i for i in rows if method.supports(problem, criteria[i]) is None]
        chosen = tuple(criteria[i] for i in asked)
        solution, attempt = self.tried(method, chosen, most, purpose, problem)
        for i, own, estimate in zip(asked, solution.estimates, attempt.estimates, strict=True):
            # one that is only wide may speak against another all the same, but the answer of a
            # density is compared with what found it only where it is not
            judged = estimate if own.ci_kind == BY_WEIGHTS else own
            speaks = judged.status in SOUND and estimate.states_an_error
            told = _Told(attempt, estimate, estimate if speaks else None, own.status in SOUND)
            narrow = estimate.error_kind == "sampling"
            narrow = narrow and estimate.stated_error <= SEEN * estimate.pf
            # one in doubt contradicts nothing, but where it differs it has confirmed nothing, too
            others = [one.sound for one in self._rows[i].told if one.sound is not None]
            if narrow and (speaks or not any(differ(one, estimate) for one in others)):
                self._rows[i].checked = True
            self._rows[i].told.append(told)
        return solution

    def tried(
        self,
        method: ReliabilityMethod,
        criteria: tuple[Criterion, ...],
        most: int,
        purpose: str,
        problem: Problem,
    ) -> tuple[Solution, MethodTried]:
        """Let a method answer criteria of a problem; also return the record of it."""
        with self.task.session.share(most) as session:
            seed = int(self.task.generator(len(self.attempts)).integers(2**63))
            own = replace(self.task, problem=problem, criteria=criteria, session=session, seed=seed)
            solution = method._guarded(own, lambda: method._solution(own))
            estimates = [method._checked(one, session) for one in solution.estimates]
            made = session.n_evals
        attempt = MethodTried(method, purpose, criteria, tuple(estimates), made)
        self.attempts.append(attempt)
        return solution, attempt

    def status(self, row: int) -> str:
        """Return what the last answer to a criterion says of itself."""
        told = self._rows[row].told
        return told[-1].estimate.status if told else "unsupported"

    def best(self, row: int) -> Estimate | None:
        """Return the best answer to a criterion that is a number, or None; the first of equals."""
        told = [one.estimate for one in self._rows[row].told]
        known = [one for one in told if one.status not in NO_ANSWER]
        return min(known, key=_merit, default=None)

    def pf(self, row: int) -> float:
        """Return the best answer to a criterion; 0 without one."""
        best = self.best(row)
        return 0.0 if best is None else best.pf

    def held(self, row: int, said: str) -> None:
        """Take down that a surface was checked for a criterion, and holds."""
        self._rows[row].checked = True
        self._rows[row].said.append(said)

    def refuted(self, row: int, said: str) -> None:
        """Take down that the surface that answers a criterion is not believed any more."""
        self._rows[row].refuted = True
        self._rows[row].said.append(said)

    def is_checked(self, row: int) -> bool:
        """Whether a check has seen what a surface says to a criterion."""
        return self._rows[row].checked

    def contradicted(self, row: int) -> bool:
        """Whether two answers to a criterion differ by more than their errors allow."""
        sound = [one.sound for one in self._rows[row].told if one.sound is not None]
        apart = any(differ(one, two) for one in sound for two in sound)
        return apart or self._rows[row].refuted

    def answer(self, row: int, target_cov: float, *, check_wanted: bool) -> Estimate:
        """Return the best answer to a criterion, and say what it rests on."""
        known = self._rows[row]
        told = [one for one in known.told if one.estimate.status not in NO_ANSWER]
        if not told:
            messages = [f"{t.attempt.method.name}: {t.estimate.message}" for t in known.told]
            return Estimate.without_answer("failed", "; ".join(messages))
        own = [one for one in told if one.attempt.purpose == "answer"] or told
        # what the model itself bounds, no surface that is in doubt is believed against
        bounds = [one.estimate for one in told if one.bounds]
        possible = [one for one in own if not any(_excludes(b, one.estimate) for b in bounds)]
        best = min(possible or own, key=lambda one: _merit(one.estimate))
        estimate = best.estimate
        messages = [f"by {best.attempt.method.name}", *filter(None, [estimate.message])]
        guess = _within(best, possible)
        if guess is not None:
            interval = f"interval of {best.attempt.method.name}"
            name = guess.attempt.method.name
            messages = [f"by {name}", *filter(None, [guess.estimate.message]), interval]
            estimate = _with_interval(guess.estimate, estimate)
        status = estimate.status
        if self.contradicted(row):
            status = "doubtful"
            messages.append("answers contradict each other")
        shown = best if guess is None else guess
        if shown.attempt.purpose == "answer" and estimate.error_kind == "surrogate":
            needed = status == "converged" and 0.0 < estimate.pf < 1.0
            if needed and not known.checked:
                messages.append("not checked on the model")
                status = "unchecked" if check_wanted else status
        messages += known.said
        messages += [
            f"{one.attempt.method.name} found {_stated(one)}" for one in told if one is not shown
        ]
        if guess is None and best.only_wide and estimate.error_kind == "sampling":
            wide = estimate.stated_error / target_cov / max(estimate.pf, 1e-300)
            if wide > 1.0 and estimate.pf > 0.0:
                enough = best.attempt.n_evals * wide**2
                messages.append(f"about {enough:,.0f} runs would be enough")
        return replace(estimate, status=status, message="; ".join(messages), n_evals_row=None)


def differ(one: Estimate, two: Estimate) -> bool:
    """Whether two answers lie further apart than what both leave open on the side of the other."""
    low, high = (one, two) if one.pf <= two.pf else (two, one)
    open_above, open_below = low.ci_high - low.pf, high.pf - high.ci_low
    return high.pf - low.pf > AGREE / NORMAL_95 * math.hypot(open_above, open_below)


def _excludes(bound: Estimate, other: Estimate) -> bool:
    """Whether the answer of a surface in doubt lies outside what runs of the model allow."""
    if other.error_kind == "sampling" or other.status == "converged":
        return False
    return not bound.ci_low <= other.pf <= bound.ci_high


def _merit(estimate: Estimate) -> tuple[bool, float]:
    """Return what sorts answers: the best comes first."""
    wide = estimate.stated_error / estimate.pf if estimate.pf > 0.0 else math.inf
    return estimate.status != "converged", wide if math.isfinite(wide) else math.inf


def _within(best: _Told, possible: Sequence[_Told]) -> _Told | None:
    """Return a surface that a simulation too wide to know better does not contradict, or None.

    One that rests on a single sample or so is mostly too low, and bounds nothing above.
    """
    one = best.estimate
    if one.error_kind != "sampling" or one.stated_error <= WIDE * one.pf:
        return None
    nothing = not best.bounds and one.stated_error > HARDLY * one.pf
    for other in possible:
        guess = other.estimate
        if guess.error_kind == "sampling":
            continue
        if one.ci_low <= guess.pf <= one.ci_high or (nothing and guess.pf > one.pf):
            return other
    return None


def _with_interval(guess: Estimate, simulated: Estimate) -> Estimate:
    """Return the answer of a surface with what a simulation knows of its error."""
    return replace(
        guess,
        std_error=math.nan,
        ci_low=simulated.ci_low,
        ci_high=max(guess.pf, simulated.ci_high),
        ci_kind=simulated.ci_kind,
        pf_low=simulated.pf_low,
        pf_high=guess.pf if simulated.pf_high is None else max(guess.pf, simulated.pf_high),
        error_kind="sampling",
        status="doubtful",
    )


def _stated(told: _Told) -> str:
    one = told.estimate
    doubt = ", doubtful" if one.status == "doubtful" else ""
    if one.std_error > 0.0:
        return f"{one.pf:.4g} +- {one.std_error:.2g}{doubt}"
    if one.states_an_error:
        return f"{one.pf:.4g} in {one.ci_low:.2g} .. {one.ci_high:.2g}{doubt}"
    return f"{one.pf:.4g} without an error{doubt}"
