"""Distribution of a cheap function of standard-normal variables, by integration along lines.

Lines run in one direction a; a rule over the space orthogonal to it says where. Along a line, all
crossings of a level t are found, and the probability of the line's parts above and below t is a
difference of normal probabilities: exact in the tails, whether the function is monotone or not,
and whether failure lies at one end of the line, at both, or in between.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, field, replace
from functools import cache, cached_property

import numpy as np

from uqfold.moments.conditional import AtomicDistribution
from uqfold.moments.normal import NormalDistribution
from uqfold.moments.tabulated import TabulatedDistribution
from uqfold.system.conditional_response import ConditionalResponse
from uqfold.time_limit import check_time
from uqfold.typing import BoolArray, FloatArray, IntArray

REACH = 8.5
"""Lines end at this many standard deviations, where 1e-17 of the probability is left."""

FINITE, NEVER, ALWAYS, MISSING = 0, 1, 2, 3
"""Outcomes at a point: a finite response, +inf, -inf, and a failed run."""

Distribution = TabulatedDistribution | AtomicDistribution | NormalDistribution

_REFINED = 16
# Scores at which tables aim; beyond 8, fewer than 1e-15 of all responses lie.
_TARGETS, _FEW_TARGETS = np.linspace(-8.0, 8.0, 97), np.linspace(-8.0, 8.0, 33)
_SMALLEST_STEP = 1e-7
# Numbers held at once.
_MOST_NUMBERS = 2_000_000
# Noise below this share of a table's unit moves no score up to 8 by more than 4e-6.
_NEGLIGIBLE_NOISE = 1e-3


@dataclass(frozen=True, eq=False)
class LineRule:
    """Lines in standard-normal space of d variables.

    Attributes
    ----------
    points
        All points (lines * stations, d) at which the function is needed, line by line.
    weights
        Probability (lines,) that each line stands for.
    stations
        Positions (stations,) along every line, equally spaced from -REACH to REACH, or from 0 to
        `radial_reach` along rays.
    short
        Whether tables of a third of the usual length will do.
    asked
        Thresholds (T,) that tables hold exactly, without interpolation.
    radial
        Number of variables if these are rays from the origin, along which the radius has the chi
        distribution; 0 for lines.
    sampled
        Whether lines were drawn at random, with weights whose expected sum is 1.
    """

    points: FloatArray
    weights: FloatArray
    stations: FloatArray
    short: bool = False
    asked: FloatArray = field(default_factory=lambda: np.empty(0))
    radial: int = 0
    sampled: bool = False

    @classmethod
    def point(cls) -> LineRule:
        """The rule over no variables at all."""
        return cls(np.empty((1, 0)), np.ones(1), np.zeros(1))

    def every(self, step: int, first: int) -> LineRule:
        """The rule of every step-th line alone, from the first on; for lines drawn at random."""
        some = slice(first, None, step)
        d = self.points.shape[1]
        points = self.points.reshape(self.weights.size, self.stations.size, d)[some]
        share = self.weights.size / points.shape[0]
        return replace(self, points=points.reshape(-1, d), weights=share * self.weights[some])

    def thinned(self) -> LineRule:
        """The same lines with every second station, of which there is an odd number."""
        d = self.points.shape[1]
        points = self.points.reshape(self.weights.size, self.stations.size, d)[:, ::2]
        stations = self.stations[::2]
        size = self.weights.size * stations.size
        return replace(self, points=points.reshape(size, d), stations=stations)

    def _mass(self, low: FloatArray, high: FloatArray) -> FloatArray:
        """Probability of a part of a line."""
        return self._tails(low).up_to(self._tails(high))

    def _tails(self, edge: FloatArray) -> _Tails:
        return _Tails.radial(self.radial, edge) if self.radial else _Tails.normal(edge)

    def response(
        self, values: FloatArray, outcomes: IntArray | None = None, noise: float = 0.0
    ) -> ConditionalResponse:
        """Distribution of the function, from its values at the points.

        Parameters
        ----------
        values
            Finite values (lines * stations,); where the outcome is not finite, any finite number.
        outcomes
            Kind of outcome at each point (`FINITE`, `NEVER`, `ALWAYS`, `MISSING`); None: all
            are finite.
        noise
            Standard deviation of an independent normal disturbance of every response.

        Raises
        ------
        ValueError
            If a value is not finite.
        """
        check_time()
        table = values.reshape(self.weights.size, self.stations.size)
        if not np.isfinite(table).all():
            raise ValueError("a response surface gave values that are not finite")
        unit, upsample = _refinement(self.stations.size)
        fine = self.stations[0] + (self.stations[-1] - self.stations[0]) * unit
        usable, masses = None, np.zeros(4)
        if outcomes is not None and outcomes.any():
            nearest = (np.arange(fine.size) + _REFINED // 2) // _REFINED
            kinds = outcomes.reshape(table.shape)[:, nearest]
            cells = self._mass(*_cells(fine))
            weights = self.weights / self.weights.sum()
            masses = np.array([weights @ (kinds == kind) @ cells for kind in range(4)])
            usable = kinds == FINITE
            if not usable.any():
                return _without_distribution(masses)
        found = self._distribution(table, upsample, fine, usable)
        return ConditionalResponse(
            _disturbed(found, noise),
            p_never=float(masses[NEVER]),
            p_always=float(masses[ALWAYS]),
            p_missing=float(masses[MISSING]),
        )

    def tails(
        self,
        values: FloatArray,
        levels: FloatArray,
        outcomes: IntArray | None = None,
        noise: float = 0.0,
    ) -> tuple[FloatArray, FloatArray]:
        """Probability (K, T) up to levels and above them, at once for K functions.

        Parameters
        ----------
        values, outcomes
            Of each function at the points (K, lines * stations), as in `response`. A failed run
            counts as one above all levels.
        levels
            The levels (T,).
        noise
            As in `response`; a function counts as a normal variable there.
        """
        if not np.isfinite(values).all():
            raise ValueError("a response surface gave values that are not finite")
        if self.stations.size == 1:
            return self._tails_of_points(values[:, 0], levels, outcomes, noise)
        asked, place = np.unique(levels, return_inverse=True)
        unit, upsample = _refinement(self.stations.size)
        fine = self.stations[0] + (self.stations[-1] - self.stations[0]) * unit
        nearest = (np.arange(fine.size) + _REFINED // 2) // _REFINED
        cells = self._mass(*_cells(fine))
        found = np.empty((2, len(values), asked.size))
        block = max(1, _MOST_NUMBERS // (fine.size * self.weights.size))
        for start in range(0, len(values), block):
            check_time()
            some = slice(start, start + block)
            table = values[some].reshape(-1, self.stations.size)
            usable, kinds = None, None
            if outcomes is not None:
                kinds = outcomes[some].reshape(table.shape)[:, nearest]
                usable = kinds == FINITE
            for side, masses in enumerate(self._masses(table @ upsample.T, fine, asked, usable)):
                whole = masses
                if kinds is not None:
                    beyond = [kinds == ALWAYS, (kinds == NEVER) | (kinds == MISSING)][side]
                    whole = masses + (beyond @ cells)[:, None]
                each = whole.reshape(-1, self.weights.size, asked.size)
                found[side, some] = np.tensordot(each, self.weights, axes=(1, 0))
        found /= np.maximum(found.sum(axis=0), 1e-300)
        if noise > 0.0:
            density = np.exp(-0.5 * self.stations**2)
            weights = np.outer(self.weights, density / density.sum()).ravel()
            mean = values @ weights
            std = np.sqrt(np.maximum((values - mean[:, None]) ** 2 @ weights, 1e-300))
            found = _less_certain(found, 1.0 / np.sqrt(1.0 + (noise / std) ** 2))
        return found[0][:, place], found[1][:, place]

    def _tails_of_points(
        self, values: FloatArray, levels: FloatArray, outcomes: IntArray | None, noise: float
    ) -> tuple[FloatArray, FloatArray]:
        """The same where there is one point and nothing to integrate over."""
        from scipy.special import ndtr

        beyond = values[:, None] - levels
        if noise > 0.0:
            up_to, above = ndtr(-beyond / noise), ndtr(beyond / noise)
        else:
            above = (beyond > 0.0).astype(float)
            up_to = 1.0 - above
        if outcomes is None:
            return up_to, above
        finite, always = outcomes == FINITE, outcomes == ALWAYS
        return (
            np.where(finite, up_to, always.astype(float)),
            np.where(finite, above, 1.0 - always),
        )

    def _distribution(
        self, table: FloatArray, upsample: FloatArray, fine: FloatArray, usable: BoolArray | None
    ) -> TabulatedDistribution | AtomicDistribution:
        low, high = float(table.min()), float(table.max())
        if high - low <= 1e-13 * max(abs(low), abs(high)):
            return AtomicDistribution((0.5 * (low + high) if high > low else low,))
        levels = self._levels(table)
        below, above = self._masses(table @ upsample.T, fine, levels, usable)
        return _tabulated(levels, self._mean(below), self._mean(above))

    def _masses(
        self, curves: FloatArray, s: FloatArray, levels: FloatArray, usable: BoolArray | None
    ) -> tuple[FloatArray, FloatArray]:
        """Probability (lines, L) below and above the levels (L,) on curves over positions s.

        What a curve is at a place in the middle holds all along the line, but for the tail beyond
        each crossing, on the side away from the middle; the tail is exact however small it is.
        """
        count, middle = levels.size, int(np.argmax(self._tails(s).far))
        # how many levels lie below the curve
        rank = np.searchsorted(levels, curves)
        step = np.diff(rank, axis=1)
        if usable is not None:
            step[~(usable[:, 1:] & usable[:, :-1])] = 0
        line, cell = np.nonzero(step)
        rise = step[line, cell]
        crossed = np.abs(rise)
        each = np.repeat(np.arange(line.size), crossed)
        first = np.minimum(rank[line, cell], rank[line, cell + 1])
        level = (
            first[each] + np.arange(each.size) - np.repeat(np.cumsum(crossed) - crossed, crossed)
        )
        start, end = curves[line, cell][each], curves[line, cell + 1][each]
        at = s[cell][each] + (levels[level] - start) / (end - start) * (s[1] - s[0])
        tail = np.sign(rise)[each] * self._signed(at, cell[each] >= middle)
        place, shape = line[each] * count + level, (curves.shape[0], count)
        moved = np.bincount(place, tail, math.prod(shape)).reshape(shape)
        over = rank[:, middle, None] > np.arange(count)
        below, above = np.where(over, -moved, 1.0 - moved), np.where(over, 1.0 + moved, moved)
        if usable is not None:
            below, above = self._with_gaps(below, above, rank, usable, s, middle)
        return np.maximum(below, 0.0), np.maximum(above, 0.0)

    def _with_gaps(
        self,
        below: FloatArray,
        above: FloatArray,
        rank: IntArray,
        usable: BoolArray,
        s: FloatArray,
        middle: int,
    ) -> tuple[FloatArray, FloatArray]:
        """Take away the probability of gaps, which end half way between two positions."""
        gone = ~usable[:, middle, None]
        over = rank[:, middle, None] > np.arange(below.shape[1])
        below, above = below - (gone & ~over), above - (gone & over)
        line, cell = np.nonzero(usable[:, 1:] != usable[:, :-1])
        opens = usable[line, cell + 1]
        tail = self._signed(0.5 * (s[cell] + s[cell + 1]), cell >= middle)
        shape = below.shape[0], below.shape[1] + 1
        place = line * shape[1] + rank[line, cell + opens]
        edges = np.bincount(place, np.where(opens, tail, -tail), math.prod(shape)).reshape(shape)
        below = below + np.cumsum(edges, axis=1)[:, :-1]
        return below, above + np.cumsum(edges[:, ::-1], axis=1)[:, -2::-1]

    def _signed(self, edge: FloatArray, beyond: BoolArray) -> FloatArray:
        """Return the tail above edges beyond the middle, and minus the one below the others."""
        tails = self._tails(edge)
        return np.where(beyond, tails.above, -tails.below)

    def _mean(self, masses: FloatArray) -> FloatArray:
        """Mean (L,) over all lines of masses (lines, L)."""
        if self.sampled:
            return weighted_mean(self.weights, masses)
        return np.asarray(self.weights @ masses)

    @cached_property
    def _point_masses(self) -> FloatArray:
        """Probability (lines * stations,) that each point stands for."""
        density = self._mass(*_cells(self.stations))
        return np.outer(self.weights / self.weights.sum(), density / density.sum()).ravel()

    def _levels(self, table: FloatArray) -> FloatArray:
        """Levels that lie about evenly in normal score, from the values at the points alone."""
        mass = self._point_masses
        order = np.argsort(table, axis=None)
        value, mass = table.ravel()[order], mass[order]
        below = np.cumsum(mass) - 0.5 * mass
        above = np.cumsum(mass[::-1])[::-1] - 0.5 * mass
        score = _normal_score(below, np.maximum(above, 1e-300))
        targets = _FEW_TARGETS if self.short else _TARGETS
        spread = np.interp(targets, np.maximum.accumulate(score), value)
        asked = self.asked[(self.asked > spread[0]) & (self.asked < spread[-1])]
        levels = np.concatenate([asked, spread])
        order = np.argsort(levels, kind="stable")
        # of levels that nearly coincide one is enough, an asked one rather than another
        found = levels[order]
        apart = np.append(True, found[1:] - found[:-1] > _SMALLEST_STEP * np.ptp(spread))
        if apart.all():
            return found
        group = np.cumsum(apart) - 1
        first = np.full(group[-1] + 1, levels.size)
        np.minimum.at(first, group, order)
        return np.asarray(levels[first])


def weighted_mean(weights: FloatArray, masses: FloatArray) -> FloatArray:
    """Mean (L,) of masses (n, L) with random weights (n,), whose expected sum is 1."""
    count = weights.size
    weight = count * weights
    parts = weight[:, None] * masses
    # the mean weight is known to be 1: a control variate
    off = weight - weight.mean()
    square = float(off @ off)
    slope = off @ parts / square if square > 0.0 else 0.0
    corrected = parts.mean(axis=0) - slope * (weight.mean() - 1.0)
    return np.asarray(np.maximum(corrected, 0.0))


def _cells(s: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Ends of the cells around the positions s; the outer ones are infinite."""
    middle = 0.5 * (s[1:] + s[:-1])
    return np.concatenate([[-np.inf], middle]), np.concatenate([middle, [np.inf]])


