"""The search for a design point: its record, its trace, and the verdict on what it found.

The optimiser that walks is the caller's business; here every linearisation on its way is kept, and
the one that comes closest to being a design point is judged.
"""

from __future__ import annotations

import math
from contextlib import suppress
from dataclasses import dataclass, field

import numpy as np

from uqfold.methods.result import Status
from uqfold.methods.standard_space import (
    SEARCH_RADIUS,
    Linearisation,
    NoGradientError,
    StandardSpaceResponse,
    shown,
)
from uqfold.typing import FloatArray

NOTICEABLE = 0.05
"""Share of the probability behind a design point from which a second domain matters."""
BENT = 0.2
"""Change of the smaller probability by second order, relative, from which curvature matters."""
_LOOKED_AT = (0.25, 0.5, 1.0)
"""Shares of the search radius at which a limit state is looked for that no search has found."""
LOOSE_RESIDUAL = 0.25
"""A point further than this (per unit of beta) from being a design point is not an answer."""


@dataclass(frozen=True, eq=False)
class DesignPoint:
    """What the search found for one threshold.

    Attributes
    ----------
    threshold
        T.
    u, x
        The point at which the response was linearised, in standard-normal space and in the
        inputs' own units (d,).
    beta_hl
        Hasofer-Lind index: distance of the linearised limit state from the origin, negative if
        the origin fails; infinite where no run came to it.
    alpha
        Unit vector (d,) towards failure.
    shared_fraction
        Squared length of the shared part of alpha: correlation of any two units.
    residual
        Distance between u and beta_hl * alpha, zero at an exact design point.
    second_order
        Factor of second order to the smaller probability of one unit; NaN where not looked for.
    algorithm
        Algorithm that came closest; empty where none had to run, or none could.
    linearisations
        Gradients asked for in the search, remembered ones included.
    n_evals
        Runs spent on this threshold, those at the starting point that all share left out.
    kind
        Of which kind of units the response is, in the order in which they occur.
    names
        Names (d,) of the inputs.
    """

    threshold: float
    u: FloatArray
    x: FloatArray
    beta_hl: float
    alpha: FloatArray
    shared_fraction: float
    residual: float
    second_order: float
    algorithm: str
    linearisations: int
    n_evals: int
    kind: int = 0
    names: tuple[str, ...] = ()

    @property
    def importance(self) -> FloatArray:
        """Importance factors alpha^2 (d,), which sum to one."""
        return self.alpha**2

    @property
    def importance_by_name(self) -> dict[str, float]:
        """Importance factors by input, the largest first.

        Where inputs depend on each other, that of an input is that of what it adds to those before
        it.
        """
        pairs = zip(self.names, self.importance.tolist(), strict=True)
        return dict(sorted(pairs, key=lambda pair: -pair[1]))


@dataclass(frozen=True)
class Start:
    """Where searches start.

    Attributes
    ----------
    known
        Linearisations at the origin or, where the response has no slope there, near it; a level one
        where it has none there either.
    y_origin
        Response at the origin.
    stationary
        Whether it has no slope there.
    """

    known: tuple[Linearisation, ...]
    y_origin: float
    stationary: bool


def common_start(response: StandardSpaceResponse) -> Start:
    """Linearise at the origin; where it is stationary, at the extremes one deviation away."""
    d = response.inputs.dimension
    origin = np.zeros(d)
    y_origin = float(response.values(origin[None, :])[0])
    known = []
    with suppress(NoGradientError):
        return Start((response.linearise(origin),), y_origin, stationary=False)
    if math.isfinite(y_origin):
        around = np.vstack([np.eye(d), -np.eye(d)])
        y = response.values(around)
        for i in dict.fromkeys((int(y.argmax()), int(y.argmin()))):
            with suppress(NoGradientError):
                known.append(response.linearise(around[i]))
    level = Linearisation.level(origin, y_origin)
    return Start(tuple(known) or (level,), y_origin, stationary=True)


@dataclass(frozen=True)
class SecondLook:
    """What runs around a design point show.

    Attributes
    ----------
    second_order
        Factor of second order to the smaller probability, from the curvature at the point.
    curvature
        The sizes of what the main curvatures change, summed.
    place
        What is changed by the limit state's distance from the point and its slant there.
    sampled
        Change that points drawn on the point's plane show, and its standard error.
    elsewhere
        Share of failures that begin on other rays than the point's, but further out.
    """

    second_order: float
    curvature: float
    place: float
    sampled: float
    elsewhere: float


