"""What the lines beside a line tell of it: where it should be run once more.

A narrow region of failure, or a gap in a wide one, is met by a run on some lines and lies between
the runs of others. So every piece of a line is looked for on the lines beside it: one that shows
nothing of its kind there gets a run where the piece is.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from uqfold.methods.line_pieces import RunPlaces, Segments
from uqfold.typing import FloatArray, IntArray

BESIDE, AROUND = 4, 3
"""Lines that are beside each, and further ones, where lines stand in crowds, of one in so many:"""
ONE_IN = 7
PLACES = (0.2, 0.8)
"""Where a piece is looked for: shares of its length, or of the longest that is looked at."""
LONGEST = 0.5
"""No more than this of a piece is looked at, from its beginning."""
KNOWN = 0.02
"""A place so near to one that was run needs no other run."""
REMEMBERED = 2_000
"""Earlier lines that are kept at most."""


@dataclass(frozen=True, eq=False)
class Traces:
    """Lines and their pieces.

    Attributes
    ----------
    whereabouts
        Points (N, k) whose distances tell how near two lines are.
    segments
        The pieces of all lines.
    places
        What was run on the lines; of earlier lines it is not kept.
    """

    whereabouts: FloatArray
    segments: Segments
    places: RunPlaces

    def joined(self, earlier: Traces | None) -> Traces:
        """Return these lines, and earlier ones with numbers after them."""
        if earlier is None:
            return self
        own, other, number = self.segments, earlier.segments, len(self.whereabouts)
        return Traces(
            np.concatenate([self.whereabouts, earlier.whereabouts]),
            Segments(
                np.concatenate([own.line, other.line + number]),
                np.concatenate([own.start, other.start]),
                np.concatenate([own.end, other.end]),
                np.concatenate([own.state, other.state]),
            ),
            self.places,
        )

    def latest(self) -> Traces:
        """Return those that are kept for later lines."""
        first, one = self.segments.line < REMEMBERED, self.segments
        kept = Segments(one.line[first], one.start[first], one.end[first], one.state[first])
        return Traces(self.whereabouts[:REMEMBERED], kept, self.places)


def unmatched(
    lines: Traces, earlier: Traces | None, last: FloatArray
) -> tuple[IntArray, FloatArray]:
    """Return where to run lines that lack a piece of a line beside them.

    Parameters
    ----------
    lines, earlier
        The lines, and others that are known.
    last
        Where each line ends (N,).

    Returns
    -------
    line, at : arrays (k,)
        Which line, and where on it.
    """
    from scipy.spatial import cKDTree

    together = lines.joined(earlier)
    segments, number = together.segments, len(lines.whereabouts)
    if len(together.whereabouts) < 2 or segments.line.size == len(together.whereabouts):
        return np.empty(0, dtype=np.int64), np.empty(0)
    some = together.whereabouts[::ONE_IN]
    near = np.hstack(
        [
            cKDTree(points).query(lines.whereabouts, k=range(1, 1 + min(k, len(points))))[1] * step
            for points, k, step in ((together.whereabouts, BESIDE + 1, 1), (some, AROUND, ONE_IN))
        ]
    )
    # each piece of the lines beside line i, to be found on line i
    own, piece = _pairs(np.repeat(np.arange(number), near.shape[1]), near.ravel(), segments)
    start = segments.start[piece]
    end = np.minimum(segments.end[piece], last[own])
    pair, other = _pairs(np.arange(own.size), own, segments)
    same = segments.state[other] == segments.state[piece[pair]]
    same &= (segments.start[other] < end[pair]) & (segments.end[other] > start[pair])
    lacking = np.isfinite(start) & (start < end)
    lacking[pair[same]] = False
    length = np.minimum((end - start)[lacking], LONGEST)
    at = start[lacking] + np.multiply.outer(PLACES, length)
    return _new(np.tile(own[lacking], len(PLACES)), at.ravel(), lines.places)


def _pairs(first: IntArray, line: IntArray, segments: Segments) -> tuple[IntArray, IntArray]:
    """Pair each of `first` (k,) with every piece of its line (k,)."""
    begin = np.searchsorted(segments.line, line)
    count = np.searchsorted(segments.line, line, side="right") - begin
    before = np.cumsum(count) - count
    piece = np.arange(count.sum()) - np.repeat(before - begin, count)
    return np.repeat(first, count), piece


def _new(line: IntArray, at: FloatArray, places: RunPlaces) -> tuple[IntArray, FloatArray]:
    """Leave out places beside those that were run, or beside one another."""
    cells = np.rint(np.concatenate([places.at, at]) / KNOWN).astype(np.int64)
    keys = np.stack([np.concatenate([places.line, line]), cells])
    _, first = np.unique(keys, axis=1, return_index=True)
    new = first[first >= places.line.size] - places.line.size
    return line[new], at[new]
