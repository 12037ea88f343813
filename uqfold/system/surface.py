"""From a cheap surface over standard-normal space to the system's failure probability.

The surface f(u) gives the response of one unit at standard-normal variables u, shared ones first.
It is integrated without sampling, see `uqfold.system.surface_rule`.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from typing import NamedTuple, TypeAlias

import numpy as np

from uqfold.problems.criterion import Binomial, Criterion
from uqfold.system.conditional import SystemProbability, system_failures
from uqfold.system.conditional_response import ConditionalResponse
from uqfold.system.drawn_rules import DrawnRules
from uqfold.system.refinement import TOLERANCE, Compared
from uqfold.system.sampled_rule import SAMPLED_STATIONS
from uqfold.system.surface_rule import MAX_POINTS, Surface, SurfaceRule, plan_surface
from uqfold.typing import FloatArray, IntArray

Outcomes: TypeAlias = Callable[[FloatArray], IntArray]
"""Takes u (n, d), gives the kinds of outcome (n,): see `uqfold.system.lines`."""


# Coordinates of all points at which a surface is evaluated: bounds memory for many variables.
_MOST_NUMBERS = 20_000_000
_MOST_EXACT = 50
# Error of crossings and tables; and how much worse a rule may be than its last refinement showed,
# where the errors of all directions together exceed so many tolerances of one.
_ROUNDING, _CAUTION, _MET = 1e-4, 2.0, 2.0
# Parts of random lines whose scatter is measured, and Student's quantile for them over that of
# the 20 draws behind the rest of the stated error.
_GROUPS, _FEW_PARTS = 8, 1.13
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
# Share of what twice as many stations change that the finer ones leave: a sixteenth where the
# surface is smooth, more at kinks.
_HALVED = 0.25


@dataclass(frozen=True, eq=False)
class Responses:
    """Conditional responses at the shared nodes.

    Attributes
    ----------
    whole
        From all lines.
    parts
        From parts of lines drawn at random, in order to tell their error; empty for quadrature.
    thinned
        From every second station of such lines, in order to tell the error along them.
    """

    whole: list[ConditionalResponse]
    parts: list[list[ConditionalResponse]]
    thinned: list[ConditionalResponse]


class _Trial(NamedTuple):
    """Lines or rays drawn, the indices (C,) that they give, their errors (C,), and those along."""

    system: SurfaceSystem
    indices: FloatArray
    errors: FloatArray
    along: float


@dataclass(frozen=True, eq=False)
class SurfaceSystem:
    """Exchangeable units in series whose responses share one surface.

    Built by `SurfaceSystem.of` from the surface that matters most; other surfaces that differ
    little from it (draws from a posterior) are answered on the same points.

    Attributes
    ----------
    rule, coarse
        Points for answers, and fewer points for changes of answers. Where quadrature does not
        resolve the surface, both hold lines or rays drawn at random.
    units
        Number of units.
    together
        Whether all units and missions of a system give one and the same response, since nothing
        is individual, or there is only one unit and one mission.
    """

    rule: SurfaceRule
    coarse: SurfaceRule
    units: int
    together: bool

    @classmethod
    def of(
        cls,
        surface: Surface,
        dimension: int,
        n_shared: int,
        units: int,
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
            Number of units n.
        criteria
            The questions that will be asked.
        max_points
            Most points at which the surface is to be evaluated for an answer.
        complete
            Whether responses are finite everywhere; if not, `outcomes` will say where.
        """
        single = units == 1 and all(criterion.missions == 1 for criterion in criteria)
        together = single or n_shared == dimension
        most = units * max((one.max_missions for one in criteria), default=1)
        max_points = min(max_points, _MOST_NUMBERS // dimension)
        asked = _thresholds(criteria)
        # with a shared input or tau, responses matter that lie between the thresholds and the body
        alone = together and all(one.tau is None for one in criteria)
        plan = plan_surface(
            surface, dimension, 0 if together else n_shared, most,
            compared=Compared(asked, alone), max_points=max_points,
        )  # fmt: skip
        if not complete:
            plan = plan.for_outcomes()
        rule = plan.rule(max_points, asked)
        quadrature = cls(rule, plan.coarse_rule(asked), units, together)
        own = dimension - plan.axes.shared.shape[0]
        # where responses are missing no error is stated: a better rule would gain nothing
        if not complete or (own < _MISLEADING and (rule.resolved or own == 1)):
            return quadrature
        drawn = DrawnRules.of(surface, plan, asked)
        # the same without tau is told at a fraction of the cost
        some = [
            Criterion(one.threshold, None, one.missions)
            for one in criteria[:: max(1, len(criteria) // _CRITERIA_TRIED)]
        ]
        if rule.resolved:
            if quadrature._agrees(surface, some, drawn, max_points):
                return quadrature
            return quadrature._sampled(surface, some, drawn, max_points)[0]
        sampled, error = quadrature._sampled(surface, some, drawn, max_points)
        if error <= _WELL_KNOWN:
            return sampled
        # what refinement could not settle over the whole distribution may be settled here
        fewer = replace(quadrature, rule=plan.rule(max_points // _FEWER_POINTS, asked))
        changed = quadrature._apart(fewer, surface, some)
        apart = quadrature._apart(sampled, surface, some)
        if changed < error and apart <= _AT_ODDS * (changed + error):
            return replace(quadrature, rule=replace(rule, error=changed))
        return sampled

    def _apart(
        self, other: SurfaceSystem, surface: Surface, criteria: Sequence[Criterion]
    ) -> float:
        """Largest distance of the reliability indices of two systems."""
        one, two = (
            reliability_indices(
                system._answer(
                    system.rule, system.rule.responses(surface(system.rule.points)), criteria
                )
            )
            for system in (self, other)
        )
        return float(np.abs(one - two).max())

    def _agrees(
        self,
        surface: Surface,
        criteria: Sequence[Criterion],
        drawn: DrawnRules,
        max_points: int,
    ) -> bool:
        """Whether rays give the answers of the quadrature, within their scatter.

        Refinement looks from two places, and may miss what is to be seen from others. A few rays
        are drawn, and more of them as long as they neither confirm nor contradict.
        """
        own = self.responses(surface)
        indices = reliability_indices(self.failures_given(own, criteria))
        allowed = self.integration_errors(own, criteria)
        most = _CHECKED
        while True:
            few = replace(self, rule=drawn.rule(most, rays=True))
            found = few.responses(surface)
            gap = np.abs(reliability_indices(few.failures_given(found, criteria)) - indices)
            beyond = (gap - allowed) / few.integration_errors(found, criteria)
            if beyond.max() <= _CONFIRMED:
                return True
            if beyond.max() > _CONTRADICTED or most >= max_points:
                return False
            most = min(4 * most, max_points)

    def _sampled(
        self,
        surface: Surface,
        criteria: Sequence[Criterion],
        drawn: DrawnRules,
        max_points: int,
    ) -> tuple[SurfaceSystem, float]:
        """Draw lines or rays, whichever a trial finds to err less; and give the largest error.

        Where the answers of the two contradict each other, one of them has missed something that
        its own scatter does not show: the distance counts as an error. So does what half as many
        shared nodes change.
        """

        def tried(most: int, stations: int, *, rays: bool) -> _Trial:
            system = replace(self, rule=drawn.rule(most, rays=rays, stations=stations))
            responses = system.responses(surface)
            return _Trial(
                system,
                reliability_indices(system.failures_given(responses, criteria)),
                system.integration_errors(responses, criteria),
                float(system._along_lines(responses, criteria).max()),
            )

        def trial(*, rays: bool) -> _Trial:
            for stations in SAMPLED_STATIONS:
                found = tried(most, stations, rays=rays)
                if found.along <= _ENOUGH:
                    break
            return found

        most, enough = max_points // _TRIED, max_points // _FEWER
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
        nodes, weights = drawn.fewer
        if weights.size < drawn.weights.size:
            fewer = replace(found, rule=replace(found.rule, shared_nodes=nodes, weights=weights))
            error = math.hypot(error, found._apart(fewer, surface, criteria))
        rule, coarse = replace(found.rule, error=error), found.rule.parts(step)[0][0]
        largest = math.hypot(error, float(best.errors.max()))
        return replace(found, rule=rule, coarse=coarse), largest

    def failures(
        self,
        surface: Surface,
        criteria: Sequence[Criterion],
        outcomes: Outcomes | None = None,
        noise: float = 0.0,
    ) -> list[SystemProbability]:
        """Failure probability under each criterion.

        Parameters
        ----------
        surface
            The surface.
        criteria
            The questions.
        outcomes
            Where responses are infinite or runs fail; None: nowhere.
        noise
            Standard deviation of an independent normal disturbance of every response.

        Raises
        ------
        ValueError
            If the surface gives a value that is not finite.
        """
        return self.failures_given(self.responses(surface, outcomes, noise), criteria)

    def responses(
        self, surface: Surface, outcomes: Outcomes | None = None, noise: float = 0.0
    ) -> Responses:
        """Conditional responses at the shared nodes, which answer any criteria."""
        points = self.rule.points
        kinds = None if outcomes is None else outcomes(points)
        values = surface(points)
        whole = self.rule.responses(values, kinds, noise)
        if not self.rule.lines.sampled:
            return Responses(whole, [], [])
        *parts, thinned = (
            part.responses(values[some], None if kinds is None else kinds[some], noise)
            for part, some in [*self.rule.parts(_GROUPS), self.rule.thinned()]
        )
        return Responses(whole, parts, thinned)

    def failures_given(
        self, responses: Responses, criteria: Sequence[Criterion]
    ) -> list[SystemProbability]:
        """Failure probability under each criterion from `responses`."""
        return self._answer(self.rule, responses.whole, criteria)

    def integration_errors(self, responses: Responses, criteria: Sequence[Criterion]) -> FloatArray:
        """Error (C,) of the reliability indices that the integration alone leaves.

        Of quadrature: the tolerance of its refinement, or what this has still changed if that is
        more; what else is asked makes no difference to a rule that meets the tolerance. Of lines
        drawn at random: the standard error, from the scatter of the answers of eight parts, what
        twice as many stations along them change, and what lines and rays contradict each other by.
        """
        if not responses.parts:
            left = self.rule.error
            error = TOLERANCE if left <= _MET * TOLERANCE else _CAUTION * left
            return np.full(len(criteria), error)
        along = self._along_lines(responses, criteria)
        indices = np.array(
            [
                reliability_indices(self._answer(self.rule, part, criteria))
                for part in responses.parts
            ]
        )
        scatter = _FEW_PARTS * indices.std(axis=0, ddof=1) / math.sqrt(_GROUPS)
        fixed = math.hypot(_ROUNDING, self.rule.error)
        return np.asarray(np.sqrt(fixed**2 + along**2 + scatter**2))

    def _along_lines(self, responses: Responses, criteria: Sequence[Criterion]) -> FloatArray:
        """Error (C,) of the reliability indices from stations too far apart on random lines."""
        found, coarser = (
            reliability_indices(self._answer(self.rule, some, criteria))
            for some in (responses.whole, responses.thinned)
        )
        return np.asarray(_HALVED * np.abs(found - coarser))

    def changes(
        self,
        surface: Surface,
        paths: Surface,
        criteria: Sequence[Criterion],
        outcomes: Outcomes | None = None,
        noise: float = 0.0,
    ) -> FloatArray:
        """How far each of R other surfaces moves the reliability index -Phi^-1(pf).

        Parameters
        ----------
        surface
            The surface from which changes count.
        paths
            The R others: takes u (n, d), gives (R, n).
        criteria, outcomes, noise
            As in `failures`.

        Returns
        -------
        FloatArray
            Changes (R, len(criteria)); 0 where pf is 0 or 1 with all surfaces.
        """
        return self.changes_given(self.coarse_responses(surface, paths, outcomes, noise), criteria)

    def coarse_responses(
        self,
        surface: Surface,
        paths: Surface,
        outcomes: Outcomes | None = None,
        noise: float = 0.0,
    ) -> list[list[ConditionalResponse]]:
        """Conditional responses of 1 + R surfaces, which tell the changes of any answers."""
        points = self.coarse.points
        kinds = None if outcomes is None else outcomes(points)
        return [
            self.coarse.responses(values, kinds, noise)
            for values in [surface(points), *paths(points)]
        ]

    def changes_given(
        self, responses: Sequence[Sequence[ConditionalResponse]], criteria: Sequence[Criterion]
    ) -> FloatArray:
        """Changes (R, C) of the indices from `coarse_responses`."""
        indices = np.array(
            [reliability_indices(self._answer(self.coarse, one, criteria)) for one in responses]
        )
        return np.asarray(indices[1:] - indices[0])

    def _answer(
        self,
        rule: SurfaceRule,
        responses: Sequence[ConditionalResponse],
        criteria: Sequence[Criterion],
    ) -> list[SystemProbability]:
        if not self.together:
            return system_failures(responses, rule.weights, self.units, criteria)
        # tau = 0 still refuses infinite responses, which have no difference
        alone = [Criterion(c.threshold, None if c.tau is None else 0.0) for c in criteria]
        found = system_failures(responses, rule.weights, 1, alone)
        return [_if_flown(one, c) for one, c in zip(found, criteria, strict=True)]


def surface_failures(
    surface: Surface,
    dimension: int,
    n_shared: int,
    units: int,
    criteria: Sequence[Criterion],
    max_points: int = MAX_POINTS,
) -> list[SystemProbability]:
    """Failure probability of units whose response is a surface; see `SurfaceSystem`."""
    system = SurfaceSystem.of(surface, dimension, n_shared, units, criteria, max_points)
    return system.failures(surface, criteria)


def reliability_index(found: SystemProbability) -> float:
    """-Phi^-1(pf) from the smaller of the two probabilities, kept within +-38."""
    return float(reliability_indices([found])[0])


def reliability_indices(found: Sequence[SystemProbability]) -> FloatArray:
    """Reliability index (C,) of each; see `reliability_index`."""
    from scipy.special import ndtri

    pf = np.array([one.pf for one in found])
    reliability = np.array([one.reliability for one in found])
    beta = np.where(pf <= reliability, -ndtri(pf), ndtri(reliability))
    return np.asarray(np.clip(beta, -38.0, 38.0))


def _thresholds(criteria: Sequence[Criterion]) -> FloatArray:
    """Thresholds T that tables are to hold exactly: all, or some spread among many."""
    asked = np.unique([one.threshold for one in criteria])
    if asked.size > _MOST_EXACT:
        asked = asked[np.linspace(0, asked.size - 1, _MOST_EXACT).round().astype(int)]
    return np.asarray(asked)


def _if_flown(found: SystemProbability, criterion: Criterion) -> SystemProbability:
    """All units and missions fail together, if a mission is flown at all."""
    if not isinstance(criterion.missions, Binomial):
        return found
    missions = criterion.missions
    with np.errstate(divide="ignore"):
        log_never = missions.planned * float(np.log1p(-missions.p))
    flown = -math.expm1(log_never)
    return SystemProbability(
        found.pf * flown,
        found.reliability + found.pf * math.exp(log_never),
        found.pf_low * flown,
        found.pf_high * flown,
    )
