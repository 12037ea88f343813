"""Checks of accuracy against systems whose failure probability is known."""

from __future__ import annotations

import math

from uqfold.inputs import bernoulli, normal
from uqfold.methods.base import ReliabilityMethod
from uqfold.methods.result import NO_ANSWER, CriterionResult
from uqfold.problems.base import Problem
from uqfold.problems.criterion import Binomial, Criterion, Missions
from uqfold.testing.linear_normal import LinearNormalSystem
from uqfold.testing.linear_units import OFFSETS, STRUCTURES, LinearUnits
from uqfold.testing.verdict import Settings, demand, shown
from uqfold.typing import FloatArray

STANDARD_ERRORS = 4.0
FEW_RUNS = 60


def judge(
    method: ReliabilityMethod,
    criterion: Criterion,
    row: CriterionResult,
    exact: float,
    settings: Settings,
    what: str,
) -> None:
    """Compare one row with the exact value: in its own standard errors, or to the tolerance."""
    if row.status in NO_ANSWER:
        return
    found = f"{shown(method, criterion, row, what)}, exact {exact:.6g}"
    if row.error_kind == "none":
        error = abs(row.pf - exact) / exact
        demand(error <= settings.tolerance, f"{found}, relative error {error:.2%}")
    elif math.isfinite(row.std_error) and row.std_error > 0.0:
        z = (row.pf - exact) / row.std_error
        demand(abs(z) <= STANDARD_ERRORS, f"{found}, {z:+.1f} standard errors away")
    else:
        inside = row.ci_low <= exact <= row.ci_high
        demand(inside, f"{found}, outside its interval [{row.ci_low:.6g}, {row.ci_high:.6g}]")


def _judge_grid(
    method: ReliabilityMethod, system: LinearNormalSystem, asked: list[Criterion], s: Settings
) -> int:
    result = method.estimate(system.problem(), asked, max_evals=s.max_evals, rng=21)
    for criterion, row in zip(asked, result, strict=True):
        judge(method, criterion, row, system.pf(criterion), s, f"{system.units} units")
    return sum(row.status not in NO_ANSWER for row in result)


def check_one_unit_is_exact(method: ReliabilityMethod, settings: Settings) -> None:
    """One unit, one mission: the unit's own failure probability."""
    thresholds = settings.choose(quick=[11.0], full=[9.5, 11.0, 12.5])
    answered = _judge_grid(
        method, LinearNormalSystem(units=1), [Criterion(t) for t in thresholds], settings
    )
    demand(answered > 0, f"{method.name} answers no criterion of one unit in one mission")


def check_shared_inputs_correlate_units(method: ReliabilityMethod, settings: Settings) -> None:
    """Units and missions share the shared inputs: neither independent nor drawn anew."""
    system = LinearNormalSystem(units=4, shared_std=0.6)
    few: list[Missions] = [5, Binomial(6, 0.9)]
    profiles = settings.choose(quick=few, full=[*few, 1, 2, Binomial(4, 0.5)])
    thresholds = settings.choose(quick=[11.5], full=[11.5, 12.5])
    asked = [Criterion(t, missions=m) for m in profiles for t in thresholds]
    _judge_grid(method, system, asked, settings)


def check_synchronization(method: ReliabilityMethod, settings: Settings) -> None:
    """Rows with tau are exact, on the climb and on the plateau."""
    system = LinearNormalSystem(units=3, shared_std=0.4)
    every: list[Missions] = [1, 2, Binomial(3, 0.7)]
    asked = [
        Criterion(t, tau=tau, missions=m)
        for m in settings.choose(quick=every[1:2], full=every)
        for tau in settings.choose(quick=[3.0], full=[1.5, 3.0])
        for t in settings.choose(quick=[10.5, 16.0], full=[10.5, 12.0, 16.0])
    ]
    _judge_grid(method, system, asked, settings)


