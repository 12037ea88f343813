"""How the failure probability of a system answers to a small change of the response surface.

Let f_j(v, u) be the response of one unit of sort j with its offset added, h_j its density and H_j
its distribution function given the shared inputs v, and c_j the number of such units. If f_j
changes by df, the failure probability of one mission given v changes by

    c_j E_u[ { J_j delta(f_j - T) + s_j(f_j) } df ].

Without tau J_j is how the failure of the system answers to that of one unit of the sort, for any
structure, and s_j = 0. With tau, in series,

    J_j = prod [H_i(T) - H_i(T - tau)],

    s_j(y) = sum_k (c_k - [k = j]) { h_k(y - tau) prod [H_i(y) - H_i(y - tau)]
                   - h_k(y + tau) prod [H_i(y + tau) - H_i(y)]  (the latter for y + tau < T) },

for y < T, with products over all other units: the derivative of the order-statistics integral in
`synchronized`. J_j is for a response that passes the threshold, s_j for one that spreads or closes
a mission. Several missions multiply by the derivative of `over_missions`.

This is what a surrogate has to know: where the product of this influence and of its own
uncertainty is large, another evaluation teaches most. The accuracy is that of a trapezoidal rule
over the distributions' own panels, enough to say where a surface matters; answers come from
`conditional`.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from uqfold.moments.conditional import ConditionalDistribution, integrable
from uqfold.problems.criterion import Binomial, Criterion
from uqfold.system.conditional_response import ConditionalResponse
from uqfold.system.conditional_unit import UnitResponse
from uqfold.system.structure import SystemUnits
from uqfold.system.synchronized import failure_of_units
from uqfold.time_limit import check_time
from uqfold.typing import FloatArray

_ROOT_TWO_PI = math.sqrt(2.0 * math.pi)
# Stands for 0 in a logarithm.
_TINY = 1e-300


@dataclass(frozen=True, eq=False)
class Influence:
    """Influence of the response of one kind of units on pf, given the shared inputs.

    Attributes
    ----------
    failure
        Probability that one mission fails.
    levels
        The responses (S,) at which the influence is concentrated: where units of each sort of this
        kind pass T.
    jumps
        Weights (S,) of the concentrated parts.
    stakes
        Failure, and success, of the system that go with those of each sort (2, S), without tau.
    y, slopes
        The rest, per unit of the response, tabulated for each sort over responses (S, L); 0 from
        its level on.
    """

    failure: float
    levels: FloatArray
    jumps: FloatArray
    stakes: FloatArray
    y: FloatArray
    slopes: FloatArray

    def rest(self, y: FloatArray) -> FloatArray:
        """Value of the spread part at responses y."""
        value = np.zeros(y.shape)
        if self.y.size:
            for level, places, slope in zip(self.levels, self.y, self.slopes, strict=True):
                value += np.where(y < level, np.interp(y, places, slope), 0.0)
        return value


def influences(
    responses: ConditionalResponse | Sequence[ConditionalResponse],
    units: SystemUnits | int,
    criteria: Sequence[Criterion],
) -> list[list[Influence]]:
    """Influence of the responses of each kind of units on pf of each criterion.

    Parameters
    ----------
    responses
        Response of a unit of each kind given the shared inputs; a single one where all are of one
        kind. Infinite responses and failed runs have no influence.
    units
        The units and their structure, or the number n of units in series.
    criteria
        Threshold, tau and missions of each.
    """
    each = [responses] if isinstance(responses, ConditionalResponse) else list(responses)
    units = SystemUnits.of(units)
    thresholds = np.array([criterion.threshold for criterion in criteria])
    alone = [UnitResponse([response], np.ones(1)) for response in each]
    fails, works = failure_of_units(alone, units, thresholds)
    failures, changes = units.with_derivatives(fails, works)
    finite = np.array([response.distribution is not None for response in each])
    changes = changes * finite[units.of_kinds][:, None]
    spread = [_Scores.of(one.distribution) for one in each if one.distribution is not None]
    tables = [one for one in spread if one is not None]
    known = len(tables) == len(each)
    own = [units.of_kinds == kind for kind in range(len(each))]
    found: list[list[Influence]] = [[] for _ in each]
    for column, criterion in enumerate(criteria):
        check_time()
        failure, jumps = float(failures[column]), changes[:, column]
        y = slopes = np.empty((len(units.of_kinds), 0))
        if criterion.tau is not None and units.count > 1 and known:
            sorts = [tables[kind] for kind in units.of_kinds]
            apart, jumps, y, slopes = _within(sorts, units, criterion.threshold, criterion.tau)
            failure = min(failure + apart, 1.0)
        factor = _mission_factor(criterion, failure)
        levels = units.thresholds(criterion.threshold)
        stakes = factor * jumps * np.stack([fails[:, column], works[:, column]])
        for kind, some in enumerate(own):
            parts = levels[some], factor * jumps[some], stakes[:, some]
            found[kind].append(Influence(failure, *parts, y[some], factor * slopes[some]))
    return found


def _within(
    sorts: Sequence[_Scores], units: SystemUnits, threshold: float, tau: float
) -> tuple[float, FloatArray, FloatArray, FloatArray]:
    """Failure by tau alone, jumps (J,), and where (J, L) and what (J, L) the rest is, under tau."""
    counts, offsets = np.array(units.counts)[:, None], units.offsets[:, None]
    levels = threshold - units.offsets
    grids = [one.grid(T, tau) + o for one, T, o in zip(sorts, levels, offsets[:, 0], strict=True)]
    y = np.unique(np.concatenate(grids))

    def at(places: FloatArray) -> tuple[FloatArray, FloatArray]:
        values = [one(own) for one, own in zip(sorts, places - offsets, strict=True)]
        cdf, density = zip(*values, strict=True)
        return np.stack(cdf), np.stack(density)

    (cdf, density), (cdf_earlier, density_earlier) = at(y), at(y - tau)
    cdf_later, density_later = at(np.minimum(y + tau, threshold))
    near, nearest = at(np.array([threshold, threshold - tau]))[0].T
    before = y + tau < threshold
    up_to, later, earlier = (
        _Others(np.maximum(one, 0.0), counts)
        for one in (near[:, None] - cdf, cdf_later - cdf, cdf - cdf_earlier)
    )
    # all in time, but the smallest response so early that not all others lie within tau of it
    apart = np.maximum(up_to.than_one - later.than_one, 0.0)
    apart = np.where(before, counts * density * apart, 0.0).sum(axis=0)
    failure = float(np.sum(0.5 * (apart[1:] + apart[:-1]) * np.diff(y)))
    closes = np.where(before, later.with_one_at(density_later), 0.0)
    slopes = counts * (earlier.with_one_at(density_earlier) - closes)
    jumps = counts * _Others(np.maximum(near - nearest, 0.0)[:, None], counts).than_one
    return failure, jumps[:, 0], y - offsets, slopes


class _Others:
    """Products of probabilities (J, L) over all units but a few, of which c_j (J, 1) are alike."""

    def __init__(self, factors: FloatArray, counts: FloatArray) -> None:
        self.logs = np.log(np.maximum(factors, _TINY))
        self.counts = counts
        self.whole = (counts * self.logs).sum(axis=0)

    @property
    def than_one(self) -> FloatArray:
        """Over all but one of each sort (J, L)."""
        return np.asarray(np.exp(self.whole - self.logs))

    def with_one_at(self, density: FloatArray) -> FloatArray:
        """Over all but one of each sort (J, L), another one of them with its density (J, L)."""
        rows = []
        for sort, log in enumerate(self.logs):
            check_time()
            others = self.counts - (np.arange(len(self.logs)) == sort)[:, None]
            rows.append((others * density * np.exp(self.whole - self.logs - log)).sum(axis=0))
        return np.array(rows)


def _mission_factor(criterion: Criterion, failure: float) -> float:
    """Derivative of failure over all missions by failure in one."""
    missions = criterion.missions
    count, flown = (
        (missions.planned, missions.p) if isinstance(missions, Binomial) else (missions, 1.0)
    )
    return float(count * flown * max(1.0 - flown * failure, 0.0) ** (count - 1))


@dataclass(frozen=True, eq=False)
class _Scores:
    """Normal scores of a distribution on a grid: looked up, they save many of its own calls."""

    y: FloatArray
    score: FloatArray
    slope: FloatArray

    @classmethod
    def of(cls, distribution: ConditionalDistribution) -> _Scores | None:
        """Tabulate; None for a distribution without a density."""
        from scipy.special import ndtri

        if not integrable(distribution):
            return None
        edges = distribution.breakpoints
        if edges.size < 2:
            return None
        fine = np.concatenate([edges, 0.5 * (edges[1:] + edges[:-1])])
        at = distribution.at_coordinate(np.sort(fine))
        score = np.where(at.cdf < at.sf, ndtri(at.cdf), -ndtri(at.sf))
        kept = np.isfinite(score) & np.isfinite(at.y)
        y, first = np.unique(at.y[kept], return_index=True)
        if y.size < 2:
            return None
        score = np.maximum.accumulate(score[kept][first])
        return cls(y, score, np.gradient(score, y))

    def __call__(self, y: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Distribution function and density at responses y."""
        from scipy.special import ndtr

        score = np.interp(y, self.y, self.score)
        density = np.exp(-0.5 * score**2) / _ROOT_TWO_PI * np.interp(y, self.y, self.slope)
        inside = (y >= self.y[0]) & (y <= self.y[-1])
        return np.asarray(ndtr(score)), np.where(inside, density, 0.0)

    def grid(self, threshold: float, tau: float) -> FloatArray:
        """Responses up to T at which the influence has features."""
        points = np.concatenate(
            [self.y, self.y[::2] + tau, self.y[::2] - tau, [threshold, threshold - tau]]
        )
        return np.unique(points[(points <= threshold) & np.isfinite(points)])
