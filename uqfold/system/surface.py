"""From a cheap surface over standard-normal space to the system's failure probability.

The surface f(u) gives the response of one unit at standard-normal variables u, shared ones first.
It is integrated without sampling, see `uqfold.system.surface_rule`.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import TypeAlias

import numpy as np

from uqfold.problems.criterion import Binomial, Criterion
from uqfold.system.conditional import SystemProbability, system_failures
from uqfold.system.conditional_response import ConditionalResponse
from uqfold.system.surface_rule import MAX_POINTS, Surface, SurfaceRule, plan_surface
from uqfold.typing import FloatArray, IntArray

Outcomes: TypeAlias = Callable[[FloatArray], IntArray]
"""Takes u (n, d), gives the kinds of outcome (n,): see `uqfold.system.lines`."""


# Coordinates of all points at which a surface is evaluated: bounds memory for many variables.
_MOST_NUMBERS = 20_000_000


@dataclass(frozen=True, eq=False)
class SurfaceSystem:
    """Exchangeable units in series whose responses share one surface.

    Built by `SurfaceSystem.of` from the surface that matters most; other surfaces that differ
    little from it (draws from a posterior) are answered on the same points.

    Attributes
    ----------
    rule, coarse
        Points for answers, and fewer points for changes of answers.
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
        plan = plan_surface(surface, dimension, 0 if together else n_shared, most)
        if not complete:
            plan = plan.for_outcomes()
        max_points = min(max_points, _MOST_NUMBERS // dimension)
        return cls(plan.rule(max_points), plan.coarse_rule(), units, together)

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
    ) -> list[ConditionalResponse]:
        """Conditional responses at the shared nodes, which answer any criteria."""
        points = self.rule.points
        kinds = None if outcomes is None else outcomes(points)
        return self.rule.responses(surface(points), kinds, noise)

    def failures_given(
        self, responses: Sequence[ConditionalResponse], criteria: Sequence[Criterion]
    ) -> list[SystemProbability]:
        """Failure probability under each criterion from `responses`."""
        return self._answer(self.rule, responses, criteria)

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
