"""FFNI with a Pearson distribution: the paper's method for synchronous deployment."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import ClassVar, Literal, get_args

from uqfold.checks import choice, flag, keep, or_none, real, whole
from uqfold.methods.arguments import without_gauss_rules, without_own_inputs
from uqfold.methods.base import ReliabilityMethod, UnitsMayDiffer
from uqfold.methods.factorial_answers import doubts_about_ends, doubts_about_nodes, system_estimates
from uqfold.methods.factorial_check import design_with_verdicts
from uqfold.methods.factorial_design import (
    Nodes,
    affordable_designs,
    checked_nodes,
    counts_per_input,
    details_of_kinds,
    joined_details,
)
from uqfold.methods.pearson_sampling import sampled_failure
from uqfold.methods.result import TARGET_COV
from uqfold.methods.task import Solution, Task
from uqfold.methods.theory import Theory
from uqfold.methods.theory_of_integration import PEARSON
from uqfold.moments.families import FAMILIES
from uqfold.problems.base import Problem
from uqfold.problems.criterion import Criterion
from uqfold.system.conditional import SystemProbability
from uqfold.system.structure import SystemUnits

Family = Literal["pearson", "normal"]


@dataclass(frozen=True)
class FFNIPearson(ReliabilityMethod):
    """Full-factorial numerical integration with a Pearson distribution, Eqs. (41)-(47).

    Gauss rules over the shared inputs give the outer expectation; at each shared node, Gauss rules
    over the individual inputs give four moments, which select one member of the Pearson family as
    the conditional distribution. The order statistics of the units then follow by integration; no
    sampling is needed.

    Attributes
    ----------
    nodes_shared, nodes_individual
        Nodes per shared and per individual input: one number for all, or a tuple. The product
        of all of them is the number of evaluations of the design.
    family
        ``pearson``, or ``normal`` for the two-moment distribution of earlier work (the paper's
        reference 32).
    rows
        None: integrate. A number: draw that many rows N_0 from each conditional distribution, as
        the paper does in Eqs. (43)-(47); the answer then has a sampling error.
    check
        Whether to spend some runs beside the design, two nodes more along each input and up to
        eight near the thresholds, and to answer in other ways, so that each answer states an error
        and is ``converged`` or ``doubtful``. Without it, or where the budget has no room for
        these runs, answers are ``unchecked``. Sampled rows are not checked.
    target_cov
        Largest stated error, relative to pf or to the reliability, whichever is smaller, of an
        answer that is ``converged``.

    Raises
    ------
    ValueError
        If a setting is out of range.

    Notes
    -----
    A bounded Pearson type ends somewhere; where the threshold lies beyond that end, pf has no
    contribution from it and the status is ``doubtful``. What the check compares is told in
    ``docs/ffni.md``.
    """

    name: ClassVar[str] = "ffni-pearson"
    title: ClassVar[str] = "FFNI + Pearson"
    theory: ClassVar[Theory] = PEARSON
    bounds_failed_runs: ClassVar[bool] = True
    any_structure: ClassVar[bool] = True
    units_may_differ: ClassVar[UnitsMayDiffer] = "in all"

    nodes_shared: Nodes = 3
    nodes_individual: Nodes = 5
    family: Family = "pearson"
    rows: int | None = None
    check: bool = True
    target_cov: float = TARGET_COV

    def __post_init__(self) -> None:
        keep(self, "nodes_shared", checked_nodes)
        keep(self, "nodes_individual", checked_nodes)
        keep(self, "family", choice, get_args(Family))
        keep(self, "rows", or_none, whole, at_least=2)
        keep(self, "check", flag)
        keep(self, "target_cov", real, above=0.0)

    @property
    def stochastic(self) -> bool:
        """Whether rows are sampled."""
        return self.rows is not None

    def supports(self, problem: Problem, criterion: Criterion) -> str | None:
        """Return why not, or None: the reasons of the base, and rows of several kinds of units."""
        if self.rows is not None and len(problem.kinds.models) > 1:
            return "units of several kinds are integrated, not sampled: leave out rows="
        reason = super().supports(problem, criterion) or without_gauss_rules(problem)
        several = len(problem.kinds.models) > 1
        return reason or (without_own_inputs(problem, criterion) if several else None)

    def _solve(self, task: Task) -> Solution:
        family, problem = FAMILIES[self.family], task.problem
        nodes = self.nodes_shared, self.nodes_individual
        designs = affordable_designs(task, *nodes)
        details, y = details_of_kinds(task, designs, family.fit)
        doubts = []
        if self.family == "pearson":
            doubts = [
                problem.kinds.said(kind, problem.unit_names) + doubt
                for kind, inputs in enumerate(problem.kinds.inputs)
                for doubt in doubts_about_nodes(inputs, *nodes)
            ]
        if self.rows is not None:
            sampled = sampled_failure(task, details[0].responses, details[0], self.rows, doubts)
            return Solution(sampled, details[0])

        units = SystemUnits.of(problem)

        def doubts_about(
            criteria: Sequence[Criterion], found: Sequence[SystemProbability]
        ) -> list[str]:
            every = [
                doubts_about_ends(units, criteria, found, one, kind)
                for kind, one in enumerate(details)
            ]
            return ["; ".join(filter(None, own)) for own in zip(*every, strict=True)]

        estimates = system_estimates(task, details, doubts, doubts_about)
        if self.check:
            counts = [counts_per_input(inputs, *nodes) for inputs in problem.kinds.inputs]
            estimates = design_with_verdicts(task, counts, y, family, estimates, self.target_cov)
        return Solution(estimates, joined_details(details))
