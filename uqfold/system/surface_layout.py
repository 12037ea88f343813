"""Where surfaces are evaluated: by quadrature, or along lines or rays drawn at random.

Quadrature comes first. Where refinement does not resolve the surfaces, or a few rays contradict it,
lines and rays are tried, and what errs less by its own measure is taken.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import numpy as np

from uqfold.problems.criterion import Criterion
from uqfold.system.drawn_rules import DrawnRules
from uqfold.system.refinement import Compared
from uqfold.system.sampled_rule import SAMPLED_STATIONS
from uqfold.system.shared_lines_layout import laid_out_on_shared_lines
from uqfold.system.shared_nodes import with_shared_nodes
from uqfold.system.structure import SystemUnits
from uqfold.system.surface import Surfaces, SurfaceSystem, reliability_indices
from uqfold.system.surface_plan import SurfacePlan, plans_of_kinds, rules_of_kinds
from uqfold.system.surface_rule import MAX_POINTS, Surface, SurfaceRule
from uqfold.typing import FloatArray

# Coordinates of all points at which a surface is evaluated: bounds memory for many variables.
_MOST_NUMBERS = 20_000_000
_MOST_EXACT = 50
# How many times fewer points do where answers are doubted whatever the rule.
_DOUBTED = 8
# Individual variables from which refinement along single directions may mislead.
_MISLEADING = 3
# Lines, and stations along each, with which two variables are looked at all over; how much of the
# change from one to the other is left, and how much worse quadrature may be than it states.
_GRIDS, _HALVED, _CAUTION = (65, 129), 0.25, 2.0
# Points of a first check by rays; errors of the check within which quadrature is confirmed, and
# beyond which it is contradicted; the largest error of rays that can confirm anything.
_CHECKED, _CONFIRMED, _CONTRADICTED, _TELLING = 10_000, 2.5, 6.0, 0.02
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
_AT_ODDS = 2.5


def laid_out(
    surfaces: Surfaces,
    dimensions: int | Sequence[int],
    n_shared: int,
    units: SystemUnits | int,
    criteria: Sequence[Criterion],
    max_points: int = MAX_POINTS,
    *,
    complete: bool = True,
    trusted: bool = True,
) -> SurfaceSystem:
    """Lay out the points for the surface of all units, or for the surfaces of several kinds.

    Parameters
    ----------
    surfaces
        Response of one unit over standard-normal space, or of one unit of each kind.
    dimensions
        Number of variables (of each kind).
    n_shared
        How many of them (the first ones) are shared.
    units
        The units and their structure, or the number n of units in series.
    criteria
        The questions that will be asked.
    max_points
        Most points at which the surface is to be evaluated for an answer.
    complete
        Whether responses are finite everywhere; if not, `outcomes` will say where.
    trusted
        Whether an error will be stated of the answers; if not, some quadrature is good enough.
    """
    units = SystemUnits.of(units)
    each = [surfaces] if callable(surfaces) else list(surfaces)
    sizes = [dimensions] if isinstance(dimensions, int) else list(dimensions)
    single = units.count == 1 and all(criterion.missions == 1 for criterion in criteria)
    together = single or n_shared == max(sizes)
    most = units.count * max((one.max_missions for one in criteria), default=1)
    max_points = min(max_points if trusted else max_points // _DOUBTED, _MOST_NUMBERS // max(sizes))
    asked = [_thresholds(units, criteria, kind) for kind in range(len(each))]
    if len(each) > 1 and n_shared == min(sizes):
        return laid_out_on_shared_lines(each, sizes, n_shared, units, criteria, asked, max_points)
    # with a shared input or tau, responses matter that lie between the thresholds and the body
    alone = together and all(one.tau is None for one in criteria)
    plans = plans_of_kinds(
        each, sizes, 0 if together else n_shared, most,
        [Compared(one, alone) for one in asked], max_points,
    )  # fmt: skip
    if not complete:
        plans = [plan.for_outcomes() for plan in plans]
    # the same without tau is told at a fraction of the cost
    some = _some(criteria)
    if complete and not together and n_shared > 0:
        plans = with_shared_nodes(plans, each, units, some, asked)
    rules = rules_of_kinds(plans, max_points, asked)
    coarse = tuple(plan.coarse_rule(own) for plan, own in zip(plans, asked, strict=True))
    quadrature = SurfaceSystem(rules, coarse, units, together)
    own = max(plan.n_individual for plan in plans)
    # where responses are missing no error is stated: a better rule would gain nothing
    least = 2 if _few(plans) else _MISLEADING
    if not (complete and trusted) or own == 1 or (own < least and quadrature.resolved):
        return quadrature
    # the same without tau is told at a fraction of the cost
    some = [
        Criterion(one.threshold, None, one.missions)
        for one in criteria[:: max(1, len(criteria) // _CRITERIA_TRIED)]
    ]
    drawn = [DrawnRules.of(*one, short=alone) for one in zip(each, plans, asked, strict=True)]
    return _Choice(each, some, plans, asked, max_points, drawn).between(quadrature)


SEARCHED = 16
"""How many criteria are resolved is looked for to one part in so many of them."""


def laid_out_apart(
    lay: Callable[[Sequence[int]], SurfaceSystem],
    indices: Callable[[SurfaceSystem], FloatArray],
    count: int,
) -> list[tuple[list[int], SurfaceSystem]]:
    """Lay out criteria together, or those apart that no rule resolves.

    What one criterion far out asks for would be too much for the points of all. The further out,
    the harder: the nearest ones, as many as a rule resolves, have one of their own.

    Parameters
    ----------
    lay
        Lays out some of the criteria, by their numbers.
    indices
        Reliability indices (count,) of all of them.
    count
        How many they are.

    Returns
    -------
    list[tuple[list[int], SurfaceSystem]]
        Numbers of criteria, and where the surfaces are evaluated for them.
    """
    whole = lay(range(count))
    if whole.resolved or count == 1:
        return [(list(range(count)), whole)]
    order = np.argsort(np.abs(indices(whole)), kind="stable").tolist()
    resolved, unresolved, best = 1, count, lay(order[:1])
    if not best.resolved:
        return [(list(range(count)), whole)]
    while unresolved - resolved > max(1, count // SEARCHED):
        middle = (resolved + unresolved) // 2
        tried = lay(order[:middle])
        if tried.resolved:
            resolved, best = middle, tried
        else:
            unresolved = middle
    return [(sorted(order[:resolved]), best), (sorted(order[resolved:]), whole)]


def _some(criteria: Sequence[Criterion]) -> list[Criterion]:
    """Some of the criteria, without tau, from the smallest to the largest threshold."""
    ordered = sorted(criteria, key=lambda one: (one.threshold, one.max_missions))
    picked = np.linspace(0, len(ordered) - 1, min(len(ordered), _CRITERIA_TRIED)).round()
    return [Criterion(ordered[int(i)].threshold, None, ordered[int(i)].missions) for i in picked]


def _thresholds(units: SystemUnits, criteria: Sequence[Criterion], kind: int) -> FloatArray:
    """Thresholds of one kind that tables are to hold exactly: all, or some spread among many."""
    asked = np.unique(units.thresholds([one.threshold for one in criteria], kind))
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
    def of(cls, system: SurfaceSystem, surfaces: Surfaces, criteria: Sequence[Criterion]) -> _Trial:
        responses = system.responses(surfaces)
        return cls(
            system,
            reliability_indices(system.failures_given(responses, criteria)),
            system.integration_errors(responses, criteria),
            float(system.errors_along_lines(responses, criteria).max(initial=0.0)),
        )


class _Choice:
    """What a choice of rules looks at: surfaces, some criteria, plans of quadrature, a size."""

    def __init__(
        self,
        surfaces: Sequence[Surface],
        criteria: Sequence[Criterion],
        plans: Sequence[SurfacePlan],
        asked: Sequence[FloatArray],
        max_points: int,
        drawn: Sequence[DrawnRules],
    ) -> None:
        self.surfaces = surfaces
        self.criteria = criteria
        self.plans = plans
        self.asked = asked
        self.max_points = max_points
        self.drawn = drawn

    def between(self, quadrature: SurfaceSystem) -> SurfaceSystem:
        """Choose between quadrature and lines or rays drawn at random."""
        plans = self.plans
        if quadrature.resolved:
            if self._confirmed(quadrature):
                return quadrature
            # refinement was misled: as many points everywhere as there are
            plans = [plan.finest() for plan in plans]
            rules = rules_of_kinds(plans, self.max_points, self.asked)
            quadrature = replace(quadrature, rules=rules)
        sampled, error = self._sampled(quadrature)
        fewer = rules_of_kinds(plans, self.max_points // _FEWER_POINTS, self.asked)
        if error <= _WELL_KNOWN or _size(fewer) >= _size(quadrature.rules):
            return sampled
        # what refinement could not settle over the whole distribution may be settled here
        indices = self._indices(quadrature)
        changed = _apart(indices, self._indices(replace(quadrature, rules=fewer)))
        contradicted = _apart(indices, self._indices(sampled)) > _AT_ODDS * (changed + error)
        if changed < error and not contradicted:
            rules = tuple(replace(one, confirmed=True) for one in quadrature.rules)
            return _with_error(replace(quadrature, rules=rules), changed)
        return sampled

    def _indices(self, system: SurfaceSystem) -> FloatArray:
        """Reliability indices (C,) of a system."""
        return system.indices(self.surfaces, self.criteria)

    def _confirmed(self, quadrature: SurfaceSystem) -> bool:
        """Whether rays give the answers of the quadrature, within their scatter.

        Refinement looks from two places, and may miss what is to be seen from others. Two variables
        are looked at all over. A few rays are drawn, and more of them as long as they neither
        confirm nor contradict. Those of which some alone have met failures, as in a small ball,
        scatter too much to confirm anything.
        """
        responses = quadrature.responses(self.surfaces)
        found = quadrature.failures_given(responses, self.criteria)
        indices = reliability_indices(found)
        allowed = quadrature.integration_errors(responses, self.criteria)
        if _few(self.plans):
            coarse, fine = (self._indices(self._grid(quadrature, size)) for size in _GRIDS)
            left = _CAUTION * allowed + _HALVED * np.abs(fine - coarse)
            if (np.abs(fine - indices) > left).any():
                return False
        alone = self.plans[0].n_shared == 0 and len(self.criteria) == 1 and not _few(self.plans)
        most, telling = _CHECKED, _TELLING if alone else math.inf
        while True:
            rays = self._drawn(quadrature, most, rays=True)
            few = _Trial.of(rays, self.surfaces, self.criteria)
            beyond = (np.abs(few.indices - indices) - allowed) / few.errors
            if beyond.max() <= _CONFIRMED and few.errors.max() <= telling:
                return True
            if beyond.max() > _CONTRADICTED or most >= self.max_points:
                return False
            most = min(4 * most, self.max_points)

    def _grid(self, quadrature: SurfaceSystem, size: int) -> SurfaceSystem:
        """Lay out so many lines with so many stations each, for two variables."""
        pairs = zip(self.plans, self.asked, strict=True)
        return replace(quadrature, rules=tuple(plan.grid(size, own) for plan, own in pairs))

    def _sampled(self, quadrature: SurfaceSystem) -> tuple[SurfaceSystem, float]:
        """Draw lines or rays, whichever a trial finds to err less; and give the largest error.

        Where the answers of the two contradict each other, the one that sees less of the rarer
        outcome has missed something that its own scatter does not show: if that one is drawn, the
        distance counts as an error. So does what half as many shared nodes change.
        """

        def tried(most: int, stations: int, *, rays: bool) -> _Trial:
            system = self._drawn(quadrature, most, rays=rays, stations=stations)
            return _Trial.of(system, self.surfaces, self.criteria)

        def trial(*, rays: bool) -> _Trial:
            for stations in SAMPLED_STATIONS:
                found = tried(most, stations, rays=rays)
                if found.along <= _ENOUGH:
                    break
            return found

        most, enough = self.max_points // _TRIED, self.max_points // _FEWER
        lines, rays = trial(rays=False), trial(rays=True)
        by_rays = bool(rays.errors.max() < lines.errors.max())
        best, other = (rays, lines) if by_rays else (lines, rays)
        gap = np.abs(best.indices) - np.abs(other.indices)
        contradicted = gap > _AT_ODDS * np.hypot(lines.errors, rays.errors)
        error = float(gap[contradicted].max(initial=0.0))
        stations = max(rule.lines.stations.size for rule in best.system.rules if rule.lines.sampled)
        while best.errors.max() > _ENOUGH and most < enough:
            most = min(4 * most, enough)
            best = tried(most, stations, rays=by_rays)
        found = best.system
        step = max(1, _size(found.rules) // _MOST_COARSE)
        nodes, weights = self.drawn[0].fewer
        if weights.size < self.drawn[0].weights.size:
            fewer = tuple(
                replace(rule, shared_nodes=nodes, weights=weights) for rule in found.rules
            )
            apart = _apart(self._indices(found), self._indices(replace(found, rules=fewer)))
            error = math.hypot(error, apart)
        largest = math.hypot(error, float(best.errors.max()))
        coarse = tuple(
            _shortened(rule.parts(step)[0][0]) if rule.lines.sampled else rule
            for rule in found.rules
        )
        return replace(_with_error(found, error), coarse=coarse), largest

    def _drawn(
        self,
        quadrature: SurfaceSystem,
        most: int,
        *,
        rays: bool,
        stations: int = SAMPLED_STATIONS[0],
    ) -> SurfaceSystem:
        """Draw lines or rays for all kinds, of at most so many points."""
        share = most // len(self.drawn)
        rules = [one.rule(share, rays=rays, stations=stations) for one in self.drawn]
        return replace(quadrature, rules=tuple(rules))


def _few(plans: Sequence[SurfacePlan]) -> bool:
    """Whether there are two variables, and none of them is shared."""
    return all(plan.n_shared == 0 and plan.n_individual == 2 for plan in plans)


def _size(rules: Sequence[SurfaceRule]) -> int:
    return sum(rule.points.shape[0] for rule in rules)


def _with_error(system: SurfaceSystem, error: float) -> SurfaceSystem:
    return replace(system, rules=tuple(replace(rule, error=error) for rule in system.rules))


def _apart(one: FloatArray, other: FloatArray) -> float:
    """Largest distance of reliability indices (C,)."""
    return float(np.abs(one - other).max())


def _shortened(rule: SurfaceRule) -> SurfaceRule:
    """Return a rule with short tables, which tell changes as well."""
    return replace(rule, lines=replace(rule.lines, short=True))
