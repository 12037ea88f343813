"""Line sampling: probabilities along lines towards failure, each found by a few runs."""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from typing import ClassVar

import numpy as np

from uqfold.checks import keep, or_none, real, whole
from uqfold.evaluation import TimeLimitError
from uqfold.methods.crossings import Lines
from uqfold.methods.line_alone import OneLine
from uqfold.methods.line_directions import DirectionSearch
from uqfold.methods.line_laws import normal_law
from uqfold.methods.line_neighbours import Traces
from uqfold.methods.line_planes import PlanePoints, overlooked
from uqfold.methods.line_sums import Round, Rounds, Sample, frequent
from uqfold.methods.rare_event import NestedCriteria, RareEventMethod, Running
from uqfold.methods.repetitions import FEWEST
from uqfold.methods.result import Estimate
from uqfold.methods.theory import Theory
from uqfold.methods.theory_of_lines import LINE_SAMPLING
from uqfold.methods.weighted_sums import HEAVY
from uqfold.problems.criterion import Criterion
from uqfold.typing import BoolArray, FloatArray, IntArray

WITHOUT_A_BUDGET = 100
"""Repetitions where neither a number nor a budget is given."""
BEYOND = 1e-3
"""Lines end where this part of pf is left beyond."""
NARROWEST, FIRST_WIDTH = 0.1, 0.4
"""Lines are run on both sides of where failure is expected to begin, at least so far from it."""
CLOSELY = 3
"""Further runs of a line that is looked at closely: those of the first round, and all others if
these meet failure more than once."""
NOTICED = 0.02
"""A direction whose plane has less than this part of pf behind it need not be met."""
AHEAD = 10.0
"""Between lines half of the runs are where the probability beyond is so many times pf."""
COST = 12.0
"""Runs of a line, as guessed before there are any."""


@dataclass(frozen=True)
class LineDetails:
    """How one criterion was answered.

    Attributes
    ----------
    criterion
        The criterion.
    directions
        Important directions (K, d) in standard-normal space, in the order of
        `uqfold.system.event.SystemEvent`; none where failures were counted.
    distances
        Where failure begins along each (K,), in standard deviations.
    pf
        Estimates (R,), each from one line in every direction.
    """

    criterion: Criterion
    directions: FloatArray
    distances: FloatArray
    pf: FloatArray


