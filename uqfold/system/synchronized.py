"""One mission of n units: in series all fast enough, and close to each other.

Without a synchronization threshold tau any structure is answered by `uqfold.system.structure`.

With H_i the distribution function of unit i's response, h_i its density, a mission works if
max <= T and max - min <= tau. By conditioning on the largest response s, and on whose it is,

    works = sum_i int_{-inf}^{T} h_i(s) prod_{j != i} [H_j(s) - H_j(s - tau)] ds
    fails = 1 - prod_i H_i(T) + sum_i int_{-inf}^{T} h_i(s) D_i(s) ds,
    D_i = prod_{j != i} H_j(s) - prod_{j != i} [H_j(s) - H_j(s - tau)].

Both integrands are positive and know nothing of T, so that neither number is ever formed as one
minus the other, and one integration answers all thresholds. Units with the same distribution and
offset are one sort, of which there may be any number: a sum over c of them is c times one term, and
a product a power. The difference of products prod x_j - prod y_j is formed from x_j - y_j =
H_j(s - tau). At an atom s, where unit j has the mass p_j, h_i ds prod_{j != i} X_j is replaced by
prod (X_j + p_j) - prod X_j over all units, where X_j leaves out the atom.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from functools import partial
from typing import NamedTuple

import numpy as np

from uqfold.moments.panels import integrals_up_to
from uqfold.system.conditional_unit import Measure, UnitResponse
from uqfold.system.structure import SystemUnits
from uqfold.typing import FloatArray

# Every so many places of another unit's body are edges of the integration.
_THINNED = 4


@dataclass(frozen=True)
class MissionProbability:
    """Failure and success of one mission at R thresholds, arrays (R,).

    Attributes
    ----------
    failure, success
        With failed runs counted as failing.
    failure_low, success_low
        With failed runs ignored: a unit without an answer is left out of the mission.
    """

    failure: FloatArray
    success: FloatArray
    failure_low: FloatArray
    success_low: FloatArray


def mission_probability(
    responses: UnitResponse | Sequence[UnitResponse],
    units: SystemUnits | int,
    thresholds: FloatArray,
    tau: float | None,
) -> MissionProbability:
    """Probability that one mission of independent units fails, and that it works.

    Parameters
    ----------
    responses
        Response of a unit of each kind, without offset; a single one where all are of one kind.
    units
        The units and their structure, or the number n >= 1 of units in series.
    thresholds : array (R,)
        Response thresholds T (unit of the response); +-inf allowed.
    tau
        Synchronization threshold >= 0 (unit of the response); None: no such threshold.
        With inf, any finite difference is small enough.

    Raises
    ------
    ValueError
        For units < 1, a NaN threshold, a negative or NaN tau, tau with units that may fail, or
        another number of responses than there are kinds.
    TypeError
        If tau is given and a distribution has no density to integrate over.
    """
    units = SystemUnits.of(units)
    thresholds = np.atleast_1d(np.asarray(thresholds, dtype=float))
    if np.isnan(thresholds).any():
        raise ValueError(f"thresholds {thresholds}: NaN is not a threshold")
    if tau is not None and not tau >= 0:
        raise ValueError(f"tau = {tau}: give a synchronization threshold >= 0, or None for none")
    sorts = _by_sort(responses, units)
    if tau is None:
        return _unsynchronized(sorts, units, thresholds)
    if units.diagram is not None:
        raise ValueError(f"tau = {tau}: it needs units in Series()")
    return _synchronized(sorts, units, thresholds, tau)


def failure_of_units(
    responses: UnitResponse | Sequence[UnitResponse], units: SystemUnits, thresholds: FloatArray
) -> tuple[FloatArray, FloatArray]:
    """Probabilities (J, R) that a unit of each sort fails at each threshold, and that it works.

    What is missing from their sum is the probability of a failed run.
    """
    sorts = _by_sort(responses, units)
    above, below = _tails_of_sorts(sorts, units, thresholds)
    return above + _shares(sorts, "p_never"), below + _shares(sorts, "p_always")


def _by_sort(
    responses: UnitResponse | Sequence[UnitResponse], units: SystemUnits
) -> list[UnitResponse]:
    """Return the response of each sort (J,), without offset."""
    kinds = [responses] if isinstance(responses, UnitResponse) else list(responses)
    if len(kinds) != units.n_kinds:
        raise ValueError(f"{len(kinds)} responses for units of {units.n_kinds} kinds")
    return [kinds[kind] for kind in units.of_kinds]


def _tails_of_sorts(
    sorts: Sequence[UnitResponse], units: SystemUnits, thresholds: FloatArray
) -> tuple[FloatArray, FloatArray]:
    """Probabilities (J, R) of a finite response above each threshold, and up to it."""
    asked = units.thresholds(thresholds)
    above, below = np.empty(asked.shape), np.empty(asked.shape)
    for kind in range(units.n_kinds):
        rows = np.flatnonzero(units.of_kinds == kind)
        unit = sorts[rows[0]]
        cdf, sf = (tail.reshape(rows.size, -1) for tail in unit.tails(asked[rows].ravel()))
        above[rows], below[rows] = unit.p_finite * sf, unit.p_finite * cdf
    return above, below


def _shares(sorts: Sequence[UnitResponse], name: str) -> FloatArray:
    """A share (J, 1) of the responses of each sort."""
    return np.array([[getattr(unit, name)] for unit in sorts])


def _unsynchronized(
    sorts: Sequence[UnitResponse], units: SystemUnits, thresholds: FloatArray
) -> MissionProbability:
    above, below = _tails_of_sorts(sorts, units, thresholds)
    fails, works = above + _shares(sorts, "p_never"), below + _shares(sorts, "p_always")
    missing = _shares(sorts, "p_missing")
    high = units.mission(fails + missing, works)
    low = units.mission(fails, works + missing) if missing.any() else high
    return MissionProbability(*high, *low)


def _synchronized(
    sorts: Sequence[UnitResponse], units: SystemUnits, thresholds: FloatArray, tau: float
) -> MissionProbability:
    outside, inside = _tails_of_sorts(sorts, units, thresholds)
    outside = outside + _shares(sorts, "p_never") + _shares(sorts, "p_always")
    missing = _shares(sorts, "p_missing")
    high = units.mission(missing + outside, inside)
    # no unit with an answer: nothing is seen to fail
    low = units.mission(outside, missing + inside) if missing.any() else high
    known = any(unit.p_finite > 0.0 for unit in sorts)
    if units.count == 1 or not known or math.isinf(tau):
        return MissionProbability(*high, *low)
    ignored = np.stack([np.zeros(len(sorts)), missing[:, 0]])[: 2 if missing.any() else 1]
    largest = _Largest(sorts, units.offsets, np.array(units.counts), tau, ignored)
    stops, place = np.unique(thresholds, return_inverse=True)
    late = np.stack([high[0], low[0]][: len(ignored)])
    nobody = np.prod(ignored ** np.array(units.counts), axis=1)[:, None] * np.ones(thresholds.size)
    offset = np.empty((2, len(ignored), stops.size))
    offset[0, :, place], offset[1, :, place] = late.T, nobody.T
    total = offset + largest.atoms_up_to(stops)
    for sort, unit in enumerate(sorts):
        for measure in unit.measures:
            total = total + largest.continuous_up_to(sort, measure, stops, total)
    failure, success = complementary(*np.minimum(total, 1.0)[:, :, place])
    return MissionProbability(failure[0], success[0], failure[-1], success[-1])


def complementary(failure: FloatArray, success: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Take the larger one of a probability and its complement from the smaller one."""
    return (
        np.where(success < failure, 1.0 - success, failure),
        np.where(failure <= success, 1.0 - failure, success),
    )