@dataclass(frozen=True, eq=False)
class _Tails:
    """Probability `below` and `above` edges; the one above is the smaller where they are `far`."""

    below: FloatArray
    above: FloatArray
    far: BoolArray

    @classmethod
    def of(cls, smaller: FloatArray, far: BoolArray) -> _Tails:
        """Complete the smaller of both probabilities, the one above where edges are far."""
        return cls(
            np.where(far, 1.0 - smaller, smaller), np.where(far, smaller, 1.0 - smaller), far
        )

    @classmethod
    def normal(cls, edge: FloatArray) -> _Tails:
        """Return those of a standard-normal variable."""
        from scipy.special import ndtr

        return cls.of(ndtr(-np.abs(edge)), edge > 0.0)

    @classmethod
    def radial(cls, d: int, edge: FloatArray) -> _Tails:
        """Return those of the distance from the origin of d normal variables."""
        from scipy.special import gammainc, gammaincc

        half = 0.5 * np.maximum(edge, 0.0) ** 2
        far = half > 0.5 * d
        smaller = np.empty(half.shape)
        smaller[far] = gammaincc(0.5 * d, half[far])
        smaller[~far] = gammainc(0.5 * d, half[~far])
        return cls.of(smaller, far)

    def up_to(self, other: _Tails) -> FloatArray:
        """Probability from these edges to others, from the tail in which it is small."""
        above, below = self.above - other.above, other.below - self.below
        return np.asarray(np.where(self.far, above, below))


