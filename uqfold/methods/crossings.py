"""Where lines through standard-normal space cross from working to failing, and what lies between.

A line is run at some places; between two of them that differ a crossing is narrowed down, by
secants where the response is like a line and by halves where it jumps. What lies between two places
that agree is believed to agree with them, and a belief may be wrong. So lines are compared with
those beside them, and each gets two more runs, at places drawn at random: where one contradicts,
the difference counts with the weight of the draw. The probability along a line has no bias then,
whatever was overlooked.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from uqfold.methods.line_laws import TOLERANCE, LineLaw
from uqfold.methods.line_neighbours import Traces, unmatched
from uqfold.methods.line_pieces import RunPlaces, Segments
from uqfold.methods.rare_event import NestedCriteria, Running
from uqfold.typing import BoolArray, FloatArray, IntArray

CLOSE = 0.5
"""A secant is believed over no more than this."""
ROUNDS, SECANTS = 24, 8
"""Times that crossings are narrowed down at most, and by secants, with halves between them."""
BENT = 4.0
"""A secant is believed if it is steeper than the one beside it by no more than this."""
BUMPS = 2
"""In so many first rounds places are tried where three others say that the response may turn."""
LESSONS = 20
"""Times that lines learn from those beside them at most."""
BEFORE = 0.3
"""One place that may contradict is drawn beyond where failure begins, or so far before."""


@dataclass(frozen=True, eq=False)
class Lines:
    """Lines through standard-normal space, each looked at over a stretch of its own.

    Attributes
    ----------
    asked
        What fails, and how it is run.
    base, along
        Points (N, d) on the lines, and their directions (N, d), unit vectors.
    law
        How places on a line are distributed.
    first, last
        The stretches (N,); beyond each end the state is believed to be that at the end.
    """

    asked: NestedCriteria
    base: FloatArray
    along: FloatArray
    law: LineLaw
    first: FloatArray
    last: FloatArray

    def __len__(self) -> int:
        """Count the lines."""
        return len(self.base)

    def run(self, line: IntArray, at: FloatArray) -> Running[RunPlaces]:
        """Run some places: which line (k,), and where (k,)."""
        low, high = yield from self.asked.heights(self.base[line] + at[:, None] * self.along[line])
        fails = self.asked.fail(low)[0].astype(np.int64) + self.asked.fail(high)[0]
        return RunPlaces(line, at, fails, high).sorted()

    def followed(
        self, inner: FloatArray, known: RunPlaces | None = None, earlier: Traces | None = None
    ) -> Running[Traces]:
        """Find the pieces of all lines that fail.

        Parameters
        ----------
        inner
            Places (N, k) to begin with, beside both ends; those outside a stretch are left out.
        known
            Places that need no run any more, one at the lower end of each line.
        earlier
            Other lines, whose pieces are looked for on these where they are beside them.
        """
        number = np.arange(len(self))
        ends = [self.last] if known is not None else [self.first, self.last]
        line = np.concatenate([*[number] * len(ends), np.repeat(number, inner.shape[1])])
        at = np.concatenate([*ends, inner.ravel()])
        within = (at > self.first[line]) & (at < self.last[line])
        within[: len(ends) * len(self)] = True
        places = yield from self.run(line[within], at[within])
        if known is not None:
            places = known.joined(places)
        limit = float(self.asked.limits[0])
        places = yield from self._narrowed(places, limit, BUMPS)
        whereabouts = np.hstack([self.base, self.along])
        for _ in range(LESSONS):
            traces = Traces(whereabouts, _segments(places, limit), places)
            line, at = unmatched(traces, earlier, self.last)
            if not line.size:
                return traces
            found = yield from self.run(line, at)
            places = yield from self._narrowed(places.joined(found), limit)
        return Traces(whereabouts, _segments(places, limit), places)

    def _narrowed(self, places: RunPlaces, limit: float, bumps: int = 0) -> Running[RunPlaces]:
        """Add runs until each crossing is known well enough."""
        for step in range(ROUNDS):
            cells = _cells(places, limit)
            halve = step >= SECANTS or (step > 2 and step % 2 == 1)
            line, at = cells.narrowed(self.law.tolerance(cells.crossing), halve=halve)
            if step < bumps:
                turns = _bumps(places, limit)
                line = np.concatenate([line, turns[0]])
                at = np.concatenate([at, turns[1]])
            if not line.size:
                break
            found = yield from self.run(line, at)
            places = places.joined(found)
        return places

    def checked(
        self, traces: Traces, rng: np.random.Generator, *, evenly: bool = False
    ) -> Running[tuple[FloatArray, FloatArray, Traces]]:
        """Contradict the pieces by two runs on each line, at places drawn from its stretch.

        One place is drawn evenly, the other by the law from where failure begins on the line, or on
        any line; they count by the sum of both densities. `evenly`: the first places of all lines
        together lie evenly, each anywhere by itself.

        Returns
        -------
        low, high : arrays (N,)
            What it adds to the probability of failure along each line, failed runs as safe and as
            failures: nothing where the run says what the pieces say.
        traces
            What later lines learn from: with what contradicted.
        """
        segments = traces.segments
        begins = segments.first_failures(len(self))
        anywhere = np.isinf(begins) | (np.arange(len(self)) % 2 == 0)
        begins = np.where(anywhere, begins.min(), begins)
        begins = np.maximum(self.first, begins - BEFORE)
        beyond, left = self.law.above(begins), self.law.above(self.last)
        tail = begins < self.last
        share = rng.random((2, len(self)))
        if evenly:
            share[0] = (rng.permutation(len(self)) + share[0]) / len(self)
        stretch = self.last - self.first
        by_law = self.law.place(left + (beyond - left) * share[1])
        other = np.where(tail, by_law, self.first + stretch * rng.random(len(self)))
        at = np.concatenate([self.first + stretch * share[0], other])
        line = np.tile(np.arange(len(self)), 2)
        at = np.clip(at, self.first[line], self.last[line])
        found = yield from self.run(line, at)
        line, at = found.line, found.at
        with np.errstate(divide="ignore", invalid="ignore"):
            density = self.law.density(at)
            by_law = density / (beyond - left)[line]
        beside = np.where(tail[line], by_law * (at >= begins[line]), 1.0 / stretch[line])
        weight = density / (1.0 / stretch[line] + beside)
        believed = segments.state_at(line, at)
        low, high = np.zeros((2, len(self)))
        np.add.at(low, line, weight * ((found.state == 2).astype(float) - (believed == 2)))
        np.add.at(high, line, weight * ((found.state > 0).astype(float) - (believed > 0)))
        if high.any():
            # later lines look for what was overlooked here
            limit = float(self.asked.limits[0])
            places = yield from self._narrowed(traces.places.joined(found), limit)
            traces = replace(traces, segments=_segments(places, limit), places=places)
        return low, high, traces

    def masses(
        self, segments: Segments, start: FloatArray, end: FloatArray
    ) -> tuple[FloatArray, FloatArray]:
        """Probabilities (N,) of failure along each line from start to end (N,): low and high."""
        line = segments.line
        cut = np.maximum(segments.start, start[line]), np.minimum(segments.end, end[line])
        mass = np.where(cut[0] < cut[1], self.law.between(cut[0], np.maximum(*cut)), 0.0)
        low, high = np.zeros((2, len(self)))
        np.add.at(low, line, mass * (segments.state == 2))
        np.add.at(high, line, mass * (segments.state > 0))
        return low, high


@dataclass(frozen=True, eq=False)
class _Cells:
    """Stretches (k,) between neighbouring places whose states differ."""

    line: IntArray
    start: FloatArray
    end: FloatArray
    crossing: FloatArray
    straight: BoolArray
    believed: BoolArray

    def narrowed(self, tolerance: FloatArray, *, halve: bool) -> tuple[IntArray, FloatArray]:
        """Return where to run the cells whose crossing is not known to a tolerance (k,)."""
        width = self.end - self.start
        from_start, from_end = self.crossing - self.start, self.end - self.crossing
        near = self.straight & (np.minimum(from_start, from_end) <= tolerance)
        near &= (self.believed | (width > CLOSE)) & (np.minimum(from_start, from_end) > 0.0)
        wanted = (width > tolerance) & ~(near & (width <= CLOSE))
        middle = 0.5 * (self.start + self.end)
        at = np.where(self.straight & (not halve), self.crossing, middle)
        # the other side of a crossing that is at an end of its cell
        beside = np.where(from_start < from_end, self.start + 0.5 * CLOSE, self.end - 0.5 * CLOSE)
        at = np.where(near & (width > CLOSE), beside, at)
        # where the response equals the limit it may stand on a plateau: a little further tells
        at_limit = self.straight & ~near & (np.minimum(from_start, from_end) == 0.0)
        least = np.where(at_limit, 0.9 * np.minimum(tolerance, width), 0.01 * width)
        inside = np.clip(at, self.start + least, self.end - least)
        at = np.where(near, at, inside)
        return self.line[wanted], at[wanted]


def _cells(places: RunPlaces, limit: float) -> _Cells:
    """Return the cells in which the state changes."""
    differ = (places.line[1:] == places.line[:-1]) & (places.state[1:] != places.state[:-1])
    before = np.flatnonzero(differ)
    after = before + 1
    start, end = places.at[before], places.at[after]
    low, high = places.height[before], places.height[after]
    closed = (places.state[before] != 1) & (places.state[after] != 1)
    with np.errstate(invalid="ignore", over="ignore"):
        share = (limit - low) / (high - low)
    straight = closed & np.isfinite(low) & np.isfinite(high) & (share >= 0.0) & (share <= 1.0)
    share = np.where(straight, share, 0.5)
    crossing = start + share * (end - start)
    # beyond the end that is nearer to the crossing a jump is not as steep as within
    line, last = places.line, places.line.size - 1
    outside = np.where(share < 0.5, np.maximum(before - 1, 0), np.minimum(after + 1, last))
    inside = np.where(share < 0.5, before, after)
    with np.errstate(all="ignore"):
        beside = (places.height[outside] - places.height[inside]) / (
            places.at[outside] - places.at[inside]
        )
        bent = np.abs((high - low) / (end - start)) / np.abs(beside)
    believed = (line[outside] == line[inside]) & (outside != inside) & (bent <= BENT)
    return _Cells(line[before], start, end, crossing, straight, believed)


def _bumps(places: RunPlaces, limit: float) -> tuple[IntArray, FloatArray]:
    """Return where a parabola through three places that agree comes to the other side."""
    line, at, state, height = places.line, places.at, places.state, places.height
    first = np.flatnonzero(
        (line[2:] == line[:-2]) & (state[2:] == state[1:-1]) & (state[1:-1] == state[:-2])
    )
    a, b, c = at[first], at[first + 1], at[first + 2]
    fa, fb, fc = height[first], height[first + 1], height[first + 2]
    with np.errstate(all="ignore"):
        slopes = (fb - fa) / (b - a), (fc - fb) / (c - b)
        bend = (slopes[1] - slopes[0]) / (c - a)
        top = 0.5 * (a + b) - 0.5 * slopes[0] / bend
        value = fa + slopes[0] * (top - a) + bend * (top - a) * (top - b)
    new = (top > a) & (top < c) & (np.abs(top - b) > TOLERANCE) & np.isfinite(value)
    new &= (value > limit) != (fb > limit)
    return line[first][new], top[new]


def _segments(places: RunPlaces, limit: float) -> Segments:
    """Divide lines at their crossings."""
    new_line = np.diff(places.line, prepend=-1) != 0
    changes = new_line.copy()
    start = np.full(places.line.size, -np.inf)
    cells = _cells(places, limit)
    differ = (places.line[1:] == places.line[:-1]) & (places.state[1:] != places.state[:-1])
    after = np.flatnonzero(differ) + 1
    start[after] = cells.crossing
    changes[after] = True
    kept = np.flatnonzero(changes)
    line, start, state = places.line[kept], start[kept], places.state[kept]
    end = np.append(start[1:], np.inf)
    end[np.append(line[1:] != line[:-1], True)] = np.inf
    return Segments(line, start, end, state)
