"""The density that rare failures are drawn from: found by climbs, then fitted round by round."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, field, replace

import numpy as np

from uqfold.methods.polar_mixture import FitError, PolarMixture
from uqfold.methods.rare_event import NestedCriteria, Running
from uqfold.methods.subset_climb import Pilot, Population, Rung, along, climbs
from uqfold.methods.system_sample import BLOCK_VALUES
from uqfold.typing import BoolArray, FloatArray

SHARE = 0.1
"""Share of the samples of a level that leads to the next one, about."""
CLIMBS, FEWEST_CLIMBS = 8, 2
"""Independent climbs that find failures to begin with: most and fewest."""
OF_CLIMBS, SMALLEST_CLIMB = 0.6, 100
"""They take so much of the budget; least samples of one at each level."""
ROUNDS, PART_OF_ROUND, SMALLEST_ROUND, LARGEST_ROUND = 6, 40, 200, 2_000
"""Rounds of fitting, each one part in so many of the budget; least and most samples of one."""
FEWEST_HITS = 25
"""With fewer failures than this in a round the density stays as it is."""
GOOD = 0.3
"""With so many equally weighted samples in each one drawn, the density is good enough."""
CLIPPED = 1.0
"""In a round of n samples, so many times the root of n of the largest weights are made equal."""
FAR_OUT, SPREAD_OUT = 0.15, 6.0
"""Share of the samples whose distances are spread out, by so many times the variance: failures have
a longer tail than a Nakagami law of their own variance, and what lies there would not be seen."""
RARE, OF_LOST = 30.0, 0.15
"""Failures that are known and so many times rarer among the samples than the commonest tenth are
lost; they get that share of the samples."""
CHAINS, CHAIN, PART_OF_CHAINS = 20, 20, 5
"""At first they are led apart, by so many chains of so many states at most, or one part in so many
of the runs that are left."""
FEWEST_LOST = 10
"""With fewer of them in a round, those of the climbs are kept to."""
OFFSPRING = 3.0
"""Variance of the number of seeds that a seed leads to at the next level, about. See
`part_unseen`."""
ONE_IN_TWENTY = math.log(20.0)
UNSEEN = 0.025
"""Part of pf that climbs may miss in the mean: with so many samples that it is less they are of
little use."""
ELSEWHERE = 0.2
"""Share of the samples that do not follow the failures found."""


@dataclass(frozen=True, eq=False)
class WeightedSamples:
    """Samples and what each counts.

    Attributes
    ----------
    u
        Standard-normal variables (n, d), one more if there is a single one.
    weights
        Density of the standard normal law (n,) over that which they were drawn from.
    low, high
        Which fail (n,), failed runs counted as safe, and as failures.
    """

    u: FloatArray
    weights: FloatArray
    low: BoolArray
    high: BoolArray


@dataclass(eq=False)
class ImportanceSearch:
    """A density that follows the failures of one criterion, as far as it is known.

    Attributes
    ----------
    asked
        The criterion.
    rng
        Source of randomness.
    cost
        Runs of one sample, as measured last.
    mixture
        The density; None: that of the inputs.
    components
        How many of its components follow failures.
    climbs
        Estimates of pf (R,) by the climbs.
    rounds
        Share of equally weighted samples in each round.
    witnesses
        Failures (n, d) that the climbs found, and their shares (n,) in all failures.
    seeds
        Samples of the climbs that led from each level to the next, or to failure.
    aim
        Part of all failures that climbs may miss in the mean.
    """

    asked: NestedCriteria
    rng: np.random.Generator
    cost: float
    mixture: PolarMixture | None = None
    components: int = 0
    climbs: FloatArray = field(default_factory=lambda: np.empty(0))
    rounds: list[float] = field(default_factory=list)
    witnesses: tuple[FloatArray, FloatArray] | None = None
    seeds: tuple[int, ...] = ()
    aim: float = UNSEEN

    @property
    def affordable(self) -> int:
        """Samples that the runs that are left pay for."""
        return int(self.asked.left / self.cost)

    @property
    def most_at_once(self) -> int:
        """Samples that fit into memory side by side."""
        return max(1, BLOCK_VALUES // self.asked.event.dimension)

    def drawn(self, size: int, phase: str = "answer") -> Running[WeightedSamples]:
        """Draw samples from the density and run them."""
        dimension, before = self.asked.event.dimension, self.asked.session.n_evals
        if self.mixture is None:
            u = self.rng.standard_normal((size, dimension))
            weights = np.ones(size)
        else:
            u = self.mixture.draw(size, self.rng)
            weights = np.exp(-self.mixture.log_ratio(u))
        heights = yield from self.asked.heights(u[:, :dimension], phase=phase, weight=weights)
        self.cost = max(1.0, (self.asked.session.n_evals - before) / size)
        low, high = (self.asked.fail(one)[0] for one in heights)
        return WeightedSamples(u, weights, low, high)

    def find(self, pilot: Pilot) -> Running[str]:
        """Find failures by climbs over the levels of a pilot, and fit the density to them.

        Return why there is none, or nothing.
        """
        limit = replace(pilot.levels[-1], height=float(self.asked.limits[0]))
        rungs = (*pilot.levels, limit)
        samples = int(OF_CLIMBS * self.affordable / (len(rungs) + 1))
        number = min(max(samples // SMALLEST_CLIMB, FEWEST_CLIMBS), CLIMBS)
        enough = samples_for(self.aim, len(rungs))
        size = max(min(samples, enough) // number, SMALLEST_CLIMB)
        size = min(size, max(1, self.most_at_once // number))
        if number * size * (len(rungs) + 1) > self.affordable:
            return "the runs that are left are too few to look for failures"
        made = yield from climbs(self.asked, rungs, number, size, self.rng, keep=True)
        self.climbs = made.high[:, 0]
        self.seeds = tuple(
            int(np.count_nonzero(population.high > rung.height))
            for population, rung in zip(made.kept, rungs, strict=False)
        )
        top = made.kept[-1]
        rows = len(top.u)
        u = self.with_two(top.u)
        arrived = np.bincount(top.climb, minlength=number) > 0
        # no climb is in both halves, unless hardly one has arrived
        second = np.cumsum(arrived)[top.climb] % 2 == 0
        if not 0.1 * rows < np.count_nonzero(second) < 0.9 * rows:
            second = self.rng.random(rows) < 0.5
        try:
            self._fit(u, np.ones(rows), second)
        except FitError as error:
            return str(error)
        shares = self.climbs[top.climb] / np.bincount(top.climb)[top.climb]
        self.witnesses = u, shares / shares.sum()
        yield from self._lead_apart(top, limit)
        self._cover(np.empty((0, u.shape[1])), np.empty(0))
        return ""

    def with_two(self, u: FloatArray) -> FloatArray:
        """Return points (n, d) with a second variable if they have a single one."""
        return u if u.shape[1] > 1 else np.hstack([u, self.rng.standard_normal((len(u), 1))])

    def follow(self, u: FloatArray) -> None:
        """Take failures (n, d) for the known ones, and let none of them be lost."""
        self.witnesses = self.with_two(u), np.full(len(u), 1.0 / len(u))
        self._cover(np.empty((0, self.witnesses[0].shape[1])), np.empty(0))

    def _lead_apart(self, top: Population, limit: Rung) -> Running[None]:
        """Lead those known failures apart that are lost: they may descend from a single sample."""
        if self.witnesses is None:
            return
        u, shares = self.witnesses
        lost = self.lost(u)
        # at most so many: with a random number of missions these may be few
        most = self.asked.left // self.asked.event.max_evals_per_sample // PART_OF_CHAINS
        if not lost.any() or most < CHAINS:
            return
        places = self.rng.permutation(np.nonzero(lost)[0])[:CHAINS]
        states = min(CHAIN * places.size, most)
        moved = yield from along(self.asked, top, places, limit, states, self.rng, len(self.seeds))
        if not len(moved):
            return
        moved = self.with_two(moved)
        part = float(shares[lost].sum())
        self.witnesses = (
            np.concatenate([u[~lost], moved]),
            np.concatenate([shares[~lost], np.full(len(moved), part / len(moved))]),
        )

    @property
    def unseen(self) -> float:
        """Mean part of all failures that the climbs may have missed in a region of its own."""
        return part_unseen(self.seeds)

    def overlooked(self, largest: float) -> float:
        """Return the share of failures known from the climbs where samples are too rare.

        There a sample would weigh more than the largest of those that were drawn.
        """
        if self.witnesses is None or self.mixture is None:
            return 0.0
        u, shares = self.witnesses
        return float(shares[np.exp(-self.mixture.log_ratio(u)) > largest].sum())

    def refine(self) -> Running[None]:
        """Fit the density to weighted samples drawn from it, until they are about alike."""
        size = min(max(self.affordable // PART_OF_ROUND, SMALLEST_ROUND), LARGEST_ROUND)
        size = min(size, self.most_at_once)
        for _ in range(ROUNDS):
            if self.affordable < 3 * size:
                break
            found = yield from self.drawn(size, "fit")
            weights = found.weights[found.high]
            alike = weights.sum() ** 2 / np.sum(weights**2) if weights.size else 0.0
            self.rounds.append(float(alike) / size)
            if alike > GOOD * size or weights.size < FEWEST_HITS:
                break
            # the largest weights of few samples say more of chance than of the failures
            clipped = min(weights.size - 1, int(CLIPPED * math.sqrt(size)))
            weights = np.minimum(weights, np.sort(weights)[::-1][clipped])
            self._fit(found.u[found.high], weights, self.rng.random(weights.size) < 0.5)
            self._cover(found.u[found.high], found.weights[found.high])

    def _fit(self, u: FloatArray, weights: FloatArray, second: BoolArray) -> None:
        fitted = PolarMixture.fitted(u, weights, second, self.rng)
        self.components = fitted.shares.size
        reaching = fitted.joined(replace(fitted, shape=fitted.shape / SPREAD_OUT), FAR_OUT)
        pf = float(self.climbs.mean())
        self.mixture = reaching.joined(PolarMixture.everywhere(u, weights, pf), ELSEWHERE)

    def lost(self, u: FloatArray) -> BoolArray:
        """Whether failures (n, d) are rare among the samples, against those that are known."""
        if self.mixture is None or self.witnesses is None or not len(u):
            return np.zeros(len(u), dtype=np.bool_)
        usual = np.quantile(-self.mixture.log_ratio(self.witnesses[0]), 0.1)
        return np.asarray(-self.mixture.log_ratio(u) > usual + math.log(RARE))

    def _cover(self, u: FloatArray, weights: FloatArray) -> None:
        """Add components that follow lost failures, from new ones u (n, d) if they are enough.

        A region that few climbs have entered may have much of pf all the same.
        """
        if self.mixture is None or self.witnesses is None:
            return
        lost = self.lost(u)
        u, weights = u[lost], weights[lost]
        if len(u) < FEWEST_LOST:
            u = self.witnesses[0][self.lost(self.witnesses[0])]
            weights = np.ones(len(u))
        if len(u):
            about = PolarMixture.about(u, weights, self.rng)
            self.mixture = self.mixture.joined(about, OF_LOST)


def part_unseen(seeds: Sequence[int]) -> float:
    """Return the part of all failures that climbs miss in the mean, where most is hidden from them.

    The seeds in a region of its own are a critical branching process: each has one seed at the next
    level in the mean, often none, and several if its chain has moved little. With the variance s^2
    of that number, and the part x of the M seeds at each of L levels, none is left at the end with
    the probability exp(-2 x M / (s^2 L)), and exp(-x / t) where M differs from level to level
    (Athreya K.B., Ney P.E. Branching processes. Springer, 1972, theorem I.9.1). So the part that is
    missed is at most exponential, with the mean t and the 95 % quantile t log 20. A region that has
    a smaller part of the samples at lower levels than it has of pf is missed more often.

    Parameters
    ----------
    seeds
        Samples M that led from each level to the next, or to failure.

    Returns
    -------
    float
        t, half of s^2 times the sum of 1 / M.
    """
    return 0.5 * OFFSPRING * sum(1.0 / max(one, 1) for one in seeds)


def samples_for(part: float, levels: int) -> int:
    """Return the samples at each level with which climbs miss a part of pf in the mean."""
    return math.ceil(0.5 * OFFSPRING * levels / (SHARE * part))
