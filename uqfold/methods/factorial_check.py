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
from uqfold.methods.factorial_answers import fallbacks_that_matter
from uqfold.methods.factorial_rules import OuterRule, SurfaceMoments
from uqfold.methods.factorial_runs import MORE, FactorialRuns
from uqfold.methods.factorial_tested import TestedSurface, tested_surfaces
from uqfold.methods.factorial_verdict import (
    OtherAnswers,
    judged,
    reliability_of,
    with_reasons,
)
from uqfold.methods.result import NO_ANSWER, Estimate
from uqfold.methods.task import Task
from uqfold.moments.conditional import integrable
from uqfold.moments.families import FAMILIES, Family
from uqfold.problems.criterion import Criterion
from uqfold.system.conditional import system_failures_of_kinds
from uqfold.system.conditional_response import ConditionalResponse
from uqfold.system.structure import SystemUnits
from uqfold.typing import BoolArray, FloatArray

OTHERS = ("saddlepoint", "pearson", "cubic-normal")
"""Families that are compared with one another unless others are named."""
_FINER, _MOST_OUTER = 6, 100
"""Nodes that the finest rule over a shared input has more, and most nodes over all of them."""
_ASKED = (0, 1, 2, 5, 15, 50, 84, 94, 97, 98, 99)
"""Places, in the order of what their responses miss the polynomial by, whose answers are asked."""