@dataclass(eq=False)
class Search:
    """The way to one threshold's design point.

    Attributes
    ----------
    threshold
        T.
    trace
        Every linearisation on the way, and the algorithm that asked for it; never empty.
    cut
        Why budget or time ended the search; empty where they did not.
    out_of_reach
        Whether the limit state seems to lie beyond the search radius.
    one_sided
        How many runs, up to the search radius, lie on one and the same side of T; 0: some lie on
        the other, or nobody has looked.
    rival
        A point as near as the best one, but well beyond the limit state; None: none known.
    several
        Whether other design points are likely to be about as near.
    second_order
        Factor by which the curvature of the limit state changes the smaller of both probabilities.
    others
        Linearisations at further design points, and their factors of second order.
    look
        What a second look at the best point showed; None: it was not taken, or not to its end.
    n_evals
        Runs spent.
    """

    threshold: float
    trace: list[tuple[Linearisation, str]]
    cut: str = ""
    out_of_reach: bool = False
    one_sided: int = 0
    rival: FloatArray | None = None
    several: bool = False
    second_order: float = 1.0
    others: list[tuple[Linearisation, float]] = field(default_factory=list)
    look: SecondLook | None = None
    n_evals: int = 0

    def at(self, one: Linearisation) -> Search:
        """Return the same search as if it had come to another point."""
        return Search(self.threshold, [(one, "")])

    @property
    def start(self) -> Linearisation:
        """The linearisation with which the search began."""
        return self.trace[0][0]

    @property
    def best(self) -> Linearisation:
        """The linearisation that comes closest to being at a design point."""
        return self._closest[0]

    @property
    def beta(self) -> float:
        """Reliability index by the best linearisation; infinite where no run came to T."""
        if self.one_sided:
            return math.inf if self.start.y <= self.threshold else -math.inf
        return self.best.beta(self.threshold)

    @property
    def error(self) -> float:
        """Residual of the best linearisation, relative to max(1, |beta|)."""
        return self._error(self.best)

    @property
    def _closest(self) -> tuple[Linearisation, str]:
        return min(self.trace, key=lambda entry: self._error(entry[0]))

    def _error(self, one: Linearisation) -> float:
        residual = one.residual(self.threshold)
        if math.isinf(residual):
            return math.inf
        return residual / max(1.0, abs(one.beta(self.threshold)))

    def look_far(self, response: StandardSpaceResponse) -> None:
        """See along alpha, almost at the search radius, whether the limit state lies beyond."""
        beta = self.start.beta(self.threshold)
        if abs(beta) <= SEARCH_RADIUS:
            return
        far = math.copysign(SEARCH_RADIUS - 2.0 * response.step, beta) * self.start.alpha
        try:
            there = response.linearise(far)
        except NoGradientError:
            return
        self.trace.append((there, ""))
        ahead = there.beta(self.threshold)
        self.out_of_reach = abs(ahead) > SEARCH_RADIUS and (ahead > 0.0) == (beta > 0.0)

    def look_everywhere(self, response: StandardSpaceResponse) -> None:
        """See along all axes, and where the search went, whether any run lies beyond T."""
        axes = np.eye(self.start.u.size)
        ways = np.vstack([axes, self.start.alpha, self.best.alpha])
        rays = np.vstack([ways, -ways])
        went = np.array([one.u for one, _ in self.trace])
        far = [share * SEARCH_RADIUS * rays for share in _LOOKED_AT]
        y = response.values(np.unique(np.vstack([went, *far]), axis=0))
        fails = y > self.threshold
        self.one_sided = y.size if fails.all() or not fails.any() else 0

    def look_around(self, response: StandardSpaceResponse, tolerance: float) -> None:
        """Test whether the best point is the nearest, the only one, and flat: 4 d runs at most.

        A point of the limit state that is collinear with its gradient may as well be the farthest
        one. So look one standard deviation to both sides of it in d - 1 tangent directions: none
        of these points may lie beyond the limit state. The point opposite may not even be near it.
        """
        beta = self.best.beta(self.threshold)
        side, radius = math.copysign(1.0, beta), abs(beta)
        if radius <= tolerance:
            self._look_elsewhere(response, side, radius)
            return
        towards = side * self.best.alpha
        angle = min(1.0 / radius, math.pi / 2)
        tangents = np.linalg.qr(towards[:, None], mode="complete")[0][:, 1:].T
        around = np.vstack([tangents, -tangents])
        points = math.cos(angle) * towards + math.sin(angle) * around
        points = radius * np.vstack([points, -towards])
        beyond = side * self.best.beyond(response.values(points), self.threshold)
        flat = radius * (math.cos(angle) - 1.0)
        bulge = 0.5 * (beyond[: len(tangents)] + beyond[len(tangents) : -1]) - flat
        self.second_order = _breitung(radius, -2.0 * bulge / (radius * math.sin(angle)) ** 2)
        if beyond.max() > tolerance:
            self.rival = points[int(beyond.argmax())]
        self.several |= bool(beyond[-1] > -min(0.5, radius))
        if self.rival is None and not self.several:
            self._look_elsewhere(response, side, radius)

    def _look_elsewhere(self, response: StandardSpaceResponse, side: float, radius: float) -> None:
        """See along every axis, and opposite, whether the limit state is met a second time.

        So far out that a second domain that begins there has `NOTICEABLE` of the probability of
        the first; only what the linearisation takes to be on the near side is looked at.
        """
        from scipy.special import ndtr, ndtri

        reach = float(-ndtri(NOTICEABLE * ndtr(-radius)))
        axes = np.eye(self.best.alpha.size)
        points = reach * np.vstack([-side * self.best.alpha, axes, -axes])
        near = side * (points @ self.best.alpha) < radius
        beyond = side * self.best.beyond(response.values(points[near]), self.threshold)
        self.several = bool((beyond > 0.0).any())

    def design_point(
        self, x: FloatArray, n_shared: int, kind: int, names: tuple[str, ...]
    ) -> DesignPoint:
        """Return the record of the best point, whose inputs are x (d,), shared ones first."""
        best, algorithm = self._closest
        return DesignPoint(
            threshold=self.threshold,
            u=best.u,
            x=x,
            beta_hl=self.beta,
            alpha=best.alpha,
            # rounding must not carry the square of a unit vector beyond one
            shared_fraction=min(1.0, float(np.sum(best.alpha[:n_shared] ** 2))),
            residual=best.residual(self.threshold),
            second_order=math.nan if self.look is None else self.look.second_order,
            algorithm=algorithm,
            linearisations=len(self.trace),
            n_evals=self.n_evals,
            kind=kind,
            names=names,
        )


