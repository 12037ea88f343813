"""Climbing to a rare event by populations of Markov chains, each level a little higher.

A population sits where the height of the system exceeds a level. Those of its samples that exceed
the next level are seeds of chains there; a chain proposes rho u + sigma xi with a fresh standard
normal xi and rho^2 + sigma^2 = 1, and stays where it is if the proposal lies below the level. That
leaves the standard normal law above the level as it is (Papaioannou, Betz, Zwirglmaier and Straub
2015, "conditional sampling").

Levels and sigma are settled by a pilot. A climb after it, independent of it, gives an estimate
without bias but for the lengths of its chains, which follow the number of seeds, however few
samples it has and however badly its chains move: the product of the shares that exceed the levels
is that of a particle filter (Del Moral 2004). So independent climbs tell their own error.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from uqfold.methods.rare_event import NestedCriteria, Running
from uqfold.typing import BoolArray, FloatArray, IntArray

ACCEPTANCE = 0.35
"""Share of proposals that the pilot adapts sigma to; 0.44 is best in one dimension, less in many
(the variance for the same runs is about a quarter lower, measured in 100 and 200)."""
FIRST_SIGMA, LEAST_SIGMA = 0.6, 1e-4
SMALLEST = 1e-12
"""The pilot climbs to levels of about this probability."""
LONGEST = 30
"""States of one chain at most: where hardly a seed is left, long chains only cost time."""


@dataclass(frozen=True)
class Rung:
    """One level: the height to be exceeded, and sigma of the chains above it."""

    height: float
    sigma: float


@dataclass(frozen=True, eq=False)
class Population:
    """Samples of several climbs above one level.

    Attributes
    ----------
    u
        Standard-normal variables (N, d).
    low, high
        Heights (N,), failed runs counted as safe and as failures; `high` decides the climb.
    climb
        To which climb (N,) each belongs.
    share
        Estimated probability (R,) of the level, one of each climb.
    """

    u: FloatArray
    low: FloatArray
    high: FloatArray
    climb: IntArray
    share: FloatArray

    @property
    def sizes(self) -> IntArray:
        """Samples (R,) of each climb."""
        return self.per_climb(np.ones(len(self.u), dtype=np.bool_))

    def per_climb(self, chosen: BoolArray) -> IntArray:
        """Count the chosen samples (N,) of each climb (R,)."""
        return np.bincount(self.climb[chosen], minlength=self.share.size)

    def estimates(self, failing: BoolArray) -> FloatArray:
        """Return each climb's estimate (R,) of the probability that a sample is failing (N,)."""
        return self.share * self.per_climb(failing) / np.maximum(self.sizes, 1)


@dataclass(frozen=True)
class Pilot:
    """What the pilot found.

    Attributes
    ----------
    levels
        The levels, in order.
    n_samples
        Samples that it has drawn.
    note
        Why it ended before failures were frequent; empty if they are.
    last
        The samples above the last level.
    """

    levels: tuple[Rung, ...]
    n_samples: int
    note: str
    last: Population | None = None


@dataclass(frozen=True, eq=False)
class Climbs:
    """What some climbs found.

    Attributes
    ----------
    levels, size
        The levels, and the samples of each climb at each of them.
    high, low
        Their estimates of pf (R, C), failed runs counted as failures and as safe.
    shares
        Their estimates (R, L + 1) of the probability of each level, the first of them 1.
    moves, moved
        Proposals at each level (L,), and how many of them were taken.
    kept
        Their populations, one after the other, if they were to be kept.
    """

    levels: tuple[Rung, ...]
    size: int
    high: FloatArray
    low: FloatArray
    shares: FloatArray
    moves: IntArray
    moved: IntArray
    kept: tuple[Population, ...] = ()

    @property
    def acceptance(self) -> FloatArray:
        """Share (L,) of the proposals that were taken; 1 where none was made."""
        return np.where(self.moves > 0, self.moved / np.maximum(self.moves, 1), 1.0)

    @classmethod
    def together(cls, parts: list[Climbs]) -> Climbs:
        """Return all climbs of some rounds."""
        first = parts[0]
        return cls(
            first.levels,
            first.size,
            high=np.concatenate([part.high for part in parts]),
            low=np.concatenate([part.low for part in parts]),
            shares=np.concatenate([part.shares for part in parts]),
            moves=np.sum([part.moves for part in parts], axis=0),
            moved=np.sum([part.moved for part in parts], axis=0),
            kept=tuple(population for part in parts for population in part.kept),
        )


