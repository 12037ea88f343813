"""One mission of n exchangeable units: all fast enough, and close enough to each other.

With H the distribution function of one unit's response, h its density, S = 1 - H, a mission works
if max <= T and max - min <= tau. By conditioning on the smallest response t,

    works = n int_{-inf}^{T} h(t) [H(min(t + tau, T)) - H(t)]^(n-1) dt
    fails = 1 - H(T)^n
          + n int_{-inf}^{T-tau} h(t) { [H(T) - H(t)]^(n-1) - [H(t + tau) - H(t)]^(n-1) } dt

The braces are (A - B) sum_i A^i B^(n-2-i) with A - B = S(t + tau) - S(T): positive throughout, so
neither number is ever formed as one minus the other. An atom of mass p at t adds the same with
n h dt X^(n-1) replaced by (X + p)^n - X^n.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from uqfold.moments.panels import integrate
from uqfold.system.conditional_unit import Measure, UnitResponse
from uqfold.typing import BoolArray, FloatArray


@dataclass(frozen=True)
class MissionProbability:
    """Failure and success of one mission at R thresholds, arrays (R,).

    Attributes
    ----------
    failure, success
        With failed model runs counted as failing.
    failure_low, success_low
        With failed model runs ignored: a unit without an answer is left out of the mission.
    """

    failure: FloatArray
    success: FloatArray
    failure_low: FloatArray
    success_low: FloatArray


def mission_probability(
    unit: UnitResponse, units: int, thresholds: FloatArray, tau: float | None
) -> MissionProbability:
    """Probability that one mission of exchangeable, independent units fails, and that it works.

    Parameters
    ----------
    unit
        Response of each unit.
    units
        Number of units, n >= 1.
    thresholds : array (R,)
        Response thresholds T (unit of the response); +-inf allowed.
    tau
        Synchronization threshold >= 0 (unit of the response); None: no such threshold.
        With inf, any finite difference is small enough.

    Raises
    ------
    ValueError
        For units < 1, a NaN threshold, or a negative or NaN tau.
    TypeError
        If tau is given and a distribution has no density to integrate over.
    """
    if units < 1:
        raise ValueError(f"units = {units}: a system needs at least one unit")
    thresholds = np.atleast_1d(np.asarray(thresholds, dtype=float))
    if np.isnan(thresholds).any():
        raise ValueError(f"thresholds {thresholds}: NaN is no threshold")
    if tau is not None and not tau >= 0:
        raise ValueError(f"tau = {tau}: give a synchronization threshold >= 0, or None for none")
    if tau is None:
        return _unsynchronized(unit, units, thresholds)
    return _synchronized(unit, units, thresholds, tau)


def _unsynchronized(unit: UnitResponse, units: int, thresholds: FloatArray) -> MissionProbability:
    cdf, sf = unit.tails(thresholds)
    fails = unit.p_never + unit.p_finite * sf
    works = unit.p_always + unit.p_finite * cdf
    high = _all_work(fails + unit.p_missing, works, units)
    low = _all_work(fails, works + unit.p_missing, units) if unit.p_missing > 0 else high
    return MissionProbability(*high, *low)


def _all_work(fails: FloatArray, works: FloatArray, units: int) -> tuple[FloatArray, FloatArray]:
    """(failure, success) of `units` units that must all work."""
    with np.errstate(divide="ignore"):
        log_works = np.where(fails < 0.5, np.log1p(-np.minimum(fails, 0.5)), np.log(works))
    return -np.expm1(units * log_works), np.exp(units * log_works)


def _synchronized(
    unit: UnitResponse, units: int, thresholds: FloatArray, tau: float
) -> MissionProbability:
    shape = thresholds.shape
    counts = [units] if unit.p_missing == 0 else list(range(1, units + 1))
    finite = finite_units(unit, counts, thresholds, tau)
    bad = unit.p_never + unit.p_always
    high = _with_bad(*finite[units], bad + unit.p_missing, units)
    if unit.p_missing == 0:
        return MissionProbability(*high, *high)
    # How many units have a known answer is binomial; none: nothing is seen to fail.
    known = max(0.0, 1.0 - unit.p_missing)
    failure, success = np.zeros(shape), np.full(shape, unit.p_missing**units)
    if known > 0:
        for count in counts:
            share = math.comb(units, count) * known**count * unit.p_missing ** (units - count)
            fails, works = _with_bad(*finite[count], min(1.0, bad / known), count)
            failure, success = failure + share * fails, success + share * works
    return MissionProbability(*high, failure, success)


def _with_bad(
    failure: FloatArray, success: FloatArray, bad: float, units: int
) -> tuple[FloatArray, FloatArray]:
    """Let each unit also be bad with a given probability, which alone fails the mission."""
    if bad >= 1.0:
        return np.ones(failure.shape), np.zeros(success.shape)
    log_good = units * math.log1p(-bad)
    return -math.expm1(log_good) + math.exp(log_good) * failure, math.exp(log_good) * success


def finite_units(
    unit: UnitResponse, counts: Sequence[int], thresholds: FloatArray, tau: float
) -> dict[int, tuple[FloatArray, FloatArray]]:
    """(failure, success) (R,) each, of missions of `counts` units with finite responses."""
    cdf, sf = unit.tails(thresholds)
    results = {n: _all_work(sf, cdf, n) for n in counts}
    several = [n for n in counts if n > 1]
    if not several or unit.p_finite == 0 or math.isinf(tau):
        return results
    rows = _Rows(unit, several, thresholds, cdf, sf, tau)
    exceeds = np.stack([results[n][0] for n in several])
    offset = np.stack([exceeds, np.zeros_like(exceeds)])
    total = rows.from_atoms()
    for measure in unit.measures:
        total = total + integrate(
            lambda x, measure=measure: rows.integrand(measure, x),  # type: ignore[misc]
            rows.edges(measure),
            (offset + total).ravel(),
        ).reshape(total.shape)
    for index, n in enumerate(several):
        results[n] = exceeds[index] + total[0, index], total[1, index]
    return results


@dataclass(frozen=True)
class _Rows:
    """Integrands for all (fails or works, number of units, threshold) at once: (2, C, R)."""

    unit: UnitResponse
    counts: list[int]
    thresholds: FloatArray
    cdf: FloatArray
    sf: FloatArray
    tau: float

    def edges(self, measure: Measure) -> FloatArray:
        """Panel edges: the measure's own, and every place where an integrand has a kink."""
        points = measure.breakpoints
        known = measure.at(points)
        body = known.y[np.minimum(known.cdf, known.sf) > 1e-4]
        kinks = np.concatenate(
            [self.thresholds, self.thresholds - self.tau, self.unit.ends, self.unit.ends - self.tau]
        )
        atoms = self.unit.atoms[0]
        kinks = np.concatenate([kinks, body - self.tau, atoms, atoms - self.tau])
        kinks = measure.coordinate(kinks[np.isfinite(kinks)])
        inside = kinks[(kinks > points[0]) & (kinks < points[-1])]
        last = float(measure.coordinate(np.max(self.thresholds)))
        edges = np.unique(np.concatenate([points, inside]))
        return edges[edges <= last] if last < edges[-1] else edges

    def integrand(self, measure: Measure, x: FloatArray) -> FloatArray:
        """Values (2 C R, N) at coordinates x."""
        y, density, cdf, sf = measure.at(x)
        before, longest, window, gap = self._pieces(y, cdf, sf)
        works = np.where(before, window, longest)
        inside = y < self.thresholds[:, None]
        values = np.empty((2, len(self.counts), *inside.shape))
        for index, n in enumerate(self.counts):
            weight = n * density
            values[0, index] = np.where(before, weight * gap * _powers(longest, window, n - 2), 0.0)
            values[1, index] = np.where(inside, weight * works ** (n - 1), 0.0)
        return values.reshape(-1, x.size)

    def from_atoms(self) -> FloatArray:
        """Contribution (2, C, R) of missions whose smallest response is an atom."""
        atoms, masses = self.unit.atoms
        total = np.zeros((2, len(self.counts), self.thresholds.size))
        if atoms.size == 0:
            return total
        before, longest, window, gap = self._pieces(atoms, *self.unit.tails(atoms))
        works = np.where(before, window, longest)
        inside = atoms <= self.thresholds[:, None]
        for index, n in enumerate(self.counts):
            fails = sum(
                math.comb(n, i) * masses**i * _powers(longest, window, n - 1 - i)
                for i in range(1, n)
            )
            total[0, index] = np.where(before, gap * fails, 0.0).sum(axis=1)
            both = masses * _powers(works + masses, works, n - 1)
            total[1, index] = np.where(inside, both, 0.0).sum(axis=1)
        return total

    def _pieces(
        self, y: FloatArray, cdf: FloatArray, sf: FloatArray
    ) -> tuple[BoolArray, FloatArray, FloatArray, FloatArray]:
        """Where y + tau < T; H(T) - H(y), H(y + tau) - H(y) (this one (N,)), H(T) - H(y + tau).

        Each difference is taken in the tail in which its larger end is small.
        """
        cdf_later, sf_later = self.unit.tails(y + self.tau)
        window = np.where(cdf_later > 0.5, sf - sf_later, cdf_later - cdf)
        upper = (self.cdf > 0.5)[:, None]
        level = np.where(upper, -self.sf[:, None], self.cdf[:, None])
        longest = np.where(upper, sf, -cdf) + level
        gap = np.where(upper, sf_later, -cdf_later) + level
        before = y < (self.thresholds - self.tau)[:, None]
        return (
            before,
            np.maximum(longest, 0.0),
            np.maximum(window, 0.0),
            np.maximum(gap, 0.0),
        )


def _powers(x: FloatArray, y: FloatArray, degree: int) -> FloatArray:
    """sum_{i=0}^{degree} x^i y^(degree-i), that is (x^(degree+1) - y^(degree+1)) / (x - y)."""
    total = np.ones(np.broadcast_shapes(np.shape(x), np.shape(y)))
    power = np.ones(np.shape(y))
    for _ in range(degree):
        power = power * y
        total = total * x + power
    return total