def line_masses(table: FloatArray, threshold: float) -> FloatArray:
    """Return the probability (n,) of values above a threshold along lines, roughly.

    Parameters
    ----------
    table
        Values (K, n, stations) of K functions at equally spaced stations from -REACH to REACH,
        whose mean is taken.
    threshold
        The threshold.
    """
    unit, upsample = _refinement(table.shape[2])
    low, high = _cells(REACH * (2.0 * unit - 1.0))
    cells = _Tails.normal(low).up_to(_Tails.normal(high))
    return np.asarray(np.mean([(one @ upsample.T > threshold) @ cells for one in table], axis=0))


def radial_mass(d: int, low: FloatArray, high: FloatArray) -> FloatArray:
    """Probability that the distance from the origin of d normal variables lies in [low, high]."""
    return _Tails.radial(d, low).up_to(_Tails.radial(d, high))


@cache
def radial_reach(d: int) -> float:
    """Distance from the origin beyond which 1e-17 of the probability of d variables is left."""
    from scipy.special import gammainccinv

    return float(np.sqrt(2.0 * gammainccinv(0.5 * d, 1e-17)))


@cache
def _refinement(stations: int) -> tuple[FloatArray, FloatArray]:
    """Fine positions in [0, 1] and the matrix of the cubic spline that gives values there."""
    from scipy.interpolate import CubicSpline

    coarse = np.linspace(0.0, 1.0, stations)
    fine = np.linspace(0.0, 1.0, _REFINED * (stations - 1) + 1)
    return fine, CubicSpline(coarse, np.eye(stations))(fine)


