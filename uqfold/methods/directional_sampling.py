"""Directional sampling: the probability along rays from the origin, in directions of all kinds."""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from typing import ClassVar

import numpy as np

from uqfold.checks import keep, or_none, real, whole
from uqfold.methods.crossings import Lines
from uqfold.methods.line_laws import LineLaw, chi_law
from uqfold.methods.line_neighbours import Traces
from uqfold.methods.line_pieces import RunPlaces, Segments
from uqfold.methods.line_sums import Round, Rounds, Sample, frequent
from uqfold.methods.rare_event import NestedCriteria, RareEventMethod, Running
from uqfold.methods.result import Estimate
from uqfold.methods.theory import Theory
from uqfold.methods.theory_of_lines import DIRECTIONAL_SAMPLING
from uqfold.problems.criterion import Criterion
from uqfold.typing import FloatArray

WITHOUT_A_BUDGET = 20
"""Sets of rays where neither a number nor a budget is given."""
SETS = 14
"""Sets that a budget is divided into."""
FEWEST_RAYS, WITH_A_TARGET, MOST_RAYS = 8, 64, 1_024
"""Rays of a set, powers of two: least, those of sets that are made one by one, and most."""
FARTHEST = 1e-12
"""Rays end where so little probability is left, until more is known of pf."""
BEYOND = 1e-3
"""Then they end where this part of pf is left."""
PLACES, CLOSELY = 5, 8
"""Runs on each ray to begin with; where rays meet failure more than once they are looked at more
closely, as those of the first round are."""
NARROW = 0.05
"""Failures in pieces between the places of rays, of more than this part of pf, are a doubt."""
STILL_MISSED = 0.5
"""Part of what places may miss that counts as an error: the rays beside a ray, and its two runs at
random places, find the rest (on a ridge and a ring, of 60 answers to each, none was three stated
errors off)."""
BESIDE_ORIGIN = 1e-6
"""Probability of what is nearer to the origin than where rays begin if no run succeeds there."""
COST = 11.0
"""Runs of a ray, as guessed before there are any."""


@dataclass(frozen=True)
class DirectionalDetails:
    """How one criterion was answered.

    Attributes
    ----------
    criterion
        The criterion.
    rays
        Rays of a set; 0 where failures were counted.
    nearest
        Where failure begins on the ray that meets it first, in standard deviations.
    pf
        Estimates (R,), each from one set.
    """

    criterion: Criterion
    rays: int
    nearest: float
    pf: FloatArray


