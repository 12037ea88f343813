"""FFNI with the saddlepoint approximation: the paper's method without synchronization."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from uqfold.checks import keep
from uqfold.methods.base import ReliabilityMethod, Solution, Task, UnitsMayDiffer
from uqfold.methods.factorial_answers import doubts_about_nodes, system_estimates
from uqfold.methods.factorial_design import (
    FFNIDetails,
    Nodes,
    affordable_design,
    checked_nodes,
    conditional_responses,
)
from uqfold.methods.theory import Theory
from uqfold.methods.theory_of_integration import SADDLEPOINT
from uqfold.moments.saddlepoint import SaddlepointDistribution
from uqfold.problems.base import Problem
from uqfold.problems.criterion import Criterion
from uqfold.system.conditional import SystemProbability
from uqfold.system.structure import SystemUnits

_MATTERS = 1e-3
"""Share of pf from which a fallback at one node makes the whole answer doubtful."""


@dataclass(frozen=True)
class FFNISaddlepoint(ReliabilityMethod):
    """Full-factorial numerical integration with the saddlepoint approximation, Eqs. (31)-(36).

    Gauss rules over the shared inputs give the outer expectation; at each shared node, Gauss rules
    over the individual inputs give four cumulants, and from these the Lugannani-Rice formula gives
    both tails of the conditional response.

    Attributes
    ----------
    nodes_shared, nodes_individual
        Nodes per shared and per individual input: one number for all, or a tuple. The product
        of all of them is the number of evaluations.

    Raises
    ------
    ValueError
        If a node count is not a whole number from 2 to 64.

    Notes
    -----
    Where the cumulants allow no admissible saddlepoint, the Pearson distribution with the same
    moments answers, and the status is ``doubtful`` if that matters. With a synchronization
    threshold the method is ``unsupported``: the approximation gives tails, but no density worth
    integrating. The method estimates no error of its own, so that its answers are ``unchecked``.
    """

    name: ClassVar[str] = "ffni-spa"
    title: ClassVar[str] = "FFNI + saddlepoint"
    theory: ClassVar[Theory] = SADDLEPOINT
    bounds_failed_runs: ClassVar[bool] = True
    any_structure: ClassVar[bool] = True
    units_may_differ: ClassVar[UnitsMayDiffer] = "by offset"

    nodes_shared: Nodes = 3
    nodes_individual: Nodes = 5

    def __post_init__(self) -> None:
        keep(self, "nodes_shared", checked_nodes)
        keep(self, "nodes_individual", checked_nodes)

    def supports(self, problem: Problem, criterion: Criterion) -> str | None:
        """Return why not, or None: the reasons of the base, and every criterion with tau."""
        if criterion.tau is not None:
            return (
                "the saddlepoint approximation gives no density for a synchronization threshold: "
                "use ffni-pearson"
            )
        return super().supports(problem, criterion)

    def _solve(self, task: Task) -> Solution:
        design = affordable_design(task, self.nodes_shared, self.nodes_individual)
        y = task.session.evaluate(design.x)
        responses, details = task.summed_up(
            lambda _: conditional_responses(design, y, SaddlepointDistribution)
        )

        def doubts_about(
            criteria: Sequence[Criterion], found: Sequence[SystemProbability]
        ) -> list[str]:
            return _doubts(SystemUnits.of(task.problem), criteria, found, details)

        nodes = self.nodes_shared, self.nodes_individual
        doubts = doubts_about_nodes(task.problem.inputs, *nodes)
        estimates = system_estimates(task, responses, details, doubts, doubts_about)
        return Solution(estimates, details)


def _doubts(
    units: SystemUnits,
    criteria: Sequence[Criterion],
    found: Sequence[SystemProbability],
    details: FFNIDetails,
) -> list[str]:
    """Return where the fallback answered at a node that contributes to pf."""
    thresholds = units.thresholds([criterion.threshold for criterion in criteria])
    missions = np.array([float(criterion.max_missions) for criterion in criteria])
    pf = np.array([one.pf for one in found])
    fallbacks = np.zeros(len(criteria), dtype=int)
    for weight, distribution in zip(details.weights, details.distributions, strict=True):
        if isinstance(distribution, SaddlepointDistribution):
            value = distribution.evaluate(thresholds)
            share = weight * units.count * missions * np.minimum(value.cdf, value.sf)
            fallbacks += (value.fallback & (share > _MATTERS * pf)).any(axis=0)
    return [
        f"no admissible saddlepoint at {count} of {len(details.weights)} shared nodes; the "
        "Pearson distribution answers there"
        if count
        else ""
        for count in fallbacks
    ]