@dataclass(frozen=True)
class LineSampling(RareEventMethod):
    """Line sampling on the real model, for failures in a few directions, whatever the dimension.

    Gradients lead to the limit state; points far out in all directions tell of further regions of
    failure, which have directions of their own. A line runs in each direction through a random
    point; where it crosses from working to failing is found by a few runs, and the normal
    probability beyond is one estimate of pf. A point belongs to the direction in whose plane it
    lies deepest, so that nothing counts twice. Two more runs at random places on each line keep
    the estimate without bias where a crossing was overlooked.

    Every criterion has runs of its own; what is left of `max_evals` is split into equal shares for
    the criteria that are left.

    Attributes
    ----------
    lines
        Lines in each direction; `max_evals` may allow fewer, then the status is
        ``budget_exhausted``. None: as many as `max_evals` pays for; without a budget 100, or what
        `target_cov` takes.
    target_cov
        Stop early once the relative standard error is at most this, for sure; None: never. A row
        with a larger one, or with more than 10 % under None, is ``doubtful``.

    Raises
    ------
    ValueError
        If a setting is out of range.

    Notes
    -----
    A frequent failure is counted, with the interval of Clopper and Pearson. So it is, and the row
    is ``doubtful``, where no direction is found, or where failures far out are met that lie in none
    of them. A system of half a million random numbers or more is ``unsupported``.
    """

    name: ClassVar[str] = "line-sampling"
    title: ClassVar[str] = "Line sampling"
    theory: ClassVar[Theory] = LINE_SAMPLING
    each_alone: ClassVar[bool] = True

    lines: int | None = None
    target_cov: float | None = None

    def __post_init__(self) -> None:
        keep(self, "lines", or_none, whole, at_least=2)
        keep(self, "target_cov", or_none, real, above=0.0)

    def _answered(
        self, asked: NestedCriteria, rng: np.random.Generator
    ) -> Running[tuple[list[Estimate], LineDetails]]:
        search = DirectionSearch(asked, rng)
        doubts = []
        count = yield from frequent(asked, rng)
        if not count and asked.event.dimension == 1:
            return (yield from self._one_line(asked, rng))
        if not count:
            doubts = yield from search.find()
        if count or doubts:
            estimate = yield from Sample().counted(asked, self.target_cov, doubts, rng)
            nothing = np.empty(0)
            return [estimate], LineDetails(asked.criteria[0], search.alphas[:0], nothing, nothing)
        bundles = Bundles(asked, rng, *search.weighty())
        rounds = Rounds(
            asked, self.lines, self.target_cov, WITHOUT_A_BUDGET, heaviest=bundles.heaviest,
            looking=True,
        )  # fmt: skip
        regions = bundles.betas.size
        cost = COST * regions * asked.event.max_evals_per_sample
        yield from rounds.make(bundles.drawn, cost, regions * asked.event.dimension)
        pf = float(np.mean(rounds.together("high"))) if rounds.made else 0.0
        doubts = bundles.missing(pf)
        if rounds.made > 1 and pf > 0.0:
            number = rounds.looks
            try:
                missed = yield from bundles.between(pf, number)
                rounds.hidden, rounds.looked = missed / pf, number // 2
            except TimeLimitError as error:
                rounds.short.append(str(error))
            if rounds.hidden > HEAVY:
                part = f"{100.0 * rounds.hidden:.0f} % of pf"
                doubts.append(f"{part} may lie in narrow regions between lines")
        estimate = yield from rounds.answer(doubts, rng)
        return [estimate], LineDetails(
            asked.criteria[0], bundles.alphas, bundles.betas, rounds.together("high")
        )

    def _one_line(
        self, asked: NestedCriteria, rng: np.random.Generator
    ) -> Running[tuple[list[Estimate], LineDetails]]:
        line = OneLine(asked, rng)
        yield from line.look()
        rounds = Rounds(
            asked, self.lines, self.target_cov, WITHOUT_A_BUDGET, heaviest=line.heaviest
        )
        yield from rounds.make(line.drawn, 2.0 * asked.event.max_evals_per_sample, 1)
        estimate = yield from rounds.answer([], rng)
        return [estimate], LineDetails(asked.criteria[0], *line.sides(), rounds.together("high"))


