"""How finely a surface must be integrated: each direction refined by itself.

The principal directions of the surface's gradient come first. Along each of them the distribution
of the surface is found with ever finer rules, until it stops changing, far tails included.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import TypeAlias

import numpy as np

from uqfold.moments.conditional import AtomicDistribution
from uqfold.moments.tabulated import TabulatedDistribution
from uqfold.system.cross_rules import EQUAL_STEPS, GAUSS, LADDER, Rule, ladder_rule
from uqfold.system.lines import REACH, LineRule
from uqfold.typing import FloatArray

Surface: TypeAlias = Callable[[FloatArray], FloatArray]
"""Takes u (n, d) in standard-normal space, gives responses (n,)."""

TOLERANCE = 3e-4
"""Change of a normal score, up to scores of 6.2, that is no longer worth a finer rule."""
STATIONS = (41, 65, 129, 257)
_MANY = 8
_COMPARED_SCORES = np.linspace(-6.2, 6.2, 17)
_LOOK_AT, _SPREAD, _STEP = 256, 1.7, 0.05
_MOST_NUMBERS = 4_000_000


@dataclass(frozen=True, eq=False)
class Axes:
    """Principal directions of a surface, in columns.

    Attributes
    ----------
    shared, individual
        Of the s shared variables (s, s), and of the others (d - s, d - s).
    """

    shared: FloatArray
    individual: FloatArray

    @classmethod
    def of(
        cls, surface: Surface, dimension: int, n_shared: int, shared: FloatArray | None = None
    ) -> Axes:
        """Directions of falling influence over body and tails; those `shared` may be known."""
        gradients = gradients_of(surface, dimension)
        if shared is None:
            shared = principal(gradients[:, :n_shared])
        return cls(shared, principal(gradients[:, n_shared:]))

    def led_by(self, first: int) -> Axes:
        """The same directions, with lines along another individual one."""
        order = [first, *(i for i in range(self.individual.shape[1]) if i != first)]
        return Axes(self.shared, self.individual[:, order])

    @property
    def across(self) -> FloatArray:
        """All directions but the main individual one, shared ones first: (d, d - 1)."""
        s, i = self.shared.shape[0], self.individual.shape[0]
        block = np.zeros((s + i, s + i - 1))
        block[:s, :s] = self.shared
        block[s:, s:] = self.individual[:, 1:]
        return block

    @property
    def along(self) -> FloatArray:
        """The main individual direction (d,), along which lines run."""
        return np.concatenate([np.zeros(self.shared.shape[0]), self.individual[:, 0]])


@dataclass(frozen=True)
class Need:
    """The rule that one direction needs.

    Attributes
    ----------
    level
        Rung of the ladder of rules.
    errors
        What this rung and each coarser one, from the coarsest, leaves as a change of the normal
        score.
    """

    level: int
    errors: tuple[float, ...]

    @classmethod
    def of_all(cls, rungs: int) -> Need:
        """Return the last of so many rungs, as if each of them halved the error."""
        return cls(rungs - 1, tuple(0.5**rung for rung in range(rungs)))

    def together(self, other: Need) -> Need:
        """Return what meets both needs."""
        size = max(self.level, other.level) + 1
        # beyond what one of them was refined to, its error is the last one
        mine = (*self.errors, *[self.errors[-1]] * (size - len(self.errors)))
        others = (*other.errors, *[other.errors[-1]] * (size - len(other.errors)))
        return Need(size - 1, tuple(max(pair) for pair in zip(mine, others, strict=True)))

    def at_least(self, level: int) -> Need:
        """Return a rule at least as fine as a rung, because coarser ones are known to be bad."""
        if self.level >= level:
            return self
        return Need(level, (*(1.0,) * level, self.errors[-1]))

    def finer(self) -> Need:
        """Return the next finer rule; the smallest ones are exact for what they are chosen for."""
        if self.level < len(GAUSS) - 1 or self.level + 1 >= len(LADDER):
            return self
        return Need(self.level + 1, (*self.errors, self.errors[-1]))


@dataclass(frozen=True, eq=False)
class Compared:
    """Where distributions are compared to see whether refinement still changes them.

    Attributes
    ----------
    asked
        Thresholds (T,) that matter; None: the whole distribution does.
    alone
        Whether the scores of the thresholds themselves are all that matters, as where no input is
        shared; otherwise all scores that are no further out.
    """

    asked: FloatArray | None = None
    alone: bool = False

    def levels(self, distribution: TabulatedDistribution) -> FloatArray:
        """Levels at which to compare, spread in the scores of a distribution."""
        scores = _COMPARED_SCORES
        if self.asked is not None:
            own = np.interp(self.asked, distribution.levels, distribution.scores)
            own = np.clip(own, scores[0], scores[-1])
            farthest = min(max(float(np.abs(own).max()) + 1.5, 3.0), scores[-1])
            scores = own if self.alone else farthest / scores[-1] * scores
        inside = np.clip(scores, distribution.scores[0], distribution.scores[-1])
        return np.interp(inside, distribution.scores, distribution.levels)

    @property
    def exact(self) -> FloatArray:
        """Thresholds that tables are to hold exactly."""
        return np.empty(0) if self.asked is None else self.asked


UNKNOWN = Need(0, (math.inf,))
"""Of a direction that was not looked at."""


def refined(
    surface: Surface,
    axes: Axes,
    together: int,
    compared: Compared,
    most: float,
) -> tuple[list[Need], Need]:
    """Needs of all directions across, and along each line (a rung of `STATIONS`).

    Refinement starts from the centre and from a place in the tail. Shared directions get a finer
    rule than the distribution itself needs, because failure of many units or missions is a
    steeper function of the shared variables: a finer one still for more than a few of them.

    Parameters
    ----------
    surface, axes
        The surface and its directions.
    together
        How many responses, units times missions, a system takes.
    compared
        Where changes count.
    most
        Points beyond which no rule is worth looking for; directions not looked at by then have an
        infinite error.
    """
    across = axes.across
    d, count = across.shape
    # far out in the first direction, moderately in the others
    out = np.concatenate([[2.5], np.ones(max(count - 1, 0))])[:count]
    needs: list[Need] = []
    for base in (np.zeros(d), across @ out):
        here, size = [], 1
        for direction in across.T:
            known = size <= most
            here.append(_need(surface, axes, base, direction, compared) if known else UNKNOWN)
            size *= LADDER[here[-1].level]
        here.append(_along(surface, axes, base, compared))
        needs = [a.together(b) for a, b in zip(needs, here, strict=True)] if needs else here
    shared = axes.shared.shape[0]
    for _ in range(2 if together > _MANY else 1):
        needs[:shared] = [need.finer() for need in needs[:shared]]
    return needs[:-1], needs[-1]


_Distribution: TypeAlias = TabulatedDistribution | AtomicDistribution


def _need(
    surface: Surface,
    axes: Axes,
    base: FloatArray,
    direction: FloatArray,
    compared: Compared,
) -> Need:
    def found(level: int) -> _Distribution:
        nodes, weights = ladder_rule(level)
        starts = base + nodes[:, None] * direction
        return _on_lines(surface, axes, (starts, weights), STATIONS[0], compared)

    first = len(GAUSS)
    finer = found(first)
    errors: list[float] = []
    for level in range(first):
        errors.append(_distance(found(level), finer, compared))
        if errors[-1] <= TOLERANCE:
            return Need(level, tuple(errors))
    for level in range(first, first + len(EQUAL_STEPS) - 1):
        coarser, finer = finer, found(level + 1)
        errors.append(_distance(coarser, finer, compared))
        if errors[-1] <= TOLERANCE:
            return Need(level, tuple(errors))
    return Need(len(LADDER) - 1, (*errors, errors[-1]))


def _along(surface: Surface, axes: Axes, base: FloatArray, compared: Compared) -> Need:
    start = base[None, :], np.ones(1)
    errors: list[float] = []
    finer = _on_lines(surface, axes, start, STATIONS[0], compared)
    for level in range(len(STATIONS) - 1):
        coarser, finer = finer, _on_lines(surface, axes, start, STATIONS[level + 1], compared)
        errors.append(_distance(coarser, finer, compared))
        if errors[-1] <= TOLERANCE:
            return Need(level, tuple(errors))
    return Need(len(STATIONS) - 1, (*errors, errors[-1]))


def _on_lines(
    surface: Surface, axes: Axes, starts: Rule, stations: int, compared: Compared
) -> _Distribution:
    positions = np.linspace(-REACH, REACH, stations)
    points = (starts[0][:, None, :] + positions[:, None] * axes.along).reshape(-1, axes.along.size)
    lines = LineRule(points, starts[1], positions, compared.alone, compared.exact)
    found = lines.response(surface(points)).distribution
    assert isinstance(found, TabulatedDistribution | AtomicDistribution)
    return found


def _distance(one: _Distribution, other: _Distribution, compared: Compared) -> float:
    """Largest difference of normal scores where it counts."""
    if isinstance(one, AtomicDistribution) or isinstance(other, AtomicDistribution):
        return 0.0 if type(one) is type(other) else math.inf
    levels = compared.levels(other)
    return float(np.abs(one.score(levels) - other.score(levels)).max())


def shared_axes(
    surfaces: Sequence[Surface], dimensions: Sequence[int], n_shared: int
) -> FloatArray:
    """Principal directions (s, s) of the shared variables for several surfaces together.

    Each surface counts by its gradients relative to their own size.
    """
    pooled = []
    for surface, dimension in zip(surfaces, dimensions, strict=True):
        gradients = gradients_of(surface, dimension)
        size = math.sqrt(float(np.mean(gradients**2)))
        pooled.append(gradients[:, :n_shared] / (size if size > 0.0 else 1.0))
    return principal(np.vstack(pooled))


def gradients_of(surface: Surface, dimension: int) -> FloatArray:
    """Differences (points, d) over body and tails, as gradients go."""
    centre = _SPREAD * np.random.default_rng(0).standard_normal((_LOOK_AT, dimension))
    gradients = np.empty((_LOOK_AT, dimension))
    # several variables at a time, but not all of many: the points would fill the memory
    block = max(1, _MOST_NUMBERS // (2 * _LOOK_AT * dimension))
    for start in range(0, dimension, block):
        shifts = _STEP * np.eye(dimension)[start : start + block]
        points = np.vstack([centre + sign * shift for shift in shifts for sign in (1.0, -1.0)])
        values = surface(points).reshape(len(shifts), 2, _LOOK_AT)
        gradients[:, start : start + block] = (values[:, 0] - values[:, 1]).T
    return gradients


def principal(gradients: FloatArray) -> FloatArray:
    """Directions in columns, by falling share of the mean squared gradient."""
    basis = np.linalg.eigh(gradients.T @ gradients)[1]
    return np.asarray(basis[:, ::-1])
