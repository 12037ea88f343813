"""How units fail given the shared inputs, on a fitted surface."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from uqfold.analysis.fitted_surface import SurfaceMethod, fit_surface
from uqfold.checks import refused
from uqfold.evaluation import Evaluator
from uqfold.methods.arguments import CriteriaLike, checked_criteria
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
    """Fit a surface, and evaluate how units fail for each criterion.

    Raises
    ------
    ValueError, TypeError
        For wrong arguments, for a criterion with tau, or where nothing is individual, so that no
        unit can fail alone.
    NoSurfaceError
        If the evaluations allow no surface.
    """
    asked = checked_criteria(problem, criteria)
    with_tau = [one for one in asked if one.tau is not None]
    if with_tau:
        raise refused("criteria", with_tau[0], "under tau units matter together; give none")
    if problem.inputs.n_individual == 0:
        raise refused("problem", problem, "nothing is individual: its units fail together")
    fitted = fit_surface(
        problem, asked, Kriging() if method is None else method,
        max_evals=max_evals, rng=rng, evaluator=evaluator,
    )  # fmt: skip
    # a second mission, so that the shared inputs are laid out for a single unit too
    laid = [*asked, Criterion(asked[0].threshold, missions=2)]
    mean, inputs, units = fitted.surface.mean, problem.inputs, SystemUnits.of(problem)
    system = laid_out(mean, inputs.dimension, inputs.n_shared, units, laid)
    responses = system.responses(mean, noise=fitted.noise).whole[0]
    nodes = [UnitResponse([response], np.ones(1)) for response in responses]
    weights = system.weights / system.weights.sum()
    return [
        UnitsGivenShared(criterion, row, *_of_units(nodes, units, criterion.threshold), weights)
        for criterion, row in zip(asked, fitted.result, strict=True)
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
    nodes: Sequence[UnitResponse], units: SystemUnits, threshold: float
) -> tuple[FloatArray, FloatArray]:
    """How each unit fails and works at each shared node (n, K)."""
    pairs = [failure_of_units(node, units, np.array([threshold])) for node in nodes]
    index = np.zeros(units.count, dtype=int) if units.of_sorts is None else units.of_sorts
    fails, works = (np.concatenate(one, axis=1)[index] for one in zip(*pairs, strict=True))
    return fails, works