@dataclass(frozen=True, eq=False)
class CheckedKind:
    """What a check knows of one kind of units.

    Attributes
    ----------
    outer
        The rule of the design over the shared inputs, one with two nodes more for each of them,
        and the finest.
    tested
        The corrected polynomial.
    whole
        Whether the design left no interaction out.
    """

    outer: tuple[OuterRule, OuterRule, OuterRule]
    tested: TestedSurface
    whole: bool


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
    kinds
        Each kind of units, over the same shared nodes. What is changed is changed for all of them.
    """

    units: SystemUnits
    own: Family
    others: Sequence[Family]
    kinds: Sequence[CheckedKind]

    def misses_at(self, criteria: Sequence[Criterion]) -> FloatArray:
        """How far responses of any kind near each threshold may be from their polynomial (C,)."""
        return np.asarray(np.max([one.tested.misses_at(criteria) for one in self.kinds], axis=0))

    def differences(
        self, criteria: Sequence[Criterion], estimates: Sequence[Estimate]
    ) -> OtherAnswers:
        """Answer in other ways what the method has answered by `estimates`.

        Answers are compared in the smaller one of pf and reliability, which the other, near 1, has
        no digits to tell.
        """
        works = np.array([reliability_of(one) < one.pf for one in estimates])
        answers = np.array([min(one.pf, reliability_of(one)) for one in estimates])
        misses = self.misses_at(criteria)
        # units of two kinds, or of a design that leaves interactions out, may be further apart, too
        apart = len(self.kinds) > 1 or not self.kinds[0].whole
        lower, higher = (_moved(criteria, sign * misses, apart) for sign in (-1.0, 1.0))
        # thresholds of one tau share their integration
        every = [*criteria, *lower, *higher]
        three = self._answers(1, self.own, every, np.tile(works, 3))
        own, *moved = three.reshape(3, -1)
        inside = self._answers(0, self.own, criteria, works)
        outside = self._answers(2, self.own, criteria, works)
        causes = [
            "runs with two nodes more along each input",
            "two nodes more over the shared inputs",
            f"{self.kinds[0].outer[2].weights.size} nodes over the shared inputs",
            "responses near the threshold",
            "responses all around",
            "responses beyond the threshold",
        ]
        amounts = [
            np.abs(inside - answers),
            np.abs(own - inside),
            np.abs(outside - own),
            np.maximum(*(np.abs(one - own) for one in moved)),
            self._around(criteria, works, own),
            answers * np.max([one.tested.astray_at(criteria) for one in self.kinds], axis=0),
        ]
        amounts = [np.nan_to_num(one, nan=np.inf) for one in amounts]
        families = np.zeros(len(criteria), dtype=bool)
        for family in self.others:
            other = self._answers(1, family, criteria, works)
            families |= ~np.isnan(other)
            causes.append(family.title)
            amounts.append(np.abs(other - own))
        return OtherAnswers(causes, np.array(amounts), families)

    def _around(
        self, criteria: Sequence[Criterion], works: BoolArray, own: FloatArray
    ) -> FloatArray:
        """Return what responses that miss the polynomial all around change the answers by (C,).

        As if what each of them misses it by were added at all places that share its narrow
        feature: at one in `LOOKS`. Of those that miss it by little only a few are asked.
        """
        changes = [np.zeros(len(criteria))]
        for kind in self.kinds:
            apart = np.sort(kind.tested.apart)
            by = apart[np.unique(np.clip(_ASKED, 0, apart.size - 1))]
            every = [
                one for step in by for one in _moved(criteria, np.full(works.size, -step), False)
            ]
            moved = self._answers(1, self.own, every, np.tile(works, by.size))
            moved = np.where(np.isnan(moved), 1.0, moved).reshape(by.size, -1)
            mean = [np.interp(apart, by, moved[:, one]).mean() for one in range(works.size)]
            changes.append(np.abs(np.array(mean) - own))
        return np.asarray(np.max(changes, axis=0))

    def _answers(
        self, finer: int, family: Family, criteria: Sequence[Criterion], works: BoolArray
    ) -> FloatArray:
        """Return pf, or the reliability where `works` (C,); NaN where there is no answer."""
        answers = np.full(len(criteria), np.nan)
        rules = [one.outer[finer] for one in self.kinds]
        fitted = [rule.fitted(family.fit) for rule in rules]
        known = [one for one in fitted if one is not None]
        if len(known) < len(fitted):
            return answers
        dense = all(integrable(one) for own in known for one in own)
        rows = [row for row, one in enumerate(criteria) if dense or one.tau is None]
        asked = [criteria[row] for row in rows]
        responses = [[ConditionalResponse(one) for one in own] for own in known]
        weights = rules[0].weights
        found = system_failures_of_kinds(responses, weights, self.units, asked)
        answers[rows] = np.where(
            works[rows], [one.reliability for one in found], [one.pf for one in found]
        )
        for kind, own in enumerate(known):
            away = fallbacks_that_matter(weights, own, self.units, asked, found, kind=kind)
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
    runs: Sequence[FactorialRuns],
    own: Family,
    estimates: Sequence[Estimate],
    target: float,
    others: Sequence[str] = OTHERS,
    changes: Sequence[tuple[str, FloatArray]] = (),
) -> list[Estimate]:
    """Check answers: each becomes ``converged`` or ``doubtful``.

    Where the budget or the time has no room for the check they stay ``unchecked``, with the reason.

    Parameters
    ----------
    task
        Problem, criteria and session.
    runs
        The design and its finite responses, of each kind of units.
    own
        Distributions of the method.
    estimates
        Its answers.
    target
        Largest stated error, relative to pf or to the reliability, whichever is smaller, of one
        that is converged.
    others
        Names of families to compare with.
    changes
        What else pf, or the reliability, has been changed by already (C,), with the cause of each.
    """
    try:
        check = _check(task, runs, own, [FAMILIES[name] for name in others])
        rows = [row for row, one in enumerate(estimates) if one.status not in NO_ANSWER]
        asked = [task.criteria[row] for row in rows]
        differences = check.differences(asked, [estimates[row] for row in rows])
        for cause, amounts in changes:
            differences = differences.joined_by(cause, amounts[rows])
    except (BudgetExceededError, TimeLimitError) as error:
        return _noted(estimates, f"not checked: {error}")
    except ValueError as error:
        return _doubted(estimates, str(error))
    answers = list(estimates)
    misses = check.misses_at(asked)
    for position, row in enumerate(rows):
        miss = float(misses[position])
        answers[row] = judged(estimates[row], asked[position], differences, position, miss, target)
    return answers


def design_with_verdicts(
    task: Task,
    counts: Sequence[Sequence[int]],
    y: Sequence[FloatArray],
    own: Family,
    estimates: Sequence[Estimate],
    target: float,
    others: Sequence[str] = OTHERS,
) -> list[Estimate]:
    """Check answers from the responses `y` of products of `counts` nodes; see with_verdicts.

    Both are those of each kind of units.
    """
    if not all(np.isfinite(own).all() for own in y):
        return _doubted(estimates, "responses that are not finite cannot be checked")
    runs = [
        FactorialRuns.of_product(task, *own, kind)
        for kind, own in enumerate(zip(counts, y, strict=True))
    ]
    return with_verdicts(task, runs, own, estimates, target, others)


def _check(
    task: Task, runs: Sequence[FactorialRuns], own: Family, others: Sequence[Family]
) -> FactorialCheck:
    quadratic = any(family.moments == 0 for family in (own, *others))
    kinds = []
    for one, tested in zip(runs, tested_surfaces(runs), strict=True):
        outer = [[n + more for n in one.outer] for more in (0, MORE, _FINER)]
        while math.prod(outer[2]) > max(_MOST_OUTER, math.prod(outer[1])):
            outer[2] = [n - 1 for n in outer[2]]
        surface = SurfaceMoments(
            one.known.inputs, tested.surface, one.least, one.additive, quadratic
        )
        first, more, finest = (surface.at(some, math.prod(outer[2])) for some in outer)
        kinds.append(CheckedKind((first, more, finest), tested, one.whole))
    others = [family for family in others if family.title != own.title]
    return FactorialCheck(SystemUnits.of(task.problem), own, others, kinds)


def _doubted(estimates: Sequence[Estimate], doubt: str) -> list[Estimate]:
    return [
        one if one.status in NO_ANSWER else with_reasons(replace(one, status="doubtful"), [doubt])
        for one in estimates
    ]


def _noted(estimates: Sequence[Estimate], note: str) -> list[Estimate]:
    return [one if one.status in NO_ANSWER else with_reasons(one, [note]) for one in estimates]