def piloted(
    asked: NestedCriteria, size: int, share: float, most: int, rng: np.random.Generator
) -> Running[Pilot]:
    """Find levels, each exceeded by a given share of those that exceed the one before.

    Parameters
    ----------
    asked
        The criteria.
    size
        Samples at each level.
    share
        The share, in (0, 1/2].
    most
        Samples that may be drawn in all.
    rng
        Source of randomness.
    """
    population = yield from _drawn(asked, 1, size, rng, "pilot")
    levels: list[Rung] = []
    drawn, sigma, note = size, FIRST_SIGMA, ""
    finite = np.isfinite(asked.limits)
    while finite.any():
        failing = int(asked.fail(population.high)[finite].sum(axis=1).min())
        n = population.high.size
        if failing >= 0.5 * share * n:
            break
        height = _next_height(population.high, share)
        if height is None:
            note = "the response rises no further"
            break
        above = int(np.count_nonzero(population.high > height))
        if failing >= above:
            break
        if population.share[0] * above / n < SMALLEST:
            note = f"levels of a probability of {SMALLEST:g} do not reach the limit"
            break
        if drawn + size > most:
            note = "the budget of the pilot ended before failures were frequent"
            break
        moves = _Moves(sigma, adapted=True)
        population = yield from _climbed(
            asked, population, height, size, moves, rng, len(levels) + 1
        )
        drawn += moves.made
        sigma = moves.sigma
        levels.append(Rung(height, sigma))
    return Pilot(tuple(levels), drawn, note, population)


def climbs(
    asked: NestedCriteria,
    levels: tuple[Rung, ...],
    number: int,
    size: int,
    rng: np.random.Generator,
    *,
    keep: bool = False,
) -> Running[Climbs]:
    """Make several independent climbs over given levels.

    Parameters
    ----------
    asked, rng
        As in `piloted`.
    levels
        From a pilot.
    number
        Climbs R.
    size
        Samples of each climb at each level.
    keep
        Whether to keep the populations.
    """
    place = np.array([rung_of(levels, limit) for limit in asked.limits.tolist()])
    high = np.zeros((number, len(asked.limits)))
    low = np.zeros_like(high)
    population = yield from _drawn(asked, number, size, rng, "climb")
    shares, moves = [population.share], []
    kept = [population] if keep else []
    for rung in range(len(levels) + 1):
        if rung > 0:
            level = levels[rung - 1]
            moves.append(_Moves(level.sigma))
            population = yield from _climbed(
                asked, population, level.height, size, moves[-1], rng, rung
            )
            shares.append(population.share)
            kept += [population] if keep else []
        here = np.nonzero(place == rung)[0]
        for into, heights in ((high, population.high), (low, population.low)):
            failing = asked.fail(heights)
            for i in here:
                into[:, i] = population.estimates(failing[i])
    made = np.array([one.made for one in moves], dtype=np.int64)
    taken = np.array([one.taken for one in moves], dtype=np.int64)
    return Climbs(
        levels,
        size,
        high,
        low,
        np.stack(shares, axis=1),
        made,
        taken,
        tuple(kept),
    )


