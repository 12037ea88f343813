"""Checks on hard cases: certain outcomes, the boundary, infinite responses, failed runs."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Literal

import numpy as np

from uqfold.evaluation import Evaluator, FailedRunError
from uqfold.methods.base import ReliabilityMethod
from uqfold.methods.result import NO_ANSWER, CriterionResult
from uqfold.problems.base import Problem
from uqfold.problems.criterion import Binomial, Criterion, criteria
from uqfold.testing.accuracy import judge
from uqfold.testing.linear_normal import LinearNormalSystem
from uqfold.testing.verdict import Settings, demand, shown
from uqfold.typing import FloatArray

BUDGET = 6_000
UPPER_TAIL_AT_ONE = 0.15865525393145707
"""P(U > 1) of a standard normal U."""


def _with_model(system: LinearNormalSystem, model: Callable[[FloatArray], FloatArray]) -> Problem:
    inputs = system.problem().inputs
    return Problem(
        model,
        shared=inputs.marginals[0],
        individual=inputs.marginals[1:],
        names=inputs.names,
        units=system.units,
        low_fidelity=system.partner,
        name="hard",
    )


def _is_or_no_answer(row: CriterionResult, pf: float, slack: float, where: str) -> None:
    if row.status not in NO_ANSWER:
        demand(abs(row.pf - pf) <= slack, f"{where}, expected {pf}")


def check_certain_outcomes(method: ReliabilityMethod, settings: Settings) -> None:
    """A threshold far above all responses gives pf 0, one far below gives 1; +-inf likewise."""
    problem = LinearNormalSystem().problem()
    thresholds = settings.choose(quick=[math.inf, -1e5], full=[math.inf, 1e5, -1e5, -math.inf])
    asked = criteria(thresholds, missions=[1, 2])
    result = method.estimate(problem, asked, max_evals=BUDGET, rng=11)
    for criterion, row in zip(asked, result, strict=True):
        expected, where = 0.0 if criterion.threshold > 0 else 1.0, shown(method, criterion, row)
        _is_or_no_answer(row, expected, 1e-9, where)
        if math.isinf(criterion.threshold):
            sure = row.status == "converged"
            demand(not sure, f"{where}: no run says that no response is infinite")


def check_boundary_works(method: ReliabilityMethod, settings: Settings) -> None:
    """A response equal to the threshold works; a threshold one float below fails."""
    value = 0.1 + 0.2

    def constant(x: FloatArray) -> FloatArray:
        return np.full(x.shape[0], value)

    problem = _with_model(LinearNormalSystem(), constant)
    below = float(np.nextafter(value, -math.inf))
    taus: list[float | None] = settings.choose(quick=[None], full=[None, 0.0])
    asked = criteria([value, below], tau=taus)
    result = method.estimate(problem, asked, max_evals=BUDGET, rng=12)
    for criterion, row in zip(asked, result, strict=True):
        expected = 0.0 if criterion.threshold == value else 1.0
        where = shown(method, criterion, row, "constant response")
        _is_or_no_answer(row, expected, 0.0, where)


def check_infinite_response_fails(method: ReliabilityMethod, settings: Settings) -> None:
    """+inf is a valid response that fails: it is counted, and is not a failed run."""
    system = LinearNormalSystem()

    def never_in_a_corner(x: FloatArray) -> FloatArray:
        return np.where(x[:, 1] > 1.0, np.inf, system.response(x))

    def never(x: FloatArray) -> FloatArray:
        return np.full(x.shape[0], np.inf)

    asked, what = Criterion(1e5), "+inf where U > 1"
    corner = _with_model(system, never_in_a_corner)
    result = method.estimate(corner, asked, max_evals=BUDGET, rng=13)
    where = shown(method, asked, result[0], what)
    demand(result.n_failed == 0, f"{where}: +inf is taken for a failed run")
    exact = -math.expm1(system.units * math.log1p(-UPPER_TAIL_AT_ONE))
    if result[0].status in ("converged", "unchecked"):
        judge(method, asked, result[0], exact, settings, what)
    elif result[0].status not in NO_ANSWER:
        demand(result[0].pf > 0.1 * exact, f"{where}: infinite responses vanished")
    for_ever = [asked, Criterion(1e5, tau=1.0), Criterion(math.inf, tau=1.0)]
    answers = method.estimate(_with_model(system, never), for_ever, max_evals=BUDGET, rng=13)
    for criterion, row in zip(for_ever, answers, strict=True):
        _is_or_no_answer(row, 1.0, 1e-12, shown(method, criterion, row, "all responses +inf"))


def check_failed_runs_are_bounded(method: ReliabilityMethod, settings: Settings) -> None:
    """NaN never counts as safe: the row has bounds around the truth, or no number at all."""
    system = LinearNormalSystem()

    def lost_in_the_tail(x: FloatArray) -> FloatArray:
        return np.where(x[:, 2] > 1.2, np.nan, system.response(x))

    every = criteria([11.0, 12.0], tau=[None, 3.0], missions=[1, Binomial(2, 0.5)])
    asked = settings.choose(quick=every[2:4], full=every)
    result = method.estimate(_with_model(system, lost_in_the_tail), asked, max_evals=BUDGET, rng=14)
    if result.n_failed == 0:
        return
    for criterion, row in zip(asked, result, strict=True):
        if row.status in NO_ANSWER:
            continue
        where = shown(method, criterion, row, "failed runs in the tail")
        demand(row.status not in ("converged", "unchecked"), where)
        demand(row.pf_low < row.pf_high, where + ", pf_low is not below pf_high")
        exact = system.pf(criterion)
        slack = 0.05 * exact + (4.0 * row.std_error if math.isfinite(row.std_error) else 0.0)
        inside = row.pf_low - slack <= exact <= row.pf_high + slack
        demand(inside, where + f", [{row.pf_low}, {row.pf_high}] does not hold the true {exact}")


def check_broken_model_is_a_status(method: ReliabilityMethod, _: Settings) -> None:
    """A model that always fails gives the status ``failed`` with its message, not a number."""

    def nothing_but_nan(x: FloatArray) -> FloatArray:
        return np.full(x.shape[0], np.nan)

    def broken(x: FloatArray) -> FloatArray:
        raise ZeroDivisionError("no such design")

    def wrong_shape(x: FloatArray) -> FloatArray:
        return np.zeros((x.shape[0], 2))

    for model, trace in (
        (nothing_but_nan, "NaN"),
        (broken, "no such design"),
        (wrong_shape, "shape"),
    ):
        problem = _with_model(LinearNormalSystem(), model)
        asked = Criterion(12.0)
        row = method.estimate(problem, asked, max_evals=BUDGET, rng=15)[0]
        where = shown(method, asked, row, f"model that only fails ({trace})")
        demand(row.status == "failed", where)
        demand(trace in row.message, f"{where}: message {row.message!r} lacks {trace!r}")


def check_policies_for_failed_runs(method: ReliabilityMethod, _: Settings) -> None:
    """``raise`` raises; ``count-as-failure`` never lowers pf."""
    system = LinearNormalSystem()

    def sometimes(x: FloatArray) -> FloatArray:
        return np.where(x[:, 2] > -5.0, np.nan, system.response(x))

    problem, asked = _with_model(system, sometimes), Criterion(12.0)

    def under(policy: Literal["raise", "count-as-failure"]) -> CriterionResult:
        evaluator = Evaluator(policy)
        return method.estimate(problem, asked, max_evals=BUDGET, rng=16, evaluator=evaluator)[0]

    try:
        row = under("raise")
    except FailedRunError:
        pass
    else:
        demand(False, f'{shown(method, asked, row)}: no failed run was raised under "raise"')
    row = under("count-as-failure")
    _is_or_no_answer(row, 1.0, 1e-3, shown(method, asked, row, "failed runs counted as failures"))


def check_hard_criterion_spoils_no_other(method: ReliabilityMethod, settings: Settings) -> None:
    """Easy criteria get their answers also beside hard ones."""
    system = LinearNormalSystem()
    easy = Criterion(12.0)
    hard = [Criterion(math.inf), Criterion(-1e300), Criterion(12.0, tau=0.0), Criterion(1e12)]
    alone = method.estimate(system.problem(), easy, max_evals=BUDGET, rng=17)[0]
    if alone.status in NO_ANSWER:
        return
    asked = settings.choose(quick=[hard[0], easy, *hard[2:]], full=[hard[0], easy, *hard[1:], easy])
    result = method.estimate(system.problem(), asked, max_evals=BUDGET, rng=17)
    for criterion, row in zip(asked, result, strict=True):
        if criterion == easy:
            where = shown(method, easy, row)
            demand(row.status not in NO_ANSWER, f"{where}, lost beside hard ones: {row.message}")
            judge(method, easy, row, system.pf(easy), settings, "beside hard criteria")
