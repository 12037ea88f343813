"""Directions in which failure lies, to lead lines along: one for each region that matters.

A direction comes from gradients on the way to a point of the limit state that is nearest to the
origin. One region found says nothing of others. So points far out are run, in all directions: where
one of them fails and no plane found explains it, another search starts there. In d dimensions they
lie so far out that a plane as near as the nearest one has one in ten of them behind it. A short
climb of subset simulation looks for regions that end before.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, field

import numpy as np

from uqfold.methods.crossings import Lines
from uqfold.methods.line_laws import normal_law
from uqfold.methods.rare_event import NestedCriteria, Running
from uqfold.methods.subset_climb import piloted
from uqfold.typing import BoolArray, FloatArray

STEP = 0.1
"""Differences are taken over this length, in standard deviations of the inputs."""
STEPS = 6
"""Gradients on the way to one region at most."""
ARRIVED = 0.1
"""A point so near to the foot of its own plane, relative to the plane's distance, is arrived."""
LOOKS, MOST_LOOKS, PART_OF_LOOKS = 100, 2_000, 5
"""Points far out, fewest and most, else one part in so many of the runs."""
FEWEST_SEEN = 5
"""So many of them have to fail: fewer would hardly tell of other regions of failure."""
LOOKS_AGAIN = 3
"""Times that they are drawn at most, since they belong to a distance."""
CLIMB, FEWEST_OF_CLIMB, PART_OF_CLIMB, LEVEL_PROBABILITY = 100, 50, 15, 0.1
"""Samples at each level of a climb that looks for regions which do not reach far out: most and
fewest, else one part in so many of the runs; and the share of them that leads to the next level."""
MOVED = 0.3
"""They are drawn again if that distance has changed by more than this."""
SHARE_BEYOND = 0.1
"""Share of the points far out that a plane as near as the nearest one has behind it."""
EXPLAINED = 0.95
"""A failure beyond this part of a plane's distance is one that the plane explains."""
NEGLIGIBLE = 1e-3
"""A region with less than this share of the probability of all has no lines of its own."""
MOST_DIRECTIONS = 20
SHARE_OF_RUNS = 0.8
"""Of the runs, the search may take so much: few lines say more than a wrong direction."""
FARTHEST = 9.0
"""No limit state is looked for further out: the probability is 1e-19."""
LARGEST_COORDINATE = 8.0
"""Points far out are cut here: models seldom mean anything beyond."""
ALIKE = 0.999
"""Directions with a larger cosine than this belong to the same region."""
UNKNOWN_DISTANCES = (4.0, 6.0, 8.0)
"""How far out failures are looked for as long as no region is known."""


