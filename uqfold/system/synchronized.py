"""One mission of n exchangeable units: in series all fast enough, and close to each other.

Without a synchronization threshold tau any structure is answered by `uqfold.system.structure`.

With H the distribution function of one unit's response, h its density, S = 1 - H, a mission works
if max <= T and max - min <= tau. By conditioning on the largest response s,

    works = n int_{-inf}^{T} h(s) [H(s) - H(s - tau)]^(n-1) ds
    fails = 1 - H(T)^n + n int_{-inf}^{T} h(s) { H(s)^(n-1) - [H(s) - H(s - tau)]^(n-1) } ds

Both integrands are positive and know nothing of T, so that neither number is ever formed as one
minus the other, and one integration answers all thresholds. The difference of powers x^k - y^k is
formed from x - y = H(s - tau), at the same cost for any number of units. An atom of mass p at s
adds the same with n h ds X^(n-1) replaced by (X + p)^n - X^n, where X leaves out the atom.
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
    unit: UnitResponse, units: SystemUnits | int, thresholds: FloatArray, tau: float | None
) -> MissionProbability:
    """Probability that one mission of exchangeable, independent units fails, and that it works.

    Parameters
    ----------
    unit
        Response of each unit.
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
        For units < 1, a NaN threshold, a negative or NaN tau, or tau with units
        that differ or may fail.
    TypeError
        If tau is given and a distribution has no density to integrate over.
    """
    units = SystemUnits.of(units)
    thresholds = np.atleast_1d(np.asarray(thresholds, dtype=float))
    if np.isnan(thresholds).any():
        raise ValueError(f"thresholds {thresholds}: NaN is not a threshold")
    if tau is not None and not tau >= 0:
        raise ValueError(f"tau = {tau}: give a synchronization threshold >= 0, or None for none")
    if tau is None:
        return _unsynchronized(unit, units, thresholds)
    if units.diagram is not None or not units.equal:
        raise ValueError(f"tau = {tau}: it needs equal units in Series()")
    return _synchronized(unit, units, thresholds, tau)


def failure_of_units(
    unit: UnitResponse, units: SystemUnits, thresholds: FloatArray
) -> tuple[FloatArray, FloatArray]:
    """Probabilities (J, R) that a unit of each offset fails at each threshold, and that it works.

    What is missing from their sum is the probability of a failed run.
    """
    asked = units.thresholds(thresholds)
    cdf, sf = (tail.reshape(asked.shape) for tail in unit.tails(asked.ravel()))
    return unit.p_never + unit.p_finite * sf, unit.p_always + unit.p_finite * cdf


def _unsynchronized(
    unit: UnitResponse, units: SystemUnits, thresholds: FloatArray
) -> MissionProbability:
    fails, works = failure_of_units(unit, units, thresholds)
    high = units.mission(fails + unit.p_missing, works)
    low = units.mission(fails, works + unit.p_missing) if unit.p_missing > 0 else high
    return MissionProbability(*high, *low)


def _synchronized(
    unit: UnitResponse, units: SystemUnits, thresholds: FloatArray, tau: float
) -> MissionProbability:
    bad, missing = unit.p_never + unit.p_always, unit.p_missing
    cdf, sf = unit.tails(thresholds)
    inside, outside = unit.p_finite * cdf, unit.p_finite * sf
    high = units.mission((bad + missing + outside)[None], inside[None])
    # no unit with an answer: nothing is seen to fail
    low = high
    if missing > 0:
        low = units.mission((bad + outside)[None], (missing + inside)[None])
    if units.count == 1 or unit.p_finite == 0.0 or math.isinf(tau):
        return MissionProbability(*high, *low)
    ignored = [0.0, missing] if missing > 0 else [0.0]
    largest = _Largest(unit, units.count, tau, ignored)
    stops, place = np.unique(thresholds, return_inverse=True)
    late = np.stack([high[0], low[0]][: len(ignored)])
    nobody = np.array(ignored)[:, None] ** units.count * np.ones(thresholds.size)
    offset = np.empty((2, len(ignored), stops.size))
    offset[0, :, place], offset[1, :, place] = late.T, nobody.T
    total = offset + largest.atoms_up_to(stops)
    for measure in unit.measures:
        total = total + largest.continuous_up_to(measure, stops, total)
    failure, success = complementary(*np.minimum(total, 1.0)[:, :, place])
    return MissionProbability(failure[0], success[0], failure[-1], success[-1])


def complementary(failure: FloatArray, success: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Take the larger one of a probability and its complement from the smaller one."""
    return (
        np.where(success < failure, 1.0 - success, failure),
        np.where(failure <= success, 1.0 - failure, success),
    )


