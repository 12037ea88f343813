"""How units fail given the shared inputs, on a fitted surface of each kind of them.

What is made of this for one criterion has an error in three parts. Surfaces drawn from the
posteriors of all kinds tell how it scatters, each unit for itself; and all thresholds are moved,
forth and back, by what moves pf by its stated error, which holds whatever else is doubted about the
surfaces. The nodes over the shared inputs miss each number by about as much as they do pf.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from typing import TypeAlias

import numpy as np

from uqfold.analysis.fitted_surface import SurfaceMethod, fit_surfaces
from uqfold.checks import refused
from uqfold.evaluation import Evaluator
from uqfold.methods.arguments import CriteriaLike, checked_criteria, without_own_inputs
from uqfold.methods.kriging import Kriging
from uqfold.methods.result import CriterionResult
from uqfold.methods.seeding import RandomSource
from uqfold.problems.base import Problem
from uqfold.problems.criterion import Criterion
from uqfold.system.conditional_unit import UnitResponse
from uqfold.system.decision_diagram import diagram
from uqfold.system.missions import over_missions
from uqfold.system.structure import SystemUnits
from uqfold.system.surface import OfKinds
from uqfold.system.surface_layout import laid_out
from uqfold.system.synchronized import failure_of_units
from uqfold.typing import FloatArray

_Units: TypeAlias = tuple[FloatArray, FloatArray]
"""How each unit fails, and works, at each shared node (n, K)."""

_DRAWS = 12
"""Surfaces drawn for the error."""
_CAUTION = 1.5
"""Error over the spread of these, as measured beside tables of many more runs."""
_STEP = 1e-3
"""Step in the threshold for the derivative of pf, as a share of the range of responses."""


@dataclass(frozen=True, eq=False)
class UnitsGivenShared:
    """Units at the nodes of a quadrature over the shared inputs, for one criterion.

    Attributes
    ----------
    criterion, answer
        What was asked, and what the method answered for the system.
    fails, works
        How each unit does in one mission (n, K), and its complement.
    weights
        Of the nodes (K,), with the sum 1.
    drawn, moved
        How else they might do, as pairs like `fails` and `works`: by surfaces drawn, and with lower
        and higher thresholds. Both are empty where no error of pf is stated.
    caution
        How many times the spread of the former counts.
    integration
        Error of pf by the nodes themselves, relative to pf: they are those of all other numbers.
    """

    criterion: Criterion
    answer: CriterionResult
    fails: FloatArray
    works: FloatArray
    weights: FloatArray
    drawn: Sequence[_Units] = ()
    moved: Sequence[_Units] = ()
    caution: float = 1.0
    integration: float = 0.0

    def error(self, measure: Callable[[FloatArray, FloatArray], FloatArray]) -> FloatArray:
        """Standard errors of a function of `fails` and `works`, in its shape; NaN without any."""
        found = measure(self.fails, self.works)
        if not self.moved:
            return np.full_like(found, np.nan)
        drawn = np.array([measure(*one) for one in self.drawn])
        low, high = (measure(*one) for one in self.moved)
        # infinite ones have no error
        with np.errstate(invalid="ignore"):
            spread = self.caution * drawn.std(axis=0, ddof=1)
            training = np.hypot(spread, 0.5 * np.abs(high - low))
            integration = np.where(np.isfinite(found), self.integration * found, 0.0)
            return np.asarray(np.hypot(training, integration))


def units_given_shared(
    problem: Problem,
    criteria: CriteriaLike,
    method: SurfaceMethod | None,
    *,
    max_evals: int | None,
    rng: RandomSource,
    evaluator: Evaluator | None,
) -> list[UnitsGivenShared]:
    """Fit a surface for each kind of units, and evaluate how units fail for each criterion.

    Raises
    ------
    ValueError, TypeError
        For wrong arguments, for a criterion with tau, or where a unit has no individual input, so
        that it cannot fail alone.
    NoSurfaceError
        If the evaluations allow no surface.
    """
    asked = checked_criteria(problem, criteria)
    with_tau = [one for one in asked if one.tau is not None]
    if with_tau:
        raise refused("criteria", with_tau[0], "under tau units matter together; give none")
    if not any(one.n_individual for one in problem.kinds.inputs):
        raise refused("problem", problem, "nothing is individual: its units fail together")
    why = without_own_inputs(problem, asked[0])
    if why is not None:
        raise refused("problem", problem, why)
    fitted = fit_surfaces(
        problem, asked, Kriging() if method is None else method,
        max_evals=max_evals, rng=rng, evaluator=evaluator,
    )  # fmt: skip
    units, means = SystemUnits.of(problem), [one.surface.mean for one in fitted]
    # a second mission, so that the shared inputs are laid out for a single unit too
    laid = [*asked, Criterion(asked[0].threshold, missions=2)]
    dimensions = [one.inputs.dimension for one in fitted]
    system = laid_out(means, dimensions, problem.inputs.n_shared, units, laid)
    noise = [one.noise for one in fitted]
    weights = system.weights / system.weights.sum()
    nodes = _nodes(system.responses(means, noise=noise).whole)
    # few lines are enough for changes, but over the same shared nodes
    few = tuple(
        replace(coarse, shared_nodes=rule.shared_nodes, weights=rule.weights)
        for coarse, rule in zip(system.coarse, system.rules, strict=True)
    )
    generator = np.random.default_rng(fitted[0].result.seed)
    paths = [one.surface.sample_paths(generator, _DRAWS) for one in fitted]
    _, *by_others = replace(system, coarse=few).coarse_responses(means, paths, noise=noise)
    others = [_nodes(one) for one in by_others]
    step = _STEP * max(
        float(np.ptp(mean(rule.points))) for mean, rule in zip(means, few, strict=True)
    )
    structure = diagram(problem.structure, problem.unit_names)

    def given(row: int, criterion: Criterion, answer: CriterionResult) -> UnitsGivenShared:
        def units_at(threshold: float) -> _Units:
            return _of_units(nodes, units, threshold)

        def log_pf(threshold: float) -> float:
            whole = over_missions(
                *structure.probabilities(*units_at(threshold)), criterion.missions
            )
            return float(np.log(np.maximum(whole[0] @ weights, np.finfo(np.float64).tiny)))

        T = criterion.threshold
        own = UnitsGivenShared(criterion, answer, *units_at(T), weights)
        slope = (log_pf(T - step) - log_pf(T + step)) / (2.0 * step)
        if not (answer.std_error > 0.0 and slope > 0.0):
            return own
        by = answer.std_error / answer.pf / slope
        moved = [units_at(T - by), units_at(T + by)]
        drawn = [_of_units(one, units, T) for one in others]
        caution = _CAUTION * max(one.overconfidence for one in fitted)
        parts = fitted[0].result.details.errors
        integration = float(parts.integration[row]) / answer.pf
        return replace(own, drawn=drawn, moved=moved, caution=caution, integration=integration)

    answers = zip(asked, fitted[0].result, strict=True)
    return [given(row, *pair) for row, pair in enumerate(answers)]


def _nodes(responses: OfKinds) -> list[list[UnitResponse]]:
    """Responses of all kinds at each shared node."""
    return [
        [UnitResponse([one], np.ones(1)) for one in of_kinds]
        for of_kinds in zip(*responses, strict=True)
    ]


def correlation_of_failures(first: FloatArray, second: FloatArray, weights: FloatArray) -> float:
    """Correlation of two failures that are independent given the shared inputs.

    Parameters
    ----------
    first, second
        Their probabilities (K,) at the nodes of weights (K,). Of two alike the same one twice.

    Returns
    -------
    float
        0 where nothing is shared; NaN where one of them is certain.
    """
    p, q = float(first @ weights), float(second @ weights)
    joint = float(((first - p) * (second - q)) @ weights)
    scale = np.sqrt(p * (1.0 - p) * q * (1.0 - q))
    return joint / float(scale) if scale > 0.0 else float("nan")


def _of_units(
    nodes: Sequence[Sequence[UnitResponse]], units: SystemUnits, threshold: float
) -> _Units:
    """How each unit fails and works at each shared node (n, K)."""
    pairs = [failure_of_units(node, units, np.array([threshold])) for node in nodes]
    index = np.zeros(units.count, dtype=int) if units.of_sorts is None else units.of_sorts
    fails, works = (np.concatenate(one, axis=1)[index] for one in zip(*pairs, strict=True))
    return fails, works
