"""FFNI with the saddlepoint approximation: the paper's method without synchronization."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from uqfold.checks import flag, keep, real
from uqfold.methods.arguments import without_gauss_rules, without_own_inputs
from uqfold.methods.base import ReliabilityMethod, UnitsMayDiffer
from uqfold.methods.factorial_answers import (
    doubts_about_nodes,
    fallbacks_that_matter,
    system_estimates,
)
from uqfold.methods.factorial_check import design_with_verdicts
from uqfold.methods.factorial_design import (
    Nodes,
    affordable_designs,
    checked_nodes,
    counts_per_input,
    details_of_kinds,
    joined_details,
)
from uqfold.methods.result import TARGET_COV
from uqfold.methods.task import Solution, Task
from uqfold.methods.theory import Theory
from uqfold.methods.theory_of_integration import SADDLEPOINT
from uqfold.moments.families import FAMILIES
from uqfold.problems.base import Problem
from uqfold.problems.criterion import Criterion
from uqfold.system.conditional import SystemProbability
from uqfold.system.structure import SystemUnits


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
        of all of them is the number of evaluations of the design.
    check
        Whether to spend some runs beside the design, two nodes more along each input and up to
        eight near the thresholds, and to answer in other ways, so that each answer states an error
        and is ``converged`` or ``doubtful``. Without it, or where the budget has no room for
        these runs, answers are ``unchecked``.
    target_cov
        Largest stated error, relative to pf or to the reliability, whichever is smaller, of an
        answer that is ``converged``.

    Raises
    ------
    ValueError
        If a node count is not a whole number from 2 to 64.

    Notes
    -----
    Where the cumulants allow no admissible saddlepoint, the Pearson distribution with the same
    moments answers, and the status is ``doubtful`` if that matters. With a synchronization
    threshold the method is ``unsupported``: the approximation gives tails, but no density worth
    integrating. What the check compares is told in ``docs/ffni.md``.
    """

    name: ClassVar[str] = "ffni-spa"
    title: ClassVar[str] = "FFNI + saddlepoint"
    theory: ClassVar[Theory] = SADDLEPOINT
    bounds_failed_runs: ClassVar[bool] = True
    any_structure: ClassVar[bool] = True
    units_may_differ: ClassVar[UnitsMayDiffer] = "in all"

    nodes_shared: Nodes = 3
    nodes_individual: Nodes = 5
    check: bool = True
    target_cov: float = TARGET_COV

    def __post_init__(self) -> None:
        keep(self, "nodes_shared", checked_nodes)
        keep(self, "nodes_individual", checked_nodes)
        keep(self, "check", flag)
        keep(self, "target_cov", real, above=0.0)

    def supports(self, problem: Problem, criterion: Criterion) -> str | None:
        """Return why not, or None: the reasons of the base, and every criterion with tau."""
        if criterion.tau is not None:
            return (
                "the saddlepoint approximation gives no density for a synchronization threshold: "
                "use ffni-pearson"
            )
        return (
            super().supports(problem, criterion)
            or without_gauss_rules(problem)
            or without_own_inputs(problem, criterion)
        )

    def _solve(self, task: Task) -> Solution:
        family, problem = FAMILIES["saddlepoint"], task.problem
        nodes = self.nodes_shared, self.nodes_individual
        designs = affordable_designs(task, *nodes)
        details, y = details_of_kinds(task, designs, family.fit)
        units = SystemUnits.of(problem)

        def doubts_about(
            criteria: Sequence[Criterion], found: Sequence[SystemProbability]
        ) -> list[str]:
            fallbacks = sum(
                fallbacks_that_matter(
                    one.weights, one.distributions, units, criteria, found, kind=kind
                )
                for kind, one in enumerate(details)
            )
            return [
                f"no admissible saddlepoint at {count} of {len(details[0].weights)} shared nodes; "
                "the Pearson distribution answers there"
                if count
                else ""
                for count in np.asarray(fallbacks).tolist()
            ]

        doubts = [
            problem.kinds.said(kind, problem.unit_names) + doubt
            for kind, inputs in enumerate(problem.kinds.inputs)
            for doubt in doubts_about_nodes(inputs, *nodes)
        ]
        estimates = system_estimates(task, details, doubts, doubts_about)
        if self.check:
            counts = [counts_per_input(inputs, *nodes) for inputs in problem.kinds.inputs]
            estimates = design_with_verdicts(task, counts, y, family, estimates, self.target_cov)
        return Solution(estimates, joined_details(details))
