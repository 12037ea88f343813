"""Where lines through standard-normal space cross from working to failing, and what lies between.

A line is run at some places; between two of them that differ a crossing is narrowed down, by
secants where the response is like a line and by halves where it jumps. What lies between two places
that agree is believed to agree with them, and a belief may be wrong. So each line gets one more
run, at a place drawn at random: where it contradicts, the difference counts with the weight of the
draw. The probability along a line has no bias then, whatever was overlooked. Half of these places
are drawn where what is overlooked would matter.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from uqfold.methods.line_laws import TOLERANCE, LineLaw
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


@dataclass(frozen=True, eq=False)
class RunPlaces:
    """Places on lines that were run, line by line and along each of them.

    Attributes
    ----------
    line, at
        Which line (k,), and where on it (k,).
    state
        0 where the system works, 2 where it fails, 1 where a failed run leaves it open (k,).
    height
        The height there (k,), failed runs as failures.
    """

    line: IntArray
    at: FloatArray
    state: IntArray
    height: FloatArray

    def joined(self, other: RunPlaces) -> RunPlaces:
        """Return the places of both, in order."""
        return RunPlaces(
            np.concatenate([self.line, other.line]),
            np.concatenate([self.at, other.at]),
            np.concatenate([self.state, other.state]),
            np.concatenate([self.height, other.height]),
        ).sorted()

    def sorted(self) -> RunPlaces:
        """Return the places in order."""
        order = np.lexsort((self.at, self.line))
        return RunPlaces(self.line[order], self.at[order], self.state[order], self.height[order])


@dataclass(frozen=True, eq=False)
class Segments:
    """Pieces of lines, each with one state; those of a line cover it all.

    Attributes
    ----------
    line, start, end, state
        Which line (k,), where each begins and ends, and its state as in `RunPlaces`.
    """

    line: IntArray
    start: FloatArray
    end: FloatArray
    state: IntArray

    def state_at(self, at: FloatArray) -> IntArray:
        """Return the state at one place on each line (N,)."""
        here = (self.start <= at[self.line]) & (at[self.line] < self.end)
        found = np.zeros(at.size, dtype=np.int64)
        found[self.line[here]] = self.state[here]
        return found

    def first_failures(self, lines: int) -> FloatArray:
        """Return where the first failure of each line begins (N,); +inf where there is none."""
        first = np.full(lines, np.inf)
        fails = self.state > 0
        np.minimum.at(first, self.line[fails], self.start[fails])
        return first

    def crossings(self, lines: int) -> IntArray:
        """Count how often each line (N,) passes from one state to another."""
        inner = np.isfinite(self.start)
        return np.bincount(self.line[inner], minlength=lines)


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

    def followed(self, inner: FloatArray, known: RunPlaces | None = None) -> Running[Segments]:
        """Find the pieces of all lines that fail.

        Parameters
        ----------
        inner
            Places (N, k) to begin with, beside both ends; those outside a stretch are left out.
        known
            Places that need no run any more, one at the lower end of each line.
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
        for step in range(ROUNDS):
            cells = _cells(places, limit)
            halve = step >= SECANTS or (step > 2 and step % 2 == 1)
            line, at = cells.narrowed(self.law.tolerance(cells.crossing), halve=halve)
            if step < BUMPS:
                bumps = _bumps(places, limit)
                line = np.concatenate([line, bumps[0]])
                at = np.concatenate([at, bumps[1]])
            if not line.size:
                break
            found = yield from self.run(line, at)
            places = places.joined(found)
        return _segments(places, limit)

    def checked(
        self, segments: Segments, share: float, rng: np.random.Generator
    ) -> Running[tuple[FloatArray, FloatArray]]:
        """Contradict the pieces by one run on each line, at a random place of its stretch.

        Half of the places are drawn evenly, and half by the law from its uppermost part.

        Parameters
        ----------
        segments
            The pieces.
        share
            How much of the law lies in that part; it may not rest on these lines.
        rng
            Source of randomness.

        Returns
        -------
        low, high : arrays (N,)
            What it adds to the probability of failure along each line, failed runs as safe and as
            failures: nothing where the run says what the pieces say.
        """
        length, even = self.last - self.first, rng.random(len(self)) < 0.5
        most = np.minimum(share, self.law.above(self.first))
        upper = most - self.law.above(self.last)
        even |= ~(upper > 0.0)
        drawn = rng.random(len(self))
        with np.errstate(invalid="ignore"):
            far = self.law.place(most - drawn * upper)
        at = np.where(even, self.first + length * drawn, np.clip(far, self.first, self.last))
        found = yield from self.run(np.arange(len(self)), at)
        density = self.law.density(at)
        within = (self.law.above(at) <= most) & (upper > 0.0)
        # the density that the place was drawn from, in two halves
        by_law = np.where(within, density / np.where(upper > 0.0, upper, 1.0), 0.0)
        chance = np.where(upper > 0.0, 0.5 / length + 0.5 * by_law, 1.0 / length)
        weight = density / chance
        believed = segments.state_at(at)
        low = (found.state == 2).astype(float) - (believed == 2)
        high = (found.state > 0).astype(float) - (believed > 0)
        return weight * low, weight * high

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
        near &= self.believed | (width > CLOSE)
        wanted = (width > tolerance) & ~(near & (width <= CLOSE))
        middle = 0.5 * (self.start + self.end)
        at = np.where(self.straight & (not halve), self.crossing, middle)
        # the other side of a crossing that is at an end of its cell
        beside = np.where(from_start < from_end, self.start + 0.5 * CLOSE, self.end - 0.5 * CLOSE)
        at = np.where(near & (width > CLOSE), beside, at)
        inside = np.clip(at, self.start + 0.01 * width, self.end - 0.01 * width)
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
