"""From a cheap surface over standard-normal space to the system's failure probability.

The surface f(u) gives the response of one unit at standard-normal variables u, shared ones first.
Where it is evaluated, `uqfold.system.surface_layout` decides.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from typing import TypeAlias

import numpy as np

from uqfold.problems.criterion import Binomial, Criterion
from uqfold.system.conditional import SystemProbability, system_failures
from uqfold.system.conditional_response import ConditionalResponse
from uqfold.system.cross_rules import SHARED_REACH
from uqfold.system.refinement import TOLERANCE
from uqfold.system.structure import SystemUnits
from uqfold.system.surface_rule import Surface, SurfaceRule
from uqfold.typing import FloatArray, IntArray

Outcomes: TypeAlias = Callable[[FloatArray], IntArray]
"""Takes u (n, d), gives the kinds of outcome (n,): see `uqfold.system.lines`."""


# Error of crossings and tables; and how much worse a rule may be than its last refinement showed,
# where the errors of all directions together exceed so many tolerances of one.
_ROUNDING, _CAUTION, _MET = 1e-4, 2.0, 2.0
# Parts of random lines whose scatter is measured, and Student's quantile for them over that of
# the 20 draws behind the rest of the stated error.
_GROUPS, _FEW_PARTS = 8, 1.13
# Share of what twice as many stations change that the finer ones leave: a sixteenth where the
# surface is smooth, more at kinks.
_HALVED = 0.25
# So many times as likely as at the outermost shared nodes a system may fail beyond them.
_GROWTH_BEYOND = 3.0


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


@dataclass(frozen=True, eq=False)
class SurfaceSystem:
    """Exchangeable units whose responses share one surface.

    Built by `laid_out` from the surface that matters most; other surfaces that differ
    little from it (draws from a posterior) are answered on the same points.

    Attributes
    ----------
    rule, coarse
        Points for answers, and fewer points for changes of answers. Where quadrature does not
        resolve the surface, both hold lines or rays drawn at random.
    units
        The units and their structure.
    together
        Whether all units and missions of a system give one and the same response, since nothing
        is individual, or there is only one unit and one mission.
    """

    rule: SurfaceRule
    coarse: SurfaceRule
    units: SystemUnits
    together: bool

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

    def indices(self, surface: Surface, criteria: Sequence[Criterion]) -> FloatArray:
        """Reliability indices (C,), of which no error is asked."""
        values = surface(self.rule.points)
        return reliability_indices(self._answer(self.rule, self.rule.responses(values), criteria))

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
        beyond = self._errors_beyond(responses, criteria)
        if not responses.parts:
            left = self.rule.error
            error = TOLERANCE if left <= _MET * TOLERANCE else _CAUTION * left
            return np.hypot(error, beyond)
        along = self.errors_along_lines(responses, criteria)
        indices = np.array(
            [
                reliability_indices(self._answer(self.rule, part, criteria))
                for part in responses.parts
            ]
        )
        scatter = _FEW_PARTS * indices.std(axis=0, ddof=1) / math.sqrt(_GROUPS)
        fixed = math.hypot(_ROUNDING, self.rule.error)
        return np.asarray(np.sqrt(fixed**2 + along**2 + scatter**2 + beyond**2))

    def _errors_beyond(self, responses: Responses, criteria: Sequence[Criterion]) -> FloatArray:
        """Error (C,) of the indices from shared variables further out than the outermost nodes.

        Failure there is likelier than at these nodes, but by how much nobody has looked.
        """
        from scipy.stats import chi

        nodes = self.rule.shared_nodes
        radius = np.linalg.norm(nodes, axis=1)
        edge = np.flatnonzero((radius > 0.999 * SHARED_REACH) & (radius < SHARED_REACH + 0.5))
        if self.together or edge.size == 0:
            return np.zeros(len(criteria))
        weights = np.full(edge.size, 1.0 / edge.size)
        there = system_failures([responses.whole[i] for i in edge], weights, self.units, criteria)
        share = _GROWTH_BEYOND * float(chi.sf(SHARED_REACH, nodes.shape[1]))
        found = self.failures_given(responses, criteria)
        more = [
            replace(
                one,
                pf=min(1.0, one.pf + share * outer.pf),
                reliability=min(1.0, one.reliability + share * outer.reliability),
            )
            for one, outer in zip(found, there, strict=True)
        ]
        return np.abs(reliability_indices(found) - reliability_indices(more))

    def errors_along_lines(self, responses: Responses, criteria: Sequence[Criterion]) -> FloatArray:
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
        shift = self.units.shift
        alone = [Criterion(c.threshold - shift, None if c.tau is None else 0.0) for c in criteria]
        found = system_failures(responses, rule.weights, 1, alone)
        return [_if_flown(one, c) for one, c in zip(found, criteria, strict=True)]


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
