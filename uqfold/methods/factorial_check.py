"""What full-factorial numerical integration (FFNI) can tell of its own error.

A few runs beside the design test and correct the polynomial through its responses. The question is
then answered again: with the moments of the corrected polynomial, with finer rules over the shared
inputs, with other distributions of the same moments, and with the threshold moved by what the
responses near it miss the polynomial by. How far these answers lie apart is the stated error.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import TypeAlias

import numpy as np

from uqfold.evaluation import BudgetExceededError, TimeLimitError
from uqfold.inputs import JointInputs
from uqfold.methods.base import Task
from uqfold.methods.factorial_answers import fallbacks_that_matter
from uqfold.methods.factorial_design import Fit
from uqfold.methods.factorial_runs import (
    MORE,
    MOST_POINTS,
    TestedSurface,
    product_of_weights,
    rules_of,
    tested_surface,
)
from uqfold.methods.result import NO_ANSWER, NORMAL_95, Estimate
from uqfold.moments.conditional import ConditionalDistribution, integrable
from uqfold.moments.cubic_normal import cubic_normal
from uqfold.moments.cumulants import moments_from_rule
from uqfold.moments.pearson import PearsonDistribution
from uqfold.moments.saddlepoint import SaddlepointDistribution
from uqfold.problems.criterion import Criterion
from uqfold.system.conditional import system_failures
from uqfold.system.conditional_response import ConditionalResponse
from uqfold.system.structure import SystemUnits
from uqfold.typing import BoolArray, FloatArray

OtherFit: TypeAlias = Callable[[float, float, float, float], ConditionalDistribution | None]
"""Builds a distribution from the four moments, or has none with these."""

OTHERS: dict[str, OtherFit] = {
    "the saddlepoint approximation": SaddlepointDistribution,
    "the Pearson distribution": PearsonDistribution.from_moments,
    "the cubic normal distribution": cubic_normal,
}
_CAUTION = 1.5
"""Stated error over what the answers differ by; see ``docs/ffni.md`` for what was measured."""
_LEAST = 5e-3
"""Smallest stated error, as a share of pf or of its complement."""
_FINE = 13
"""Nodes over an individual input that integrate fourth powers of polynomials of degree 6."""
_FINER, _MOST_OUTER = 6, 100
"""Nodes that the finest rule over a shared input has more, and most nodes over all of them."""
_BLURRED = 0.05
"""Share of tau by which responses may miss the polynomial."""


@dataclass(frozen=True, eq=False)
class OuterRule:
    """Moments of the corrected polynomial at the nodes of a rule over the shared inputs.

    Attributes
    ----------
    weights
        Weights of the K nodes.
    moments
        Mean, standard deviation, skewness and kurtosis at each of them (K, 4).
    """

    weights: FloatArray
    moments: FloatArray

    def fitted(self, fit: OtherFit) -> list[ConditionalDistribution] | None:
        """Return a distribution at every node, or None if one node has none."""
        found = [fit(*row) for row in self.moments.tolist()]
        known = [one for one in found if one is not None]
        return known if len(known) == len(found) else None


@dataclass(frozen=True, eq=False)
class OtherAnswers:
    """How far answers of the same question lie apart.

    Attributes
    ----------
    causes
        What was changed (S,), as the subject of a sentence.
    amounts
        What that changed pf, or the reliability, by (S, C); infinite where the method itself found
        no answer, NaN where another distribution has none.
    families
        Whether another distribution could be compared (C,).
    """

    causes: list[str]
    amounts: FloatArray
    families: BoolArray


@dataclass(frozen=True, eq=False)
class FactorialCheck:
    """Other answers to the questions of a task.

    Attributes
    ----------
    units
        Units and their structure.
    own
        Builds the distributions of the method.
    others
        Builds others.
    outer
        The rule of the design over the shared inputs, one with two nodes more for each of them,
        and the finest.
    tested
        The corrected polynomial.
    """

    units: SystemUnits
    own: Fit
    others: Mapping[str, OtherFit]
    outer: tuple[OuterRule, OuterRule, OuterRule]
    tested: TestedSurface

    def differences(
        self, criteria: Sequence[Criterion], estimates: Sequence[Estimate]
    ) -> OtherAnswers:
        """Answer in other ways what the method has answered by `estimates`.

        Answers are compared in the smaller one of pf and reliability, which the other, near 1, has
        no digits to tell.
        """
        works = np.array([_reliability(one) < one.pf for one in estimates])
        answers = np.array([min(one.pf, _reliability(one)) for one in estimates])
        first, more, last = (rule.fitted(self.own) for rule in self.outer)
        misses = self.tested.misses_at(criteria)
        lower, higher = (_moved(criteria, sign * misses) for sign in (-1.0, 1.0))
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
        for name, fit in self.others.items():
            other = self._answers(self.outer[1], self.outer[1].fitted(fit), criteria, works)
            families |= ~np.isnan(other)
            causes.append(name)
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


def _moved(criteria: Sequence[Criterion], by: FloatArray) -> list[Criterion]:
    return [
        replace(one, threshold=one.threshold + step)
        for one, step in zip(criteria, by.tolist(), strict=True)
    ]


def with_verdicts(
    task: Task,
    counts: Sequence[int],
    y: FloatArray,
    own: Fit,
    estimates: Sequence[Estimate],
    target: float,
) -> list[Estimate]:
    """Check answers: each becomes ``converged`` or ``doubtful``.

    Where the budget or the time has no room for the check they stay ``unchecked``, with the reason.

    Parameters
    ----------
    task
        Problem, criteria and session.
    counts
        Nodes of every input in the design.
    y
        Responses of the design.
    own
        Builds the distributions of the method.
    estimates
        Its answers.
    target
        Largest stated error, relative to pf or to the reliability, whichever is smaller, of one
        that is converged.
    """
    if not np.isfinite(y).all():
        return _doubted(estimates, "responses that are not finite cannot be checked")
    try:
        check = _check(task, counts, y, own)
        rows = [row for row, one in enumerate(estimates) if one.status not in NO_ANSWER]
        asked = [task.criteria[row] for row in rows]
        differences = check.differences(asked, [estimates[row] for row in rows])
    except (BudgetExceededError, TimeLimitError) as error:
        return _noted(estimates, f"not checked: {error}")
    except ValueError as error:
        return _doubted(estimates, str(error))
    judged = list(estimates)
    misses = check.tested.misses_at(asked)
    for position, row in enumerate(rows):
        miss = float(misses[position])
        judged[row] = _judged(estimates[row], asked[position], differences, position, miss, target)
    return judged


def _check(task: Task, counts: Sequence[int], y: FloatArray, own: Fit) -> FactorialCheck:
    inputs = task.problem.inputs
    tested = tested_surface(task, counts, y)
    shared = counts[: inputs.n_shared]
    outer = [[n + more for n in shared] for more in (0, MORE, _FINER)]
    while math.prod(outer[2]) > max(_MOST_OUTER, math.prod(outer[1])):
        outer[2] = [n - 1 for n in outer[2]]
    inner = _inner_counts(inputs, counts, math.prod(outer[2]))
    first, more, finest = (_outer_rule(inputs, tested, [*some, *inner]) for some in outer)
    others = {name: fit for name, fit in OTHERS.items() if fit != own}
    return FactorialCheck(SystemUnits.of(task.problem), own, others, (first, more, finest), tested)


def _inner_counts(inputs: JointInputs, counts: Sequence[int], outer: int) -> list[int]:
    """Return nodes over the individual inputs: as many as memory and marginals allow."""
    designed = counts[inputs.n_shared :]
    for n in range(_FINE, min(designed, default=_FINE), -1):
        wanted = [max(n, count) for count in designed]
        if outer * math.prod(wanted) <= MOST_POINTS:
            try:
                rules_of(inputs, [*counts[: inputs.n_shared], *wanted])
            except ValueError:
                continue
            return wanted
    return list(designed)


def _outer_rule(inputs: JointInputs, tested: TestedSurface, counts: Sequence[int]) -> OuterRule:
    rules = rules_of(inputs, counts)
    outer, inner = rules[: inputs.n_shared], rules[inputs.n_shared :]
    weights = product_of_weights(outer)
    values = tested.surface.on_grid([places for places, _ in rules]).reshape(weights.size, -1)
    found = moments_from_rule(values, product_of_weights(inner))
    moments = np.stack([found.mean, found.std, found.skewness, found.kurtosis], axis=1)
    return OuterRule(weights, moments)


def _judged(
    estimate: Estimate,
    criterion: Criterion,
    differences: OtherAnswers,
    row: int,
    miss: float,
    target: float,
) -> Estimate:
    """Return one answer with its stated error and status."""
    pf, reliability = estimate.pf, _reliability(estimate)
    name, smaller = ("reliability", reliability) if reliability < pf else ("pf", pf)
    amounts = np.nan_to_num(differences.amounts[:, row], nan=0.0, posinf=math.inf)
    stated = math.hypot(_CAUTION * float(np.sqrt(amounts @ amounts)), _LEAST * smaller)
    doubts = []
    if smaller == 0.0:
        does = "fails" if name == "pf" else "works"
        doubts.append(f"{name} = 0: no response of the design, nor what is fitted to them, {does}")
    elif stated > target * smaller:
        worst = int(amounts.argmax())
        share = 100.0 * float(amounts[worst]) / smaller
        by = f"by {share:.2g} %" if math.isfinite(share) else "beyond what the method can answer"
        doubts.append(f"compared with {differences.causes[worst]}, {name} changes {by}")
    if not differences.families[row]:
        doubts.append("no other distribution with these moments to compare with")
    if criterion.tau is not None and not miss <= _BLURRED * criterion.tau:
        doubts.append(f"responses miss the polynomial by {miss:.2g}, tau is {criterion.tau:g}")
    if estimate.status == "doubtful" or doubts:
        return _with_reasons(replace(estimate, status="doubtful"), doubts)
    return replace(
        estimate,
        std_error=stated,
        ci_low=max(pf - NORMAL_95 * stated, 0.0),
        ci_high=min(pf + NORMAL_95 * stated, 1.0),
        ci_kind="normal 95 %, from rules and distributions compared",
        error_kind="surrogate",
        status="converged",
    )


def _reliability(estimate: Estimate) -> float:
    return 1.0 - estimate.pf if estimate.reliability is None else estimate.reliability


def _doubted(estimates: Sequence[Estimate], doubt: str) -> list[Estimate]:
    return [
        one if one.status in NO_ANSWER else _with_reasons(replace(one, status="doubtful"), [doubt])
        for one in estimates
    ]


def _noted(estimates: Sequence[Estimate], note: str) -> list[Estimate]:
    return [one if one.status in NO_ANSWER else _with_reasons(one, [note]) for one in estimates]


def _with_reasons(estimate: Estimate, reasons: Sequence[str]) -> Estimate:
    said = [estimate.message] if estimate.message else []
    return replace(estimate, message="; ".join([*said, *reasons]))
