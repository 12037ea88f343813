"""How FFNI takes the expectation over the shared inputs."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from typing import TypeAlias

import numpy as np

from uqfold.checks import keep, real, whole
from uqfold.inputs.gauss import MAX_GAUSS_NODES
from uqfold.methods.factorial_design import Nodes, checked_nodes
from uqfold.methods.factorial_inner import Grids
from uqfold.methods.factorial_runs import (
    MORE,
    FactorialRuns,
    KnownRuns,
    line_places,
    runs_of_kinds,
)
from uqfold.typing import FloatArray

Answer: TypeAlias = Callable[[Sequence[FactorialRuns]], FloatArray]
"""Smaller ones of pf and reliability (C,) from runs of each kind, by the nodes `outer` of these."""

_BESIDE = "the design without two nodes more along each shared input"
_FEWER = "a third fewer nodes over the shared inputs"
_SETTLED = 0.3
"""Share of the tolerance that two rules over the polynomial may differ by."""
MOST_NODES, MOST_OF_INPUT = 400, 250
"""Nodes of the finest rule over all shared inputs together, and over one of them."""


@dataclass(frozen=True)
class GaussOuter:
    """One Gauss rule: the paper's choice.

    Attributes
    ----------
    nodes
        Nodes per shared input, from 2 to 64: one number for all, or a tuple.
    """

    nodes: Nodes = 3

    def __post_init__(self) -> None:
        keep(self, "nodes", checked_nodes)


@dataclass(frozen=True)
class RefinedOuter:
    """Gauss rules over the polynomial through few nodes, refined until answers stand.

    The response is smooth in the shared inputs; the power of its distribution that a system of
    many units asks for is not. So the model is run at few nodes, and at two more along each shared
    input, the others in the middle; the rule over the polynomial through them costs no runs.

    Attributes
    ----------
    tolerance
        Largest change, relative to pf or to the reliability, whichever is smaller: between one rule
        over the polynomial and the next, and by the two nodes more. Where these change more, the
        whole design is run with two nodes more for each shared input.
    nodes
        Nodes per shared input of the first design.
    most
        Most nodes per shared input of a design; not above `nodes`: the first one is the last.

    Raises
    ------
    ValueError
        If a setting is out of range.
    """

    tolerance: float = 0.01
    nodes: Nodes = 3
    most: int = 9

    def __post_init__(self) -> None:
        keep(self, "tolerance", real, above=0.0)
        keep(self, "nodes", checked_nodes)
        keep(self, "most", whole, at_least=2, at_most=MAX_GAUSS_NODES)


Outer: TypeAlias = GaussOuter | RefinedOuter


@dataclass(frozen=True, eq=False)
class Refined:
    """What refining has found.

    Attributes
    ----------
    runs
        The last design with its lines, and the nodes of the last rule, of each kind of units.
    changes
        What the smaller one of pf and reliability was changed by (C,): by the lines, and where the
        last rule has not settled by the one before; each with its cause.
    """

    runs: list[FactorialRuns]
    changes: list[tuple[str, FloatArray]]


def refined(
    outer: RefinedOuter,
    first: Sequence[int],
    known: Sequence[KnownRuns],
    grids: Sequence[Grids],
    answer: Answer,
) -> Refined:
    """Run designs and refine rules until answers stand, or the budget ends.

    Parameters
    ----------
    outer
        The settings.
    first
        Nodes of each shared input in the first design.
    known
        Runs made before, of each kind of units; takes those made here.
    grids
        The design over the individual inputs of each kind.
    answer
        Answers the criteria.

    Raises
    ------
    ValueError
        If a response is not finite, or an input has no such rule.
    BudgetExceededError, TimeLimitError
        If there is no room for the first design and its lines.
    """
    session, counts = known[0].task.session, list(first)
    while True:
        plain = runs_of_kinds(known, counts, grids)
        corrected = [_with_shared_lines(one) for one in plain]
        runs, with_lines, unsettled = _settled(corrected, outer.tolerance, answer)
        change = np.abs(answer(_by_rule(plain, runs[0].outer)) - with_lines)
        enough = (change <= outer.tolerance * with_lines).all()
        found = Refined(runs, [(_BESIDE, change), (_FEWER, unsettled)])
        counts = [n + MORE for n in counts]
        if enough or max(counts) > outer.most:
            return found
        size = math.prod(counts) * sum(math.prod(some) for own in grids for _, some in own)
        if size + MORE * len(counts) * len(known) > session.remaining:
            return found


def _with_shared_lines(runs: FactorialRuns) -> FactorialRuns:
    shared = range(len(runs.outer))
    lines = line_places(runs.known.inputs, runs.surface, runs.counts, shared)
    return replace(runs, surface=runs.surface.with_lines(lines, runs.known.finite))


def _by_rule(runs: Sequence[FactorialRuns], counts: tuple[int, ...]) -> list[FactorialRuns]:
    return [replace(one, outer=counts) for one in runs]


def _settled(
    runs: list[FactorialRuns], tolerance: float, answer: Answer
) -> tuple[list[FactorialRuns], FloatArray, FloatArray]:
    """Refine the rule over the polynomials, by half as many nodes each time, and answer by it.

    The last numbers (C,) tell what the last step changed answers by that have not settled.
    """
    counts = runs[0].outer
    found = answer(runs)
    unsettled = np.zeros_like(found)
    while counts:
        finer = tuple(n + max(MORE, n // 2) for n in counts)
        if math.prod(finer) > MOST_NODES or max(finer) > MOST_OF_INPUT:
            break
        counts, before = finer, found
        found = answer(_by_rule(runs, counts))
        apart = np.abs(found - before)
        unsettled = np.where(apart <= _SETTLED * tolerance * found, 0.0, apart)
        if not unsettled.any():
            break
    return _by_rule(runs, counts), found, unsettled
