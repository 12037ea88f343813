"""FFNI put together from its parts: inner design, conditional distribution, outer rule."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import ClassVar

import numpy as np

from uqfold.checks import choice, flag, instance, keep, real
from uqfold.evaluation import BudgetExceededError
from uqfold.methods.arguments import without_gauss_rules, without_own_inputs
from uqfold.methods.base import ReliabilityMethod, UnitsMayDiffer
from uqfold.methods.factorial_answers import (
    doubts_about_ends,
    doubts_about_nodes,
    fallbacks_that_matter,
    system_estimates,
)
from uqfold.methods.factorial_check import design_with_verdicts, with_verdicts
from uqfold.methods.factorial_design import (
    FactorialDesign,
    FFNIDetails,
    affordable_designs,
    conditional_responses,
    counts_per_input,
    joined_details,
)
from uqfold.methods.factorial_inner import (
    DimensionReduction,
    FullFactorial,
    Grids,
    Inner,
    SparseGrid,
)
from uqfold.methods.factorial_outer import GaussOuter, Outer, RefinedOuter, refined
from uqfold.methods.factorial_rules import SurfaceMoments, rules_of
from uqfold.methods.factorial_runs import FactorialRuns, KnownRuns, runs_of_kinds
from uqfold.methods.result import TARGET_COV, Estimate
from uqfold.methods.task import Solution, Task
from uqfold.methods.theory import Theory
from uqfold.methods.theory_of_integration import COMPOSED
from uqfold.moments.cumulants import Moments
from uqfold.moments.families import FAMILIES, Family
from uqfold.moments.quadrature import tensor_grid
from uqfold.problems.base import Problem
from uqfold.problems.criterion import Criterion
from uqfold.system.conditional import SystemProbability, system_failures_of_kinds
from uqfold.system.structure import SystemUnits
from uqfold.typing import FloatArray

_PEERS = ("pearson", "cubic-normal", "saddlepoint-quadratic", "maximum-entropy")
"""Families that are compared with one another: a few cumulants cut off say too little in tails."""
_NOT_REFINED = "the rule over the shared inputs is not refined: "


@dataclass(frozen=True)
class FFNI(ReliabilityMethod):
    """Numerical integration over shared and individual inputs, of parts that are chosen.

    At the nodes of a rule over the shared inputs, runs over the individual inputs give the moments
    of the response, and these its distribution; the units are independent there.

    Attributes
    ----------
    inner
        Where the model is run over the individual inputs: `FullFactorial`, `SparseGrid` or
        `DimensionReduction`.
    distribution
        ``saddlepoint`` with four cumulants, ``saddlepoint-6`` with six,
        ``saddlepoint-quadratic`` with all those of a response of degree two in standard normal
        inputs; ``pearson``, ``normal``, ``cubic-normal``, ``cornish-fisher``, or
        ``maximum-entropy`` with up to six moments.
    outer
        The expectation over the shared inputs: `GaussOuter` or `RefinedOuter`.
    check
        Whether to spend some runs beside the design and to answer in other ways, so that each
        answer states an error and is ``converged`` or ``doubtful``, as `FFNISaddlepoint` does.
    target_cov
        Largest stated error, relative to pf, of an answer that is ``converged``.

    Raises
    ------
    ValueError, TypeError
        If a setting is out of range.

    Notes
    -----
    Where moments belong to no distribution of the family, the Pearson distribution answers, and the
    status is ``doubtful`` if that matters. The saddlepoint approximations have no density, so that
    they are ``unsupported`` under a synchronization threshold. With failed runs or infinite
    responses only `FullFactorial` answers, with its own Gauss rules. ``docs/ffni.md`` derives the
    formulas.
    """

    name: ClassVar[str] = "ffni"
    title: ClassVar[str] = "FFNI, composed"
    theory: ClassVar[Theory] = COMPOSED
    bounds_failed_runs: ClassVar[bool] = True
    any_structure: ClassVar[bool] = True
    units_may_differ: ClassVar[UnitsMayDiffer] = "in all"

    inner: Inner = field(default_factory=FullFactorial)
    distribution: str = "cubic-normal"
    outer: Outer = field(default_factory=RefinedOuter)
    check: bool = True
    target_cov: float = TARGET_COV

    def __post_init__(self) -> None:
        kinds = FullFactorial, SparseGrid, DimensionReduction
        keep(self, "inner", instance, kinds, "give FullFactorial(), SparseGrid() or so")
        keep(self, "distribution", choice, FAMILIES)
        keep(self, "outer", instance, (GaussOuter, RefinedOuter), "give GaussOuter() or so")
        keep(self, "check", flag)
        keep(self, "target_cov", real, above=0.0)

    @classmethod
    def mended(cls, distribution: str = "cubic-normal") -> FFNI:
        """Return the paper's design with the rule over its shared inputs mended.

        Two nodes more along each shared input are all that is run beside the 3 x 5 x 5 ... nodes
        of the paper: four runs for each shared input.
        """
        return cls(FullFactorial(5), distribution, RefinedOuter(nodes=3, most=3))

    def supports(self, problem: Problem, criterion: Criterion) -> str | None:
        """Return why not, or None: the reasons of the base, and tau without a density."""
        if criterion.tau is not None and not FAMILIES[self.distribution].dense:
            return (
                f"distribution = {self.distribution!r} has no density for a synchronization "
                "threshold: give 'pearson' or another family"
            )
        return (
            super().supports(problem, criterion)
            or without_gauss_rules(problem)
            or without_own_inputs(problem, criterion)
        )

    def _solve(self, task: Task) -> Solution:
        kinds = task.problem.kinds
        known = [KnownRuns(task, kind) for kind in range(len(kinds.models))]
        grids = [self.inner.grids(inputs.n_individual) for inputs in kinds.inputs]
        outer = counts_per_input(kinds.inputs[0], self.outer.nodes, 2)[: kinds.n_shared]
        if not isinstance(self.inner, FullFactorial):
            return self._by_surface(task, known, outer, grids)
        designs = affordable_designs(task, self.outer.nodes, self.inner.nodes)
        counts = [[*outer, *own[0][1]] for own in grids]
        y = [
            one.at(tensor_grid(rules_of(one.inputs, own))[0])
            for one, own in zip(known, counts, strict=True)
        ]
        if isinstance(self.outer, GaussOuter):
            return self._by_design(task, designs, counts, y, [])
        if not all(np.isfinite(own).all() for own in y):
            return self._by_design(task, designs, counts, y, [_NOT_REFINED + "not finite"])
        try:
            return self._by_surface(task, known, outer, grids)
        except (ValueError, BudgetExceededError) as error:
            return self._by_design(task, designs, counts, y, [_NOT_REFINED + str(error)])

    def _by_design(
        self,
        task: Task,
        designs: Sequence[FactorialDesign],
        counts: Sequence[Sequence[int]],
        y: Sequence[FloatArray],
        doubts: Sequence[str],
    ) -> Solution:
        """Answer with the moments of the design's own rules, as the paper does."""
        family, problem = self._family, task.problem
        pairs = list(zip(designs, y, strict=True))
        details = task.summed_up(
            lambda _: [conditional_responses(*one, family.fit)[1] for one in pairs]
        )
        doubts = list(doubts)
        for kind, own in enumerate(counts if family.moments > 2 else []):
            inputs, name = problem.kinds.inputs[kind], problem.kinds.said(kind, problem.unit_names)
            nodes = tuple(own[: inputs.n_shared]), tuple(own[inputs.n_shared :])
            doubts += [name + doubt for doubt in doubts_about_nodes(inputs, *nodes)]
        estimates = _answers(task, family, details, doubts)
        if self.check:
            estimates = design_with_verdicts(
                task, counts, y, family, estimates, self.target_cov, self._peers
            )
        return Solution(estimates, joined_details(details))

    def _by_surface(
        self, task: Task, known: Sequence[KnownRuns], outer: Sequence[int], grids: Sequence[Grids]
    ) -> Solution:
        """Answer with the moments of the polynomials through the runs."""
        family, units = self._family, SystemUnits.of(task.problem)
        changes: list[tuple[str, FloatArray]] = []

        def smaller(runs: Sequence[FactorialRuns]) -> FloatArray:
            details = [_details(one, family) for one in runs]
            responses = [one.responses for one in details]
            weights = details[0].weights
            found = system_failures_of_kinds(responses, weights, units, task.criteria)
            return np.array([min(one.pf, one.reliability) for one in found])

        if isinstance(self.outer, RefinedOuter):
            found = refined(self.outer, outer, known, grids, smaller)
            runs, changes = found.runs, found.changes
        else:
            runs = runs_of_kinds(known, outer, grids)
        details = task.summed_up(lambda _: [_details(one, family) for one in runs])
        estimates = _answers(task, family, details, [])
        if self.check:
            estimates = with_verdicts(
                task, runs, family, estimates, self.target_cov, self._peers, changes
            )
        return Solution(estimates, joined_details(details))

    @property
    def _peers(self) -> tuple[str, ...]:
        # what knows fewer cumulants than all of them says little about these
        return _PEERS[:1] if self._family.moments == 0 else _PEERS

    @property
    def _family(self) -> Family:
        return FAMILIES[self.distribution].always()