def along(
    asked: NestedCriteria,
    population: Population,
    places: IntArray,
    level: Rung,
    size: int,
    rng: np.random.Generator,
    number: int,
) -> Running[FloatArray]:
    """Return the states (about size, d) of chains above a level that begin at some samples.

    Parameters
    ----------
    asked, rng
        As in `piloted`.
    population, places
        Samples above the level, and the positions of those where chains begin.
    level
        The level.
    size
        States in all.
    number
        Which level it is, from 1.
    """
    begun = Population(
        population.u[places],
        population.low[places],
        population.high[places],
        np.zeros(places.size, dtype=np.int64),
        np.ones(1),
    )
    moves = _Moves(level.sigma)
    moved = yield from _climbed(asked, begun, level.height, size, moves, rng, number)
    return moved.u


def rung_of(levels: tuple[Rung, ...], limit: float) -> int:
    """Return how many levels a failure above some limit exceeds whatever it is."""
    return sum(level.height <= limit for level in levels)


@dataclass
class _Moves:
    """Moves of all chains at one level: sigma, how many were made, and how many taken."""

    sigma: float
    adapted: bool = False
    made: int = 0
    taken: int = 0

    def count(self, made: int, taken: int, step: int) -> None:
        self.made += made
        self.taken += taken
        if self.adapted:
            wished = self.sigma * math.exp((taken / made - ACCEPTANCE) / math.sqrt(step))
            self.sigma = min(1.0, max(LEAST_SIGMA, wished))


def _drawn(
    asked: NestedCriteria, number: int, size: int, rng: np.random.Generator, phase: str
) -> Running[Population]:
    """Draw the population of the lowest level: all of space."""
    u = rng.standard_normal((number * size, asked.event.dimension))
    low, high = yield from asked.heights(u, phase=phase, level=0)
    return Population(u, low, high, np.repeat(np.arange(number), size), np.ones(number))


def _climbed(
    asked: NestedCriteria,
    population: Population,
    height: float,
    size: int,
    moves: _Moves,
    rng: np.random.Generator,
    level: int,
) -> Running[Population]:
    """Lead a population to a higher level, by chains from those that are there already."""
    above = population.high > height
    share = population.estimates(above)
    climb = population.climb[above]
    length = _lengths(population.per_climb(above), size, rng)
    u, low, high = population.u[above], population.low[above], population.high[above]
    states = [(u.copy(), low.copy(), high.copy(), climb)]
    for step in range(1, int(length.max(initial=0))):
        on = np.nonzero(length > step)[0]
        rho = math.sqrt(1.0 - moves.sigma**2)
        proposed = rho * u[on] + moves.sigma * rng.standard_normal((on.size, u.shape[1]))
        new_low, new_high = yield from asked.heights(
            proposed, phase="pilot" if moves.adapted else "climb", level=level
        )
        taken = new_high > height
        goes = on[taken]
        u[goes], low[goes], high[goes] = proposed[taken], new_low[taken], new_high[taken]
        states.append((u[on], low[on], high[on], climb[on]))
        moves.count(on.size, goes.size, step)
    columns = [np.concatenate(column) for column in zip(*states, strict=True)]
    return Population(columns[0], columns[1], columns[2], columns[3], share)


def _lengths(seeds: IntArray, size: int, rng: np.random.Generator) -> IntArray:
    """States of each chain, seed by seed: those of one climb share its samples evenly.

    Which chains are longer by one is drawn, so that it has to do with no seed's place.
    """
    lengths = []
    for number in seeds[seeds > 0].tolist():
        length = np.full(number, min(LONGEST, size // number), dtype=np.int64)
        if length[0] < LONGEST:
            length[rng.permutation(number)[: size % number]] += 1
        lengths.append(length)
    return np.concatenate(lengths) if lengths else np.zeros(0, dtype=np.int64)


def _next_height(high: FloatArray, share: float) -> float | None:
    """Return the level that about this share of samples exceeds; None if they rise no further.

    Where many samples have the same height, no level may be exceeded by just that share.
    """
    falling = np.sort(high)[::-1]
    wanted = max(1, int(share * high.size))
    height = float(falling[wanted])
    above = int(np.count_nonzero(high > height))
    if above >= 0.5 * wanted:
        return height
    below = high[high < height]
    if below.size and 2 * (high.size - below.size) <= high.size:
        return float(below.max())
    return height if above > 0 else None