@dataclass(frozen=True, eq=False)
class _Largest:
    """Probabilities of missions with known responses up to T, by their largest response s.

    `sorts`, `offsets` and `counts` (J,) are those of the units; `ignored` (I, J) is the probability
    that one of them has no answer and is left out of the mission. Results are (2, I, R): fails
    (because of tau) or works, for each row of `ignored`, for each threshold.
    """

    sorts: Sequence[UnitResponse]
    offsets: FloatArray
    counts: FloatArray
    tau: float
    ignored: FloatArray

    def continuous_up_to(
        self, sort: int, measure: Measure, thresholds: FloatArray, offset: FloatArray
    ) -> FloatArray:
        """Contribution of missions whose largest response lies in a continuous part of a sort."""
        points = measure.breakpoints
        ends = measure.at(points[[0, -1]]).y
        stops = measure.coordinate(np.clip(thresholds - self.offsets[sort], *ends))
        stops = np.maximum.accumulate(np.clip(stops, points[0], points[-1]))
        edges = np.unique(np.concatenate([points, self._kinks(sort, measure), stops]))
        rows = offset.reshape(-1, stops.size)
        found = integrals_up_to(partial(self._integrand, sort, measure), edges, stops, rows)
        return found.reshape(offset.shape)

    def _kinks(self, sort: int, measure: Measure) -> FloatArray:
        """Where the integrand is not smooth, besides the measure's own breakpoints."""
        kinks = [_body(measure) + self.tau]
        for other, unit in enumerate(self.sorts):
            shift = self.offsets[other] - self.offsets[sort]
            sharp = [unit.ends, unit.atoms[0]]
            if other != sort:
                sharp += [_body(one)[::_THINNED] for one in unit.measures]
            kinks += [places + shift + step for places in sharp for step in (0.0, self.tau)]
        every = np.concatenate(kinks)
        every = measure.coordinate(every[np.isfinite(every)])
        points = measure.breakpoints
        return np.asarray(every[(every > points[0]) & (every < points[-1])])

    def _integrand(self, sort: int, measure: Measure, x: FloatArray) -> FloatArray:
        """Values (2 I, N) at coordinates x."""
        own = measure.spread(x, self.tau)
        y = measure.at(x).y + self.offsets[sort] if len(self.sorts) > 1 else x
        around = [
            own if other == sort else unit.spread(y - self.offsets[other], self.tau)
            for other, unit in enumerate(self.sorts)
        ]
        others = self.counts - (np.arange(self.counts.size) == sort)
        finite = np.array([unit.p_finite for unit in self.sorts])[:, None]
        cdf, sf, below, within = (
            finite * np.stack([getattr(one, name) for one in around])
            for name in ("cdf", "sf", "below", "within")
        )
        weight = self.counts[sort] * finite[sort] * own.density
        values = np.empty((2, len(self.ignored), x.size))
        for row, missing in enumerate(self.ignored[:, :, None]):
            failing = 1.0 - finite - missing
            all_up_to = _Product(cdf + missing, failing + sf, others)
            near = _Product(within + missing, failing + sf + below, others)
            values[0, row] = weight * all_up_to.minus(near, below)
            values[1, row] = weight * near.value
        return values.reshape(-1, x.size)

    def atoms_up_to(self, thresholds: FloatArray) -> FloatArray:
        """Contribution of missions whose largest response is an atom."""
        shifted = [unit.atoms[0] + o for unit, o in zip(self.sorts, self.offsets, strict=True)]
        atoms = np.unique(np.concatenate(shifted))
        found = np.zeros((2, len(self.ignored), atoms.size + 1))
        if atoms.size:
            finite = np.array([unit.p_finite for unit in self.sorts])[:, None]
            masses, below, within, sf = (
                finite * np.stack(one)
                for one in zip(
                    *(
                        unit.around(atoms - o, places == atoms[:, None], self.tau)
                        for unit, o, places in zip(self.sorts, self.offsets, shifted, strict=True)
                    ),
                    strict=True,
                )
            )
            for row, missing in enumerate(self.ignored[:, :, None]):
                late, n = 1.0 - finite - missing + sf, self.counts
                up_to = _Product(missing + below + within + masses, late, n)
                before = _Product(missing + below + within, late + masses, n)
                near = _Product(missing + within + masses, late + below, n)
                nearer = _Product(missing + within, late + below + masses, n)
                # the largest is this atom, and any smaller one lies below it by more than tau
                apart = up_to.minus(near, below) - before.minus(nearer, below)
                found[0, row, 1:] = np.maximum(apart, 0.0)
                found[1, row, 1:] = near.minus(nearer, masses)
        return np.cumsum(found, axis=2)[:, :, np.searchsorted(atoms, thresholds, side="right")]


