"""What full-factorial numerical integration (FFNI) can tell of its own error.

A few runs beside the design test and correct the polynomial through its responses. The question is
then answered again: with the moments of the corrected polynomial, with finer rules over the shared
inputs, with other distributions of the same moments, and with the threshold moved by what the
responses near it miss the polynomial by. How far these answers lie apart is the stated error.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from uqfold.evaluation import BudgetExceededError, TimeLimitError
from uqfold.methods.base import Task
from uqfold.methods.factorial_answers import fallbacks_that_matter
from uqfold.methods.factorial_rules import OuterRule, SurfaceMoments
from uqfold.methods.factorial_runs import MORE, FactorialRuns
from uqfold.methods.factorial_tested import TestedSurface, tested_surface
from uqfold.methods.factorial_verdict import (
    OtherAnswers,
    judged,
    reliability_of,
    with_reasons,
)
from uqfold.methods.result import NO_ANSWER, Estimate
from uqfold.moments.conditional import ConditionalDistribution, integrable
from uqfold.moments.families import FAMILIES, Family
from uqfold.problems.criterion import Criterion
from uqfold.system.conditional import system_failures
from uqfold.system.conditional_response import ConditionalResponse
from uqfold.system.structure import SystemUnits
from uqfold.typing import BoolArray, FloatArray

OTHERS = ("saddlepoint", "pearson", "cubic-normal")
"""Families that are compared with one another unless others are named."""
_BESIDE = "the design without two nodes more along each shared input"
_FINER, _MOST_OUTER = 6, 100
"""Nodes that the finest rule over a shared input has more, and most nodes over all of them."""


@dataclass(frozen=True, eq=False)
class FactorialCheck:
    """Other answers to the questions of a task.

    Attributes
    ----------
    units
        Units and their structure.
    own
        Distributions of the method.
    others
        Others.
    outer
        The rule of the design over the shared inputs, one with two nodes more for each of them,
        and the finest.
    tested
        The corrected polynomial.
    whole
        Whether the design left no interaction out.
    """

    units: SystemUnits
    own: Family
    others: Sequence[Family]
    outer: tuple[OuterRule, OuterRule, OuterRule]
    tested: TestedSurface
    whole: bool

    def differences(
        self, criteria: Sequence[Criterion], estimates: Sequence[Estimate]
    ) -> OtherAnswers:
        """Answer in other ways what the method has answered by `estimates`.

        Answers are compared in the smaller one of pf and reliability, which the other, near 1, has
        no digits to tell.
        """
        works = np.array([reliability_of(one) < one.pf for one in estimates])
        answers = np.array([min(one.pf, reliability_of(one)) for one in estimates])
        first, more, last = (rule.fitted(self.own.fit) for rule in self.outer)
        misses = self.tested.misses_at(criteria)
        # a design that leaves interactions out may miss how far units are apart, too
        apart = not self.whole
        lower, higher = (_moved(criteria, sign * misses, apart) for sign in (-1.0, 1.0))
        # thresholds of one tau share their integration
        three = self._answers(self.outer[1], more, [*criteria, *lower, *higher], np.tile(works, 3))
        own, *moved = three.reshape(3, -1)
        inside = self._answers(self.outer[0], first, criteria, works)
        outside = self._answers(self.outer[2], last, criteria, works)
        causes = [
            "runs with two nodes more along each input",
            "two nodes more over the shared inputs",
            f"{self.outer[2].weights.size} nodes over the shared inputs",
            "responses near the threshold",
        ]
        amounts = [
            np.abs(inside - answers),
            np.abs(own - inside),
            np.abs(outside - own),
            np.maximum(*(np.abs(one - own) for one in moved)),
        ]
        amounts = [np.nan_to_num(one, nan=np.inf) for one in amounts]
        families = np.zeros(len(criteria), dtype=bool)
        for family in self.others:
            distributions = self.outer[1].fitted(family.fit)
            other = self._answers(self.outer[1], distributions, criteria, works)
            families |= ~np.isnan(other)
            causes.append(family.title)
            amounts.append(np.abs(other - own))
        return OtherAnswers(causes, np.array(amounts), families)

    def _answers(
        self,
        rule: OuterRule,
        distributions: Sequence[ConditionalDistribution] | None,
        criteria: Sequence[Criterion],
        works: BoolArray,
    ) -> FloatArray:
        """Return pf, or the reliability where `works` (C,); NaN where there is no answer."""
        answers = np.full(len(criteria), np.nan)
        if distributions is None:
            return answers
        dense = all(integrable(one) for one in distributions)
        rows = [row for row, one in enumerate(criteria) if dense or one.tau is None]
        asked = [criteria[row] for row in rows]
        responses = [ConditionalResponse(one) for one in distributions]
        found = system_failures(responses, rule.weights, self.units, asked)
        answers[rows] = np.where(
            works[rows], [one.reliability for one in found], [one.pf for one in found]
        )
        away = fallbacks_that_matter(rule.weights, distributions, self.units, asked, found)
        answers[np.array(rows, dtype=int)[away > 0]] = np.nan
        return answers


def _moved(criteria: Sequence[Criterion], by: FloatArray, apart: bool) -> list[Criterion]:
    """Move thresholds, and tau where units may be `apart` by as much."""
    moved = []
    for one, step in zip(criteria, by.tolist(), strict=True):
        tau = max(one.tau + step, 0.0) if apart and one.tau is not None else one.tau
        moved.append(replace(one, threshold=one.threshold + step, tau=tau))
    return moved


def with_verdicts(
    task: Task,
    runs: FactorialRuns,
    own: Family,
    estimates: Sequence[Estimate],
    target: float,
    others: Sequence[str] = OTHERS,
    change: FloatArray | None = None,
) -> list[Estimate]:
    """Check answers: each becomes ``converged`` or ``doubtful``.

    Where the budget or the time has no room for the check they stay ``unchecked``, with the reason.

    Parameters
    ----------
    task
        Problem, criteria and session.
    runs
        The design and its finite responses.
    own
        Distributions of the method.
    estimates
        Its answers.
    target
        Largest stated error, relative to pf or to the reliability, whichever is smaller, of one
        that is converged.
    others
        Names of families to compare with.
    change
        What runs beside the design have changed pf, or the reliability, by already (C,).
    """
    try:
        check = _check(task, runs, own, [FAMILIES[name] for name in others])
        rows = [row for row, one in enumerate(estimates) if one.status not in NO_ANSWER]
        asked = [task.criteria[row] for row in rows]
        differences = check.differences(asked, [estimates[row] for row in rows])
        if change is not None:
            differences = differences.joined_by(_BESIDE, change[rows])
    except (BudgetExceededError, TimeLimitError) as error:
        return _noted(estimates, f"not checked: {error}")
    except ValueError as error:
        return _doubted(estimates, str(error))
    answers = list(estimates)
    misses = check.tested.misses_at(asked)
    for position, row in enumerate(rows):
        miss = float(misses[position])
        answers[row] = judged(estimates[row], asked[position], differences, position, miss, target)
    return answers


def design_with_verdicts(
    task: Task,
    counts: Sequence[int],
    y: FloatArray,
    own: Family,
    estimates: Sequence[Estimate],
    target: float,
    others: Sequence[str] = OTHERS,
) -> list[Estimate]:
    """Check answers from the responses `y` of one product of `counts` nodes; see with_verdicts."""
    if not np.isfinite(y).all():
        return _doubted(estimates, "responses that are not finite cannot be checked")
    runs = FactorialRuns.of_product(task, counts, y)
    return with_verdicts(task, runs, own, estimates, target, others)


def _check(
    task: Task, runs: FactorialRuns, own: Family, others: Sequence[Family]
) -> FactorialCheck:
    inputs = task.problem.inputs
    tested = tested_surface(task, runs)
    outer = [[n + more for n in runs.outer] for more in (0, MORE, _FINER)]
    while math.prod(outer[2]) > max(_MOST_OUTER, math.prod(outer[1])):
        outer[2] = [n - 1 for n in outer[2]]
    quadratic = any(family.moments == 0 for family in (own, *others))
    surface = SurfaceMoments(inputs, tested.surface, runs.least, runs.additive, quadratic)
    first, more, finest = (surface.at(some, math.prod(outer[2])) for some in outer)
    others = [family for family in others if family.title != own.title]
    units = SystemUnits.of(task.problem)
    return FactorialCheck(units, own, others, (first, more, finest), tested, runs.whole)


def unchecked_kinds(estimates: Sequence[Estimate]) -> list[Estimate]:
    """Leave the answers of units of several kinds as they are, and say so."""
    return _noted(estimates, "not checked: units have models or inputs of their own")


def _doubted(estimates: Sequence[Estimate], doubt: str) -> list[Estimate]:
    return [
        one if one.status in NO_ANSWER else with_reasons(replace(one, status="doubtful"), [doubt])
        for one in estimates
    ]


def _noted(estimates: Sequence[Estimate], note: str) -> list[Estimate]:
    return [one if one.status in NO_ANSWER else with_reasons(one, [note]) for one in estimates]
