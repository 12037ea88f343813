"""A second look at a design point: its curvature, its place, and where else failure may be near.

FORM puts a plane through the design point. Runs around the point tell by how much the limit state
leaves that plane; runs further off tell where another search should start. All changes are
relative ones of the smaller of the two probabilities of one unit, as natural logarithms.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from uqfold.methods.design_point import NOTICEABLE, Search, SecondLook
from uqfold.methods.standard_space import (
    SEARCH_RADIUS,
    Linearisation,
    NoGradientError,
    StandardSpaceResponse,
)
from uqfold.methods.stratified import stratified_points
from uqfold.typing import FloatArray

FAR_OUT = math.sqrt(3.0)
"""Curvature is seen over this length, the outer node of three-point Gauss quadrature, and over one
standard deviation."""
OUTERMOST, SEEN_THERE = 2.857, 0.015
"""Kinks further out are looked for there, at the outermost node of five-point Gauss quadrature,
with the weight by which one from `FAR_OUT` on counts as a whole: E max(v - sqrt 3, 0) = 0.0169."""
SLANTED = 6
"""Directions, drawn among all tangent ones, along which such kinks are looked for as well."""
CLOSE_BY = 0.1
"""Change of the probability over which the response has to run through T like a line."""
FEW = 9
"""Tangent directions up to which every pair of them is looked at."""
PROBES = 6
"""Mixtures of all tangent directions that stand for the pairs of more than `FEW`."""
DRAWN = 100
"""Points of the plane, to see what lies between the directions looked at."""
AROUND = 100
"""Points all around, the same ones for all design points."""
RANDOM_RAYS = 4
"""Rays that are drawn, at right angles to the design point, beside the axes."""
EXPECTED = 0.9
"""A search starts where the limit state is nearer than this share of its distance by the plane."""
EXPLAINED = 0.95
"""Share of the way to the plane beyond which a failure is one that the plane knows of."""
FURTHEST_SHARE = 1e-3
"""Share of the probability from which a domain of failure on another ray counts."""
BEHIND = 10
"""Points straight behind the design point, each for a tenth of what lies beyond its plane."""
HALVINGS = 6
"""Of a ray, to tell where failure begins."""


@dataclass(frozen=True, eq=False)
class Surroundings:
    """The margin around the best point of a search, in standard deviations.

    Attributes
    ----------
    response, search
        Counted access to the response, and the search that found the point.
    """

    response: StandardSpaceResponse
    search: Search

    @property
    def side(self) -> float:
        """1 where failure lies beyond the point, -1 where the origin fails."""
        return math.copysign(1.0, self.search.best.beta(self.search.threshold))

    @property
    def towards(self) -> FloatArray:
        """Unit vector (d,) from the origin to the point."""
        return self.side * self.search.best.alpha

    @property
    def radius(self) -> float:
        """Distance of the point from the origin."""
        return abs(self.search.best.beta(self.search.threshold))

    @property
    def probability(self) -> float:
        """Probability beyond the plane, Phi(-radius)."""
        from scipy.special import ndtr

        return float(ndtr(-self.radius))

    @property
    def rate(self) -> float:
        """Density over probability beyond the plane, phi / Phi(-radius)."""
        from scipy.special import log_ndtr

        log_density = -0.5 * self.radius**2 - 0.5 * math.log(2.0 * math.pi)
        return math.exp(log_density - float(log_ndtr(-self.radius)))

    def margin(self, points: FloatArray) -> FloatArray:
        """Distances (k,) beyond the limit state, by the slope at the point; points (k, d)."""
        values = self.response.values(points)
        return self.side * self.search.best.beyond(values, self.search.threshold)

    def folded(self, directions: FloatArray, length: float) -> tuple[FloatArray, FloatArray]:
        """Curvatures (k,) over +-length, positive away from the origin, and odd parts (k,)."""
        foot, steps = self.radius * self.towards, length * directions
        both = self.margin(foot + np.vstack([np.zeros_like(foot), steps, -steps]))
        ahead, back = np.split(both[1:], 2)
        return (2.0 * both[0] - ahead - back) / length**2, 0.5 * (ahead - back)

    def curvatures(self) -> tuple[FloatArray, FloatArray, FloatArray, float]:
        """Tangent directions (k, d), and curvatures (k, k) over one deviation and over `FAR_OUT`.

        Of more than ten inputs only the main diagonal is known, and the last number is what the
        others may change the probability by, as a logarithm.
        """
        room = SEARCH_RADIUS**2 - self.radius**2
        far = min(FAR_OUT, math.sqrt(max(room, 0.0)))
        near = far / FAR_OUT
        tangents = np.linalg.qr(self.towards[:, None], mode="complete")[0][:, 1:].T
        bend, bend_far = (self.folded(tangents, length)[0] for length in (near, far))
        mixed, hidden = self._mixed(tangents, bend, near)
        return tangents, np.diag(bend) + mixed, np.diag(bend_far) + mixed, self.rate**2 * hidden

    def second_order(self) -> float:
        """Factor of second order to the smaller probability, from the curvatures alone."""
        if SEARCH_RADIUS**2 - self.radius**2 < 0.01:
            return 1.0
        _, *both, hidden = self.curvatures()
        if not np.isfinite(both).all():
            return 1.0
        return math.exp(max((_second_order(one, self.rate)[0] + hidden for one in both), key=abs))

    def second_look(self) -> SecondLook:
        """Look along the normal and in every tangent direction.

        Takes 113 + 4 (d - 1) runs, 12 + d (d - 1) more up to ten inputs (2 in two), twelve beyond;
        2 d + 5 on other rays; and `AROUND` that all design points share.

        Raises
        ------
        BudgetExceededError
            If the runs do not fit.
        """
        room = SEARCH_RADIUS**2 - self.radius**2
        if room < 0.01:
            return SecondLook(1.0, 0.0, math.inf, 0.0, 0.0)
        tangents = np.linalg.qr(self.towards[:, None], mode="complete")[0][:, 1:].T
        far = min(FAR_OUT, math.sqrt(room))
        near = far / FAR_OUT
        with np.errstate(invalid="ignore"):
            place = self._misplaced()
            bend, odd = self.folded(tangents, near)
            bend_far, odd_far = self.folded(tangents, far)
            slant = np.maximum(odd**2, 0.5 * odd_far**2).sum()
            mixed, hidden = self._mixed(tangents, bend, near)
        if not np.isfinite([place, slant, hidden, *bend, *bend_far, *mixed.ravel()]).all():
            return SecondLook(1.0, 0.0, math.inf, 0.0, 0.0)
        outside = 0.0
        if 0 < len(tangents) <= FEW:
            turned = self._slanted(len(tangents))
            seen = self._outside(
                turned @ tangents, odd_far @ turned.T / far,
                np.einsum("ij,jk,ik->i", turned, np.diag(bend_far) + mixed, turned),
                min(OUTERMOST, math.sqrt(room)),
            )  # fmt: skip
            outside = max(float(seen[: len(tangents)].sum()), float(seen.max()))
        orders = [_second_order(np.diag(main) + mixed, self.rate) for main in (bend, bend_far)]
        unknown = self.rate**2 * hidden
        return SecondLook(
            second_order=math.exp(max((net + unknown for net, _ in orders), key=abs)),
            curvature=max(sizes for _, sizes in orders) + unknown,
            place=self.rate * place + 0.5 * self.rate**2 * float(slant) + outside + self._behind(),
            sampled=self._sampled(),
            elsewhere=self.elsewhere(),
        )

    def _misplaced(self) -> float:
        """How far T lies from the point along the normal, and the response from a line there."""
        close = CLOSE_BY / self.rate
        lengths = self.radius + close * np.array([0.0, 1.0, -1.0])
        here, ahead, back = self.margin(np.outer(lengths, self.towards)).tolist()
        slope = (ahead - back) / (2.0 * close)
        if not 0.5 < slope < 2.0:
            return math.inf
        return float((abs(here) + 0.5 * abs(ahead + back - 2.0 * here)) / slope)

    def _behind(self) -> float:
        """Return what is changed by points straight behind the design point that work again."""
        from scipy.special import ndtr, ndtri

        shares = (np.arange(BEHIND) + 0.5) / BEHIND
        depths = np.minimum(-ndtri(shares * ndtr(-self.radius)), SEARCH_RADIUS)
        works = float((self.margin(depths[:, None] * self.towards) < 0.0).mean())
        return -math.log1p(-works) if works < 1.0 else math.inf

    def _slanted(self, k: int) -> FloatArray:
        """Unit vectors (k + SLANTED, k): the k tangents themselves, and directions among them."""
        drawn = np.random.default_rng(0).normal(size=(SLANTED if k > 1 else 0, k))
        return np.vstack([np.eye(k), drawn / np.linalg.norm(drawn, axis=1, keepdims=True)])

    def _outside(
        self, directions: FloatArray, slopes: FloatArray, curvatures: FloatArray, length: float
    ) -> FloatArray:
        """Changes (k,) by what departs, far out along directions (k, d), from a parabola there."""
        from scipy.special import log_ndtr

        foot, steps = self.radius * self.towards, length * directions
        by_parabola = np.stack([length * slopes, -length * slopes]) - 0.5 * curvatures * length**2
        both = self.margin(foot + np.vstack([steps, -steps])).reshape(2, -1)
        with np.errstate(invalid="ignore", over="ignore"):
            logs = log_ndtr(both - by_parabola - self.radius) - log_ndtr(-self.radius)
            return np.asarray(SEEN_THERE * np.abs(np.expm1(logs).sum(axis=0)))

    def drawn(self) -> tuple[FloatArray, FloatArray, FloatArray]:
        """Points (k, d) on the plane, from its foot, and distances (k,) of T above them.

        They lie evenly along each tangent direction; with weights (k,).
        """
        tangents = np.linalg.qr(self.towards[:, None], mode="complete")[0][:, 1:].T
        across, weights = stratified_points(DRAWN, len(tangents), 1)
        drawn = across @ tangents
        longest = math.sqrt(SEARCH_RADIUS**2 - self.radius**2)
        drawn *= np.minimum(1.0, longest / (np.linalg.norm(drawn, axis=1, keepdims=True) + 1e-12))
        # in one batch with points all around: rows that lie at T alone have no spread to compare by
        around = stratified_points(AROUND, self.towards.size, 2)[0]
        margins = self.margin(np.vstack([self.radius * self.towards + drawn, around]))
        return drawn, self.radius - margins[:DRAWN], weights

    def shares(self, distances: FloatArray) -> FloatArray:
        """Probabilities (k,) beyond distances (k,), relative to that beyond the point's plane."""
        from scipy.special import log_ndtr

        return np.asarray(np.exp(log_ndtr(-distances) - log_ndtr(-self.radius)))

    def _sampled(self) -> float:
        """Return by how much points on the plane differ from it, with the error of that."""
        _, distances, weights = self.drawn()
        changes = weights * (self.shares(distances) - 1.0)
        return float(abs(changes.mean()) + changes.std() / math.sqrt(DRAWN))

    def _mixed(
        self, tangents: FloatArray, bend: FloatArray, length: float
    ) -> tuple[FloatArray, float]:
        """Mixed curvatures (k, k), and what they add (per rate^2) where they are not known.

        Of many directions only mixtures with random signs are looked at. Such a mixture has the
        mean curvature but for the mixed ones, whose squares sum to half its mean square deviation.
        """
        k = len(tangents)
        mixed = np.zeros((k, k))
        if k < 2:
            return mixed, 0.0
        if k <= FEW:
            i, j = np.triu_indices(k, 1)
            pairs = self.folded((tangents[i] + tangents[j]) / math.sqrt(2.0), length)[0]
            mixed[i, j] = mixed[j, i] = pairs - 0.5 * (bend[i] + bend[j])
            return mixed, 0.0
        signs = np.random.default_rng(0).choice([-1.0, 1.0], (PROBES, k))
        deviations = k * self.folded(signs @ tangents / math.sqrt(k), length)[0] - bend.sum()
        return mixed, float((deviations**2).max()) / 8.0

    def _rays(self) -> FloatArray:
        """Unit vectors (k, d) of the ray opposite, all axes, and some that are drawn."""
        d = self.towards.size
        drawn = np.random.default_rng(0).normal(size=(RANDOM_RAYS if d > 2 else 0, d))
        drawn -= np.outer(drawn @ self.towards, self.towards)
        drawn /= np.linalg.norm(drawn, axis=1, keepdims=True)
        return np.vstack([-self.towards, np.eye(d), -np.eye(d), drawn])

    def _reach(self, share: float) -> float:
        """Distance of a plane with this share of the probability beyond the point's own."""
        from scipy.special import ndtr, ndtri

        return float(-ndtri(share * ndtr(-self.radius)))

    def elsewhere(self, others: Sequence[Linearisation] = ()) -> float:
        """Share of the probability beyond planes where rays that the point's misses meet T.

        Rays that lead beyond the planes of others count as explained, too.
        """
        from scipy.special import ndtr

        reach, rays = self._reach(FURTHEST_SHARE), self._rays()
        rays = rays[reach * (rays @ self.towards) < EXPLAINED * self.radius]
        for one in others:
            beta = one.beta(self.search.threshold)
            rays = rays[reach * (rays @ one.alpha) * self.side < EXPLAINED * abs(beta)]
        if len(rays):
            rays = rays[self.margin(reach * rays) > 0.0]
        if not len(rays):
            return 0.0
        low, high = np.full(len(rays), self.radius), np.full(len(rays), reach)
        for _ in range(HALVINGS):
            middle = 0.5 * (low + high)
            fails = self.margin(middle[:, None] * rays) > 0.0
            low, high = np.where(fails, low, middle), np.where(fails, middle, high)
        return float(ndtr(-low).sum() / ndtr(-self.radius))

    def starts(self, count: int) -> list[FloatArray]:
        """Return where else to search: at most `count` points (d,), the most promising first.

        The axes, the ray opposite and a few more are looked at as far out as the point. A search
        is worth its runs where the limit state seems much nearer than the plane.
        """
        points = self.radius * self._rays()
        by_plane = self.radius - points @ self.towards
        points, by_plane = points[by_plane > 0.5], by_plane[by_plane > 0.5]
        seen = -self.margin(points)
        nearer = np.flatnonzero(seen < EXPECTED * by_plane)
        best = nearer[np.argsort(seen[nearer], kind="stable")][:count]
        return [points[i] for i in best]

    def fails_nearby(self, start: FloatArray) -> FloatArray | None:
        """Return a point (d,) that fails near a start where the plane lets it work, or None.

        It is where the response's own plane at the start meets T, if that is near enough to the
        origin to have a noticeable share of the probability.
        """
        try:
            here = self.response.linearise(start)
        except NoGradientError:
            return None
        gap = (self.search.threshold - here.y) / here.slope
        point = start + gap * (1.0 + 1e-6) * here.alpha
        reach = self._reach(NOTICEABLE)
        known = float(point @ self.towards) > EXPLAINED * self.radius
        if known or math.hypot(*point) > reach or self.margin(point[None, :])[0] < 0.0:
            return None
        return point


def _second_order(curvatures: FloatArray, rate: float) -> tuple[float, float]:
    """Logarithm of the factor of second order, and its parts summed by size; curvatures (k, k).

    Hohenbichler M., Rackwitz R. Improvement of second-order reliability estimates by importance
    sampling. J. Eng. Mech. 114 (1988) 2195-2199. The factor prod (1 + rate kappa)^(-1/2) is
    Breitung's for large distances.
    """
    bends = 1.0 + rate * np.linalg.eigvalsh(curvatures)
    if not (bends > 0.0).all():
        return math.inf, math.inf
    parts = -0.5 * np.log(bends)
    return float(parts.sum()), float(np.abs(parts).sum())
