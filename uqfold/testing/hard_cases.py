"""Checks on hard cases: certain outcomes, the boundary, infinite responses, failed runs."""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np

from uqfold.evaluation import Evaluator, FailedRunError
from uqfold.methods.base import ReliabilityMethod
from uqfold.methods.result import NO_ANSWER, CriterionResult
from uqfold.problems.base import Problem
from uqfold.problems.criterion import Binomial, Criterion, criteria
from uqfold.testing.accuracy import judge
from uqfold.testing.linear_normal import LinearNormalSystem
from uqfold.testing.verdict import Settings, demand
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


def _is_or_no_answer(row: CriterionResult, pf: float, slack: float, what: str) -> None:
    if row.status not in NO_ANSWER:
        right = abs(row.pf - pf) <= slack
        demand(right, f"{what}: {row.status} with pf = {row.pf}, expected {pf}")


def check_certain_outcomes(method: ReliabilityMethod, _: Settings) -> None:
    """A threshold far above all responses gives pf 0, one far below gives 1; +-inf likewise."""
    problem = LinearNormalSystem().problem()
    asked = criteria([math.inf, 1e5, -1e5, -math.inf], missions=[1, 2])
    result = method.estimate(problem, asked, max_evals=BUDGET, rng=11)
    for criterion, row in zip(asked, result, strict=True):
        expected = 0.0 if criterion.threshold > 0 else 1.0
        _is_or_no_answer(row, expected, 1e-9, f"{method.name}, {criterion}")


def check_boundary_works(method: ReliabilityMethod, _: Settings) -> None:
    """A response equal to the threshold works; a threshold one float below fails."""
    value = 0.1 + 0.2

    def constant(x: FloatArray) -> FloatArray:
        return np.full(x.shape[0], value)

    problem = _with_model(LinearNormalSystem(), constant)
    below = float(np.nextafter(value, -math.inf))
    asked = criteria([value, below], tau=[None, 0.0])
    result = method.estimate(problem, asked, max_evals=BUDGET, rng=12)
    for criterion, row in zip(asked, result, strict=True):
        expected = 0.0 if criterion.threshold == value else 1.0
        _is_or_no_answer(row, expected, 0.0, f"{method.name}, constant response, {criterion}")


def check_infinite_response_fails(method: ReliabilityMethod, settings: Settings) -> None:
    """+inf is a valid response that fails: it is counted, and is not a failed run."""
    system = LinearNormalSystem()

    def never_in_a_corner(x: FloatArray) -> FloatArray:
        return np.where(x[:, 1] > 1.0, np.inf, system.response(x))

    def never(x: FloatArray) -> FloatArray:
        return np.full(x.shape[0], np.inf)

    result = method.estimate(
        _with_model(system, never_in_a_corner), criteria(1e5), max_evals=BUDGET, rng=13
    )
    demand(result.n_failed == 0, f"{method.name} takes +inf for a failed run")
    exact = -math.expm1(system.units * math.log1p(-UPPER_TAIL_AT_ONE))
    if result[0].status in ("converged", "unchecked"):
        judge(method, result[0], exact, settings, "+inf where U > 1")
    elif result[0].status not in NO_ANSWER:
        demand(result[0].pf > 0.1 * exact, f"{method.name}: infinite responses vanished")
    asked = criteria([1e5, math.inf], tau=[None, 1.0])
    for row in method.estimate(_with_model(system, never), asked, max_evals=BUDGET, rng=13):
        if not (row.threshold == math.inf and math.isnan(row.tau)):
            _is_or_no_answer(
                row, 1.0, 1e-12, f"{method.name}, all responses +inf, T={row.threshold}"
            )


def check_failed_runs_are_bounded(method: ReliabilityMethod, _: Settings) -> None:
    """NaN never counts as safe: the row has bounds around the truth, or no number at all."""
    system = LinearNormalSystem()

    def lost_in_the_tail(x: FloatArray) -> FloatArray:
        return np.where(x[:, 2] > 1.2, np.nan, system.response(x))

    asked = criteria([11.0, 12.0], tau=[None, 3.0], missions=[1, Binomial(2, 0.5)])
    result = method.estimate(_with_model(system, lost_in_the_tail), asked, max_evals=BUDGET, rng=14)
    if result.n_failed == 0:
        return
    for criterion, row in zip(asked, result, strict=True):
        if row.status in NO_ANSWER:
            continue
        where = f"{method.name}, {criterion}, failed runs in the tail: "
        demand(row.status not in ("converged", "unchecked"), where + f"status {row.status}")
        demand(row.pf_low < row.pf_high, where + "pf_low is not below pf_high")
        exact = system.pf(criterion)
        slack = 0.05 * exact + (4.0 * row.std_error if math.isfinite(row.std_error) else 0.0)
        inside = row.pf_low - slack <= exact <= row.pf_high + slack
        demand(inside, where + f"[{row.pf_low}, {row.pf_high}] does not hold the true {exact}")


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
        for row in method.estimate(problem, criteria(12.0), max_evals=BUDGET, rng=15):
            demand(row.status == "failed", f"{method.name}: status {row.status}, model {trace}")
            demand(trace in row.message, f"{method.name}: message {row.message!r} lacks {trace!r}")


def check_policies_for_failed_runs(method: ReliabilityMethod, _: Settings) -> None:
    """``raise`` raises; ``count-as-failure`` never lowers pf."""
    system = LinearNormalSystem()

    def sometimes(x: FloatArray) -> FloatArray:
        return np.where(x[:, 2] > -5.0, np.nan, system.response(x))

    problem = _with_model(system, sometimes)
    try:
        method.estimate(
            problem, criteria(12.0), max_evals=BUDGET, rng=16, evaluator=Evaluator("raise")
        )
    except FailedRunError:
        pass
    else:
        demand(False, f'{method.name}: a failed run passed silently under the policy "raise"')
    counted = method.estimate(
        problem, criteria(12.0), max_evals=BUDGET, rng=16, evaluator=Evaluator("count-as-failure")
    )
    _is_or_no_answer(counted[0], 1.0, 1e-3, f"{method.name}, failed runs counted as failures")


def check_hard_criterion_spoils_no_other(method: ReliabilityMethod, settings: Settings) -> None:
    """Easy criteria get their answers also beside hard ones."""
    system = LinearNormalSystem()
    easy = Criterion(12.0)
    hard = [Criterion(math.inf), Criterion(-1e300), Criterion(12.0, tau=0.0), Criterion(1e12)]
    alone = method.estimate(system.problem(), easy, max_evals=BUDGET, rng=17)[0]
    rows = method.estimate(
        system.problem(), [hard[0], easy, *hard[1:], easy], max_evals=BUDGET, rng=17
    )
    for row in (rows[1], rows[5]):
        if alone.status in NO_ANSWER:
            continue
        demand(row.status not in NO_ANSWER, f"{method.name}: lost beside hard ones: {row.message}")
        judge(method, row, system.pf(easy), settings, "easy criterion beside hard ones")