def _details(runs: FactorialRuns, family: Family) -> FFNIDetails:
    """Return the distributions at the nodes of a rule over the polynomial."""
    inputs = runs.known.inputs
    quadratic = family.moments == 0
    surface = SurfaceMoments(inputs, runs.surface, runs.least, runs.additive, quadratic)
    rule = surface.at(runs.outer)
    shared, none = rule.places, np.zeros(len(rule.places))
    if not inputs.independent:
        rest = np.zeros((len(shared), inputs.n_individual))
        shared = inputs.from_standard_normal(np.hstack([shared, rest]))[:, : inputs.n_shared]
    fitted = rule.fitted(family.fit)
    assert fitted is not None
    return FFNIDetails(
        shared, rule.weights, Moments.of_rows(rule.moments), tuple(fitted), none, none, none
    )


def _answers(
    task: Task,
    family: Family,
    details: Sequence[FFNIDetails],
    doubts: Sequence[str],
) -> list[Estimate]:
    """Answer all criteria, with doubts where another distribution answers or one ends."""
    units = SystemUnits.of(task.problem)

    def doubts_of_kind(
        kind: int, criteria: Sequence[Criterion], found: Sequence[SystemProbability]
    ) -> list[str]:
        own = details[kind]
        replaced = [family.stands_in(one) for one in own.distributions]
        elsewhere = fallbacks_that_matter(
            own.weights, own.distributions, units, criteria, found, replaced, kind
        )
        ends = doubts_about_ends(units, criteria, found, own, kind)
        return [
            f"{family.title} does not exist at {count} of {len(replaced)} shared nodes; the "
            "Pearson distribution answers there"
            if count
            else end
            for count, end in zip(elsewhere.tolist(), ends, strict=True)
        ]

    def doubts_about(
        criteria: Sequence[Criterion], found: Sequence[SystemProbability]
    ) -> list[str]:
        every = [doubts_of_kind(kind, criteria, found) for kind in range(len(details))]
        return ["; ".join(filter(None, of_kinds)) for of_kinds in zip(*every, strict=True)]

    return system_estimates(task, details, list(doubts), doubts_about)
