"""Lines in the space of the shared variables, for units that have no variables of their own.

Given the shared variables such a unit fails for certain, or works, so that what the system does
jumps where the unit passes its threshold. Nodes that stand still step over jumps. Along a line
these are crossings, which are found, and move as a surface moves; between them, failure is a smooth
function of the place, known at a few stations.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import NamedTuple

import numpy as np

from uqfold.problems.criterion import Criterion
from uqfold.system.conditional import SystemProbability
from uqfold.system.lines import REACH, LineRule, weighted_mean
from uqfold.system.missions import over_missions
from uqfold.system.structure import SystemUnits
from uqfold.system.synchronized import complementary
from uqfold.time_limit import check_time
from uqfold.typing import FloatArray, IntArray

# Cells of the search for crossings, and pieces of integration, for each one between stations.
_SEARCHED, _PIECES = 16, 4
_LEGENDRE = np.polynomial.legendre.leggauss(3)
# Numbers held at once, and scores beyond which nothing is told apart.
_MOST_NUMBERS, _FARTHEST = 4_000_000, 38.0


@dataclass(frozen=True, eq=False)
class OnLines:
    """What a surface is at K shared nodes: values on the lines over a kind's own variables.

    Attributes
    ----------
    lines
        Lines over the variables of its own, which start at every node, or the only point there is.
    values, outcomes
        At the points of each node (K, points); `outcomes` is None where all of them are finite.
    noise
        Standard deviation of an independent normal disturbance of every response.
    """

    lines: LineRule
    values: FloatArray
    outcomes: IntArray | None = None
    noise: float = 0.0

    @property
    def certain(self) -> bool:
        """Whether the shared variables tell the response."""
        return self.lines.stations.size == 1 and self.outcomes is None

    def at(self, nodes: IntArray) -> OnLines:
        """The same at some of the nodes."""
        kinds = None if self.outcomes is None else self.outcomes[nodes]
        return replace(self, values=self.values[nodes], outcomes=kinds)

    def tails(self, levels: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Probability (K, T) of responses up to levels, and above them."""
        return self.lines.tails(self.values, levels, self.outcomes, self.noise)


class Certain(NamedTuple):
    """Responses (L, S) of a kind that has one given the shared variables, and their noise."""

    values: FloatArray
    noise: float = 0.0


class Chances(NamedTuple):
    """How units of each sort fail (J, R, L, S) at R thresholds, and that they work."""

    fails: FloatArray
    works: FloatArray