@dataclass(frozen=True)
class _Largest:
    """Probabilities of missions with known responses up to T, by their largest response s.

    `ignored` is the probability that a unit has no answer and is left out of the mission; results
    are (2, I, R): fails (because of tau) or works, for each such probability, for each threshold.
    """

    unit: UnitResponse
    units: int
    tau: float
    ignored: Sequence[float]

    def continuous_up_to(
        self, measure: Measure, thresholds: FloatArray, offset: FloatArray
    ) -> FloatArray:
        """Contribution of missions whose largest response lies in a continuous part."""
        points = measure.breakpoints
        ends = measure.at(points[[0, -1]]).y
        stops = measure.coordinate(np.clip(thresholds, *ends))
        stops = np.maximum.accumulate(np.clip(stops, points[0], points[-1]))
        edges = np.unique(np.concatenate([points, self._kinks(measure), stops]))
        rows = offset.reshape(-1, stops.size)
        found = integrals_up_to(partial(self._integrand, measure), edges, stops, rows)
        return found.reshape(offset.shape)

    def _kinks(self, measure: Measure) -> FloatArray:
        """Where the integrand is not smooth, besides the measure's own breakpoints."""
        points = measure.breakpoints
        known = measure.at(points)
        body = known.y[np.minimum(known.cdf, known.sf) > 1e-4]
        atoms, ends = self.unit.atoms[0], self.unit.ends
        kinks = np.concatenate([ends, ends + self.tau, atoms, atoms + self.tau, body + self.tau])
        kinks = measure.coordinate(kinks[np.isfinite(kinks)])
        return np.asarray(kinks[(kinks > points[0]) & (kinks < points[-1])])

    def _integrand(self, measure: Measure, x: FloatArray) -> FloatArray:
        """Values (2 I, N) at coordinates x."""
        finite = self.unit.p_finite
        density, cdf, sf, below, within = measure.spread(x, self.tau)
        weight = self.units * finite * density
        values = np.empty((2, len(self.ignored), x.size))
        for row, ignored in enumerate(self.ignored):
            failing = 1.0 - finite - ignored
            all_up_to = _Power(finite * cdf + ignored, failing + finite * sf)
            near = _Power(finite * within + ignored, failing + finite * (sf + below))
            values[0, row] = weight * all_up_to.minus(near, finite * below, self.units - 1)
            values[1, row] = weight * near.to(self.units - 1)
        return values.reshape(-1, x.size)

    def atoms_up_to(self, thresholds: FloatArray) -> FloatArray:
        """Contribution of missions whose largest response is an atom."""
        atoms, masses = self.unit.atoms
        found = np.zeros((2, len(self.ignored), atoms.size + 1))
        if atoms.size:
            finite, n = self.unit.p_finite, self.units
            below, within = self.unit.around_atoms(self.tau)
            _, sf = self.unit.tails(atoms)
            masses, below, within = finite * masses, finite * below, finite * within
            for row, ignored in enumerate(self.ignored):
                late = 1.0 - finite - ignored + finite * sf
                up_to = _Power(ignored + below + within + masses, late)
                before = _Power(ignored + below + within, late + masses)
                near = _Power(ignored + within + masses, late + below)
                nearer = _Power(ignored + within, late + below + masses)
                # the largest is this atom, and any smaller one lies below it by more than tau
                apart = up_to.minus(near, below, n) - before.minus(nearer, below, n)
                found[0, row, 1:] = np.maximum(apart, 0.0)
                found[1, row, 1:] = near.minus(nearer, masses, n)
        return np.cumsum(found, axis=2)[:, :, np.searchsorted(atoms, thresholds, side="right")]


class _Power(NamedTuple):
    """Powers of probabilities that are known together with their complements."""

    value: FloatArray
    complement: FloatArray

    def to(self, exponent: int) -> FloatArray:
        """Raise the value to a power, accurate next to 1 for any exponent."""
        with np.errstate(divide="ignore"):
            log = np.where(
                self.complement < 0.5,
                np.log1p(-np.clip(self.complement, 0.0, 0.5)),
                np.log(np.maximum(self.value, 0.0)),
            )
        return np.asarray(np.exp(exponent * log))

    def minus(self, smaller: _Power, gap: FloatArray, exponent: int) -> FloatArray:
        """Return value ** exponent - smaller ** exponent; gap is the difference of the values."""
        with np.errstate(divide="ignore", invalid="ignore"):
            share = np.where(self.value > 0.0, gap / self.value, 0.0)
        close = share < 0.5
        lost = np.where(close, -np.expm1(exponent * np.log1p(-np.where(close, share, 0.0))), 1.0)
        whole = self.to(exponent)
        return np.where(close, whole * lost, np.maximum(whole - smaller.to(exponent), 0.0))