@dataclass(frozen=True)
class DirectionalSampling(RareEventMethod):
    """Directional sampling on the real model, for up to ten inputs or so and failures all around.

    Rays run from the origin in directions that are spread evenly and turned at random. Where a ray
    crosses from working to failing, once or several times, is found by a few runs, and the chi
    distribution says how much lies beyond. Two more runs at random places on each ray keep the
    estimate without bias where a crossing was overlooked. Several independent sets of rays tell
    the error.

    Every criterion has runs of its own; what is left of `max_evals` is split into equal shares for
    the criteria that are left.

    Attributes
    ----------
    rays
        Rays of a set, rounded up to a power of two; None: so many that `max_evals` pays for 14
        sets or more, and 64 at most with a target.
    sets
        Sets to make; `max_evals` may allow fewer, then the status is ``budget_exhausted``. None:
        as many as `max_evals` pays for; without a budget 20, or what `target_cov` takes.
    target_cov
        Stop early once the relative standard error is at most this, for sure; None: never. A row
        with a larger one, or with more than 10 % under None, is ``doubtful``.

    Raises
    ------
    ValueError
        If a setting is out of range.

    Notes
    -----
    A frequent failure is counted, with the interval of Clopper and Pearson. Beyond ten inputs
    hardly a ray meets what matters, and the row is ``doubtful``. A system of half a million random
    numbers or more is ``unsupported``.
    """

    name: ClassVar[str] = "directional-sampling"
    title: ClassVar[str] = "Directional sampling"
    theory: ClassVar[Theory] = DIRECTIONAL_SAMPLING
    each_alone: ClassVar[bool] = True

    rays: int | None = None
    sets: int | None = None
    target_cov: float | None = None

    def __post_init__(self) -> None:
        keep(self, "rays", or_none, whole, at_least=FEWEST_RAYS)
        keep(self, "sets", or_none, whole, at_least=2)
        keep(self, "target_cov", or_none, real, above=0.0)

    def _answered(
        self, asked: NestedCriteria, rng: np.random.Generator
    ) -> Running[tuple[list[Estimate], DirectionalDetails]]:
        count = yield from frequent(asked, rng)
        if count:
            estimate = yield from Sample().counted(asked, self.target_cov, [], rng)
            return [estimate], DirectionalDetails(asked.criteria[0], 0, math.nan, np.empty(0))
        rays = self._rays(asked)
        fans = Fans(asked, rng, rays)
        rounds = Rounds(asked, self.sets, self.target_cov, WITHOUT_A_BUDGET, rays, fans.heaviest)
        cost = COST * rays * asked.event.max_evals_per_sample
        yield from rounds.make(fans.drawn, cost, rays * asked.event.dimension)
        pf = float(np.mean(rounds.together("high"))) if rounds.made else 0.0
        mean, error = fans.between
        rounds.hidden = STILL_MISSED * not_negative(mean, error) / pf if pf > 0.0 else 0.0
        doubts = []
        if mean > max(NARROW * pf, 2.0 * error):
            part = f"{100.0 * mean / pf:.0f} % of pf" if pf > 0.0 else "some of pf"
            doubts.append(f"{part} may lie in narrow regions that rays step over")
        estimate = yield from rounds.answer(doubts, rng)
        return [estimate], DirectionalDetails(
            asked.criteria[0], rays, fans.nearest, rounds.together("high")
        )

    def _rays(self, asked: NestedCriteria) -> int:
        """Rays of a set: a power of two."""
        wanted = self.rays
        if wanted is None:
            wanted = WITH_A_TARGET
            if asked.session.max_evals is not None:
                wanted = int(asked.left / (SETS * COST * asked.event.max_evals_per_sample)) // 2
            most = MOST_RAYS if self.target_cov is None else WITH_A_TARGET
            wanted = min(max(wanted, FEWEST_RAYS), most)
        return 1 << math.ceil(math.log2(wanted))


