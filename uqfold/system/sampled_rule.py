"""Random lines and rays, for surfaces that no product of quadrature rules resolves.

Rays start at the origin of the individual variables, and along each of them the radius is
integrated exactly: what is drawn are directions, from a mixture that is adapted, level by level,
to where failure lies (improved cross-entropy). Random lines run along the direction in which the
surface changes most, at places adapted likewise. Rays suit surfaces that close around the origin
and several failure regions, lines suit what bends in many directions; a trial of both tells which.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import TypeAlias

import numpy as np

from uqfold.system.directions import DirectionMixture
from uqfold.system.lines import REACH, LineRule, line_masses, radial_mass, radial_reach
from uqfold.system.places import Places, failure_places
from uqfold.typing import FloatArray, IntArray

Values: TypeAlias = Callable[[FloatArray], FloatArray]
"""Takes points (n, d_individual), gives the surface (K, n) at K places of the shared variables."""

SAMPLED_STATIONS = (41, 81, 161, 321)
"""Points along a random line: as many as its crossings need, odd numbers."""
_FEW_STATIONS = 33
_RAYS = 300
_COMPONENTS = 4
_MOST_LEVELS, _MOST_STEPS = 3, 12
# Coefficient of variation of the weights up to which a mixture is taken for adapted.
_ADAPTED = 1.5
# Share of directions that are drawn uniformly, whatever has been found.
_WIDE = 0.2


def random_lines(
    along: FloatArray,
    across: FloatArray,
    places: Places,
    size: int,
    stations: int,
    asked: FloatArray,
    rng: np.random.Generator,
) -> LineRule:
    """Lines along one direction (d,), at places drawn in the other directions (d, d - 1)."""
    positions = np.linspace(-REACH, REACH, stations)
    drawn = places.draw(size, rng)
    weights = np.exp(-places.log_density(drawn)) / size
    points = _on_lines(drawn, positions, along, across)
    return LineRule(points, weights, positions, asked=asked, sampled=True)


def places_of_failure(
    values: Values,
    along: FloatArray,
    across: FloatArray,
    asked: FloatArray,
    rng: np.random.Generator,
) -> Places:
    """Find where lines along one direction (d,) lead to each of the thresholds, or to some.

    Parameters
    ----------
    values
        The surface.
    along, across
        The direction (d,) of the lines, and the others (d, d - 1).
    asked
        Thresholds (T,).
    rng
        Source of the places tried.
    """
    thresholds = np.unique(asked[_picked(asked.size)])
    positions = np.linspace(-REACH, REACH, _FEW_STATIONS)
    sides: list[bool] = []

    def failing(places: FloatArray) -> FloatArray:
        table = values(_on_lines(places, positions, along, across))
        table = table.reshape(-1, places.shape[0], positions.size)
        above = np.array([line_masses(table, threshold) for threshold in thresholds])
        if not sides:
            sides.extend(above.mean(axis=1) <= 0.5)
        return np.where(np.array(sides)[:, None], above, 1.0 - above)

    return failure_places(failing, across.shape[1], rng)


def _on_lines(
    places: FloatArray, positions: FloatArray, along: FloatArray, across: FloatArray
) -> FloatArray:
    points = (places @ across.T)[:, None, :] + positions[:, None] * along
    return np.asarray(points.reshape(-1, along.size))


def _picked(count: int) -> IntArray:
    """Which of many thresholds places and directions are looked for."""
    return np.linspace(0, count - 1, min(count, _MOST_LEVELS)).round().astype(int)


def random_rays(
    mixture: DirectionMixture,
    size: int,
    stations: int,
    asked: FloatArray,
    rng: np.random.Generator,
) -> LineRule:
    """Rays in directions drawn from a mixture, weighted so that means are those of all rays."""
    d = mixture.means.shape[1]
    directions = mixture.draw(size, rng)
    radii = np.linspace(0.0, radial_reach(d), stations)
    points = (directions[:, None, :] * radii[:, None]).reshape(-1, d)
    weights = np.exp(-mixture.log_density(directions)) / size
    return LineRule(points, weights, radii, asked=asked, radial=d, sampled=True)


def failure_directions(
    values: Values,
    dimension: int,
    asked: FloatArray,
    rng: np.random.Generator,
) -> DirectionMixture:
    """Find directions that lead to each of the thresholds, or to some spread among many.

    Parameters
    ----------
    values
        The surface.
    dimension
        Number of individual variables d.
    asked
        Thresholds (T,).
    rng
        Source of the directions tried.
    """
    picked = _picked(asked.size)
    radii = np.linspace(0.0, radial_reach(dimension), _FEW_STATIONS)
    edges = np.concatenate([[0.0], 0.5 * (radii[1:] + radii[:-1]), [np.inf]])
    cells = radial_mass(dimension, edges[:-1], edges[1:])
    uniform = DirectionMixture.uniform(dimension)

    def tried(mixture: DirectionMixture) -> _Trial:
        directions = mixture.draw(_RAYS, rng)
        points = (directions[:, None, :] * radii[:, None]).reshape(-1, dimension)
        table = values(points)
        table = table.reshape(table.shape[0], _RAYS, radii.size)
        return _Trial(directions, -mixture.log_density(directions), table, cells)

    first = tried(uniform)
    found = [(_WIDE, uniform)]
    share = (1.0 - _WIDE) / picked.size
    for threshold in np.unique(asked[picked]):
        above = first.probability(threshold) <= 0.5
        trial, mixture = first, uniform
        width = 10.0 * first.spread
        for _ in range(_MOST_STEPS):
            width, logs = trial.narrowed(threshold, width, above=above)
            if not np.isfinite(logs).any():
                break
            weights = np.exp(logs - logs.max())
            mixture = DirectionMixture.fitted(trial.directions, weights, _COMPONENTS, rng)
            if width == 0.0:
                break
            trial = tried(mixture)
        found.append((share, mixture))
    return DirectionMixture.of(found)


class _Trial:
    """Some rays, the surface along them, and how much of a softened failure each of them holds."""

    def __init__(
        self, directions: FloatArray, log_weights: FloatArray, table: FloatArray, cells: FloatArray
    ) -> None:
        self.directions = directions
        self._log_weights = log_weights
        self._table = table
        self._cells = cells
        mean = (table.mean(axis=(0, 1)) @ cells) / cells.sum()
        square = ((table - mean) ** 2).mean(axis=(0, 1)) @ cells
        self.spread = max(math.sqrt(float(square)), 1e-300)

    def probability(self, threshold: float) -> float:
        """Probability of values above a threshold, roughly."""
        above = (self._table > threshold).mean(axis=0) @ self._cells
        weights = np.exp(self._log_weights)
        return float(weights @ above / weights.sum())

    def narrowed(self, threshold: float, width: float, *, above: bool) -> tuple[float, FloatArray]:
        """Return the narrowest softening, below `width`, that these rays bear, and log weights."""
        hard = self._logs(threshold, 0.0, above=above)
        if _variation(hard) <= _ADAPTED:
            return 0.0, hard
        low, high = math.log(1e-9 * self.spread), math.log(width)
        for _ in range(25):
            middle = 0.5 * (low + high)
            logs = self._logs(threshold, math.exp(middle), above=above)
            low, high = (middle, high) if _variation(logs) > _ADAPTED else (low, middle)
        return math.exp(high), self._logs(threshold, math.exp(high), above=above)

    def _logs(self, threshold: float, width: float, *, above: bool) -> FloatArray:
        from scipy.special import ndtr

        # far from a threshold near the largest number the distance is infinite, as good as any
        with np.errstate(divide="ignore", over="ignore"):
            distance = self._table - threshold if above else threshold - self._table
            soft = (distance > 0.0).astype(float) if width == 0.0 else ndtr(distance / width)
            return np.asarray(np.log(soft.mean(axis=0) @ self._cells) + self._log_weights)


def _variation(logs: FloatArray) -> float:
    top = logs.max()
    if not np.isfinite(top):
        return math.inf
    weights = np.exp(logs - top)
    return float(weights.std() / weights.mean())