@dataclass(eq=False)
class DirectionSearch:
    """The search for regions of failure, seen from the origin.

    Attributes
    ----------
    asked
        What fails, and how it is run.
    rng
        Source of randomness.
    alphas, betas
        Unit vectors (K, d) towards failure, and the distances (K,) at which failure begins along
        them, the nearest first.
    led
        Whether gradients have led there (K,): else it is the way to a failure, and how near its
        region comes is not known.
    unexplained
        Failures found that no direction explains.
    """

    asked: NestedCriteria
    rng: np.random.Generator
    alphas: FloatArray = field(init=False)
    betas: FloatArray = field(default_factory=lambda: np.empty(0))
    led: BoolArray = field(default_factory=lambda: np.empty(0, dtype=np.bool_))
    unexplained: int = 0
    _most: int = field(init=False)

    def __post_init__(self) -> None:
        self.alphas = np.empty((0, self.asked.event.dimension))
        self._most = self.asked.session.n_evals + int(SHARE_OF_RUNS * self.asked.left)

    @property
    def affordable(self) -> int:
        """Samples that the runs that are left for it pay for."""
        left = self._most - self.asked.session.n_evals
        return left // self.asked.event.max_evals_per_sample

    def find(self) -> Running[list[str]]:
        """Find the regions; return why lines would not reach all failures, or nothing."""
        dimension = self.asked.event.dimension
        for alpha, _ in (yield from self._towards(np.zeros(dimension)))[:1]:
            self._add(alpha, (yield from self._begins(alpha, FARTHEST)))
        distances = list(UNKNOWN_DISTANCES)
        for _ in range(LOOKS_AGAIN):
            distance = float(self.betas[0]) if self.betas.size else distances.pop(0)
            doubts = yield from self._look(distance)
            if doubts:
                return doubts
            if self.betas.size and abs(self.betas[0] - distance) < MOVED:
                break
        if self.betas.size:
            return (yield from self._climb())
        return [f"no failure found within {FARTHEST:g} standard deviations of the inputs"]

    def _climb(self) -> Running[list[str]]:
        """Climb to failures wherever the response leads, and follow what is not explained."""
        size = min(CLIMB, self.affordable // PART_OF_CLIMB)
        if size < FEWEST_OF_CLIMB:
            return []
        most = self.affordable // 2
        pilot = yield from piloted(self.asked, size, LEVEL_PROBABILITY, most, self.rng)
        assert pilot.last is not None
        fails = self.asked.fail(pilot.last.high)[0]
        return (yield from self._follow(pilot.last.u[fails], pilot.last.high[fails]))

    def _look(self, distance: float) -> Running[list[str]]:
        """Look far out in all directions, and follow what is not explained."""
        if self.affordable < LOOKS:
            return ["the runs are too few to look for regions of failure"]
        number = min(max(LOOKS, self.affordable // PART_OF_LOOKS), MOST_LOOKS)
        u = _far_out(number, self.asked.event.dimension, distance, self.rng)
        if self.asked.event.random_missions:
            # all missions are flown: none of them is to be overlooked
            u[:, -1] = LARGEST_COORDINATE
        _, high = yield from self.asked.heights(u)
        fails = self.asked.fail(high)[0]
        if self.betas.size and np.count_nonzero(fails) < FEWEST_SEEN:
            few = f"only {np.count_nonzero(fails)} of {number} points far out fail"
            return [f"{few}, too few to tell of other regions of failure"]
        return (yield from self._follow(u[fails], high[fails]))

    def _follow(self, points: FloatArray, heights: FloatArray) -> Running[list[str]]:
        """Look for directions to failures (n, d) of some heights (n,) until all are explained."""
        while True:
            left = np.flatnonzero(~self._explains(points))
            self.unexplained = left.size
            if not left.size:
                return []
            gradient = self.asked.event.dimension + 1
            if len(self.betas) >= MOST_DIRECTIONS or self.affordable < gradient:
                break
            point = points[left[int(np.argmax(heights[left]))]]
            length = float(np.linalg.norm(point))
            ray = point / length
            begin = yield from self._begins(ray, length)
            begin = min(begin, length)
            for alpha, beta in (yield from self._towards(begin * ray)):
                along = yield from self._begins(alpha, FARTHEST)
                # the ray from the origin may miss what lies aside of it, behind the plane
                self._add(alpha, min(along, beta) if beta > 0.0 else along)
                if self._explains(point[None, :]).any():
                    break
            else:
                # the way from there has led back to what is known
                self._add(ray, begin, led=False)
        return [
            f"{self.unexplained} of {len(points)} failures found lie where none of "
            f"{len(self.betas)} directions leads"
        ]

    def _explains(self, points: FloatArray) -> BoolArray:
        """Whether each point (k, d) lies beyond, or nearly beyond, a plane that is known."""
        if not self.betas.size:
            return np.zeros(len(points), dtype=np.bool_)
        return np.asarray((points @ self.alphas.T >= EXPLAINED * self.betas).any(axis=1))

    def _towards(self, start: FloatArray) -> Running[list[tuple[FloatArray, float]]]:
        """Walk to the nearest point of a limit state.

        Return the direction of the gradient nearest to it, and that of the first one, with the
        distances of their planes; none where there is no gradient.
        """
        dimension, limit = start.size, float(self.asked.limits[0])
        u, best, found = start, None, []
        for _ in range(STEPS):
            if best is not None and self.affordable < 3 * (dimension + 1) + 2 * LOOKS:
                break
            if self.affordable < dimension + 1:
                break
            height, gradient = yield from self._gradient(u)
            slope = math.hypot(*gradient)
            if not (math.isfinite(slope) and slope > 0.0 and math.isfinite(height)):
                break
            alpha = gradient / slope
            beta = (limit - height) / slope + float(alpha @ u)
            found.append((alpha, beta))
            foot = min(max(beta, -FARTHEST), FARTHEST) * alpha
            residual = float(np.linalg.norm(u - foot))
            if best is None or residual < best[0]:
                best = residual, (alpha, beta), foot
                u = foot
            else:
                u = 0.5 * (u + best[2])
            if residual < ARRIVED * max(1.0, abs(beta)):
                break
        return found if best is None else [best[1], found[0]]

    def _gradient(self, u: FloatArray) -> Running[tuple[float, FloatArray]]:
        """Height at u (d,), and its forward differences (d,); zero where there is none."""
        around = np.vstack([u, u + STEP * np.eye(u.size)])
        _, high = yield from self.asked.heights(around)
        with np.errstate(invalid="ignore"):
            rise = (high[1:] - high[0]) / STEP
        return float(high[0]), np.where(np.isfinite(rise), rise, 0.0)

    def _begins(self, ray: FloatArray, reach: float) -> Running[float]:
        """How far out failure begins along a ray, 0 at the origin; +inf if it does not."""
        inner = reach * np.linspace(0.2, 0.8, 4)[None, :]
        line = Lines(
            self.asked, np.zeros((1, ray.size)), ray[None, :], normal_law(), np.zeros(1),
            np.full(1, reach),
        )  # fmt: skip
        if self.affordable < 2 * inner.size:
            return math.inf
        traces = yield from line.followed(inner)
        return max(0.0, float(traces.segments.first_failures(1)[0]))

    def _add(self, alpha: FloatArray, beta: float, *, led: bool = True) -> None:
        """Note a direction, or that it is a better one than an old one like it."""
        alike = self.alphas @ alpha > ALIKE
        if math.isinf(beta) or (alike & (self.betas <= beta)).any():
            return
        alphas = np.vstack([self.alphas[~alike], alpha])
        betas = np.append(self.betas[~alike], beta)
        leds = np.append(self.led[~alike], led)
        order = np.argsort(betas, kind="stable")
        self.alphas, self.betas, self.led = alphas[order], betas[order], leds[order]

    def weighty(self) -> tuple[FloatArray, FloatArray, BoolArray]:
        """Directions (K, d), distances (K,) and `led` (K,) of regions that are not negligible."""
        from scipy.special import ndtr

        shares = ndtr(-self.betas)
        kept = (shares >= NEGLIGIBLE * shares.sum()) | ~self.led
        return self.alphas[kept], self.betas[kept], self.led[kept]


def _far_out(number: int, dimension: int, distance: float, rng: np.random.Generator) -> FloatArray:
    """Points (k, d) in all directions, so far out that planes at a distance are met."""
    from scipy.special import betaincinv

    u = rng.standard_normal((number, dimension))
    u /= np.linalg.norm(u, axis=1, keepdims=True)
    cosine = 0.0
    if dimension > 1:
        # the square of one coordinate of a unit vector has a beta law
        quantile = betaincinv(0.5, 0.5 * (dimension - 1), 1.0 - 2.0 * SHARE_BEYOND)
        cosine = math.sqrt(float(quantile))
    far = distance / cosine if cosine > 0.0 else 0.0
    # where that is hardly beyond the plane: as far as a plane of a negligible probability
    near = math.sqrt(distance**2 - 2.0 * math.log(NEGLIGIBLE))
    radius = np.linspace(distance, near, number)[:, None] if near > far else far
    return np.clip(radius * u, -LARGEST_COORDINATE, LARGEST_COORDINATE)
