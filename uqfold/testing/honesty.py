"""The check of stated errors: over many seeds, they explain the errors that occur."""

from __future__ import annotations

import math

import numpy as np

from uqfold.methods.base import ReliabilityMethod
from uqfold.methods.result import NO_ANSWER, CriterionResult
from uqfold.problems.base import Problem
from uqfold.problems.criterion import Criterion
from uqfold.testing.accuracy import answers_by_surrogate
from uqfold.testing.curved import CurvedSystem
from uqfold.testing.linear_normal import LinearNormalSystem
from uqfold.testing.verdict import ContractError, Settings, demand

SURROGATE_BUDGETS = (40, 160, 640)


def check_stated_errors_are_honest(method: ReliabilityMethod, settings: Settings) -> None:
    """Stated errors explain the errors that occur.

    A sampling error over 200 seeds (80 at level ``quick``): errors in units of the stated one have
    mean 0 and spread 1. The error of a surrogate over 30 seeds (4), on a curved system with few
    runs: the errors are no larger than stated. They may be smaller, since a surface can be exact
    where nobody can know it.
    """
    if not method.stochastic:
        return
    if answers_by_surrogate(method):
        # with more units an integral over shared inputs takes most of the time
        system = CurvedSystem(units=settings.choose(quick=1, full=2))
        _judge_surrogate(method, system, settings.choose(quick=4, full=30))
    else:
        _judge_sampling(method, settings.choose(quick=80, full=200))


def _answers(
    method: ReliabilityMethod, problem: Problem, criterion: Criterion, budget: int, seeds: int
) -> list[CriterionResult]:
    rows = [
        method.estimate(problem, criterion, max_evals=budget, rng=seed)[0] for seed in range(seeds)
    ]
    return [row for row in rows if row.status not in NO_ANSWER]


def _who(method: ReliabilityMethod, criterion: Criterion, rows: list[CriterionResult]) -> str:
    statuses = "/".join(sorted({row.status for row in rows}))
    return f"{method.name}, {criterion}: {len(rows)} seeds, {statuses}"


def _judge_surrogate(method: ReliabilityMethod, system: CurvedSystem, seeds: int) -> None:
    criterion = Criterion(12.5)
    problem, exact = system.problem(), system.pf(12.5)
    for budget in SURROGATE_BUDGETS:
        # too few runs for a surface are too few in every repeat
        rows = _answers(method, problem, criterion, budget, seeds)
        if rows:
            break
    else:
        raise ContractError(f"{method.name}: no answer from {budget} runs in any repeat")
    # an error stated to be zero explains nothing
    stated = np.maximum([row.std_error for row in rows], 1e-12 * exact)
    z = (np.array([row.pf for row in rows]) - exact) / stated
    size = math.sqrt(float(np.mean(z**2)))
    # five standard errors of the root mean square of standard normal numbers
    demand(
        size <= 1.0 + 5.0 / math.sqrt(2.0 * len(z)),
        f"{_who(method, criterion, rows)}, errors are {size:.2f} times the stated error of the "
        "surrogate",
    )
    _demand_cover(method, criterion, rows, exact)


def _judge_sampling(method: ReliabilityMethod, seeds: int) -> None:
    system, criterion = LinearNormalSystem(units=2), Criterion(10.5)
    exact = system.pf(criterion)
    rows = _answers(method, system.problem(), criterion, 2_400, seeds)
    if not rows or any(row.error_kind == "none" for row in rows):
        return
    z = np.array([(row.pf - exact) / row.std_error for row in rows])
    bias, spread = float(z.mean()), float(z.std(ddof=1))
    who = _who(method, criterion, rows)
    # five standard errors of the mean and of the spread of `len(z)` standard normal numbers
    demand(abs(bias) <= 5.0 / math.sqrt(len(z)), f"{who}, mean z-score {bias:+.2f}")
    demand(
        abs(spread - 1.0) <= 5.0 / math.sqrt(2.0 * len(z)),
        f"{who}, errors are {spread:.2f} times the stated standard error",
    )
    if all(math.isfinite(row.ci_low + row.ci_high) for row in rows):
        _demand_cover(method, criterion, rows, exact)


def _demand_cover(
    method: ReliabilityMethod, criterion: Criterion, rows: list[CriterionResult], exact: float
) -> None:
    covered = float(np.mean([row.ci_low <= exact <= row.ci_high for row in rows]))
    # 95 % less four standard errors of a share
    least = 0.95 - 4.0 * math.sqrt(0.95 * 0.05 / len(rows))
    demand(
        covered >= least,
        f"{_who(method, criterion, rows)}, 95 % intervals hold the truth in {covered:.0%}",
    )