@dataclass(frozen=True, eq=False)
class SharedLines:
    """L lines with S stations each in the space of s shared variables.

    Attributes
    ----------
    axes
        Directions (s, s) in columns; lines run along the first.
    places
        Where they run, (L, s - 1) along the others.
    weights
        Probability (L,) that each line stands for.
    stations
        Positions (S,) along every line, in equal steps; an odd number of them.
    sampled
        Whether places are spread over a density, with weights whose sum need not be 1.
    """

    axes: FloatArray
    places: FloatArray
    weights: FloatArray
    stations: FloatArray
    sampled: bool = False

    @classmethod
    def at(
        cls,
        axes: FloatArray,
        places: FloatArray,
        weights: FloatArray,
        stations: int,
        *,
        sampled: bool = False,
    ) -> SharedLines:
        """Lay out lines at places, with so many stations each."""
        return cls(axes, places, weights, np.linspace(-REACH, REACH, stations), sampled)

    @property
    def shape(self) -> tuple[int, int]:
        """Numbers of lines and of stations along each, (L, S)."""
        return self.weights.size, self.stations.size

    @property
    def coordinates(self) -> FloatArray:
        """All stations (L S, s) along the axes, line by line."""
        count, size = self.shape
        along = np.tile(self.stations, count)[:, None]
        return np.hstack([along, np.repeat(self.places, size, axis=0)])

    @property
    def nodes(self) -> FloatArray:
        """All stations (L S, s) in standard-normal space."""
        return np.asarray(self.coordinates @ self.axes.T)

    @property
    def node_weights(self) -> FloatArray:
        """Probability (L S,) that each station stands for."""
        density = np.exp(-0.5 * self.stations**2)
        return np.outer(self.weights / self.weights.sum(), density / density.sum()).ravel()

    def failures(
        self, responses: Sequence[OnLines], units: SystemUnits, criteria: Sequence[Criterion]
    ) -> list[SystemProbability]:
        """Failure probability under each criterion, none of them with tau.

        Parameters
        ----------
        responses
            Of each kind at all stations.
        units
            The units and their structure.
        criteria
            The questions.
        """
        return self._summed(self._of_lines(responses, units, criteria))

    def coarser(
        self, responses: Sequence[OnLines], units: SystemUnits, criteria: Sequence[Criterion]
    ) -> list[SystemProbability]:
        """The same from every second station."""
        thinned = replace(self, stations=self.stations[::2])
        place = np.arange(self.weights.size * self.stations.size).reshape(self.shape)[:, ::2]
        some = [own.at(place.ravel()) for own in responses]
        return thinned.failures(some, units, criteria)

    def of_parts(
        self,
        responses: Sequence[OnLines],
        units: SystemUnits,
        criteria: Sequence[Criterion],
        count: int,
    ) -> list[list[SystemProbability]]:
        """The same from every count-th line alone, from the first on, the second, and so on."""
        found = self._of_lines(responses, units, criteria)
        parts = []
        for first in range(count):
            some = slice(first, None, count)
            weights = self.weights[some]
            # so many lines drawn stand for all of them; those of a quadrature have the sum 1
            whole = self.weights.size / weights.size if self.sampled else 1.0 / weights.sum()
            part = replace(self, places=self.places[some], weights=whole * weights)
            parts.append(part._summed(found[:, :, some]))
        return parts

    def _of_lines(
        self, responses: Sequence[OnLines], units: SystemUnits, criteria: Sequence[Criterion]
    ) -> FloatArray:
        """Failure and success (2, C, L) along each line."""
        thresholds = np.array([one.threshold for one in criteria])
        fails, works = np.zeros((2, units.offsets.size, len(criteria), *self.shape))
        certain = {}
        for kind, own in enumerate(responses):
            if own.certain:
                certain[kind] = Certain(own.values.reshape(self.shape), own.noise)
                continue
            asked = units.thresholds(thresholds, kind)
            sides = [
                np.moveaxis(side.reshape(*self.shape, *asked.shape), (0, 1), (2, 3))
                for side in own.tails(asked.ravel())
            ]
            works[units.of_kinds == kind], fails[units.of_kinds == kind] = sides
        return along_lines(self.stations, Chances(fails, works), certain, units, criteria)

    def _summed(self, found: FloatArray) -> list[SystemProbability]:
        """Means over all lines of failure and success (2, C, L)."""
        if self.sampled:
            pf, reliability = (weighted_mean(self.weights, one.T) for one in found)
        else:
            pf, reliability = found @ self.weights
        pf, reliability = complementary(np.minimum(pf, 1.0), np.minimum(reliability, 1.0))
        return [
            SystemProbability(*values)
            for values in zip(*(one.tolist() for one in (pf, reliability, pf, pf)), strict=True)
        ]


