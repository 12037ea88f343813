"""Where a cheap partner leaves the verdict on a system open, and how often to ask the model there.

A pilot shows how the margins of some systems by the model follow those by the partner. From that
comes, for every other system, the probability that the partner's verdict is wrong; Neyman's rule
runs the model in proportion to the square root of that probability. A share of all runs is spread
evenly, so that nothing depends on what the pilot has shown but the size of the error.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from uqfold.typing import FloatArray, IntArray

EVEN_SHARES = 0.1, 0.2, 0.35, 0.5, 0.65, 0.8, 0.9
"""Shares of the runs that may be spread evenly."""
FEWEST_NEAR = 10
"""Systems of the pilot that tell how model and partner differ under one criterion, at least."""
SIGNIFICANT = 4.0
"""Standard errors by which a slope differs from zero, if it is to count."""
RARE = 3.0
"""With fewer failures than this among the pilot's systems nobody knows what the partner gains."""
_SQRT_3 = math.sqrt(3.0)


@dataclass(frozen=True, eq=False)
class MarginFit:
    """What the pilot shows of the margins near the limit of each criterion.

    The model's margin is taken for a linear function of the partner's, with an error of Student's
    distribution with 3 degrees of freedom, whose tails are heavy. All fields are (n_criteria, 1).

    Attributes
    ----------
    intercept, slope, spread
        Of that function and of its error, from the systems whose margins are finite.
    missed, false
        Share of the others in which the partner misses a failure, or reports a false one.
    """

    intercept: FloatArray
    slope: FloatArray
    spread: FloatArray
    missed: FloatArray
    false: FloatArray

    @classmethod
    def of(cls, partner: FloatArray, model: FloatArray) -> MarginFit:
        """Fit the margins (n_criteria, k) of both for the same k systems."""
        near = max(FEWEST_NEAR, partner.shape[1] // 3)
        rows = []
        for low, high in zip(partner, model, strict=True):
            closest = np.argsort(np.abs(low), kind="stable")[:near]
            line = _line(low[closest], high[closest])
            # what is lost in the noise so near may show farther away
            rows.append(line if line[1] else _line(low, high))
        return cls(*np.array(rows).T[:, :, None])

    def fails(self, margins: FloatArray) -> FloatArray:
        """Probability that the model says "fails", from the partner's margins (n_criteria, n)."""
        with np.errstate(invalid="ignore", over="ignore"):
            t = (self.intercept + self.slope * margins) / (_SQRT_3 * self.spread)
            # without a slope an infinite margin tells nothing, or as much as any other
            t = np.where(np.isnan(t), self.intercept / (_SQRT_3 * self.spread), t)
            tail = np.where(np.isinf(t), 0.0, t / (1.0 + t * t))
        chance = 0.5 + (tail + np.arctan(t)) / math.pi
        chance = self.missed + (1.0 - self.missed - self.false) * chance
        return np.asarray(np.clip(chance, 0.0, 1.0))


def _line(partner: FloatArray, model: FloatArray) -> tuple[float, float, float, float, float]:
    """Fit one criterion; see `MarginFit`."""
    finite = np.isfinite(partner) & np.isfinite(model)
    missed = float(np.mean(~finite & (model > 0.0) & ~(partner > 0.0)))
    false = float(np.mean(~finite & (partner > 0.0) & ~(model > 0.0)))
    x, y = partner[finite], model[finite]
    if x.size == 0:
        return 0.0, 1.0, np.finfo(np.float64).tiny, missed, false
    # squares of margins beyond 1e154 have no room in a float
    scale = float(max(np.abs(x).max(), np.abs(y).max())) or 1.0
    x, y = x / scale, y / scale
    mean_y, slope = float(y.mean()), 0.0
    around_x, around_y = x - x.mean(), y - mean_y
    squares, freedom = float(around_x @ around_x), max(1, x.size - 2)
    if squares > 0.0:
        slope = float(around_x @ around_y) / squares
    residual = around_y - slope * around_x
    spread = math.sqrt(float(residual @ residual) / freedom)
    # a partner that tells nothing must not seem to tell something by chance
    if slope**2 * squares < (SIGNIFICANT * spread) ** 2:
        slope, spread = 0.0, math.sqrt(float(around_y @ around_y) / freedom)
    # rounding of the margins is no information
    spread = max(spread, 16.0 * np.finfo(np.float64).eps)
    intercept = mean_y - slope * float(x.mean())
    return scale * intercept, slope, scale * spread, missed, false


@dataclass(frozen=True, eq=False)
class Allocation:
    """How often the model is run on a system, by the partner's margins.

    Attributes
    ----------
    fit
        What the pilot has shown.
    weights
        What an error of each criterion counts (n_criteria,): the reciprocal of pf squared.
    rare
        What an evenly spread run counts (2, n_criteria) where the partner says "works" and "fails".
    even
        Share of the runs that are spread evenly.
    scales
        Mean of either part over all systems.
    """

    fit: MarginFit
    weights: FloatArray
    rare: FloatArray
    even: float = 0.5
    scales: tuple[float, float] = (1.0, 1.0)

    def sizes(self, margins: FloatArray) -> FloatArray:
        """To what (n,) the probability of a run is proportional, by margins (n_criteria, n)."""
        wanted, spread = self._parts(margins)
        scale, scale_spread = self.scales
        return np.asarray((1.0 - self.even) * wanted / scale + self.even * spread / scale_spread)

    def _parts(self, margins: FloatArray) -> tuple[FloatArray, FloatArray]:
        fails = self.fit.fails(margins)
        wrong = np.where(margins > 0.0, 1.0 - fails, fails)
        spread = np.where(margins > 0.0, self.rare[1][:, None], self.rare[0][:, None])
        return np.sqrt(self.weights @ wrong), spread.max(axis=0)


@dataclass(frozen=True, eq=False)
class Plan:
    """How the runs are spent.

    Attributes
    ----------
    systems
        Systems that the model is run on.
    partner_systems
        Systems that the partner is run on, the former among them.
    allocation
        Which of these are chosen; None: the partner is of no use.
    gain
        How many times the variance of crude Monte Carlo with as many runs of the model is that of
        the plan; NaN where the pilot cannot tell.
    """

    systems: int
    partner_systems: int
    allocation: Allocation | None
    gain: float


def planned(
    fit: MarginFit, margins: FloatArray, systems: int, partner_systems: int | None, most: int
) -> Plan:
    """Choose how many systems the partner gets, and how the model's runs are spread.

    Parameters
    ----------
    fit
        What the pilot has shown.
    margins
        The partner's (n_criteria, n) for systems drawn at random.
    systems
        How many systems the model is run on.
    partner_systems
        How many the partner is run on; None: what makes variance times cost least, the cost of
        `most` systems by the partner being that of all systems by the model.
    most
        Most systems that the partner is run on.
    """
    n = margins.shape[1]
    fails = fit.fails(margins)
    wrong = np.where(margins > 0.0, 1.0 - fails, fails)
    pf = fails.mean(axis=1)
    by_partner = np.mean(margins > 0.0, axis=1)
    known = np.maximum(n * pf, n * by_partner) >= RARE
    weights = 1.0 / np.maximum(pf, 10.0 / n) ** 2
    rare = np.maximum(np.array([1.0 - by_partner, by_partner]), 1.0 / n) ** (-1.0 / 3.0)
    allocation = Allocation(fit, weights, rare)
    scales = [float(part.mean()) for part in allocation._parts(margins)]
    scales[0] = max(scales[0], np.finfo(np.float64).tiny)
    variance = pf * (1.0 - pf)

    def errors(even: float, population: int) -> tuple[float, float, float]:
        """Squared relative errors: of the partner's part, of the runs, of what may hide."""
        allocation = Allocation(fit, weights, rare, even, (scales[0], scales[1]))
        chance = inclusion(allocation.sizes(margins), n * systems / population)
        by_runs = np.mean(wrong * (1.0 / chance - 1.0), axis=1) / population
        hidden = np.zeros_like(pf)
        for own in (margins > 0.0, ~(margins > 0.0)):
            rarest = np.where(own, chance, 1.0).min(axis=1)
            hidden += ((1.0 / rarest - 1.0) / population) ** 2
        each = (variance / population, by_runs, hidden)
        first, second, third = (float(weights[known] @ one[known]) for one in each)
        return first, second, third

    if partner_systems is None:
        choices = np.unique(np.geomspace(systems, most, 13).astype(int))
        costs = [sum(errors(0.5, int(one))[:2]) * (1.0 + one / most) for one in choices]
        # where no criterion tells, the partner is to find what is rare
        partner_systems = int(choices[np.argmin(costs)]) if known.any() else most
    found = {even: errors(even, partner_systems) for even in EVEN_SHARES}
    even = min(found, key=lambda one: sum(found[one][1:]))
    best = Allocation(fit, weights, rare, even, (scales[0], scales[1]))
    crude = float(weights[known] @ variance[known]) / systems
    left = sum(found[even][:2])
    gain = crude / left if left > 0.0 else math.nan
    return Plan(systems, partner_systems, best, gain)


def inclusion(sizes: FloatArray, expected: float) -> FloatArray:
    """Probabilities (n,) in (0, 1] in proportion to sizes as far as possible, of a given sum."""
    if expected >= sizes.size:
        return np.ones_like(sizes)
    order = np.sort(sizes)[::-1]
    rest = order.sum() - np.concatenate([[0.0], np.cumsum(order)[:-1]])
    left = expected - np.arange(sizes.size)
    certain = int(np.argmax((order * left < rest) & (left > 0.0)))
    return np.asarray(np.minimum(1.0, sizes * left[certain] / rest[certain]))


@dataclass(frozen=True, eq=False)
class NearestFirst:
    """Sizes of systems by the ranks of their margins: every distance from a limit, near ones first.

    Attributes
    ----------
    distances
        Absolute margins (n_criteria, n) of systems drawn at random, each row sorted.
    wanted
        So many of the nearest are taken for equally near.
    """

    distances: FloatArray
    wanted: float

    def sizes(self, margins: FloatArray) -> FloatArray:
        """Sizes (k,) of systems with these margins (n_criteria, k)."""
        rank = [
            np.searchsorted(known, np.abs(own))
            for known, own in zip(self.distances, margins, strict=True)
        ]
        return np.asarray(1.0 / (np.min(rank, axis=0) + self.wanted))


def parts_of(total: int, parts: int) -> IntArray:
    """Cut a number into almost equal parts (parts,)."""
    return np.asarray(np.diff(np.linspace(0, total, parts + 1).astype(np.int64)))