def check_structures(method: ReliabilityMethod, settings: Settings) -> None:
    """Each structure, of equal units and of units that differ: an exact answer, or why not.

    A reason is given before any run.
    """
    criterion = Criterion(1.0, missions=2)
    budget = FEW_RUNS if answers_by_surrogate(method) else settings.max_evals
    # every structure and every difference is asked for, not all pairs of them
    pairs = [
        (structure, differing, (i + j) % len(OFFSETS) == 0)
        for i, structure in enumerate(STRUCTURES)
        for j, differing in enumerate(OFFSETS)
    ]
    # every difference once
    judged = settings.choose(quick=STRUCTURES[-4:], full=STRUCTURES)
    for structure, differing, belongs in pairs:
        system = LinearUnits(structure, differing)
        problem, what = system.problem(), f"{differing}, {structure}"
        reason = method.supports(problem, criterion)
        if reason is None and not (belongs and structure in judged):
            continue
        row = method.estimate(problem, criterion, max_evals=budget, rng=21)[0]
        if reason is None:
            judge(method, criterion, row, system.pf(1.0, 2), settings, what)
            continue
        refused = row.status == "unsupported" and row.n_evals == 0 and bool(reason)
        demand(refused, f"{shown(method, criterion, row, what)} after {row.n_evals} runs")


def check_plain_limit_state(method: ReliabilityMethod, settings: Settings) -> None:
    """A limit state g <= 0 without shared inputs, with its threshold one float below zero."""

    def g(x: FloatArray) -> FloatArray:
        return 2.0 - (x[:, 0] + 2.0 * x[:, 1] - 3.0) / math.sqrt(5.0)

    inputs = {"a": normal(1.0, 1.0), "b": normal(1.0, 1.0)}
    problem = Problem.from_limit_state(g, inputs, low_fidelity=lambda x: 0.1 - g(x))
    result = method.estimate(problem, max_evals=settings.max_evals, rng=22)
    exact, what = 0.022750131948179195, "limit state with beta = 2"
    judge(method, result.criteria[0], result[0], exact, settings, what)


def check_discrete_inputs(method: ReliabilityMethod, settings: Settings) -> None:
    """A shared or an individual input of two values: an exact answer, or why not before any run."""

    def response(x: FloatArray) -> FloatArray:
        return 2.0 * x[:, 0] + x[:, 1]

    def partner(x: FloatArray) -> FloatArray:
        return 1.9 * x[:, 0] + x[:, 1]

    rare, load = {"rare": bernoulli(0.2)}, {"load": normal(0.0, 1.0)}
    q = [0.5 * math.erfc((2.5 - two) / math.sqrt(2.0)) for two in (0.0, 2.0)]
    given = 0.8 * (1.0 - q[0]) ** 2 + 0.2 * (1.0 - q[1]) ** 2
    anew = (0.8 * (1.0 - q[0]) + 0.2 * (1.0 - q[1])) ** 2
    shared = Problem(response, shared=rare, individual=load, units=2, low_fidelity=partner)
    own = Problem(response, individual=rare | load, units=2, low_fidelity=partner)
    criterion = Criterion(2.5)
    for problem, works, what in ((shared, given, "shared"), (own, anew, "individual")):
        row = method.estimate(problem, criterion, max_evals=settings.max_evals, rng=23)[0]
        if method.supports(problem, criterion) is None:
            judge(method, criterion, row, 1.0 - works, settings, f"{what} input of two values")
            continue
        refused = row.status == "unsupported" and row.n_evals == 0
        demand(refused, f"{shown(method, criterion, row, what)} after {row.n_evals} runs")


def answers_by_surrogate(method: ReliabilityMethod) -> bool:
    """Whether the error that a method states is that of a surface."""
    problem = LinearNormalSystem(units=2).problem()
    row = method.estimate(problem, Criterion(10.5), max_evals=2_400, rng=0)[0]
    return row.error_kind == "surrogate"