def along_lines(
    stations: FloatArray,
    chances: Chances,
    certain: Mapping[int, Certain],
    units: SystemUnits,
    criteria: Sequence[Criterion],
) -> FloatArray:
    """Failure and success (2, C, L) of the system along each of L lines.

    Parameters
    ----------
    stations
        Positions (S,) along every line, in equal steps.
    chances
        How units of each sort fail there, at the thresholds of the criteria.
    certain
        Kinds whose response itself is known there, in the place of `chances`.
    units, criteria
        What is asked; no criterion has tau.
    """
    lines = chances.fails.shape[2]
    found = np.empty((2, len(criteria), lines))
    asked = units.thresholds([one.threshold for one in criteria])
    curves = {kind: _Curves.smooth(stations, own.values) for kind, own in certain.items()}
    pieces = _PIECES * (stations.size - 1) * _LEGENDRE[0].size
    block = max(1, _MOST_NUMBERS // (pieces * units.count))
    for start in range(0, lines, block):
        some = slice(start, start + block)
        for row, criterion in enumerate(criteria):
            check_time()
            levels = asked[:, row]
            here = {kind: own.some(some) for kind, own in curves.items()}
            crossings = [
                here[int(kind)].crossings(level)
                for kind, level in zip(units.of_kinds, levels, strict=True)
                if int(kind) in here
            ]
            x, weights = _points(stations, crossings, lines=len(chances.fails[0, 0, some]))
            fails, works = np.empty((2, levels.size, *x.shape))
            for sort, kind in enumerate(units.of_kinds.tolist()):
                if kind in here:
                    beyond = here[kind].at(x) - levels[sort]
                    fails[sort], works[sort] = _failing(beyond, certain[kind].noise)
                else:
                    both = (part[sort, row, some] for part in chances)
                    fails[sort], works[sort] = _tails(_Curves.scores(stations, *both).at(x))
            of_mission = units.mission(fails, works)
            for side, values in enumerate(over_missions(*of_mission, criterion.missions)):
                found[side, row, some] = (weights * values).sum(axis=1)
    return found


def _points(
    stations: FloatArray, crossings: Sequence[FloatArray], lines: int
) -> tuple[FloatArray, FloatArray]:
    """Points (L, P) of a Gauss rule between all crossings (L, ...), and weights with the sum 1."""
    even = np.linspace(stations[0], stations[-1], _PIECES * (stations.size - 1) + 1)
    edges = np.sort(np.hstack([np.tile(even, (lines, 1)), *crossings]), axis=1)
    half = 0.5 * np.diff(edges, axis=1)[..., None]
    x = (0.5 * (edges[:, 1:] + edges[:, :-1])[..., None] + half * _LEGENDRE[0]).reshape(lines, -1)
    weights = (half * _LEGENDRE[1]).reshape(lines, -1) * np.exp(-0.5 * x**2)
    return x, weights / weights.sum(axis=1, keepdims=True)


def _failing(beyond: FloatArray, noise: float) -> tuple[FloatArray, FloatArray]:
    """Failure and success of responses so far beyond a threshold."""
    if noise > 0.0:
        return _tails(beyond / noise)
    fails = (beyond > 0.0).astype(float)
    return fails, 1.0 - fails


def _tails(score: FloatArray) -> tuple[FloatArray, FloatArray]:
    from scipy.special import ndtr

    return ndtr(score), ndtr(-score)


@dataclass(frozen=True, eq=False)
class _Curves:
    """Cubic curves (L, S) through values at equal steps from `first` on, with their slopes."""

    first: float
    step: float
    values: FloatArray
    slopes: FloatArray

    @classmethod
    def smooth(cls, stations: FloatArray, values: FloatArray) -> _Curves:
        """Cubic splines."""
        from scipy.interpolate import CubicSpline

        slopes = CubicSpline(stations, values, axis=1)(stations, 1)
        return cls(float(stations[0]), float(stations[1] - stations[0]), values, slopes)

    @classmethod
    def scores(cls, stations: FloatArray, fails: FloatArray, works: FloatArray) -> _Curves:
        """Normal scores of probabilities, without waves where these end or jump."""
        from scipy.interpolate import PchipInterpolator
        from scipy.special import ndtri

        values = np.where(fails < works, ndtri(fails), -ndtri(works))
        values = np.clip(values, -_FARTHEST, _FARTHEST)
        slopes = PchipInterpolator(stations, values, axis=1)(stations, 1)
        return cls(float(stations[0]), float(stations[1] - stations[0]), values, slopes)

    def some(self, lines: slice) -> _Curves:
        """Return the curves of some lines."""
        return replace(self, values=self.values[lines], slopes=self.slopes[lines])

    def at(self, x: FloatArray) -> FloatArray:
        """Values at positions x (L, P)."""
        place = (x - self.first) / self.step
        cell = np.clip(place.astype(np.int64), 0, self.values.shape[1] - 2)
        t = place - cell
        low, high, rise, end = (
            np.take_along_axis(table, index, axis=1)
            for table in (self.values, self.step * self.slopes)
            for index in (cell, cell + 1)
        )
        bend = (rise - (high - low)) * (1.0 - t) - (end - (high - low)) * t
        return np.asarray(low + t * (high - low) + t * (1.0 - t) * bend)

    def crossings(self, level: float) -> FloatArray:
        """Positions (L, M) where curves pass a level; fewer than M are filled up with the end."""
        lines, size = self.values.shape
        last = self.first + self.step * (size - 1)
        fine = np.linspace(self.first, last, _SEARCHED * (size - 1) + 1)
        above = self.at(np.tile(fine, (lines, 1))) - level
        line, cell = np.nonzero((above[:, 1:] > 0.0) != (above[:, :-1] > 0.0))
        start, end = above[line, cell], above[line, cell + 1]
        counts = np.bincount(line, minlength=lines)
        found = np.full((lines, int(counts.max(initial=0))), last)
        order = np.arange(line.size) - np.repeat(np.cumsum(counts) - counts, counts)
        found[line, order] = fine[cell] + start / (start - end) * (fine[1] - fine[0])
        return found
