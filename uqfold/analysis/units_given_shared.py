"""How units fail given the shared inputs, on a fitted surface of each kind of them."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

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
from uqfold.system.structure import SystemUnits
from uqfold.system.surface_layout import laid_out
from uqfold.system.synchronized import failure_of_units
from uqfold.typing import FloatArray


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
    """

    criterion: Criterion
    answer: CriterionResult
    fails: FloatArray
    works: FloatArray
    weights: FloatArray


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
    responses = system.responses(means, noise=[one.noise for one in fitted]).whole
    nodes = [
        [UnitResponse([one], np.ones(1)) for one in of_kinds]
        for of_kinds in zip(*responses, strict=True)
    ]
    weights = system.weights / system.weights.sum()
    result = fitted[0].result
    return [
        UnitsGivenShared(criterion, row, *_of_units(nodes, units, criterion.threshold), weights)
        for criterion, row in zip(asked, result, strict=True)
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
) -> tuple[FloatArray, FloatArray]:
    """How each unit fails and works at each shared node (n, K)."""
    pairs = [failure_of_units(node, units, np.array([threshold])) for node in nodes]
    index = np.zeros(units.count, dtype=int) if units.of_sorts is None else units.of_sorts
    fails, works = (np.concatenate(one, axis=1)[index] for one in zip(*pairs, strict=True))
    return fails, works
