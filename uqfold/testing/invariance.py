"""Checks of what must not change an answer, and of which way an answer must move."""

from __future__ import annotations

import math

from uqfold.inputs import normal
from uqfold.methods.base import ReliabilityMethod
from uqfold.methods.result import NO_ANSWER
from uqfold.problems.base import Problem
from uqfold.problems.criterion import Binomial, Criterion
from uqfold.testing.accuracy import STANDARD_ERRORS, judge
from uqfold.testing.linear_normal import LinearNormalSystem
from uqfold.testing.verdict import Settings, demand, shown
from uqfold.typing import FloatArray


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
    result = method.estimate(other, scaled, max_evals=settings.max_evals, rng=23)
    for criterion, given, row in zip(asked, scaled, result, strict=True):
        judge(method, given, row, system.pf(criterion), settings, "response rescaled")


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
    judge(method, criterion, row, system.pf(criterion), settings, "inputs in another order")


def check_units_of_inputs_do_not_matter(method: ReliabilityMethod, settings: Settings) -> None:
    """Inputs may have any location and scale: metres or millimetres, kelvin or degrees."""
    system = LinearNormalSystem()
    centres, scales = (5_000.0, -0.002, 3e6), (1_000.0, 1e-4, 1e5)

    def standard(x: FloatArray) -> FloatArray:
        return (x - centres) / scales

    laws = [normal(mean, std) for mean, std in zip(centres, scales, strict=True)]
    problem = Problem(
        lambda x: system.response(standard(x)), shared=laws[:1], individual=laws[1:],
        names=["V", "U", "W"], units=system.units,
        low_fidelity=lambda x: system.partner(standard(x)),
    )  # fmt: skip
    criterion = Criterion(12.0)
    row = method.estimate(problem, criterion, max_evals=settings.max_evals, rng=25)[0]
    judge(method, criterion, row, system.pf(criterion), settings, "inputs in other units")


def check_answers_are_monotone(method: ReliabilityMethod, settings: Settings) -> None:
    """A higher threshold or tau fails less, more missions fail more.

    By far, in these pairs: so that the answers must differ, whatever their errors.
    """
    few = [
        (Criterion(11.5), Criterion(12.5)),
        (Criterion(11.5, tau=1.5), Criterion(11.5, tau=3.0)),
        (Criterion(11.5, missions=3), Criterion(11.5)),
    ]
    more = [
        (Criterion(10.5), Criterion(11.5)),
        (Criterion(11.5, tau=3.0), Criterion(11.5)),
        (Criterion(12.5, tau=1.5, missions=2), Criterion(12.5, tau=3.0, missions=2)),
        (Criterion(11.5, missions=Binomial(6, 0.9)), Criterion(11.5, missions=Binomial(3, 0.5))),
    ]
    pairs = settings.choose(quick=few, full=[*few, *more])
    asked = list(dict.fromkeys(criterion for pair in pairs for criterion in pair))
    problem = LinearNormalSystem(shared_std=0.2).problem()
    result = method.estimate(problem, asked, max_evals=settings.max_evals, rng=26)
    rows = dict(zip(asked, result, strict=True))
    for often, seldom in pairs:
        row, other = rows[seldom], rows[often]
        if row.status in NO_ANSWER or other.status in NO_ANSWER:
            continue
        demand(
            row.pf < other.pf,
            f"{shown(method, seldom, row)} is not below that of {often}, {other.pf:.6g}",
        )


def check_grid_agrees_with_single_criteria(method: ReliabilityMethod, settings: Settings) -> None:
    """A criterion has the same answer alone as among others, to the errors that both state."""
    problem = LinearNormalSystem().problem()
    asked = [Criterion(12.0), Criterion(11.0, tau=2.5), Criterion(11.5, missions=3)]
    together = method.estimate(problem, asked, max_evals=settings.max_evals, rng=27)
    which = settings.choose(quick=(1,), full=(0, 1, 2))
    for criterion, among in [(asked[i], together[i]) for i in which]:
        alone = method.estimate(problem, criterion, max_evals=settings.max_evals, rng=28)[0]
        if alone.status in NO_ANSWER or among.status in NO_ANSWER:
            continue
        errors = [row.std_error for row in (alone, among) if math.isfinite(row.std_error)]
        allowed = STANDARD_ERRORS * math.hypot(*errors) if errors else settings.tolerance * alone.pf
        demand(
            abs(among.pf - alone.pf) <= allowed,
            f"{shown(method, criterion, among, 'among others')}, {alone.pf:.6g} alone",
        )