def _body(measure: Measure) -> FloatArray:
    """Responses at the breakpoints of a measure that are not far out in its tails."""
    known = measure.at(measure.breakpoints)
    return np.asarray(known.y[np.minimum(known.cdf, known.sf) > 1e-4])


class _Product(NamedTuple):
    """Probabilities (J, N) that are known together with their complements, to powers (J,)."""

    factors: FloatArray
    complements: FloatArray
    exponents: FloatArray

    @property
    def logs(self) -> FloatArray:
        """Logarithms of the factors, accurate next to 1."""
        with np.errstate(divide="ignore"):
            return np.where(
                self.complements < 0.5,
                np.log1p(-np.clip(self.complements, 0.0, 0.5)),
                np.log(np.maximum(self.factors, 0.0)),
            )

    @property
    def value(self) -> FloatArray:
        """The product (N,)."""
        return np.asarray(np.exp(self._summed(self.logs)))

    def minus(self, smaller: _Product, gaps: FloatArray) -> FloatArray:
        """Return the difference (N,) of two products; gaps (J, N) are those of their factors."""
        with np.errstate(divide="ignore", invalid="ignore"):
            shares = np.where(self.factors > 0.0, gaps / self.factors, 0.0)
            close = shares < 0.5
            apart = np.where(self.factors > 0.0, smaller.logs - self.logs, -np.inf)
            ratios = np.where(close, np.log1p(-np.where(close, shares, 0.0)), apart)
        return np.asarray(np.maximum(-np.expm1(self._summed(ratios)) * self.value, 0.0))

    def _summed(self, logs: FloatArray) -> FloatArray:
        """Sum over factors; what is raised to the power 0 does not count, even if it is 0."""
        used = self.exponents > 0
        return np.asarray(self.exponents[used] @ logs[used])
