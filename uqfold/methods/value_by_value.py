"""One answer for each value of the discrete inputs, and the exact sum of them."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace
from typing import Any

from uqfold.evaluation import EvaluationSession
from uqfold.methods.result import (
    NO_ANSWER,
    NORMAL_95,
    STATUSES,
    ErrorKind,
    Estimate,
    Status,
)
from uqfold.problems.base import Problem
from uqfold.problems.held_values import HeldModel, HeldValues, with_values

NEGLIGIBLE = 0.01
"""Share of the smaller of pf and reliability that may hang on a value whose answer is in doubt, or
on values that are left out."""


@dataclass(frozen=True)
class ValueByValueDetails:
    """Answers given each value of the discrete inputs.

    Attributes
    ----------
    held
        The values and their probabilities.
    estimates
        For each of them the answers to the criteria, in order.
    details
        For each of them what the method found on its way.
    """

    held: HeldValues
    estimates: tuple[tuple[Estimate, ...], ...]
    details: tuple[Any, ...]


def value_by_value(
    problem: Problem,
    held: HeldValues,
    session: EvaluationSession,
    solve: Callable[[int, Problem, EvaluationSession], tuple[Sequence[Estimate], Any]],
) -> tuple[list[Estimate], ValueByValueDetails]:
    """Answer a problem for each value of its discrete inputs, and sum up.

    What is left of the budget is split into equal shares for the values that are left.

    Parameters
    ----------
    problem, held
        The problem, and the values.
    session
        Counted access to its model.
    solve
        Answers the criteria for one value: takes its number, the problem of the other inputs and
        access to its model, returns the answers and details.
    """
    told: list[tuple[Estimate, ...]] = []
    details = []
    count = len(held.probabilities)
    for row in range(count):
        sub = with_values(problem, held, row)
        with session.share(session.remaining // (count - row)) as part:
            if session.max_evals is None:
                part.max_evals = None
            assert isinstance(sub.model, HeldModel)
            part.dimension, part.lift = sub.inputs.dimension, sub.model.place.rows
            part.slopes = sub.kinds.gradients
            estimates, found = solve(row, sub, part)
            told.append(tuple(_own(one, part.n_failed) for one in estimates))
        details.append(found)
    sums = [_summed(held, answers) for answers in zip(*told, strict=True)]
    return sums, ValueByValueDetails(held, tuple(told), tuple(details))


def _own(estimate: Estimate, n_failed: int) -> Estimate:
    """Return the answer for one value as it goes into the sum."""
    if estimate.status in NO_ANSWER or not 0.0 <= estimate.pf <= 1.0:
        message = estimate.message or f"pf = {estimate.pf} is not a probability"
        return Estimate.without_answer("failed", message)
    if estimate.status == "converged" and not estimate.states_an_error:
        estimate = replace(estimate, status="unchecked")
    if n_failed == 0:
        estimate = replace(estimate, pf_low=estimate.pf, pf_high=estimate.pf)
    return estimate


def _summed(held: HeldValues, told: Sequence[Estimate]) -> Estimate:
    """Sum up the answers for all values.

    Errors of samples that have nothing to do with each other add up by their squares, all others,
    and the ends of intervals, as they are. What is in doubt for a value, or not answered, changes
    pf by the probability of the value at most: it is passed over as long as that is negligible.
    """
    answered = [(w, one) for w, one in _pairs(held, told) if one.status not in NO_ANSWER]
    pf = math.fsum(w * one.pf for w, one in answered)
    works = math.fsum(w * _reliability(one) for w, one in answered)
    unknown = math.fsum(w for w, one in _pairs(held, told) if one.status in NO_ANSWER)
    spare = NEGLIGIBLE * min(pf, works) - held.neglected
    messages = [f"given each of {len(told)} values of {', '.join(held.names)}"]
    status: Status = "converged"
    if spare < 0.0 < held.neglected:
        status = "doubtful"
        messages.append(f"values of a probability of {held.neglected:.1g} are left out")
    counted, beyond = [], held.neglected
    for row, (w, one) in enumerate(_pairs(held, told)):
        if one.status != "converged" and w <= spare:
            spare -= w
            beyond += w
            continue
        if one.status in NO_ANSWER:
            return Estimate.without_answer("failed", f"{held.said(row)}: {one.message}")
        counted.append((w, one))
        status = max(status, one.status, key=STATUSES.index)
        if one.message:
            messages.append(f"{held.said(row)}: {one.message}")
    kinds = {one.error_kind for _, one in counted}
    kind: ErrorKind = kinds.pop() if len(kinds) == 1 else "surrogate"
    errors = [w * one.stated_error for w, one in counted]
    ends = [(w, *_interval(one)) for w, one in counted]
    low = math.fsum(w * end for w, end, _ in ends)
    high = math.fsum(w * end for w, _, end in ends) + beyond
    bounds = None
    if all(one.pf_low is not None for _, one in answered):
        of_all = [(w * (one.pf_low or 0.0), w * (one.pf_high or 0.0)) for w, one in answered]
        bounds = [math.fsum(each) for each in zip(*of_all, strict=True)]
    return Estimate(
        pf,
        works + held.neglected + unknown,
        std_error=math.hypot(*errors) if kind == "sampling" else math.fsum(errors),
        ci_low=low,
        ci_high=high if math.isnan(high) else min(1.0, high),
        ci_kind="sum over values, 95 % each" if math.isfinite(high - low) else "",
        pf_low=None if bounds is None else bounds[0],
        pf_high=None if bounds is None else bounds[1] + unknown,
        error_kind=kind,
        status=status,
        message="; ".join(messages),
    )


def _pairs(held: HeldValues, told: Sequence[Estimate]) -> Iterator[tuple[float, Estimate]]:
    """Probabilities of values and the answers for them, the least likely first."""
    return zip(held.probabilities.tolist(), told, strict=True)


def _reliability(estimate: Estimate) -> float:
    return 1.0 - estimate.pf if estimate.reliability is None else estimate.reliability


def _interval(estimate: Estimate) -> tuple[float, float]:
    """Return the interval of an answer, by its standard error if it has no other; or NaN."""
    wide = NORMAL_95 * estimate.std_error
    if math.isfinite(estimate.ci_high - estimate.ci_low) or math.isnan(wide):
        return estimate.ci_low, estimate.ci_high
    return max(0.0, estimate.pf - wide), min(1.0, estimate.pf + wide)
