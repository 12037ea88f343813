"""Checks of accuracy against systems whose failure probability is known."""

from __future__ import annotations

import math

import numpy as np

from uqfold.inputs import normal
from uqfold.methods.base import ReliabilityMethod
from uqfold.methods.result import NO_ANSWER, CriterionResult
from uqfold.problems.base import Problem
from uqfold.problems.criterion import Binomial, Criterion, criteria
from uqfold.testing.curved import CurvedSystem
from uqfold.testing.linear_normal import LinearNormalSystem
from uqfold.testing.linear_units import OFFSETS, STRUCTURES, LinearUnits
from uqfold.testing.verdict import ContractError, Settings, demand
from uqfold.typing import FloatArray

STANDARD_ERRORS = 4.0
REPEATS = 200
REPEAT_BUDGET = 2_400
SURROGATE_REPEATS = 30
SURROGATE_BUDGETS = (40, 160, 640)
FEW_RUNS = 60


def judge(
    method: ReliabilityMethod,
    row: CriterionResult,
    exact: float,
    settings: Settings,
    what: str,
) -> None:
    """Compare one row with the exact value: in its own standard errors, or to the tolerance."""
    if row.status in NO_ANSWER:
        return
    shown = f"{method.name}, {what}: {row.status} with pf = {row.pf:.6g}, exact {exact:.6g}"
    if row.error_kind == "none":
        error = abs(row.pf - exact) / exact
        demand(error <= settings.tolerance, f"{shown}, relative error {error:.2%}")
    elif math.isfinite(row.std_error) and row.std_error > 0.0:
        z = (row.pf - exact) / row.std_error
        demand(abs(z) <= STANDARD_ERRORS, f"{shown}, {z:+.1f} standard errors away")
    else:
        inside = row.ci_low <= exact <= row.ci_high
        demand(inside, f"{shown}, outside its interval [{row.ci_low:.6g}, {row.ci_high:.6g}]")


def _judge_grid(
    method: ReliabilityMethod, system: LinearNormalSystem, asked: list[Criterion], s: Settings
) -> int:
    result = method.estimate(system.problem(), asked, max_evals=s.max_evals, rng=21)
    rows = zip(asked, result, strict=True)
    answered = [(criterion, row) for criterion, row in rows if row.status not in NO_ANSWER]
    for criterion, row in answered:
        what = f"{system.units} units, {criterion}"
        judge(method, row, system.pf(criterion), s, what)
    return len(answered)


def check_one_unit_is_exact(method: ReliabilityMethod, settings: Settings) -> None:
    """One unit, one mission: the unit's own failure probability."""
    answered = _judge_grid(
        method, LinearNormalSystem(units=1), [Criterion(t) for t in (9.5, 11.0, 12.5)], settings
    )
    demand(answered > 0, f"{method.name} answers no criterion of one unit in one mission")


def check_shared_inputs_correlate_units(method: ReliabilityMethod, settings: Settings) -> None:
    """Units and missions share the shared inputs: neither independent nor drawn anew."""
    system = LinearNormalSystem(units=4, shared_std=0.6)
    profiles = (1, 2, 5, Binomial(4, 0.5), Binomial(6, 0.9))
    asked = [Criterion(t, missions=m) for m in profiles for t in (11.5, 12.5)]
    _judge_grid(method, system, asked, settings)


def check_synchronization(method: ReliabilityMethod, settings: Settings) -> None:
    """Rows with tau are exact, on the climb and on the plateau."""
    system = LinearNormalSystem(units=3, shared_std=0.4)
    asked = [
        Criterion(t, tau=tau, missions=m)
        for m in (1, 2, Binomial(3, 0.7))
        for tau in (1.5, 3.0)
        for t in (10.5, 12.0, 16.0)
    ]
    _judge_grid(method, system, asked, settings)


def check_structures(method: ReliabilityMethod, settings: Settings) -> None:
    """Each structure, of equal units, of offsets and of kinds: an exact answer, or why not.

    A reason is given before any run.
    """
    criterion = Criterion(1.0, missions=2)
    budget = FEW_RUNS if _answers_by_surrogate(method) else settings.max_evals
    for i, structure in enumerate(STRUCTURES):
        for j, differing in enumerate(OFFSETS):
            system = LinearUnits(structure, differing)
            problem, what = system.problem(), f"{differing}, {structure}"
            reason = method.supports(problem, criterion)
            if reason is None and (i + j) % len(OFFSETS):
                # every structure and every difference is asked for, not all pairs of them
                continue
            row = method.estimate(problem, criterion, max_evals=budget, rng=21)[0]
            if reason is None:
                judge(method, row, system.pf(1.0, 2), settings, what)
                continue
            spent = f"{method.name}, {what}: {row.n_evals} runs, status {row.status}"
            demand(row.status == "unsupported" and row.n_evals == 0 and bool(reason), spent)


def check_plain_limit_state(method: ReliabilityMethod, settings: Settings) -> None:
    """A limit state g <= 0 without shared inputs, with its threshold one float below zero."""

    def g(x: FloatArray) -> FloatArray:
        return 2.0 - (x[:, 0] + 2.0 * x[:, 1] - 3.0) / math.sqrt(5.0)

    inputs = {"a": normal(1.0, 1.0), "b": normal(1.0, 1.0)}
    problem = Problem.from_limit_state(g, inputs, low_fidelity=lambda x: 0.1 - g(x))
    row = method.estimate(problem, max_evals=settings.max_evals, rng=22)[0]
    judge(method, row, 0.022750131948179195, settings, "limit state with beta = 2")


