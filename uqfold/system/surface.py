"""From a cheap surface over standard-normal space to the system's failure probability.

The surface f(u) gives the response of one unit at standard-normal variables u, shared ones first.
Units of several kinds have a surface each, over the same shared variables. Where surfaces are
evaluated, `uqfold.system.surface_layout` decides.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace
from typing import TypeAlias

import numpy as np

from uqfold.problems.criterion import Binomial, Criterion
from uqfold.system.conditional import (
    SystemProbability,
    system_failures,
    system_failures_of_kinds,
)
from uqfold.system.conditional_response import ConditionalResponse
from uqfold.system.cross_rules import SHARED_REACH
from uqfold.system.refinement import TOLERANCE
from uqfold.system.shared_lines import OnLines
from uqfold.system.structure import SystemUnits
from uqfold.system.surface_rule import AtNodes, Surface, SurfaceRule
from uqfold.typing import FloatArray, IntArray

Outcomes: TypeAlias = Callable[[FloatArray], IntArray]
"""Takes u (n, d), gives the kinds of outcome (n,): see `uqfold.system.lines`."""
Surfaces: TypeAlias = Surface | Sequence[Surface]
"""The surface of units that are all of one kind, or one for each kind."""
OfKinds: TypeAlias = Sequence[AtNodes]
"""What the units of each kind do at the shared nodes."""


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
    """Conditional responses at the shared nodes, of each kind of units.

    Attributes
    ----------
    whole
        From all lines.
    parts
        From parts of lines drawn at random, in order to tell their error; empty for quadrature.
    thinned
        From every second station of all lines, in order to tell the error along them.
    """

    whole: OfKinds
    parts: list[OfKinds]
    thinned: OfKinds


@dataclass(frozen=True, eq=False)
class SurfaceSystem:
    """Units whose responses are surfaces, one for each kind of them.

    Built by `laid_out` from the surfaces that matter most; other surfaces that differ
    little from them (draws from a posterior) are answered on the same points.

    Attributes
    ----------
    rules, coarse
        Points of each kind for answers, and fewer points for changes of answers; their shared
        nodes are the same. Where quadrature does not resolve the surfaces, both hold lines or rays
        drawn at random.
    units
        The units and their structure.
    together
        Whether the shared inputs, or a single unit in one mission, tell the response of the whole
        system of units of one kind.
    """

    rules: tuple[SurfaceRule, ...]
    coarse: tuple[SurfaceRule, ...]
    units: SystemUnits
    together: bool

    @property
    def weights(self) -> FloatArray:
        """Weights (K,) of the shared nodes."""
        return self.rules[0].weights

    @property
    def resolved(self) -> bool:
        """Whether the number of points sufficed for an acceptable accuracy."""
        return all(rule.resolved for rule in self.rules)

    def failures(
        self,
        surfaces: Surfaces,
        criteria: Sequence[Criterion],
        outcomes: Outcomes | Sequence[Outcomes] | None = None,
        noise: float | Sequence[float] = 0.0,
    ) -> list[SystemProbability]:
        """Failure probability under each criterion.

        Parameters
        ----------
        surfaces
            The surface, or one for each kind of units.
        criteria
            The questions.
        outcomes
            Where responses are infinite or runs fail (of each kind); None: nowhere.
        noise
            Standard deviation of an independent normal disturbance of every response (of each
            kind).

        Raises
        ------
        ValueError
            If a surface gives a value that is not finite.
        """
        return self.failures_given(self.responses(surfaces, outcomes, noise), criteria)

    def responses(
        self,
        surfaces: Surfaces,
        outcomes: Outcomes | Sequence[Outcomes] | None = None,
        noise: float | Sequence[float] = 0.0,
    ) -> Responses:
        """Conditional responses at the shared nodes, which answer any criteria."""
        whole, divided = [], []
        for rule, surface, of_kind, std in self._each(self.rules, surfaces, outcomes, noise):
            points = rule.points
            kinds = None if of_kind is None else of_kind(points)
            values = surface(points)
            whole.append(rule.responses(values, kinds, std))
            pieces = [rule.thinned(), *(rule.parts(_GROUPS) if rule.lines.sampled else [])]
            found = [
                part.responses(values[some], None if kinds is None else kinds[some], std)
                for part, some in pieces
            ]
            # those of a quadrature are not divided
            divided.append([*found, *[whole[-1]] * (_GROUPS + 1 - len(found))])
        thinned, *parts = zip(*divided, strict=True)
        drawn = any(rule.lines.sampled for rule in self.rules)
        return Responses(whole, list(parts) if drawn else [], thinned)

    def indices(self, surfaces: Surfaces, criteria: Sequence[Criterion]) -> FloatArray:
        """Reliability indices (C,), of which no error is asked."""
        found = [
            rule.responses(surface(rule.points))
            for rule, surface, _, _ in self._each(self.rules, surfaces, None, 0.0)
        ]
        return reliability_indices(self._answer(self.rules[0], found, criteria))

    def failures_given(
        self, responses: Responses, criteria: Sequence[Criterion]
    ) -> list[SystemProbability]:
        """Failure probability under each criterion from `responses`."""
        return self._answer(self.rules[0], responses.whole, criteria)

    def integration_errors(self, responses: Responses, criteria: Sequence[Criterion]) -> FloatArray:
        """Error (C,) of the reliability indices that the integration alone leaves.

        Of quadrature: the tolerance of its refinement, or what this has still changed if that is
        more, or what twice as many stations along all its lines change if that is more still;
        refinement looks at few lines. Of lines
        drawn at random: the standard error, from the scatter of the answers of eight parts, what
        twice as many stations along them change, and what lines and rays contradict each other by.
        """
        beyond = self._errors_beyond(responses, criteria)
        along = self.errors_along_lines(responses, criteria)
        if not responses.parts:
            left = max(rule.error for rule in self.rules)
            error = TOLERANCE if left <= _MET * TOLERANCE else _CAUTION * left
            shared = self._errors_of_shared_lines(responses, criteria)
            return np.sqrt(np.maximum(error, along) ** 2 + shared**2 + beyond**2)
        indices = np.array(
            [
                reliability_indices(self._answer(self.rules[0], part, criteria))
                for part in responses.parts
            ]
        )
        scatter = _FEW_PARTS * indices.std(axis=0, ddof=1) / math.sqrt(_GROUPS)
        fixed = math.hypot(_ROUNDING, max(rule.error for rule in self.rules))
        return np.asarray(np.sqrt(fixed**2 + along**2 + scatter**2 + beyond**2))

    def _errors_beyond(self, responses: Responses, criteria: Sequence[Criterion]) -> FloatArray:
        """Error (C,) of the indices from shared variables further out than the outermost nodes.

        Failure there is likelier than at these nodes, but by how much nobody has looked.
        """
        from scipy.stats import chi

        nodes = self.rules[0].shared_nodes
        radius = np.linalg.norm(nodes, axis=1)
        edge = np.flatnonzero((radius > 0.999 * SHARED_REACH) & (radius < SHARED_REACH + 0.5))
        if self.together or edge.size == 0 or self.rules[0].shared_lines is not None:
            return np.zeros(len(criteria))
        weights = np.full(edge.size, 1.0 / edge.size)
        outermost = [[of_kind[int(i)] for i in edge] for of_kind in conditional(responses.whole)]
        there = system_failures_of_kinds(outermost, weights, self.units, criteria)
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

    def _errors_of_shared_lines(
        self, responses: Responses, criteria: Sequence[Criterion]
    ) -> FloatArray:
        """Error (C,) of the indices from too few lines over the shared variables, and stations."""
        shared = self.rules[0].shared_lines
        if shared is None:
            return np.zeros(len(criteria))
        found, thinned = (
            reliability_indices(one(_on_lines(responses.whole), self.units, criteria))
            for one in (shared.failures, shared.coarser)
        )
        along = _HALVED * np.abs(found - thinned)
        if shared.weights.size == 1:
            return np.asarray(along)
        count = _GROUPS if shared.sampled else 2
        parts = np.array(
            [
                reliability_indices(part)
                for part in shared.of_parts(_on_lines(responses.whole), self.units, criteria, count)
            ]
        )
        if shared.sampled:
            across = _FEW_PARTS * parts.std(axis=0, ddof=1) / math.sqrt(count)
        else:
            across = _HALVED * np.ptp(parts, axis=0)
        return np.asarray(np.hypot(along, across))

    def errors_along_lines(self, responses: Responses, criteria: Sequence[Criterion]) -> FloatArray:
        """Error (C,) of the reliability indices from stations too far apart on random lines."""
        found, coarser = (
            reliability_indices(self._answer(self.rules[0], some, criteria))
            for some in (responses.whole, responses.thinned)
        )
        return np.asarray(_HALVED * np.abs(found - coarser))

    def changes(
        self,
        surfaces: Surfaces,
        paths: Surfaces,
        criteria: Sequence[Criterion],
        outcomes: Outcomes | Sequence[Outcomes] | None = None,
        noise: float | Sequence[float] = 0.0,
    ) -> FloatArray:
        """How far each of R other surfaces, or sets of them, moves the index -Phi^-1(pf).

        Parameters
        ----------
        surfaces
            The surface (of each kind) from which changes count.
        paths
            The R others (of each kind): takes u (n, d), gives (R, n).
        criteria, outcomes, noise
            As in `failures`.

        Returns
        -------
        FloatArray
            Changes (R, len(criteria)); 0 where pf is 0 or 1 with all surfaces.
        """
        return self.changes_given(self.coarse_responses(surfaces, paths, outcomes, noise), criteria)

    def coarse_responses(
        self,
        surfaces: Surfaces,
        paths: Surfaces,
        outcomes: Outcomes | Sequence[Outcomes] | None = None,
        noise: float | Sequence[float] = 0.0,
    ) -> list[OfKinds]:
        """Conditional responses of 1 + R sets of surfaces, which tell the changes of answers."""
        found = []
        others = (path for _, path, _, _ in self._each(self.coarse, paths, None, 0.0))
        each = self._each(self.coarse, surfaces, outcomes, noise)
        for (rule, surface, of_kind, std), path in zip(each, others, strict=True):
            points = rule.points
            kinds = None if of_kind is None else of_kind(points)
            every = [surface(points), *path(points)]
            found.append([rule.responses(values, kinds, std) for values in every])
        return list(zip(*found, strict=True))

    def changes_given(
        self, responses: Sequence[OfKinds], criteria: Sequence[Criterion]
    ) -> FloatArray:
        """Changes (R, C) of the indices from `coarse_responses`."""
        rule = self.coarse[0]
        indices = np.array(
            [reliability_indices(self._answer(rule, one, criteria)) for one in responses]
        )
        return np.asarray(indices[1:] - indices[0])

    def _each(
        self,
        rules: Sequence[SurfaceRule],
        surfaces: Surfaces,
        outcomes: Outcomes | Sequence[Outcomes] | None,
        noise: float | Sequence[float],
    ) -> Iterator[tuple[SurfaceRule, Surface, Outcomes | None, float]]:
        """Rule, surface, outcomes and noise of each kind."""
        each = [surfaces] if callable(surfaces) else list(surfaces)
        kinds: list[Outcomes | None] = [None] * len(each)
        if outcomes is not None:
            kinds = [outcomes] if callable(outcomes) else list(outcomes)
        std = [noise] * len(each) if isinstance(noise, float | int) else list(noise)
        return zip(rules, each, kinds, std, strict=True)

    def _answer(
        self, rule: SurfaceRule, responses: OfKinds, criteria: Sequence[Criterion]
    ) -> list[SystemProbability]:
        if rule.shared_lines is not None:
            return rule.shared_lines.failures(_on_lines(responses), self.units, criteria)
        given = conditional(responses)
        if not self.together:
            return system_failures_of_kinds(given, rule.weights, self.units, criteria)
        # tau = 0 still refuses infinite responses, which have no difference
        shift = self.units.shift
        alone = [Criterion(c.threshold - shift, None if c.tau is None else 0.0) for c in criteria]
        found = system_failures(given[0], rule.weights, 1, alone)
        return [_if_flown(one, c) for one, c in zip(found, criteria, strict=True)]


def conditional(responses: OfKinds) -> list[Sequence[ConditionalResponse]]:
    """Return those of each kind that are conditional responses."""
    return [one for one in responses if not isinstance(one, OnLines)]


def _on_lines(responses: OfKinds) -> list[OnLines]:
    """Return those of each kind at the stations of shared lines."""
    return [one for one in responses if isinstance(one, OnLines)]


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