@dataclass(eq=False)
class Fans:
    """Sets of rays: each set is one estimate of pf.

    Attributes
    ----------
    asked
        The criterion.
    rng
        Source of randomness.
    rays
        Rays of a set.
    closely
        Whether rays are looked at closely.
    nearest
        Where failure begins on the ray that meets it first.
    """

    asked: NestedCriteria
    rng: np.random.Generator
    rays: int
    closely: bool = True
    nearest: float = math.inf
    _law: LineLaw = field(init=False)
    _pf: list[float] = field(default_factory=list)
    _between: list[float] = field(default_factory=list)
    _origin: RunPlaces | None = None
    _traces: Traces | None = None

    def __post_init__(self) -> None:
        self._law = chi_law(self.asked.event.dimension)

    def drawn(self, number: int) -> Running[Round]:
        """Draw some sets."""
        dimension, n = self.asked.event.dimension, number * self.rays
        along = np.concatenate([_spread(self.rays, dimension, self.rng) for _ in range(number)])
        reach = self._reach()
        lines = Lines(
            self.asked, np.zeros((n, dimension)), along, self._law, np.zeros(n), np.full(n, reach)
        )
        if self._origin is None:
            self._origin = yield from lines.run(np.zeros(1, dtype=np.int64), np.zeros(1))
        origin = self._origin
        known = None
        if origin.state[0] == 1:
            # the run at the origin failed: each ray has a place of its own beside it
            lines.first[:] = self._law.place(np.array([1.0 - BESIDE_ORIGIN]))
        else:
            known = RunPlaces(
                np.arange(n), np.repeat(origin.at, n), np.repeat(origin.state, n),
                np.repeat(origin.height, n),
            )  # fmt: skip
        # places of a ray are evenly spaced, those of all rays together are everywhere
        number_of_places = CLOSELY if self.closely else PLACES
        shares = np.arange(number_of_places) + self.rng.random((n, 1))
        inner = reach * shares / number_of_places
        traces = yield from lines.followed(inner, known, self._traces)
        more_low, more_high, taught = yield from lines.checked(traces, self.rng)
        segments, self._traces = traces.segments, taught.joined(self._traces).latest()
        nowhere, everywhere = np.zeros(n), np.full(n, np.inf)
        low, high = lines.masses(segments, nowhere, everywhere)
        values = [one.reshape(number, -1) for one in (high + more_high, low + more_low)]
        self.closely = bool((segments.crossings(n) > 1).any() or more_high.any())
        self._between.extend(self._overlooked(segments, inner).reshape(number, -1).mean(axis=1))
        self.nearest = min(self.nearest, float(segments.first_failures(n).min()))
        self._pf.extend(values[0].mean(axis=1))
        return Round(
            values[0].mean(axis=1),
            values[1].mean(axis=1),
            np.abs(more_high).reshape(number, -1).max(axis=1) / self.rays,
            values[0].max(axis=1) / self.rays,
        )

    def _overlooked(self, segments: Segments, places: FloatArray) -> FloatArray:
        """How much failure on each ray (N,) its places (N, k) have missed, in expectation.

        A piece that is narrower than the distance of two places holds one of them by luck, and as
        many more are missed, but for those that the responses beside them have led to.
        """
        spacing, width = float(places[0, 1] - places[0, 0]), segments.end - segments.start
        chosen = (segments.state > 0) & (segments.start > spacing) & (width < spacing)
        line, start, end = segments.line[chosen], segments.start[chosen], segments.end[chosen]
        held = ((start[:, None] <= places[line]) & (places[line] < end[:, None])).any(axis=1)
        found, missed = self._law.between(start, end), np.zeros(len(places))
        np.add.at(missed, line, found * (held * spacing / np.maximum(end - start, 1e-12) - 1.0))
        return missed

    @property
    def between(self) -> tuple[float, float]:
        """Failure probability in pieces between the places of rays, and its standard error."""
        found = np.array(self._between)
        if found.size < 2:
            return 0.0, 0.0
        return float(found.mean()), float(found.std(ddof=1)) / math.sqrt(found.size)

    @property
    def heaviest(self) -> float:
        """The largest weight of a run that contradicts a ray."""
        mode = math.sqrt(self.asked.event.dimension - 1)
        return self._reach() * float(self._law.density(np.array([max(mode, 1e-300)]))[0])

    def _reach(self) -> float:
        """How far out rays are looked at."""
        from scipy.special import chdtri

        known = float(np.mean(self._pf)) if self._pf else 0.0
        beyond = BEYOND * known if known > 0.0 else FARTHEST
        return math.sqrt(float(chdtri(self.asked.event.dimension, min(beyond, 0.5))))


def not_negative(mean: float, error: float) -> float:
    """Return the root mean square of what has been estimated with a normal error, and is >= 0."""
    from scipy.special import log_ndtr

    if error == 0.0:
        return max(mean, 0.0)
    at = mean / error
    ratio = math.exp(-0.5 * at * at - 0.5 * math.log(2.0 * math.pi) - float(log_ndtr(at)))
    return error * math.sqrt(max(0.0, 1.0 + at * (at + ratio)))


def _spread(number: int, dimension: int, rng: np.random.Generator) -> FloatArray:
    """Unit vectors (number, dimension) that are spread evenly over the sphere, turned at random."""
    from scipy.special import ndtri
    from scipy.stats.qmc import Sobol

    if dimension == 1:
        return np.where(np.arange(number) % 2 == 0, 1.0, -1.0)[:, None]
    if dimension == 2:
        angle = 2.0 * math.pi * (np.arange(number) + rng.random()) / number
        return np.stack([np.cos(angle), np.sin(angle)], axis=1)
    if dimension <= Sobol.MAXDIM:
        points = Sobol(dimension, scramble=True, rng=rng).random(number)
        u = np.asarray(ndtri(np.clip(points, 1e-15, 1.0 - 1e-15)))
    else:
        u = rng.standard_normal((number, dimension))
    return np.asarray(u / np.linalg.norm(u, axis=1, keepdims=True))