def check_scale_and_shift(method: ReliabilityMethod, settings: Settings) -> None:
    """Another unit of the response (c y + d, threshold and tau likewise) changes nothing."""
    system = LinearNormalSystem()
    plain, scale, shift = system.problem(), 250.0, -4_000.0

    def rescaled(x: FloatArray) -> FloatArray:
        return scale * system.response(x) + shift

    def partner(x: FloatArray) -> FloatArray:
        return scale * system.partner(x) + shift

    other = Problem(
        rescaled, shared=plain.inputs.marginals[0],
        individual=plain.inputs.marginals[1:], units=system.units,
        names=plain.inputs.names, low_fidelity=partner,
    )  # fmt: skip
    asked = [Criterion(12.0), Criterion(12.0, 2.5)]
    scaled = [Criterion(scale * 12.0 + shift), Criterion(scale * 12.0 + shift, scale * 2.5)]
    for problem, given in ((plain, asked), (other, scaled)):
        result = method.estimate(problem, given, max_evals=settings.max_evals, rng=23)
        for first, second, row in zip(asked, given, result, strict=True):
            judge(method, row, system.pf(first), settings, f"{second}, response rescaled")


def check_order_of_inputs_does_not_matter(method: ReliabilityMethod, settings: Settings) -> None:
    """Individual inputs may stand in any order."""
    system = LinearNormalSystem()
    inputs = system.problem().inputs

    def swapped(x: FloatArray) -> FloatArray:
        return system.response(x[:, [0, 2, 1]])

    problem = Problem(
        swapped, shared=inputs.marginals[0],
        individual=inputs.marginals[:0:-1], names=["V", "W", "U"],
        units=system.units, low_fidelity=lambda x: system.partner(x[:, [0, 2, 1]]),
    )  # fmt: skip
    criterion = Criterion(12.0)
    row = method.estimate(problem, criterion, max_evals=settings.max_evals, rng=24)[0]
    judge(method, row, system.pf(criterion), settings, "inputs in another order")


def check_stated_errors_are_honest(method: ReliabilityMethod, _: Settings) -> None:
    """Stated errors explain the errors that occur.

    A sampling error over 200 seeds: errors in units of the stated one have mean 0 and spread 1. The
    error of a surrogate over 30 seeds, on a curved system with few runs: the errors are no larger
    than stated. They may be smaller, since a surface can be exact where nobody can know it.
    """
    if not method.stochastic:
        return
    if _answers_by_surrogate(method):
        _judge_surrogate(method)
    else:
        _judge_sampling(method)


def _answers_by_surrogate(method: ReliabilityMethod) -> bool:
    system = LinearNormalSystem(units=2)
    row = method.estimate(system.problem(), Criterion(10.5), max_evals=REPEAT_BUDGET, rng=0)[0]
    return row.error_kind == "surrogate"


def _judge_surrogate(method: ReliabilityMethod) -> None:
    system, criterion = CurvedSystem(), Criterion(12.5)
    problem, exact = system.problem(), system.pf(12.5)
    for budget in SURROGATE_BUDGETS:
        rows = [
            method.estimate(problem, criterion, max_evals=budget, rng=seed)[0]
            for seed in range(SURROGATE_REPEATS)
        ]
        rows = [row for row in rows if row.status not in NO_ANSWER]
        # too few runs for a surface are too few in every repeat
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
        f"{method.name}: errors are {size:.2f} times the stated error of the surrogate",
    )
    covered = float(np.mean([row.ci_low <= exact <= row.ci_high for row in rows]))
    # 95 % less four standard errors of a share
    least = 0.95 - 4.0 * math.sqrt(0.95 * 0.05 / len(z))
    demand(covered >= least, f"{method.name}: 95 % intervals hold the truth in {covered:.0%}")


def _judge_sampling(method: ReliabilityMethod) -> None:
    system = LinearNormalSystem(units=2)
    criterion = criteria(10.5)[0]
    problem, exact = system.problem(), system.pf(criterion)
    rows = [
        method.estimate(problem, criterion, max_evals=REPEAT_BUDGET, rng=seed)[0]
        for seed in range(REPEATS)
    ]
    answered = [row for row in rows if row.status not in NO_ANSWER]
    if not answered or any(row.error_kind == "none" for row in answered):
        return
    z = np.array([(row.pf - exact) / row.std_error for row in answered])
    bias, spread = float(z.mean()), float(z.std(ddof=1))
    # five standard errors of the mean and of the spread of `len(z)` standard normal numbers
    demand(abs(bias) <= 5.0 / math.sqrt(len(z)), f"{method.name}: mean z-score {bias:+.2f}")
    demand(
        abs(spread - 1.0) <= 5.0 / math.sqrt(2.0 * len(z)),
        f"{method.name}: errors are {spread:.2f} times the stated standard error",
    )
    if not all(math.isfinite(row.ci_low + row.ci_high) for row in answered):
        return
    covered = float(np.mean([row.ci_low <= exact <= row.ci_high for row in answered]))
    demand(covered >= 0.88, f"{method.name}: 95 % intervals hold the truth in {covered:.0%}")
