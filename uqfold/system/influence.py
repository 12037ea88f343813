"""How the failure probability of a system answers to a small change of the response surface.

Let f(v, u) be the response of one unit, with density h and distribution function H given the
shared inputs v. If f changes by df, the failure probability of one mission of n units given v
changes by

    n E_u[ { J delta(f - T) + s(f) } df ],       J = [H(T) - H(T - tau)]^(n-1),

    s(y) = (n-1) { h(y - tau) [H(y) - H(y - tau)]^(n-2)
                   - h(y + tau) [H(y + tau) - H(y)]^(n-2)  (the latter for y + tau < T) },  y < T,

the derivative of the order-statistics integral in `synchronized`: J for a response that passes the
threshold, s for one that spreads or closes a mission. Without tau, J = H(T)^(n-1) and s = 0.
Several missions multiply by the derivative of `over_missions`.

This is what a surrogate has to know: where the product of this influence and of its own
uncertainty is large, another evaluation teaches most. The accuracy is that of a trapezoidal rule
over the distribution's own panels, enough to say where a surface matters; answers come from
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
from uqfold.system.structure import SystemUnits
from uqfold.time_limit import check_time
from uqfold.typing import FloatArray

_ALMOST_SURE = 1.0 - 2.0**-53
_ROOT_TWO_PI = math.sqrt(2.0 * math.pi)


@dataclass(frozen=True, eq=False)
class Influence:
    """Influence of one unit's response on pf, given the shared inputs.

    Attributes
    ----------
    failure
        Probability that one mission fails.
    threshold
        The response T at which the influence is concentrated.
    jump
        Weight of the concentrated part.
    y, slope
        The rest, per unit of the response, tabulated over responses (L,); 0 from T on.
    """

    failure: float
    threshold: float
    jump: float
    y: FloatArray
    slope: FloatArray

    def rest(self, y: FloatArray) -> FloatArray:
        """Value of the spread part at responses y."""
        if self.y.size == 0:
            return np.zeros(y.shape)
        return np.asarray(np.where(y < self.threshold, np.interp(y, self.y, self.slope), 0.0))


def influences(
    response: ConditionalResponse, units: SystemUnits | int, criteria: Sequence[Criterion]
) -> list[Influence]:
    """Influence of one unit's response on pf of each criterion, given the shared inputs.

    Parameters
    ----------
    response
        Response given the shared inputs; infinite responses and failed runs are left out.
    units
        The exchangeable units and their structure, or the number n of units in series.
    criteria
        Threshold, tau and missions of each.
    """
    distribution = response.distribution
    if distribution is None:
        nothing = np.empty(0)
        return [Influence(math.nan, c.threshold, 0.0, nothing, nothing) for c in criteria]
    table = _Scores.of(distribution)
    units = SystemUnits.of(units)
    found = []
    late = distribution.sf(np.array([criterion.threshold for criterion in criteria]))
    for criterion, sf in zip(criteria, late.tolist(), strict=True):
        check_time()
        failure, jump, y, slope = _of_mission(sf, table, units, criterion)
        factor = units.count * _mission_factor(criterion, failure)
        found.append(Influence(failure, criterion.threshold, factor * jump, y, factor * slope))
    return found


def _of_mission(
    sf: float,
    table: _Scores | None,
    units: SystemUnits,
    criterion: Criterion,
) -> tuple[float, float, FloatArray, FloatArray]:
    """Failure, jump and tabulated rest of one mission, per unit."""
    threshold, tau, n = criterion.threshold, criterion.tau, units.count
    if units.diagram is not None:
        failure, change = units.diagram.with_derivative(min(sf, _ALMOST_SURE))
        return failure, change / n, np.empty(0), np.empty(0)
    log_works = math.log1p(-min(sf, _ALMOST_SURE))
    failure = -math.expm1(n * log_works)
    if tau is None or n == 1 or table is None:
        return failure, math.exp((n - 1) * log_works), np.empty(0), np.empty(0)
    y = table.grid(threshold, tau)
    (cdf, density), (cdf_earlier, density_earlier) = table(y), table(y - tau)
    cdf_later, density_later = table(np.minimum(y + tau, threshold))
    near, nearest = table(np.array([threshold, threshold - tau]))[0]
    before = y + tau < threshold
    # all in time, but the smallest response so early that not all others lie within tau of it
    apart = (near - cdf) ** (n - 1) - (cdf_later - cdf) ** (n - 1)
    apart = np.where(before, n * density * np.maximum(apart, 0.0), 0.0)
    failure += float(np.sum(0.5 * (apart[1:] + apart[:-1]) * np.diff(y)))
    spreads = density_earlier * (cdf - cdf_earlier) ** (n - 2)
    closes = np.where(before, density_later * (cdf_later - cdf) ** (n - 2), 0.0)
    jump = max(float(near - nearest), 0.0) ** (n - 1)
    return min(failure, 1.0), jump, y, (n - 1) * (spreads - closes)


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
