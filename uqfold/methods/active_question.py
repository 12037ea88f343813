"""What a response surface is asked: the criteria of a task, and where they are decided."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from uqfold.methods.base import Task
from uqfold.methods.design_runs import DesignRuns
from uqfold.problems.criterion import Binomial, Criterion
from uqfold.system.influence import Influence, influences
from uqfold.system.lines import FINITE
from uqfold.system.missions import over_missions
from uqfold.system.structure import SystemUnits
from uqfold.system.surface_plan import plan_surface
from uqfold.system.surface_rule import Surface
from uqfold.typing import BoolArray, FloatArray, IntArray

# Points of the integration over the surface at every step of learning: enough to see how much the
# answers still move. The final answers take many more.
_COARSE_POINTS = 6_000
MOST_LEARNED = 200
"""Criteria that decide where to learn; more of them are answered, but add nothing to that."""
_ROOT_TWO_PI = math.sqrt(2.0 * math.pi)


@dataclass(frozen=True, eq=False)
class Answers:
    """Failure probabilities under a mean surface, and how they answer to its changes.

    Attributes
    ----------
    question
        What was asked.
    pf
        Failure probabilities (C,), coarsely; None where a single response decides them, which
        sampling tells as well.
    shared_nodes
        Nodes (K, d_shared) in standard-normal space at which `influences` are given.
    influences
        Influence of the response at each node, for each criterion.
    """

    question: Question
    pf: FloatArray | None
    shared_nodes: FloatArray
    influences: Sequence[Sequence[Influence]]

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
        nearest, values = self._jumps(u)
        for row, criterion in enumerate(self.question.criteria):
            values[row] *= normal_density(criterion.threshold, mean, np.maximum(std, thickness))
        for node in np.unique(nearest):
            here = nearest == node
            for row, own in enumerate(self.influences[node]):
                if own.y.size:
                    values[row, here] += own.rest(mean[here])
        if self.question.usable is not None:
            # another infinite response would teach the surface nothing
            values *= self.question.usable(u)
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

        values = self._jumps(u)[1]
        for row, criterion in enumerate(self.question.criteria):
            above = (mean - criterion.threshold) / std
            values[row] *= ndtr(-above if centre > criterion.threshold else above)
        return values

    def _jumps(self, u: FloatArray) -> tuple[IntArray, FloatArray]:
        """Nearest shared node (N,) of points u (N, d), and the weights (C, N) of thresholds."""
        v = u[:, : self.shared_nodes.shape[1]]
        nearest = ((v[:, None, :] - self.shared_nodes) ** 2).sum(axis=2).argmin(axis=1)
        jumps = np.array([[own.jump for own in at_node] for at_node in self.influences])
        return nearest, jumps.T[:, nearest]


@dataclass(frozen=True, eq=False)
class Question:
    """The criteria of a task as functionals of a response surface over standard-normal space.

    Attributes
    ----------
    dimension, n_shared
        Number of variables, and how many of them (the first ones) are shared.
    units
        The exchangeable units and their structure.
    criteria
        The criteria that are learned from: all, or some spread among many.
    neighbours
        Positions (2, n) in `criteria` of those on both sides of each criterion of the task.
    usable
        Tells where responses (of points (n, d)) are finite, or None: everywhere.
    """

    dimension: int
    n_shared: int
    units: SystemUnits
    criteria: tuple[Criterion, ...]
    neighbours: IntArray
    usable: Callable[[FloatArray], BoolArray] | None = None

    @classmethod
    def of(cls, task: Task, runs: DesignRuns) -> Question:
        """Return the question of a task; where it has finite responses, the runs so far tell."""
        inputs = task.problem.inputs

        def usable(u: FloatArray) -> BoolArray:
            return np.asarray(runs.outcomes(u) == FINITE)

        return cls(
            inputs.dimension,
            inputs.n_shared,
            SystemUnits.of(task.problem),
            *_spread_among(task.criteria),
            None if runs.complete else usable,
        )

    def for_all(self, errors: FloatArray) -> FloatArray:
        """Errors (n,) of all criteria from those (C,) learned from: the larger of both sides'."""
        return np.asarray(errors[self.neighbours].max(axis=0))

    @property
    def together(self) -> bool:
        """Whether all units and missions give one response: one of each, or all is shared."""
        single = self.units.count == 1 and all(c.missions == 1 for c in self.criteria)
        return single or self.n_shared == self.dimension

    @property
    def levels(self) -> FloatArray:
        """The finite thresholds (L,)."""
        levels = np.unique([c.threshold for c in self.criteria])
        return np.asarray(levels[np.isfinite(levels)])

    def answers(self, mean: Surface) -> Answers:
        """Integrate over a surface, coarsely."""
        if self.together:
            nothing = np.empty(0)
            single = [
                Influence(math.nan, c.threshold, flown(c), nothing, nothing) for c in self.criteria
            ]
            return Answers(self, None, np.zeros((1, 0)), [single])
        rule = plan_surface(mean, self.dimension, self.n_shared).rule(_COARSE_POINTS)
        found = [
            influences(response, self.units, self.criteria)
            for response in rule.responses(mean(rule.points))
        ]
        failure = np.array([[one.failure for one in at_node] for at_node in found])
        pf = [
            rule.weights @ over_missions(column, 1.0 - column, criterion.missions)[0]
            for column, criterion in zip(failure.T, self.criteria, strict=True)
        ]
        return Answers(self, np.array(pf), rule.shared_nodes, found)


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
    z = np.minimum(np.abs(mean - y) / std, 40.0)
    return np.asarray(np.exp(-0.5 * z * z) / (std * _ROOT_TWO_PI))


def flown(criterion: Criterion) -> float:
    """Probability that a mission takes place at all."""
    missions = criterion.missions
    if not isinstance(missions, Binomial):
        return 1.0
    return 1.0 - (1.0 - missions.p) ** missions.planned
