"""One fitted response surface, asked about other distributions of the inputs.

A surface over the standard-normal space of the inputs it was fitted with is as good for other
distributions of the same inputs: their standard-normal variables are mapped to input values, and
these back to the variables of the surface. No evaluation of the model is needed.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import TypeAlias

import numpy as np

from uqfold.checks import instance
from uqfold.evaluation import Evaluator
from uqfold.inputs import JointInputs
from uqfold.methods.arguments import checked_unit
from uqfold.methods.fitted_kind import ResponseSurface
from uqfold.methods.kriging import Kriging, KrigingDetails
from uqfold.methods.polynomial_chaos import PolynomialChaos, PolynomialChaosDetails
from uqfold.methods.result import NO_ANSWER, ReliabilityResult
from uqfold.methods.seeding import RandomSource
from uqfold.methods.warped import WarpedSurface
from uqfold.problems.base import Problem
from uqfold.problems.criterion import Criterion
from uqfold.surrogates.gaussian_process import GaussianProcess
from uqfold.surrogates.partner_surface import PartnerSurface
from uqfold.system.surface_rule import Surface
from uqfold.typing import FloatArray

SurfaceMethod: TypeAlias = Kriging | PolynomialChaos
"""Methods whose details hold the surface."""


class NoSurfaceError(RuntimeError):
    """A method gave no surface, or one with holes."""


@dataclass(frozen=True, eq=False)
class FittedSurface:
    """A surface, and what a method says with it.

    Attributes
    ----------
    surface
        Over the standard-normal space of `inputs`.
    inputs
        The inputs it was fitted with.
    noise
        Standard deviation of what the model does beside the surface, in the response's unit.
    result
        The answers of the method.
    """

    surface: ResponseSurface
    inputs: JointInputs
    noise: float
    result: ReliabilityResult

    @property
    def overconfidence(self) -> float:
        """By what factor left-out runs are missed by more than the surface says, at least 1."""
        return max(1.0, self.surface.leave_one_out().ratio)

    def seen_from(self, surface: Surface, inputs: JointInputs) -> Surface:
        """Return a function over the space of `self.inputs` as one over the space of other inputs.

        Raises
        ------
        ValueError
            When called where the other inputs reach beyond the bounds of `self.inputs`.
        """
        if inputs is self.inputs:
            return surface

        def seen(u: FloatArray) -> FloatArray:
            own = self.inputs.to_standard_normal(inputs.from_standard_normal(u))
            if not np.isfinite(own).all():
                column = int(np.argmin(np.isfinite(own).all(axis=0)))
                raise ValueError(
                    f"{inputs.names[column]} reaches beyond the bounds of the distribution that "
                    "the surface was fitted with: use a distribution whose bounds do not move"
                )
            return surface(own)

        return seen


def fit_surface(
    problem: Problem,
    criteria: Sequence[Criterion],
    method: SurfaceMethod,
    *,
    max_evals: int | None = None,
    rng: RandomSource = None,
    evaluator: Evaluator | None = None,
) -> FittedSurface:
    """Run a method and take its surface, which stands for all units; see `fit_surfaces`.

    Raises
    ------
    TypeError, ValueError
        Also if units have models or inputs of their own.
    NoSurfaceError
        As `fit_surfaces`.
    """
    checked_unit(problem)
    return fit_surfaces(
        problem, criteria, method, max_evals=max_evals, rng=rng, evaluator=evaluator
    )[0]


def fit_surfaces(
    problem: Problem,
    criteria: Sequence[Criterion],
    method: SurfaceMethod,
    *,
    max_evals: int | None = None,
    rng: RandomSource = None,
    evaluator: Evaluator | None = None,
) -> list[FittedSurface]:
    """Run a method and take its surface of each kind of units.

    Parameters as in `ReliabilityMethod.estimate`. Responses are not transformed (`warp`): what is
    asked of the surfaces is asked of the responses.

    Raises
    ------
    TypeError, ValueError
        If the method has no surface.
    NoSurfaceError
        If it found no answer, or some responses are infinite or failed, where no surface is.
    """
    instance("method", method, (Kriging, PolynomialChaos), "give Kriging() or PolynomialChaos()")
    method = replace(method, warp=False)
    result = method.estimate(problem, criteria, max_evals=max_evals, rng=rng, evaluator=evaluator)
    details = result.details
    if not isinstance(details, KrigingDetails | PolynomialChaosDetails):
        said = [row.message for row in result if row.status in NO_ANSWER] or [result[0].message]
        why = said[0] or "no surface"
        raise NoSurfaceError(f"{method.name} gave no surface: {why}")
    of_kinds = [details, *details.of_other_kinds]
    finite = sum(one.cross_validation.residuals.size for one in of_kinds)
    if finite < result.n_evals:
        raise NoSurfaceError(
            f"{result.n_evals - finite} of {result.n_evals} runs gave no finite response: a "
            "surface says nothing about where they are"
        )
    fitted = []
    for one, inputs in zip(of_kinds, problem.kinds.inputs, strict=True):
        surface = one.surface
        assert not isinstance(surface, WarpedSurface)
        has_noise = isinstance(surface, GaussianProcess | PartnerSurface)
        noise = surface.noise_std if has_noise else 0.0
        fitted.append(FittedSurface(surface, inputs, noise, result))
    return fitted
