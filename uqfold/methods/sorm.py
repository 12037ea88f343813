"""SORM: FORM's design points, with the curvature of the limit state there."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from functools import partial
from itertools import compress
from typing import ClassVar, get_args

import numpy as np

from uqfold.checks import choice, instance, keep, real
from uqfold.evaluation import BudgetExceededError
from uqfold.methods.base import ReliabilityMethod
from uqfold.methods.design_point import DesignPoint, Search, Start, verdict
from uqfold.methods.design_point_check import Surroundings
from uqfold.methods.design_point_error import LEAST, index_moved
from uqfold.methods.design_point_scan import unexplained
from uqfold.methods.openturns_form import OpenTURNSFORM, design_points
from uqfold.methods.result import NORMAL_95, TARGET_COV, Estimate
from uqfold.methods.second_order import Formula, Paraboloid, union
from uqfold.methods.standard_space import StandardSpaceResponse, in_doubt
from uqfold.methods.task import Solution, Task, attempt
from uqfold.methods.theory import Theory
from uqfold.methods.theory_of_simulation import SORM as THEORY
from uqfold.problems.base import Problem
from uqfold.problems.criterion import Criterion, Missions
from uqfold.system.linearised import linearised_failure
from uqfold.system.structure import SystemUnits
from uqfold.typing import FloatArray

NEAREST = 1.0
"""Distance of a design point below which the limit state as a whole counts, not that around it."""


@dataclass(frozen=True, eq=False)
class SecondOrder:
    """What second order says of one threshold.

    Attributes
    ----------
    threshold
        T.
    pf
        Failure probability by each formula: ``paraboloid``, ``breitung``, ``hohenbichler-rackwitz``
        and ``tvedt``; NaN where the limit state bends too much for it.
    curvatures
        Main curvatures of the limit state at each design point (P, d - 1), ascending, per standard
        deviation, positive where it bends away from the origin.
    distances
        Distances of the design points from the origin (P,), the best one first.
    """

    threshold: float
    pf: dict[str, float]
    curvatures: FloatArray
    distances: FloatArray


@dataclass(frozen=True)
class SORMDetails:
    """Design points, and what second order says of each threshold; `n_evals_start`: runs before."""

    design_points: tuple[DesignPoint, ...]
    second_orders: tuple[SecondOrder, ...]
    n_evals_start: int


@dataclass(frozen=True)
class SORM(ReliabilityMethod):
    """Second-order reliability method on one unit.

    Design points are found and looked at as by `OpenTURNSFORM`, by the same runs. A paraboloid with
    the curvatures of the limit state takes the place of its tangent plane, and further design
    points are joined as a series system: what lies behind any of several planes, each as far out as
    its paraboloid is unlikely, with the correlation of their directions (multinormal).

    The stated error is the sum of what is seen of each thing left out: the distance of the formula
    from the integral over the paraboloid, curvatures over a longer distance, what points drawn on
    the tangent plane show beyond the paraboloid, kinks and slants, failures on other rays that no
    design point explains, and the bounds of the multinormal integral.

    Attributes
    ----------
    formula
        Which probability behind a paraboloid is reported; `SORMDetails` has all. ``paraboloid`` is
        the integral itself, the others approximate it.
    search
        How design points are sought: its `starts` are 2 at least.
    target_cov
        Largest stated error, relative to pf or to the reliability, whichever is smaller, of an
        answer that is ``converged``.

    Raises
    ------
    ValueError
        If a setting is out of range.

    Notes
    -----
    Several units in series and missions are joined as by FORM, by planes as far out as one unit is
    unlikely to fail. How curvature ties them together is not known, so that all of it is in the
    error, and several design points are ``doubtful``.
    """

    name: ClassVar[str] = "sorm"
    title: ClassVar[str] = "SORM"
    theory: ClassVar[Theory] = THEORY
    answers_tau: ClassVar[bool] = False

    formula: Formula = "paraboloid"
    search: OpenTURNSFORM = field(default_factory=OpenTURNSFORM)
    target_cov: float = TARGET_COV

    def __post_init__(self) -> None:
        keep(self, "formula", choice, get_args(Formula))
        keep(self, "search", instance, (OpenTURNSFORM,), "give uqfold.methods.OpenTURNSFORM()")
        keep(self, "target_cov", real, above=0.0)

    def _solve(self, task: Task) -> Solution:
        form = replace(self.search, starts=max(2, self.search.starts))
        done = form.how.searched(task)
        points = task.summed_up(lambda _: design_points(done.found, task.problem.kinds.inputs))
        response, start = done.responses[0], done.starts[0]
        looked: dict[float, SecondOrder] = {}
        system = partial(linearised_failure, units=SystemUnits.of(task.problem))

        def answer(criterion: Criterion) -> Estimate:
            threshold = criterion.threshold
            if math.isinf(threshold):
                message = f"T = {threshold}: SORM sees no infinite responses"
                pf, reliability = system(threshold, 0.0, missions=criterion.missions)
                return Estimate(pf, reliability, status="doubtful", message=message)
            before = task.session.n_evals
            response.allowed = before + task.session.remaining
            search = done.found[0, threshold]
            estimate, order = self._answer(response, search, start, criterion, task.problem)
            if order is not None:
                looked[threshold] = order
            spent = done.n_evals_start + search.n_evals + task.session.n_evals - before
            return replace(estimate, n_evals_row=spent)

        estimates = [attempt(partial(answer, criterion)) for criterion in task.criteria]
        estimates = [in_doubt(one, done.refuted) for one in estimates]
        orders = tuple(looked[threshold] for threshold in sorted(looked))
        details = SORMDetails(tuple(points.values()), orders, done.n_evals_start)
        return Solution(estimates, details)

    def _answer(
        self,
        response: StandardSpaceResponse,
        search: Search,
        start: Start,
        criterion: Criterion,
        problem: Problem,
    ) -> tuple[Estimate, SecondOrder | None]:
        """Answer one criterion, from a search that may not have come to its end."""
        system = _System(search, problem, criterion.missions)
        from scipy.special import ndtri

        tolerance = self.search.tolerance
        status, message = verdict(search, start, tolerance)
        if status == "failed":
            return Estimate.without_answer("failed", message), None
        plane = Estimate(
            *system.pf(search.beta),
            status="doubtful" if status == "unchecked" else status,
            message=f"first order only: {message or 'no second look'}",
        )
        look = search.look
        if look is None or search.cut or math.isinf(look.place):
            return plane, None
        others = [one for one, _ in search.others]
        try:
            around = [Surroundings(response, one) for one in (search, *map(search.at, others))]
            paraboloids = [Paraboloid.at(one) for one in around]
            elsewhere = around[0].elsewhere(others) + unexplained(around)
        except BudgetExceededError as short:
            cut = f"first order only: {short}"
            return replace(plane, status="budget_exhausted", message=cut), None
        between = not paraboloids[0].is_nearest
        if not between:
            # what lies behind a point between nearer ones lies behind these
            nearest = [one.is_nearest for one in paraboloids]
            around = list(compress(around, nearest))
            paraboloids = list(compress(paraboloids, nearest))
        joined = _Joined(around, paraboloids)
        if others and elsewhere == 0.0:
            # what was seen of other domains is what the other points explain
            search, start = replace(search, several=False), replace(start, stationary=False)
            status, message = verdict(search, start, tolerance)
        small, error = joined.answer(self.formula, elsewhere)
        estimate = _estimate(small, error, around[0].side)
        if not system.single:
            if others and status == "unchecked":
                status, message = "doubtful", "several units, and several design points of each"
            index = -around[0].side * float(ndtri(small))
            estimate = system.estimate(index, error / small + look.curvature)
            small, error = min(estimate.pf, estimate.reliability or 0.0), estimate.std_error
        if status == "unchecked" and between:
            status, message = "doubtful", "the limit state comes nearer beside the design point"
        if status != "unchecked":
            return replace(estimate, status=status, message=message), joined.told()
        if around[0].radius < NEAREST:
            near = f"the design point is too near to the median for second order: {small:.3g}"
            return replace(estimate, status="doubtful", message=near), joined.told()
        if not error <= self.target_cov * small:
            doubt = f"second order may be {error / small:.2g} off: {joined.reason(elsewhere)}"
            return replace(estimate, status="doubtful", message=doubt), joined.told()
        return estimate, joined.told()


@dataclass(frozen=True, eq=False)
class _System:
    """Units in series over missions, each as likely to fail as it is behind a plane."""

    search: Search
    problem: Problem
    missions: Missions

    @property
    def single(self) -> bool:
        """Whether it is one unit over one mission."""
        return self.problem.n_units == 1 and self.missions == 1

    def pf(self, index: float, *, at_start: bool = False) -> tuple[float, float]:
        """Failure probability and reliability for the reliability index of one unit."""
        alpha = (self.search.start if at_start else self.search.best).alpha
        shared = min(1.0, float(np.sum(alpha[: self.problem.inputs.n_shared] ** 2)))
        return linearised_failure(index, shared, SystemUnits.of(self.problem), self.missions)

    def estimate(self, index: float, change: float) -> Estimate:
        """Return the answer, where one unit's probability may change by so much, as a logarithm."""
        own = self.pf(index)
        rarer = 0 if own[0] <= own[1] else 1
        others = [self.pf(index, at_start=True)]
        if math.isfinite(change):
            others += [self.pf(index_moved(index, sign * change)) for sign in (1.0, -1.0)]
        away = [abs(one[rarer] - own[rarer]) for one in others]
        error = away[0] + max(away[1:], default=math.inf)
        return _estimate(own[rarer], error, 1.0 - 2.0 * rarer)


