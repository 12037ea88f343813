"""In one variable all lines are the same line: it is looked at as finely as the runs allow."""

from __future__ import annotations

from dataclasses import dataclass, field, replace

import numpy as np

from uqfold.methods.crossings import Lines
from uqfold.methods.line_laws import LineLaw, normal_law
from uqfold.methods.line_neighbours import Traces
from uqfold.methods.line_pieces import RunPlaces, Segments
from uqfold.methods.line_sums import Round
from uqfold.methods.rare_event import NestedCriteria, Running
from uqfold.typing import FloatArray

FARTHEST = 8.0
"""The line ends here until pf is known."""
BEYOND = 1e-3
"""Then it ends where this part of pf is left beyond."""
PLACES = 40
"""Even places to begin with."""
SHARE, WITHOUT_A_BUDGET, MOST = 2, 500, 20_000
"""Further ones: one run in so many that are left, so many without a budget, and so many at most."""
FEW = 200
"""Repetitions at once at most: each has all places of the line."""


@dataclass(eq=False)
class OneLine:
    """The line, and what is known of it.

    Attributes
    ----------
    asked
        The criterion.
    rng
        Source of randomness.
    """

    asked: NestedCriteria
    rng: np.random.Generator
    _law: LineLaw = field(default_factory=normal_law)
    _reach: float = FARTHEST
    _traces: Traces = field(init=False)

    def look(self) -> Running[None]:
        """Look at the line from end to end, first coarsely, then finely where it matters."""
        coarse = np.linspace(-FARTHEST, FARTHEST, PLACES + 2)[None, 1:-1]
        self._traces = yield from self._lines(1).followed(coarse)
        pf = float(self._masses(1)[1][0])
        if pf > 0.0:
            self._reach = min(FARTHEST, float(self._law.place(np.array([0.5 * BEYOND * pf]))[0]))
        number = WITHOUT_A_BUDGET
        if self.asked.session.max_evals is not None:
            number = self.asked.left // (SHARE * self.asked.event.max_evals_per_sample)
        number = min(number, MOST)
        shares = (np.arange(number) + self.rng.random(number)) / max(number, 1)
        yield from self._run_further(self._reach * (2.0 * shares - 1.0))

    def drawn(self, number: int) -> Running[Round]:
        """Contradict what is known of the line by pairs of runs at random places."""
        number = min(number, FEW)
        lines, mass = self._lines(number), self._masses(number)
        own, places = self._traces.segments, self._traces.places
        line, piece = np.divmod(np.arange(number * own.line.size), own.line.size)
        segments = Segments(line, own.start[piece], own.end[piece], own.state[piece])
        line, place = np.divmod(np.arange(number * places.line.size), places.line.size)
        places = RunPlaces(line, places.at[place], places.state[place], places.height[place])
        traces = Traces(np.zeros((number, 1)), segments, places)
        low, high, taught = yield from lines.checked(traces, self.rng, evenly=True)
        if high.any():
            yield from self._learn(taught.places)
        both = mass[1] + high
        return Round(both, mass[0] + low, np.abs(high), both)

    def sides(self) -> tuple[FloatArray, FloatArray]:
        """Directions (K, 1) in which there is failure, and the distances (K,) where it begins."""
        one = self._traces.segments
        fails = one.state > 0
        nearest = [
            np.maximum(start[fails & (end > 0.0)], 0.0).min(initial=np.inf)
            for start, end in ((one.start, one.end), (-one.end, -one.start))
        ]
        alphas, betas = np.array([[1.0], [-1.0]]), np.array(nearest)
        order = np.argsort(betas, kind="stable")[: np.count_nonzero(np.isfinite(betas))]
        return alphas[order], betas[order]

    @property
    def heaviest(self) -> float:
        """The largest weight of a run that contradicts the line."""
        return 2.0 * self._reach * float(self._law.density(np.zeros(1))[0])

    def _lines(self, number: int) -> Lines:
        """Return the line, so many times."""
        ends = np.full(number, self._reach)
        base, along = np.zeros((number, 1)), np.ones((number, 1))
        return Lines(self.asked, base, along, self._law, -ends, ends)

    def _masses(self, number: int) -> tuple[FloatArray, FloatArray]:
        """Probability of failure along the line, low and high, so many times."""
        everywhere = np.full(1, np.inf)
        low, high = self._lines(1).masses(self._traces.segments, -everywhere, everywhere)
        return np.repeat(low, number), np.repeat(high, number)

    def _learn(self, places: RunPlaces) -> Running[None]:
        """Add what was run on any of the same lines."""
        at, first = np.unique(places.at, return_index=True)
        line, state, height = np.zeros_like(first), places.state[first], places.height[first]
        self._traces = replace(self._traces, places=RunPlaces(line, at, state, height))
        yield from self._run_further(np.empty(0))

    def _run_further(self, at: FloatArray) -> Running[None]:
        """Add runs at some places (k,), and what they lead to.

        No other line averages out how well crossings are known: pf tells how well they have to be.
        """
        self._traces = yield from self._lines(1).followed(at[None, :], self._traces.places)
        pf = float(self._masses(1)[1][0])
        if 0.0 < pf < self._law.event:
            self._law = replace(self._law, event=pf)
            none = np.empty((1, 0))
            self._traces = yield from self._lines(1).followed(none, self._traces.places)