def _normal_score(below: FloatArray, above: FloatArray) -> FloatArray:
    """Phi^-1(P(Y <= y)) from the smaller of both tails."""
    from scipy.special import ndtri

    lower = below < above
    score = ndtri(np.where(lower, below, above))
    return np.asarray(np.where(lower, score, -score))


def _tabulated(
    levels: FloatArray, below: FloatArray, above: FloatArray
) -> TabulatedDistribution | AtomicDistribution:
    """Table of normal scores, without levels between which hardly any probability lies."""
    # parts so far out that they hold no probability at all say nothing
    whole = np.maximum(below + above, 1e-300)
    below, above = below / whole, above / whole
    score = _normal_score(below, above)
    some = np.flatnonzero(np.minimum(below, above) > 1e-16)
    kept: list[int] = some.tolist()
    if not (score[some][1:] - score[some][:-1] > _SMALLEST_STEP).all():
        kept = kept[:1]
        for index in some[1:].tolist():
            if score[index] > score[kept[-1]] + _SMALLEST_STEP:
                kept.append(index)
    if len(kept) < 2:
        middle = min(int(np.searchsorted(below, 0.5)), levels.size - 1)
        return AtomicDistribution((float(levels[middle]),))
    return TabulatedDistribution(levels[kept], score[kept])


