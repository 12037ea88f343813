"""What response surfaces are asked: the criteria of a task, and where they are decided."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from uqfold.methods.design_runs import DesignRuns
from uqfold.methods.task import Task
from uqfold.problems.criterion import Binomial, Criterion
from uqfold.system.influence import Influence, influences
from uqfold.system.lines import FINITE
from uqfold.system.missions import over_missions
from uqfold.system.refinement import Compared
from uqfold.system.structure import SystemUnits
from uqfold.system.surface_plan import plans_of_kinds, rules_of_kinds
from uqfold.system.surface_rule import MAX_POINTS, Surface
from uqfold.typing import BoolArray, FloatArray, IntArray

# Points of the integration over the surfaces at every step of learning: enough to see how much the
# answers still move. The final answers take many more.
_COARSE_POINTS = 6_000
MOST_LEARNED = 200
"""Criteria that decide where to learn; more of them are answered, but add nothing to that."""
_ROOT_TWO_PI = math.sqrt(2.0 * math.pi)


@dataclass(frozen=True, eq=False)
class Answers:
    """How failure probabilities answer to changes of the surface of one kind of units.

    Attributes
    ----------
    dimension
        Number of variables.
    shared_nodes
        Nodes (K, d_shared) in standard-normal space at which `influences` are given.
    influences
        Influence of the response at each node, for each criterion.
    usable
        Tells where responses (of points (n, d)) are finite, or None: everywhere.
    stakes
        Share (C, S) of each answer, failure or success as whichever is smaller, in which the units
        of each sort take part.
    """

    dimension: int
    shared_nodes: FloatArray
    influences: Sequence[Sequence[Influence]]
    usable: Callable[[FloatArray], BoolArray] | None
    stakes: FloatArray

    @property
    def levels(self) -> FloatArray:
        """The finite responses (L,) at which units pass a threshold."""
        levels = np.unique([one.levels for one in self.influences[0]])
        return np.asarray(levels[np.isfinite(levels)])

    def influence_at(
        self, u: FloatArray, mean: FloatArray, std: FloatArray, thickness: FloatArray
    ) -> FloatArray:
        """Influence (C, N) of the surface at points u on pf, averaged over its posterior there.

        Parameters
        ----------
        u
            Points (N, d).
        mean, std
            Posterior mean and standard deviation of the surface there (N,).
        thickness
            Least standard deviation (N,) with which levels are seen.
        """
        seen = np.maximum(std, thickness)
        values = self._jumps(u, lambda level: normal_density(level, mean, seen))
        nearest = self._nearest(u)
        for node in np.unique(nearest):
            here = nearest == node
            for row, own in enumerate(self.influences[node]):
                if own.y.size:
                    values[row, here] += own.rest(mean[here])
        if self.usable is not None:
            # another infinite response would teach the surface nothing
            values *= self.usable(u)
        return values

    def beyond(self, u: FloatArray, mean: FloatArray, std: FloatArray, centre: float) -> FloatArray:
        """Weight (C, N) of responses that may lie on the other side of a threshold than most.

        Parameters
        ----------
        u
            Points (N, d).
        mean, std
            Posterior mean and standard deviation of the surface there (N,).
        centre
            Its mean at the origin, on the side where most responses are.
        """
        from scipy.special import ndtr

        def other_side(level: float) -> FloatArray:
            with np.errstate(over="ignore"):
                above = (mean - level) / std
            return np.asarray(ndtr(-above if centre > level else above))

        return self._jumps(u, other_side)

    def _nearest(self, u: FloatArray) -> IntArray:
        """Nearest shared node (N,) of points u (N, d)."""
        v = u[:, : self.shared_nodes.shape[1]]
        return np.asarray(((v[:, None, :] - self.shared_nodes) ** 2).sum(axis=2).argmin(axis=1))

    def _jumps(self, u: FloatArray, at: Callable[[float], FloatArray]) -> FloatArray:
        """Values (C, N) of a function of levels, weighed by their jumps at points u (N, d)."""
        jumps = np.array([[own.jumps for own in node] for node in self.influences])
        weights = np.moveaxis(jumps, 0, -1)[..., self._nearest(u)]
        values = np.zeros((len(self.influences[0]), len(u)))
        for row, own in enumerate(self.influences[0]):
            for level, weight in zip(own.levels.tolist(), weights[row], strict=True):
                if weight.any():
                    values[row] += weight * at(level)
        return values


@dataclass(frozen=True, eq=False)
class Question:
    """The criteria of a task as functionals of response surfaces over standard-normal space.

    Attributes
    ----------
    dimensions, n_shared
        Number of variables of each kind of units, and how many of them (the first ones) are shared.
    units
        The units and their structure.
    criteria
        The criteria that are learned from: all, or some spread among many.
    neighbours
        Positions (2, n) in `criteria` of those on both sides of each criterion of the task.
    usable
        Tells where responses (of points (n, d)) of each kind are finite, or None: everywhere.
    """

    dimensions: tuple[int, ...]
    n_shared: int
    units: SystemUnits
    criteria: tuple[Criterion, ...]
    neighbours: IntArray
    usable: tuple[Callable[[FloatArray], BoolArray] | None, ...] = (None,)

    @classmethod
    def of(cls, task: Task, runs: Sequence[DesignRuns]) -> Question:
        """Return the question of a task; where it has finite responses, the runs so far tell."""

        def usable(own: DesignRuns) -> Callable[[FloatArray], BoolArray] | None:
            def finite(u: FloatArray) -> BoolArray:
                return np.asarray(own.outcomes(u) == FINITE)

            return None if own.complete else finite

        kinds = task.problem.kinds
        return cls(
            tuple(inputs.dimension for inputs in kinds.inputs),
            kinds.n_shared,
            SystemUnits.of(task.problem),
            *_spread_among(task.criteria),
            tuple(map(usable, runs)),
        )

    def for_all(self, errors: FloatArray) -> FloatArray:
        """Errors (n,) of all criteria from those (C,) learned from: the larger of both sides'."""
        return np.asarray(errors[self.neighbours].max(axis=0))

    @property
    def together(self) -> bool:
        """Whether all units and missions give one response: one of each, or all is shared."""
        single = self.units.count == 1 and all(c.missions == 1 for c in self.criteria)
        return single or self.n_shared == max(self.dimensions)

    def levels(self, threshold: float, kind: int) -> FloatArray:
        """Responses (S,) at which units of each sort of a kind pass a threshold of the system."""
        if self.together:
            return np.array([threshold - self.units.shift])
        return self.units.thresholds(threshold, kind)

    def answers(self, means: Sequence[Surface]) -> tuple[FloatArray | None, list[Answers]]:
        """Integrate over the surfaces of all kinds, coarsely.

        Returns
        -------
        tuple[FloatArray | None, list[Answers]]
            Failure probabilities (C,), None where a single response decides them, which sampling
            tells as well; and how they answer to the surface of each kind.
        """
        if self.together:
            return None, [self._alone()]
        dimensions, count = self.dimensions, len(means)
        plans = plans_of_kinds(
            means, dimensions, self.n_shared, 1, [Compared()] * count, MAX_POINTS
        )
        rules = rules_of_kinds(plans, _COARSE_POINTS, [np.empty(0)] * count)
        of_kinds = [
            rule.responses(mean(rule.points)) for rule, mean in zip(rules, means, strict=True)
        ]
        weights = rules[0].weights
        found = [
            influences(responses, self.units, self.criteria)
            for responses in zip(*of_kinds, strict=True)
        ]
        failure = np.array([[one.failure for one in at_node[0]] for at_node in found])
        both = [
            [
                float(weights @ share)
                for share in over_missions(column, 1.0 - column, criterion.missions)
            ]
            for column, criterion in zip(failure.T, self.criteria, strict=True)
        ]
        pf = np.array(both)[:, 0]
        side = np.argmin(both, axis=1)
        smaller = np.min(both, axis=1)[:, None]
        answers = []
        for kind, (rule, usable) in enumerate(zip(rules, self.usable, strict=True)):
            own = [at_node[kind] for at_node in found]
            stakes = np.tensordot(weights, [[c.stakes for c in node] for node in own], axes=1)
            smallest = stakes[np.arange(side.size), side]
            # what never happens is an extrapolation for all units
            share = np.where(smaller > 0.0, smallest / np.maximum(smaller, 1e-300), 1.0)
            answers.append(Answers(dimensions[kind], rule.shared_nodes, own, usable, share))
        return pf, answers

    def _alone(self) -> Answers:
        """How the only response answers for the system."""
        nothing = np.empty((1, 0))
        single = [
            Influence(
                math.nan, self.levels(c.threshold, 0), np.array([flown(c)]), np.ones((2, 1)),
                nothing, nothing,
            )
            for c in self.criteria
        ]  # fmt: skip
        no_nodes = np.zeros((1, 0))
        return Answers(
            self.dimensions[0], no_nodes, [single], self.usable[0], np.ones((len(single), 1))
        )