def _breitung(radius: float, curvatures: FloatArray) -> float:
    """Factor of second order to the probability beyond a design point, from main curvatures (k,).

    Breitung K. Asymptotic approximations for multinormal integrals. J. Eng. Mech. 110 (1984)
    357-366. The curvatures are those of the directions that were looked at, positive where the
    limit state bends away from the origin.
    """
    bends = 1.0 + radius * curvatures
    return float(np.prod(bends**-0.5)) if (bends > 0.0).all() else math.inf


def verdict(search: Search, start: Start, tolerance: float) -> tuple[Status, str]:
    """Judge what a search has left: a status and the reason for it."""
    status, message = _judged(search, start, tolerance)
    return status, f"{message}; {search.cut}" if search.cut else message


def _judged(search: Search, start: Start, tolerance: float) -> tuple[Status, str]:
    threshold, best, error = search.threshold, search.best, search.error
    beta = best.beta(threshold)
    where = f"u = {shown(best.u)}, beta = {beta:.4g}"
    off = f"{best.residual(threshold):.2g} standard deviations from a design point"
    if error <= tolerance:
        if search.rival is not None:
            return "doubtful", f"not the nearest point, see u = {shown(search.rival)}: {where}"
        if start.stationary or search.several:
            return "doubtful", f"there may be several design points, FORM sees one: {where}"
        if abs(beta) > tolerance and (start.y_origin <= threshold) != (beta > 0.0):
            return "doubtful", f"the limit state has the origin on its far side: {where}"
        told = search.look is not None and not search.cut
        if not told and abs(math.log(search.second_order)) > math.log1p(BENT):
            bent = f"second order takes the smaller probability times {search.second_order:.2g}"
            return "doubtful", f"the limit state is curved, {bent}: {where}"
        if search.cut:
            return "budget_exhausted", f"not checked whether it is the nearest point: {where}"
        return "unchecked", ""
    if search.cut and error <= 1.0:
        return "budget_exhausted", f"linearised at {where}, {off}"
    if search.one_sided:
        side = "works" if search.beta > 0.0 else "fails"
        return "doubtful", (
            f"no run out of {search.one_sided}, up to {SEARCH_RADIUS:g} standard deviations, lies "
            f"on the other side of the threshold: taken for one that always {side}"
        )
    if math.isinf(error):
        return "failed", "no design point: the response has no gradient around the origin"
    if search.out_of_reach:
        reach = f"no design point within {SEARCH_RADIUS:g} standard deviations"
        return "doubtful", f"{reach}: linearised at {where}"
    if error <= LOOSE_RESIDUAL:
        return "doubtful", f"no algorithm converged: linearised at {where}, {off}"
    return "failed", f"no design point found: the nearest is {where}, {off}"
