"""Where a surface is evaluated: by quadrature, or along lines or rays drawn at random.

Quadrature comes first. Where refinement does not resolve the surface, or a few rays contradict it,
lines and rays are tried, and what errs less by its own measure is taken.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from uqfold.problems.criterion import Criterion
from uqfold.system.conditional import SystemProbability
from uqfold.system.drawn_rules import DrawnRules
from uqfold.system.refinement import Compared
from uqfold.system.sampled_rule import SAMPLED_STATIONS
from uqfold.system.structure import SystemUnits
from uqfold.system.surface import SurfaceSystem, reliability_indices
from uqfold.system.surface_rule import MAX_POINTS, Surface, SurfacePlan, plan_surface
from uqfold.typing import FloatArray

# Coordinates of all points at which a surface is evaluated: bounds memory for many variables.
_MOST_NUMBERS = 20_000_000
_MOST_EXACT = 50
# Individual variables from which refinement along single directions may mislead.
_MISLEADING = 3
# Points of a first check by rays; errors of the check within which quadrature is confirmed, and
# beyond which it is contradicted.
_CHECKED, _CONFIRMED, _CONTRADICTED = 10_000, 2.5, 6.0
# Shares of the points: in the trial of lines and rays, and in the end; criteria in the trial.
_TRIED, _FEWER, _CRITERIA_TRIED = 16, 4, 8
_MOST_COARSE = 20_000
# Error of a reliability index at which no more lines are drawn, nor more stations along them.
_ENOUGH = 1e-3
# Share of the points of quadrature that is compared with all of them.
_FEWER_POINTS = 4
# Error of lines drawn at random up to which quadrature is not looked at again.
_WELL_KNOWN = 3e-3
# Joint errors from which lines and rays contradict each other.
_AT_ODDS = 4.0


def laid_out(
    surface: Surface,
    dimension: int,
    n_shared: int,
    units: SystemUnits | int,
    criteria: Sequence[Criterion],
    max_points: int = MAX_POINTS,
    *,
    complete: bool = True,
) -> SurfaceSystem:
    """Lay out the points for a surface.

    Parameters
    ----------
    surface
        Response of one unit over standard-normal space.
    dimension, n_shared
        Number of variables, and how many of them (the first ones) are shared.
    units
        The units and their structure, or the number n of units in series.
    criteria
        The questions that will be asked.
    max_points
        Most points at which the surface is to be evaluated for an answer.
    complete
        Whether responses are finite everywhere; if not, `outcomes` will say where.
    """
    units = SystemUnits.of(units)
    single = units.count == 1 and all(criterion.missions == 1 for criterion in criteria)
    together = single or n_shared == dimension
    most = units.count * max((one.max_missions for one in criteria), default=1)
    max_points = min(max_points, _MOST_NUMBERS // dimension)
    asked = _thresholds(units, criteria)
    # with a shared input or tau, responses matter that lie between the thresholds and the body
    alone = together and all(one.tau is None for one in criteria)
    plan = plan_surface(
        surface, dimension, 0 if together else n_shared, most,
        compared=Compared(asked, alone), max_points=max_points,
    )  # fmt: skip
    if not complete:
        plan = plan.for_outcomes()
    rule = plan.rule(max_points, asked)
    quadrature = SurfaceSystem(rule, plan.coarse_rule(asked), units, together)
    own = dimension - plan.axes.shared.shape[0]
    # where responses are missing no error is stated: a better rule would gain nothing
    if not complete or (own < _MISLEADING and (rule.resolved or own == 1)):
        return quadrature
    # the same without tau is told at a fraction of the cost
    some = [
        Criterion(one.threshold, None, one.missions)
        for one in criteria[:: max(1, len(criteria) // _CRITERIA_TRIED)]
    ]
    return _Choice(surface, some, plan, asked, max_points).between(quadrature)


def surface_failures(
    surface: Surface,
    dimension: int,
    n_shared: int,
    units: SystemUnits | int,
    criteria: Sequence[Criterion],
    max_points: int = MAX_POINTS,
) -> list[SystemProbability]:
    """Failure probability of units whose response is a surface; see `laid_out`."""
    system = laid_out(surface, dimension, n_shared, units, criteria, max_points)
    return system.failures(surface, criteria)


def _thresholds(units: SystemUnits, criteria: Sequence[Criterion]) -> FloatArray:
    """Thresholds of units that tables are to hold exactly: all, or some spread among many."""
    asked = np.unique(units.thresholds([one.threshold for one in criteria]))
    if asked.size > _MOST_EXACT:
        asked = asked[np.linspace(0, asked.size - 1, _MOST_EXACT).round().astype(int)]
    return np.asarray(asked)


@dataclass(frozen=True, eq=False)
class _Trial:
    """A system on lines or rays, its reliability indices (C,), their errors (C,), those along."""

    system: SurfaceSystem
    indices: FloatArray
    errors: FloatArray
    along: float

    @classmethod
    def of(cls, system: SurfaceSystem, surface: Surface, criteria: Sequence[Criterion]) -> _Trial:
        responses = system.responses(surface)
        return cls(
            system,
            reliability_indices(system.failures_given(responses, criteria)),
            system.integration_errors(responses, criteria),
            float(system.errors_along_lines(responses, criteria).max(initial=0.0)),
        )


class _Choice:
    """What a choice of rules looks at: a surface, some criteria, a plan of quadrature, a size."""

    def __init__(
        self,
        surface: Surface,
        criteria: Sequence[Criterion],
        plan: SurfacePlan,
        asked: FloatArray,
        max_points: int,
    ) -> None:
        self.surface = surface
        self.criteria = criteria
        self.plan = plan
        self.asked = asked
        self.max_points = max_points
        self.drawn = DrawnRules.of(surface, plan, asked)

    def between(self, quadrature: SurfaceSystem) -> SurfaceSystem:
        """Choose between quadrature and lines or rays drawn at random."""
        if quadrature.rule.resolved:
            return quadrature if self._confirmed(quadrature) else self._sampled(quadrature)[0]
        sampled, error = self._sampled(quadrature)
        fewer = self.plan.rule(self.max_points // _FEWER_POINTS, self.asked)
        if error <= _WELL_KNOWN or len(fewer.points) >= len(quadrature.rule.points):
            return sampled
        # what refinement could not settle over the whole distribution may be settled here
        changed = self._apart(quadrature, replace(quadrature, rule=fewer))
        if changed < error and self._apart(quadrature, sampled) <= _AT_ODDS * (changed + error):
            return replace(quadrature, rule=replace(quadrature.rule, error=changed))
        return sampled

    def _apart(self, one: SurfaceSystem, other: SurfaceSystem) -> float:
        """Largest distance of the reliability indices of two systems."""
        first, second = (system.indices(self.surface, self.criteria) for system in (one, other))
        return float(np.abs(first - second).max())

    def _confirmed(self, quadrature: SurfaceSystem) -> bool:
        """Whether rays give the answers of the quadrature, within their scatter.

        Refinement looks from two places, and may miss what is to be seen from others. A few rays
        are drawn, and more of them as long as they neither confirm nor contradict.
        """
        responses = quadrature.responses(self.surface)
        found = quadrature.failures_given(responses, self.criteria)
        indices = reliability_indices(found)
        allowed = quadrature.integration_errors(responses, self.criteria)
        most = _CHECKED
        while True:
            rays = replace(quadrature, rule=self.drawn.rule(most, rays=True))
            few = _Trial.of(rays, self.surface, self.criteria)
            beyond = (np.abs(few.indices - indices) - allowed) / few.errors
            if beyond.max() <= _CONFIRMED:
                return True
            if beyond.max() > _CONTRADICTED or most >= self.max_points:
                return False
            most = min(4 * most, self.max_points)

    def _sampled(self, quadrature: SurfaceSystem) -> tuple[SurfaceSystem, float]:
        """Draw lines or rays, whichever a trial finds to err less; and give the largest error.

        Where the answers of the two contradict each other, one of them has missed something that
        its own scatter does not show: the distance counts as an error. So does what half as many
        shared nodes change.
        """

        def tried(most: int, stations: int, *, rays: bool) -> _Trial:
            rule = self.drawn.rule(most, rays=rays, stations=stations)
            return _Trial.of(replace(quadrature, rule=rule), self.surface, self.criteria)

        def trial(*, rays: bool) -> _Trial:
            for stations in SAMPLED_STATIONS:
                found = tried(most, stations, rays=rays)
                if found.along <= _ENOUGH:
                    break
            return found

        most, enough = self.max_points // _TRIED, self.max_points // _FEWER
        lines, rays = trial(rays=False), trial(rays=True)
        gap = np.abs(lines.indices - rays.indices)
        contradicted = gap > _AT_ODDS * np.hypot(lines.errors, rays.errors)
        error = float(gap[contradicted].max(initial=0.0))
        by_rays = bool(rays.errors.max() < lines.errors.max())
        best = rays if by_rays else lines
        stations = best.system.rule.lines.stations.size
        while best.errors.max() > _ENOUGH and most < enough:
            most = min(4 * most, enough)
            best = tried(most, stations, rays=by_rays)
        found = best.system
        step = max(1, found.rule.points.shape[0] // _MOST_COARSE)
        nodes, weights = self.drawn.fewer
        if weights.size < self.drawn.weights.size:
            fewer = replace(found, rule=replace(found.rule, shared_nodes=nodes, weights=weights))
            error = math.hypot(error, self._apart(found, fewer))
        rule, coarse = replace(found.rule, error=error), found.rule.parts(step)[0][0]
        largest = math.hypot(error, float(best.errors.max()))
        return replace(found, rule=rule, coarse=coarse), largest