def _spread_among(criteria: tuple[Criterion, ...]) -> tuple[tuple[Criterion, ...], IntArray]:
    """Some of many criteria, and for each of all the positions of its two neighbours in them."""
    n = len(criteria)
    if n <= MOST_LEARNED:
        return criteria, np.tile(np.arange(n), (2, 1))

    def key(row: int) -> tuple[float, str, float]:
        criterion = criteria[row]
        tau = -1.0 if criterion.tau is None else criterion.tau
        return tau, str(criterion.missions), criterion.threshold

    order = np.array(sorted(range(n), key=key))
    kept = np.unique(np.linspace(0, n - 1, MOST_LEARNED).round().astype(np.int64))
    rank = np.empty(n, dtype=np.int64)
    rank[order] = np.arange(n)
    after = np.searchsorted(kept, rank)
    before = np.where(kept[after] == rank, after, after - 1)
    return tuple(criteria[row] for row in order[kept]), np.stack([before, after])


def normal_density(y: float, mean: FloatArray, std: FloatArray) -> FloatArray:
    """Density of normal distributions at y; far from it, where squares overflow, too."""
    with np.errstate(over="ignore"):
        z = np.minimum(np.abs(mean - y) / std, 40.0)
    return np.asarray(np.exp(-0.5 * z * z) / (std * _ROOT_TWO_PI))


def flown(criterion: Criterion) -> float:
    """Probability that a mission takes place at all."""
    missions = criterion.missions
    if not isinstance(missions, Binomial):
        return 1.0
    return 1.0 - (1.0 - missions.p) ** missions.planned