@dataclass(eq=False)
class Bundles:
    """Lines in all directions at once: one bundle is one estimate of pf.

    Attributes
    ----------
    asked
        The criterion.
    rng
        Source of randomness.
    alphas, betas
        The directions (K, d), and where failure begins along each (K,).
    led
        Whether it is known how near the region of each comes to the origin (K,).
    closely
        Whether lines are looked at closely.
    """

    asked: NestedCriteria
    rng: np.random.Generator
    alphas: FloatArray
    betas: FloatArray
    led: BoolArray
    closely: bool = True
    _expected: FloatArray = field(init=False)
    _width: FloatArray = field(init=False)
    _hits: IntArray = field(init=False)
    _traces: dict[int, Traces] = field(default_factory=dict)
    _planes: list[PlanePoints] = field(init=False)

    def __post_init__(self) -> None:
        self._planes = [PlanePoints(alpha, self.rng) for alpha in self.alphas]
        self._expected = self.betas.copy()
        self._width = np.full(self.betas.size, FIRST_WIDTH)
        self._hits = np.zeros(self.betas.size, dtype=np.int64)

    def drawn(self, number: int) -> Running[Round]:
        """Draw some bundles."""
        high, low, contradicted, largest = np.zeros((4, number))
        several = False
        for k in range(self.betas.size):
            lines, start, of = self._lines(k, number)
            if not len(lines):
                continue
            inner = self._expected[k] + self._width[k] * np.array([[-1.0, 1.0]])
            inner = np.broadcast_to(inner, (len(lines), 2))
            if self.closely:
                shares = np.arange(CLOSELY) + self.rng.random((len(lines), 1))
                reach = (lines.last - lines.first)[:, None]
                inner = np.hstack([inner, lines.first[:, None] + shares * reach / CLOSELY])
            traces = yield from lines.followed(inner, earlier=self._traces.get(k))
            segments = traces.segments
            more_low, more_high, taught = yield from lines.checked(traces, self.rng, evenly=True)
            self._traces[k] = taught.joined(self._traces.get(k)).latest()
            mass_low, mass_high = lines.masses(segments, start, np.full(len(lines), np.inf))
            high[of] += mass_high + more_high
            low[of] += mass_low + more_low
            contradicted[of] = np.maximum(contradicted[of], np.abs(more_high))
            largest[of] = np.maximum(largest[of], mass_high + more_high)
            several |= bool((segments.crossings(len(lines)) > 1).any() or more_high.any())
            self._hits[k] += np.count_nonzero(mass_high)
            self._expect(k, segments.first_failures(len(lines)))
        # decided for the lines after these, so that their estimates stay without bias
        self.closely = several
        return Round(high, low, contradicted, largest)

    def missing(self, pf: float) -> list[str]:
        """Return doubts where lines hardly meet the failures that their direction is there for."""
        from scipy.special import ndtr

        weighty = (ndtr(-self.betas) > NOTICED * pf) | ~self.led
        few = weighty & (self._hits < FEWEST)
        if not few.any():
            return []
        return [f"lines in {few.sum()} of {few.size} directions hardly meet failures"]

    def between(self, pf: float, number: int) -> Running[float]:
        """Look between the lines by single runs; return the probability that lines overlook.

        Half of the runs are where `AHEAD` times pf lies beyond: a ridge that matters fails there.
        One that fails, though none of the lines beside it does there, is followed as a line of its
        own. The others are spread evenly over all places before.
        """
        from scipy.special import ndtri

        near = min(float(-ndtri(min(0.5, AHEAD * pf))), self._reach())
        total = 0.0
        for k, traces in self._traces.items():
            # what others have followed is spent
            most = self.asked.left // self.asked.event.max_evals_per_sample
            each = min(number // self.betas.size, most)
            if each > 1:
                lines, start, _ = self._lines(k, each)
                found = yield from overlooked(lines, start, traces, near, self.rng)
                total += found / each
        return total

    @property
    def heaviest(self) -> float:
        """The largest weight of a run that contradicts a line, in all directions together."""
        return self.betas.size * 2.0 * self._reach() / math.sqrt(2.0 * math.pi)

    def _reach(self) -> float:
        """How far out lines are looked at."""
        return math.sqrt(self.betas.min() ** 2 - 2.0 * math.log(BEYOND / self.betas.size))

    def _lines(self, k: int, number: int) -> tuple[Lines, FloatArray, IntArray]:
        """Lines in one direction, where each becomes the direction's own, and their bundles."""
        alpha, beta = self.alphas[k], self.betas[k]
        base = self._planes[k].points(number)
        start = np.full(number, -np.inf)
        for j in range(self.betas.size):
            if j != k:
                deeper = beta - self.betas[j] + base @ self.alphas[j]
                start = np.maximum(start, deeper / (1.0 - float(self.alphas[j] @ alpha)))
        reach = self._reach()
        of = np.flatnonzero(start < reach)
        size = of.size
        first = np.maximum(start[of], -reach)
        lines = Lines(
            self.asked, base[of], np.tile(alpha, (size, 1)), normal_law(), first,
            np.full(size, reach),
        )  # fmt: skip
        return lines, start[of], of

    def _expect(self, k: int, begins: FloatArray) -> None:
        """Take from lines that were followed where those after them will begin to fail."""
        known = begins[np.isfinite(begins)]
        if known.size >= 3:
            self._expected[k] = float(np.median(known))
            self._width[k] = max(NARROWEST, float(known.std()))
