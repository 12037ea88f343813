"""A check of the answers of a surface, by runs of the model where the surface says it fails."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from uqfold.inputs import JointInputs
from uqfold.methods.automatic_course import SEEN, Course, differ
from uqfold.methods.guided_sampling import GuidedDetails, GuidedSampling
from uqfold.methods.kriging import KrigingDetails
from uqfold.methods.polynomial_chaos import PolynomialChaosDetails
from uqfold.methods.result import NORMAL_95, Estimate
from uqfold.methods.warped import WarpedSurface
from uqfold.problems.base import Problem
from uqfold.problems.criterion import Criterion
from uqfold.problems.structure import Series
from uqfold.surrogates.designs import MAX_COORDINATE
from uqfold.surrogates.gaussian_process import GaussianProcess, fit_gaussian_process
from uqfold.typing import FloatArray

MOST_INPUTS, MOST_RUNS = 30, 1_000
"""A surface of more inputs, or of more runs, learns no more from its checks."""
SURFACES = (KrigingDetails, PolynomialChaosDetails)
"""What a surface tells of itself."""
THRESHOLDS = 3
"""A surface is checked at so many thresholds at most, from the highest on, until it holds."""


@dataclass(frozen=True)
class SurfaceModel:
    """A surface over standard-normal space as a model of the inputs.

    Attributes
    ----------
    surface
        Its `mean` gives responses (n,) of standard-normal variables (n, d).
    inputs
        Lead from the inputs there.
    """

    surface: Any
    inputs: JointInputs

    def __call__(self, x: FloatArray) -> FloatArray:
        """Return responses (n,) to inputs X (n, d)."""
        y: FloatArray = self.surface.mean(self.inputs.to_standard_normal(x))
        return y

    def learned(
        self, x: FloatArray, y: FloatArray, rng: np.random.Generator
    ) -> SurfaceModel | None:
        """Return the surface of the same runs and further ones, rougher than it may have been.

        None with too many inputs or runs, where fits take too long, and of polynomials.
        """
        warp = self.surface.warp if isinstance(self.surface, WarpedSurface) else None
        fitted = self.surface if warp is None else self.surface.surface
        if not isinstance(fitted, GaussianProcess) or self.inputs.dimension > MOST_INPUTS:
            return None
        if fitted.y.size + y.size > MOST_RUNS:
            return None
        u = self.inputs.to_standard_normal(x)
        y = y if warp is None else warp(y)
        near = np.isfinite(y) & (np.abs(u).max(axis=1) <= MAX_COORDINATE)
        process = fit_gaussian_process(
            np.concatenate([fitted.u, u[near]]),
            np.concatenate([fitted.y, y[near]]),
            trend=1,
            kernel="matern52",
            rng=rng,
        )
        return SurfaceModel(process if warp is None else WarpedSurface(process, warp), self.inputs)


def as_partner(details: object, problem: Problem) -> Problem | None:
    """Return the problem with a surface as its partner; None where there is not one for all."""
    if not isinstance(details, SURFACES) or details.of_other_kinds:
        return None
    model = SurfaceModel(details.surface, problem.inputs)
    return replace(problem, low_fidelity=model)


def check_of_one_unit(
    course: Course, rows: Sequence[int], partner: Problem, most: int, target_cov: float
) -> list[int]:
    """Compare how often one unit fails by the model and by the surface.

    All else in the answers of a system follows from the surface by integration. Return the rows
    for which nothing was seen.
    """
    one_unit = replace(partner, units=1, structure=Series())
    criteria = course.task.criteria
    session, before = course.task.session, course.task.session.n_evals
    left = list(rows)
    for threshold in sorted({criteria[i].threshold for i in rows}, reverse=True)[:THRESHOLDS]:
        most_now = min(most - (session.n_evals - before), session.remaining)
        criterion = Criterion(threshold)
        method = GuidedSampling(target_cov=target_cov, refined=False)
        solution, attempt = course.tried(method, (criterion,), most_now, "check", one_unit)
        [estimate] = attempt.estimates
        found = solution.details.sets[0] if solution.details and solution.details.sets else None
        if found is None or not estimate.stated_error <= SEEN * estimate.pf:
            continue
        here = [i for i in left if criteria[i].threshold == threshold]
        said = (
            f"one unit on the model fails {estimate.pf / found.partner_pf:.3g} +- "
            f"{estimate.std_error / found.partner_pf:.1g} times as often at T = {threshold:g} as "
            "by the surface"
        )
        apart = [i for i in here if differ(_by_surface(found, course.best(i)), estimate)]
        for i in apart:
            course.refuted(i, said)
        left = [i for i in left if i not in apart]
        if not apart:
            for i in left:
                course.held(i, said)
            return []
    return left


def _by_surface(found: GuidedDetails, answer: Estimate | None) -> Estimate:
    """Return what the surface says of one unit, with the relative error of its answer."""
    pf = found.partner_pf
    relative = answer.stated_error / answer.pf if answer is not None and answer.pf > 0.0 else 0.0
    reach = NORMAL_95 * relative * pf
    return Estimate(pf, std_error=relative * pf, ci_low=pf - reach, ci_high=pf + reach)