def _disturbed(
    distribution: TabulatedDistribution | AtomicDistribution, noise: float
) -> Distribution:
    """Distribution of the sum with an independent normal variable of standard deviation `noise`."""
    if isinstance(distribution, AtomicDistribution):
        return NormalDistribution(distribution.values[0], noise) if noise > 0.0 else distribution
    if noise <= _NEGLIGIBLE_NOISE * _unit(distribution):
        return distribution
    # to second order in the noise, which for a normal response is exact
    levels, score = distribution.levels, distribution.scores
    slope = np.gradient(score, levels)
    bend = np.gradient(slope, levels)
    moved = (score + 0.5 * bend * noise**2) / np.sqrt(1.0 + (slope * noise) ** 2)
    if not (np.diff(moved) > 0.0).all():
        moved = score / np.sqrt(1.0 + (noise / _unit(distribution)) ** 2)
    return TabulatedDistribution(levels, moved)


def _less_certain(tails: FloatArray, factor: FloatArray) -> FloatArray:
    """Tails (2, K, T) whose normal scores are multiplied by factors (K,)."""
    from scipy.special import ndtr

    score = factor[:, None] * np.clip(_normal_score(*tails), -40.0, 40.0)
    return np.stack([ndtr(score), ndtr(-score)])


def _unit(distribution: TabulatedDistribution) -> float:
    """Typical change of the response per unit of normal score."""
    return float(np.ptp(distribution.levels) / np.ptp(distribution.scores))


def _without_distribution(masses: FloatArray) -> ConditionalResponse:
    masses = masses / masses.sum()
    return ConditionalResponse(
        None,
        p_never=float(masses[NEVER]),
        p_always=float(masses[ALWAYS]),
        p_missing=float(masses[MISSING]),
    )