@dataclass(frozen=True, eq=False)
class _Joined:
    """The paraboloids at all design points of one threshold."""

    around: Sequence[Surroundings]
    paraboloids: Sequence[Paraboloid]

    def behind(self, formula: Formula, *, further: bool = False) -> tuple[float, float]:
        """Probability behind any of them by a formula, and what pairs leave open of it."""
        from scipy.special import ndtri

        alone = np.array(
            [
                (replace(one, curvatures=one.further) if further else one).probabilities()[formula]
                for one in self.paraboloids
            ]
        )
        if not (alone < 1.0).all():
            return math.nan, math.inf
        towards = np.array([one.towards for one in self.paraboloids])
        return union((-ndtri(np.maximum(alone, 1e-300))).tolist(), towards)

    def answer(self, formula: Formula, elsewhere: float) -> tuple[float, float]:
        """Return the smaller probability, and its error; that of the plane if there is no other."""
        from scipy.special import ndtr

        small, open_ = self.behind(formula)
        if math.isnan(small):
            return float(ndtr(-self.paraboloids[0].radius)), math.inf
        error = open_ + small * (LEAST + sum(self._parts(elsewhere).values()))
        error += abs(self.behind("paraboloid")[0] - small)
        error += abs(self.behind("paraboloid", further=True)[0] - self.behind("paraboloid")[0])
        return small, math.inf if math.isnan(error) else error

    def _parts(self, elsewhere: float) -> dict[str, float]:
        looks = [one.search.look for one in self.around]
        return {
            "the limit state is no paraboloid": max(one.misfit for one in self.paraboloids),
            "it has kinks, or is not where it seems": looks[0].place if looks[0] else math.inf,
            "other domains of failure are near": elsewhere,
        }

    def reason(self, elsewhere: float) -> str:
        """Return what is the largest part of the error."""
        parts = self._parts(elsewhere)
        return max(parts, key=lambda name: parts[name])

    def told(self) -> SecondOrder:
        """Return what is known of the threshold."""
        side = self.around[0].side
        pf = {}
        for formula in get_args(Formula):
            small, _ = self.behind(formula)
            pf[formula] = small if side > 0.0 else 1.0 - small
        return SecondOrder(
            self.around[0].search.threshold,
            pf,
            np.array([one.curvatures for one in self.paraboloids]),
            np.array([one.radius for one in self.paraboloids]),
        )


def _estimate(small: float, error: float, side: float) -> Estimate:
    """Return an estimate of the smaller probability: pf where failure lies beyond the point."""
    pf, reliability = (small, 1.0 - small) if side > 0.0 else (1.0 - small, small)
    if math.isinf(error):
        return Estimate(pf, reliability)
    return Estimate(
        pf,
        reliability,
        std_error=error,
        ci_low=max(0.0, pf - NORMAL_95 * error),
        ci_high=min(1.0, pf + NORMAL_95 * error),
        ci_kind="second order",
        error_kind="surrogate",
    )
