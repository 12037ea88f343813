"""Pieces of lines through standard-normal space: what was run on them, what is believed of them."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from uqfold.typing import FloatArray, IntArray


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

    def state_at(self, line: IntArray, at: FloatArray) -> IntArray:
        """Return the state at places: which line (k,), and where on it (k,)."""
        order = np.lexsort((np.concatenate([self.start, at]), np.concatenate([self.line, line])))
        piece = np.cumsum(order < self.line.size) - 1
        found = np.empty(order.size, dtype=np.int64)
        found[order] = self.state[piece]
        return found[self.line.size :]

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
