"""Derivatives of pf from one fitted response surface, without further evaluations.

A moved mean or standard deviation maps the standard-normal space to other inputs, and so moves
the surface over it. The reliability index is found on the same points with the parameter a step up
and a step down; it is close to linear in most parameters, so that its central difference is
accurate where that of pf would not be. Surfaces drawn from the posterior give the error.
"""

from __future__ import annotations

import math
import time
from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from uqfold.algebra import one_blas_thread
from uqfold.analysis.fitted_surface import FittedSurface, SurfaceMethod, fit_surface
from uqfold.analysis.pf_derivatives import (
    Differentiated,
    InputParameter,
    PfDerivative,
    PfDerivatives,
    chosen_parameters,
    derivative_row,
)
from uqfold.evaluation import Evaluator
from uqfold.inputs import JointInputs
from uqfold.inputs.score import moved_inputs
from uqfold.methods.arguments import CriteriaLike, checked_criteria
from uqfold.methods.kriging import Kriging
from uqfold.methods.seeding import RandomSource, block_generator
from uqfold.problems.base import Problem
from uqfold.problems.criterion import Criterion
from uqfold.system.refinement import TOLERANCE
from uqfold.system.structure import SystemUnits
from uqfold.system.surface import SurfaceSystem, reliability_index
from uqfold.system.surface_layout import laid_out
from uqfold.system.surface_rule import Surface
from uqfold.typing import FloatArray

_STEP = 0.05
"""Half width of the central differences, in standard deviations of the input."""
_DRAWS = 20
_STREAM = 7
"""Block of the seed that the draws come from; fits use the first few."""
_RELATIVE_ERROR, _ABSOLUTE_ERROR = 4e-3, 2e-4
"""Error of a central difference of the reliability index on the points of one surface rule: a share
of it, and per standard deviation of the input where the rule meets its tolerance."""


@one_blas_thread()
def surface_derivatives(
    problem: Problem,
    criteria: CriteriaLike = None,
    method: SurfaceMethod | None = None,
    *,
    inputs: Sequence[str] | None = None,
    max_evals: int | None = None,
    rng: RandomSource = None,
    evaluator: Evaluator | None = None,
) -> PfDerivatives:
    """Differentiate pf by means and standard deviations of the inputs, on a fitted surface.

    Parameters
    ----------
    problem
        Model, inputs and units, exchangeable.
    criteria
        What "works" means; None takes the problem's own default criteria.
    method
        `Kriging` (None: with its default settings) or `PolynomialChaos`.
    inputs
        Names of the inputs to differentiate by; None: all.
    max_evals, rng, evaluator
        As in `ReliabilityMethod.estimate`.

    Returns
    -------
    PfDerivatives
        Criteria first, then means, then standard deviations.

    Raises
    ------
    ValueError, TypeError
        For wrong arguments.
    NoSurfaceError
        If the evaluations allow no surface.
    """
    started = time.perf_counter()
    asked = checked_criteria(problem, criteria)
    parameters = chosen_parameters(problem, inputs)
    fitted = fit_surface(
        problem, asked, Kriging() if method is None else method,
        max_evals=max_evals, rng=rng, evaluator=evaluator,
    )  # fmt: skip
    result = fitted.result
    found = _Differences.of(fitted, problem, asked)
    table = [list(found.by(parameter)) for parameter in parameters]
    rows = [
        _row(fitted, i, criterion, parameter, column[i])
        for i, criterion in enumerate(asked)
        for parameter, column in zip(parameters, table, strict=True)
    ]
    return PfDerivatives(
        rows=tuple(rows),
        n_evals=result.n_evals,
        n_reused=result[0].n_reused,
        n_failed=result.n_failed,
        seconds=time.perf_counter() - started,
        seed=result.seed,
    )


def _row(
    fitted: FittedSurface,
    i: int,
    criterion: Criterion,
    parameter: InputParameter,
    found: Differentiated,
) -> PfDerivative:
    row = fitted.result[i]
    return derivative_row(
        criterion, parameter, row.pf, found, "surrogate", row.method, row.status, row.message
    )


@dataclass(frozen=True, eq=False)
class _Differences:
    """A surface laid out for differences.

    `index` (C,), its changes (R, C) by drawn surfaces, and by how many of its tolerances the
    integration may miss it (C,).
    """

    fitted: FittedSurface
    system: SurfaceSystem
    criteria: Sequence[Criterion]
    paths: Surface
    index: FloatArray
    changes: FloatArray
    tolerances: FloatArray

    @classmethod
    def of(
        cls, fitted: FittedSurface, problem: Problem, criteria: Sequence[Criterion]
    ) -> _Differences:
        inputs = problem.inputs
        units, mean = SystemUnits.of(problem), fitted.surface.mean
        system = laid_out(mean, inputs.dimension, inputs.n_shared, units, criteria)
        rng = block_generator(fitted.result.seed, _STREAM)
        paths = fitted.surface.sample_paths(rng, _DRAWS)
        index, changes = _answer(fitted, system, criteria, paths, inputs)
        responses = system.responses(fitted.surface.mean, noise=fitted.noise)
        tolerances = system.integration_errors(responses, criteria) / TOLERANCE
        return cls(fitted, system, criteria, paths, index, changes, np.maximum(tolerances, 1.0))

    def by(self, parameter: InputParameter) -> Iterator[Differentiated]:
        """Derivatives by one parameter, for each criterion."""
        inputs = self.fitted.inputs
        (up, change_up), (down, change_down) = (
            _answer(
                self.fitted, self.system, self.criteria, self.paths,
                moved_inputs(inputs, parameter.input, parameter.moment, step),
            )
            for step in (_STEP, -_STEP)
        )  # fmt: skip
        width = 2.0 * _STEP * parameter.std
        slope = (up - down) / width
        slopes = slope + (change_up - change_down) / width
        indices = self.index + self.changes
        derivative, relative = _of_pf(self.index, slope)
        drawn, drawn_relative = _of_pf(indices, slopes)
        factor = self.fitted.overconfidence
        missed = _ABSOLUTE_ERROR * self.tolerances / parameter.std
        inexact = np.hypot(_RELATIVE_ERROR * slope, missed)
        own = np.abs(np.array(_of_pf(self.index, inexact)))
        errors = np.hypot(factor * drawn.std(axis=0, ddof=1), own[0])
        relative_errors = np.hypot(factor * drawn_relative.std(axis=0, ddof=1), own[1])
        rows = zip(derivative, errors, relative, relative_errors, strict=True)
        for row in rows:
            yield Differentiated(*(float(value) for value in row))


def _answer(
    fitted: FittedSurface,
    system: SurfaceSystem,
    criteria: Sequence[Criterion],
    paths: Surface,
    inputs: JointInputs,
) -> tuple[FloatArray, FloatArray]:
    """Reliability indices (C,) with the inputs as given, and their changes (R, C) by the draws."""
    mean = fitted.seen_from(fitted.surface.mean, inputs)
    drawn = fitted.seen_from(paths, inputs)
    found = system.failures(mean, criteria, noise=fitted.noise)
    changes = system.changes(mean, drawn, criteria, noise=fitted.noise)
    return np.array([reliability_index(one) for one in found]), changes


def _of_pf(index: FloatArray, slope: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Derivatives of pf and of ln pf from the reliability index and its derivative."""
    from scipy.special import log_ndtr

    log_density = -0.5 * index**2 - 0.5 * math.log(2.0 * math.pi)
    return -np.exp(log_density) * slope, -np.exp(log_density - log_ndtr(-index)) * slope
