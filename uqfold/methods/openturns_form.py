"""FORM on one unit by OpenTURNS; units and missions joined through the design point.

The design point of one unit splits into a shared and an individual part. In the linearised
picture all n m responses of a system are equally correlated normal variables, with the squared
length of the shared part of alpha as their correlation, so that the system follows from a
one-factor normal integral.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import partial
from typing import ClassVar, get_args

import numpy as np

from uqfold.checks import choice, keep, real, refused, several, whole
from uqfold.inputs import JointInputs
from uqfold.methods.base import ReliabilityMethod, UnitsMayDiffer
from uqfold.methods.design_point import LOOSE_RESIDUAL, DesignPoint, Search, verdict
from uqfold.methods.design_point_error import with_error
from uqfold.methods.design_points_of_units import estimate_of_units
from uqfold.methods.openturns_search import Algorithm, DesignPointSearch
from uqfold.methods.result import TARGET_COV, Estimate
from uqfold.methods.standard_space import NoGradientError, in_doubt
from uqfold.methods.task import Solution, Task, attempt
from uqfold.methods.theory import Theory
from uqfold.methods.theory_of_simulation import FORM
from uqfold.problems.criterion import Criterion
from uqfold.system.linearised import linearised_failure
from uqfold.system.structure import SystemUnits

SMALLEST_STEP = 1e-4
"""Smallest half width of the differences: rounding is 1e-8 of the second ones then."""


@dataclass(frozen=True)
class FORMDetails:
    """Design points by kind of units and threshold, ascending; `n_evals_start`: runs before."""

    design_points: tuple[DesignPoint, ...]
    n_evals_start: int


@dataclass(frozen=True)
class OpenTURNSFORM(ReliabilityMethod):
    """First-order reliability method on one unit, by OpenTURNS.

    One search for each distinct threshold T serves all criteria with that T; units that differ by
    offset, model or inputs have one each. It runs in
    independent standard-normal space and starts where the plane through the origin's gradient
    meets T, whatever else is asked. The result is checked, not trusted: the point must lie on the
    limit state and be collinear with the gradient there, within `tolerance`, and none of 2 d - 1
    other points as near to the origin may lie beyond the limit state. If the first check fails, the
    next algorithm has a go; if the second fails, one more search starts where the failure domain
    came nearer. Then the axes, and the ray opposite, are looked at for a second domain of failure
    that would matter.

    If all this holds, the curvature there, the place of the limit state along the normal, and
    design points that are found from `starts` - 1 other starts tell what FORM leaves out (see
    `SecondLook`); units that are not in series are looked at where they fail together, too. Up to
    `target_cov` of the smaller probability this is the stated error and the status
    ``converged``; beyond, the status is ``doubtful``, and the message states FORM's number and that
    of second order. It is also ``doubtful`` for a point that nearly fits, for signs of several
    design points (FORM sees one), and for one more than 10 standard deviations away; so it is where
    a unit is taken for one that always works, or fails, since no run has shown otherwise. It is
    ``unchecked`` with `starts` = 1, where only Breitung's factor of more than 20 % is doubted; else
    ``failed``.

    `max_evals` pays for the gradient at the origin first; what is left is split into equal shares
    for the remaining thresholds, and a share that is not used up goes to the later ones. The
    thresholds nearest to the response at the origin come first. A search cut short gives its best
    linearisation with the status ``budget_exhausted``. Without a budget every row is the same alone
    and among others, its runs apart, which several searches may share. A failed run ends the whole
    estimate.

    Attributes
    ----------
    algorithms
        OpenTURNS algorithms in the order in which they are tried.
    step
        Half width of the central differences (standard deviations), from 1e-4 to 1, where the
        problem has no ``gradient``. The default
        suits a model with noise: for the wing, 2e-5 s against 10 ms per standard deviation gives
        the gradient to about half a percent.
    tolerance
        Largest residual |u - beta alpha| of a design point, relative to max(1, |beta|). An error
        r in the point shifts beta by about r^2 times half the curvature.
    max_iterations
        Iterations allowed to each algorithm.
    starts
        Searches for each threshold. The first start is as above; the others are points as far out,
        on the axes, opposite and elsewhere, where the limit state seems nearer than the plane says:
        none is spent on a linear response. 1: no second look, and no error stated.
    target_cov
        Largest stated error, relative to pf or to the reliability, whichever is smaller, of an
        answer that is ``converged``.

    Raises
    ------
    ValueError
        If a setting is out of range.
    """

    name: ClassVar[str] = "openturns-form"
    title: ClassVar[str] = "FORM (OpenTURNS)"
    theory: ClassVar[Theory] = FORM
    any_structure: ClassVar[bool] = True
    units_may_differ: ClassVar[UnitsMayDiffer] = "in all"
    answers_tau: ClassVar[bool] = False

    algorithms: tuple[Algorithm, ...] = ("AbdoRackwitz", "SQP", "Cobyla")
    step: float = 0.2
    tolerance: float = 0.02
    max_iterations: int = 50
    starts: int = 4
    target_cov: float = TARGET_COV

    def __post_init__(self) -> None:
        keep(self, "algorithms", several, choice, get_args(Algorithm))
        if not self.algorithms:
            known = ", ".join(map(repr, get_args(Algorithm)))
            raise refused("algorithms", (), f"give at least one of {known}")
        keep(self, "step", real, at_least=SMALLEST_STEP, at_most=1.0)
        keep(self, "tolerance", real, above=0.0, below=LOOSE_RESIDUAL)
        keep(self, "max_iterations", whole, at_least=1)
        keep(self, "starts", whole, at_least=1)
        keep(self, "target_cov", real, above=0.0)

    @property
    def how(self) -> DesignPointSearch:
        """How design points are looked for."""
        return DesignPointSearch(
            self.algorithms, self.step, self.tolerance, self.max_iterations, self.starts
        )

    def _solve(self, task: Task) -> Solution:
        problem, session = task.problem, task.session
        units, kinds = SystemUnits.of(problem), problem.kinds
        try:
            done = self.how.searched(task)
        except NoGradientError as error:
            failed = Estimate.without_answer("failed", f"no design point: {error}")
            return Solution([failed] * len(task.criteria))
        responses, starts, searches, n_start = (
            done.responses,
            done.starts,
            done.found,
            done.n_evals_start,
        )
        points = task.summed_up(lambda _: design_points(searches, kinds.inputs))

        # at an infinite threshold
        alike = SystemUnits(units.count, units.diagram)

        def of_units(criterion: Criterion) -> Estimate:
            thresholds = units.thresholds(criterion.threshold).tolist()
            keys = list(zip(units.of_kinds.tolist(), thresholds, strict=True))
            own = [searches[key] for key in keys]
            verdicts = [
                verdict(search, starts[kind], self.tolerance)
                for (kind, _), search in zip(keys, own, strict=True)
            ]
            spent = n_start + sum(searches[key].n_evals for key in dict.fromkeys(keys))
            before = session.n_evals
            for response in responses:
                response.allowed = session.n_evals + session.remaining
            estimate = estimate_of_units(
                [responses[kind] for kind, _ in keys],
                own,
                verdicts,
                kinds.n_shared,
                units,
                criterion.missions,
                self.target_cov,
            )
            return replace(estimate, n_evals_row=spent + session.n_evals - before)

        def answer(criterion: Criterion) -> Estimate:
            if math.isinf(criterion.threshold):
                message = f"T = {criterion.threshold}: FORM sees no infinite responses"
                pf, reliability = linearised_failure(
                    criterion.threshold, 0.0, alike, criterion.missions
                )
                return Estimate(pf, reliability, status="doubtful", message=message)
            if units.of_sorts is not None or units.diagram is not None:
                return of_units(criterion)
            search = searches[0, criterion.threshold]
            point = points[0, criterion.threshold]
            status, message = verdict(search, starts[0], self.tolerance)
            if status == "failed":
                return Estimate.without_answer("failed", message)
            pf, reliability = linearised_failure(
                point.beta_hl, point.shared_fraction, units, criterion.missions
            )
            estimate = Estimate(
                pf,
                reliability,
                status=status,
                message=message,
                n_evals_row=n_start + point.n_evals,
            )
            if search.look is None or search.cut:
                return estimate
            return with_error(
                estimate,
                search,
                search.look,
                problem,
                criterion.missions,
                self.target_cov,
            )

        estimates = [attempt(partial(answer, criterion)) for criterion in task.criteria]
        estimates = [in_doubt(one, done.refuted) for one in estimates]
        return Solution(estimates, FORMDetails(tuple(points.values()), n_start))


def design_points(
    searches: Mapping[tuple[int, float], Search], inputs: Sequence[JointInputs]
) -> dict[tuple[int, float], DesignPoint]:
    """Return the design points by kind of units and threshold, ascending."""
    found = {}
    for kind, own in enumerate(inputs):
        thresholds = sorted(threshold for of_kind, threshold in searches if of_kind == kind)
        if not thresholds:
            continue
        # all are mapped to the inputs at once
        best = np.array([searches[kind, threshold].best.u for threshold in thresholds])
        for threshold, row in zip(thresholds, own.from_standard_normal(best), strict=True):
            search = searches[kind, threshold]
            found[kind, threshold] = search.design_point(row, own.n_shared, kind, own.names)
    return found
