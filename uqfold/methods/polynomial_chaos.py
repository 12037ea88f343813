"""Polynomial chaos: one expansion over all inputs, and every answer from it."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import partial
from typing import ClassVar, Literal, TypeAlias, get_args

import numpy as np

from uqfold.checks import choice, flag, keep, or_none, real, whole
from uqfold.inputs import JointInputs
from uqfold.inputs.marginal import Marginal
from uqfold.inputs.polynomials import OwnPolynomials, own_polynomials
from uqfold.methods.arguments import certain_under_tau
from uqfold.methods.base import UnitsMayDiffer
from uqfold.methods.design_runs import DesignRuns
from uqfold.methods.factorial_design import Nodes, affordable_design, checked_nodes
from uqfold.methods.fitted_kind import FittedKind, Rival
from uqfold.methods.growing_design import Learned, grown
from uqfold.methods.response_surface import ErrorParts, surface_estimates
from uqfold.methods.result import TARGET_COV
from uqfold.methods.steps import SequentialMethod, Steps
from uqfold.methods.task import Task
from uqfold.methods.theory import Theory
from uqfold.methods.theory_of_surfaces import POLYNOMIAL_CHAOS
from uqfold.methods.warped import WarpedSurface, transformed, warp_for
from uqfold.moments.quadrature import tensor_grid
from uqfold.problems.base import Problem
from uqfold.problems.criterion import Criterion
from uqfold.surrogates.cross_validation import LeaveOneOut
from uqfold.surrogates.designs import DEFAULT_SPREAD, checked_spread
from uqfold.surrogates.polynomial_chaos import (
    PolynomialChaosExpansion,
    VarianceShares,
    fit_basis,
    fit_polynomial_chaos,
)
from uqfold.surrogates.warping import Warp
from uqfold.typing import FloatArray

MAX_GROWN = 2_000
"""Runs to which a design grows by itself."""

DesignName: TypeAlias = Literal["space-filling", "ffni"]
BasisName: TypeAlias = Literal["best", "hermite", "own"]


@dataclass(frozen=True, eq=False)
class PolynomialChaosDetails:
    """The surface of a `PolynomialChaos` run.

    Attributes
    ----------
    surface
        The expansion: multi-indices, coefficients, `mean`, `to_chaospy`; where it is one of
        transformed responses, that expansion and the transformation.
    sobol_indices
        Sensitivity of the response, transformed in that case, to each input, in the order of the
        problem's inputs. With dependent inputs: to the variables of the Rosenblatt transformation.
    cross_validation
        Leave-one-out residuals, of transformed responses in that case.
    relative_error
        Their root mean square, as a share of the standard deviation of these responses.
    errors
        Where the stated errors come from.
    of_other_kinds
        The same for the surfaces of other kinds of units, in the order in which they occur.
    """

    surface: PolynomialChaosExpansion | WarpedSurface
    sobol_indices: VarianceShares
    cross_validation: LeaveOneOut
    relative_error: float
    errors: ErrorParts
    of_other_kinds: tuple[PolynomialChaosDetails, ...] = ()


@dataclass(frozen=True)
class PolynomialChaos(SequentialMethod):
    """Polynomial chaos expansion by regression, integrated over without sampling.

    Orthonormal polynomials are fitted to the responses at a design, with a degree that the
    corrected leave-one-out error chooses: Hermite polynomials in the standard-normal space of the
    Rosenblatt transformation, or those of the inputs' own distributions (Legendre for uniform,
    Laguerre for exponential ones, ...), whichever predicts runs left out better.
    The conditional distribution of the response given the shared inputs, and from it every
    criterion with its missions and tau, follow by integration over the expansion. The residuals
    are carried into the stated error.

    Attributes
    ----------
    runs
        Evaluations of the space-filling designs, those of all kinds of units together; fewer if the
        budget allows fewer. None: for each kind 100, or five for each input if that is more; where
        a budget is given that allows more, they are doubled as long as the stated error is above
        its target and this may help, and six more at each of up to three thresholds check the
        answers.
    sparse
        Whether least-angle regression may leave polynomials out, or all up to the degree stay.
    max_degree
        Highest total degree that is tried.
    basis
        ``best``, or only one kind of polynomials: ``hermite``, or ``own``. Normal inputs, inputs
        that depend on others and inputs without a variance have Hermite polynomials in any case.
    design
        ``space-filling``, or ``ffni``: the nodes of full-factorial numerical integration, so that
        runs already made for that method serve twice.
    nodes_shared, nodes_individual
        The counts of nodes for ``ffni``, as in `FFNIPearson`, at least 2. Few nodes per input
        cannot see its high powers; what their highest visible power changes is a part of the
        stated error.
    spread
        Standard deviation of the space-filling points, in standard deviations of the inputs.
    target_cov
        Stated error, relative to pf or to the reliability, whichever is smaller, that is aimed for:
        a row that states more is ``doubtful``.
    warp
        Whether responses that span decades may be transformed first, by a power or a logarithm that
        is found from the runs, if this predicts left-out runs better; the nodes of ``ffni``, units
        that differ and a synchronization threshold keep them as they are.

    Raises
    ------
    ValueError
        If a setting is out of range.
    """

    name: ClassVar[str] = "pce"
    title: ClassVar[str] = "Polynomial chaos"
    theory: ClassVar[Theory] = POLYNOMIAL_CHAOS
    bounds_failed_runs: ClassVar[bool] = True
    any_structure: ClassVar[bool] = True
    units_may_differ: ClassVar[UnitsMayDiffer] = "in all"

    runs: int | None = None
    sparse: bool = True
    max_degree: int = 10
    basis: BasisName = "best"
    design: DesignName = "space-filling"
    nodes_shared: Nodes = 3
    nodes_individual: Nodes = 5
    spread: float = DEFAULT_SPREAD
    target_cov: float = TARGET_COV
    warp: bool = True

    def __post_init__(self) -> None:
        keep(self, "runs", or_none, whole, at_least=1)
        keep(self, "sparse", flag)
        keep(self, "max_degree", whole, at_least=1)
        keep(self, "basis", choice, get_args(BasisName))
        keep(self, "design", choice, get_args(DesignName))
        keep(self, "nodes_shared", checked_nodes)
        keep(self, "nodes_individual", checked_nodes)
        keep(self, "spread", checked_spread)
        keep(self, "target_cov", real, above=0.0)
        keep(self, "warp", flag)

    @property
    def stochastic(self) -> bool:
        """Whether the design is scrambled; that of FFNI is fixed."""
        return self.design == "space-filling"

    def supports(self, problem: Problem, criterion: Criterion) -> str | None:
        """Refuse the nodes of FFNI for units of several kinds."""
        reason = super().supports(problem, criterion) or certain_under_tau(problem, criterion)
        if reason is None and self.design == "ffni" and len(problem.kinds.models) > 1:
            return 'units with models or inputs of their own need design="space-filling"'
        return reason

    def _steps(self, task: Task) -> Steps:
        if self.design == "space-filling":
            answered = partial(self._answered, task)
            return (yield from grown(task, self.runs, MAX_GROWN, self.spread, answered))
        x = affordable_design(task, self.nodes_shared, self.nodes_individual).x
        y = yield x
        runs = DesignRuns(self._standard_nodes(task.problem.inputs, x), y, x.shape[0])
        if not runs.fittable:
            return runs.without_surface(task)
        return self._answered(task, [runs]).solution

    def _answered(self, task: Task, runs: Sequence[DesignRuns]) -> Learned:
        kinds = [
            self._fitted(task, inputs, own)
            for inputs, own in zip(task.problem.kinds.inputs, runs, strict=True)
        ]
        warp = warp_for(task, runs[0]) if self.warp and self.stochastic else None
        if warp is not None:
            asked, seen = transformed(task, runs[0], warp)
            warped = self._fitted(task, task.problem.inputs, seen)
            if _mean_square(*warped) < _mean_square(*kinds[0]):
                task, kinds = asked, [warped]
            else:
                warp = None
        rng = task.generator(1) if self.stochastic else np.random.default_rng(0)
        fitted = [fitted for _, fitted in kinds]
        found = surface_estimates(
            task, fitted, rng,
            target_cov=self.target_cov,
            stepped=self.design == "space-filling",
        )  # fmt: skip
        return Learned(task, fitted, found, partial(_details, kinds, warp), warp)

    def _fitted(
        self, task: Task, inputs: JointInputs, runs: DesignRuns
    ) -> tuple[PolynomialChaosExpansion, FittedKind]:
        """Fit the surface of one kind of units."""
        fitted = runs.u[runs.finite], runs.y[runs.finite]
        # n nodes cannot tell u^n from lower powers
        orders = np.array(self._counts(inputs)) - 1 if self.design == "ffni" else None

        def fit(stopped: str) -> tuple[list[PolynomialChaosExpansion], str]:
            return [
                fit_polynomial_chaos(
                    *fitted,
                    sparse=self.sparse, max_degree=self.max_degree, max_orders=orders, own=own,
                    directions=self.sparse,
                )
                for own in self._bases(inputs)
            ], stopped  # fmt: skip

        surfaces, stopped = task.summed_up(fit)
        # the first of two that are equally good
        surface, *others = sorted(surfaces, key=lambda one: one.regression.error)
        if stopped:
            runs = replace(runs, stopped=stopped)
        rivals = [Rival.by_prediction(surface, other) for other in others]
        if orders is not None:
            # and leaving out one of them does not show what is missing: what the highest power
            # that they can tell changes stands for that error
            lower = surface.indices[(surface.indices < orders).all(axis=1)]
            rivals.append(Rival(fit_basis(*fitted, lower, surface.basis), share=1.0))
        return surface, FittedKind(surface, runs, rivals=rivals)

    def _bases(self, inputs: JointInputs) -> list[list[OwnPolynomials | None] | None]:
        """Sets of polynomials to try; None: those of Hermite."""
        own = None if self.basis == "hermite" else own_polynomials(inputs, self.max_degree + 1)
        if own is None or not any(own):
            return [None]
        return [own] if self.basis == "own" else [None, own]

    def _standard_nodes(self, inputs: JointInputs, x: FloatArray) -> FloatArray:
        """Nodes of the factorial design in standard-normal space, in the order of its rows x."""
        if inputs.independent:
            columns = zip(inputs.columns, x.T, strict=True)
            return np.column_stack(
                [_normal_scores(marginal, values) for marginal, values in columns]
            )
        rules = [np.polynomial.hermite_e.hermegauss(n) for n in self._counts(inputs)]
        return tensor_grid(rules)[0]

    def _counts(self, inputs: JointInputs) -> list[int]:
        return [
            *_repeated(self.nodes_shared, inputs.n_shared),
            *_repeated(self.nodes_individual, inputs.n_individual),
        ]


def _details(
    kinds: Sequence[tuple[PolynomialChaosExpansion, FittedKind]],
    warp: Warp | None,
    errors: ErrorParts,
) -> PolynomialChaosDetails:
    details = []
    for surface, fitted in kinds:
        validated, scatter = fitted.validated, float(fitted.known.std())
        relative = validated.rms / scatter if scatter > 0.0 else 0.0
        shares = surface.sobol_indices()
        shown = surface if warp is None else WarpedSurface(surface, warp)
        details.append(PolynomialChaosDetails(shown, shares, validated, relative, errors))
    return replace(details[0], of_other_kinds=tuple(details[1:]))


def _mean_square(surface: PolynomialChaosExpansion, fitted: FittedKind) -> float:
    """Return the corrected leave-one-out error in the squared unit of the response."""
    return surface.regression.error * float(fitted.known.var())


def _repeated(nodes: Nodes, n_variables: int) -> tuple[int, ...]:
    return (nodes,) * n_variables if isinstance(nodes, int) else nodes


def _normal_scores(marginal: Marginal, x: FloatArray) -> FloatArray:
    """Standard-normal variable of a marginal's values x (n,), each from its own tail."""
    from scipy.special import ndtri

    below, above = marginal.cdf(x), marginal.sf(x)
    return np.asarray(np.where(below < 0.5, ndtri(below), -ndtri(above)))
