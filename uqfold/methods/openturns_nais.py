"""NAIS by OpenTURNS: importance sampling from densities with a kernel around each failure."""

from __future__ import annotations

import math
from dataclasses import dataclass, field, replace
from typing import Any, ClassVar

import numpy as np

from uqfold.checks import keep, or_none, real, whole
from uqfold.evaluation import BudgetExceededError, TimeLimitError
from uqfold.evaluation.samples import Label
from uqfold.inputs.engine import openturns
from uqfold.inputs.interrupts import DeferredInterrupt
from uqfold.methods.conditional_sums import ENOUGH_DRAWS
from uqfold.methods.guided_sampling import driven
from uqfold.methods.importance_search import ImportanceSearch
from uqfold.methods.line_sums import Round, Rounds, Sample, frequent
from uqfold.methods.openturns_search import silent
from uqfold.methods.openturns_stream import RandomStream
from uqfold.methods.rare_event import NestedCriteria, RareEventMethod, Running
from uqfold.methods.repetitions import Repetitions
from uqfold.methods.result import Estimate
from uqfold.methods.subset_climb import piloted
from uqfold.methods.theory import Theory
from uqfold.methods.theory_of_repetitions import NAIS
from uqfold.methods.weighted_sums import APART, HEAVY, OVERLOOKED, doubts_of_unseen
from uqfold.problems.criterion import Criterion
from uqfold.typing import FloatArray

WITHOUT_A_BUDGET = 20
"""Repetitions where neither a number nor a budget is given."""
SMALLEST, WISHED, LEVELS = 100, 14, 6
"""Samples of a level at least; repetitions that a budget is divided into, and levels of each, as
guessed before there are any, with the sample of the answer."""
MOST_LEVELS = 25
"""A repetition of so many levels gets nowhere: each has a quarter of the one before, or more."""
PART_OF_CLIMBS, LEVEL_PROBABILITY = 3, 0.1
"""The climbs that look for regions of failure get one part in so many of the runs."""
FURTHEST = 1e100
"""Margins beyond are cut: the quantile of infinite ones would be no number."""


@dataclass(frozen=True)
class NAISDetails:
    """How one criterion was answered.

    Attributes
    ----------
    criterion
        The criterion.
    samples
        Samples of each level.
    pf
        Estimates (R,), each from one run of the algorithm; empty where failures were counted.
    climbs
        Estimates (R',) by climbs of subset simulation, which look for further regions of failure.
    """

    criterion: Criterion
    samples: int
    pf: FloatArray
    climbs: FloatArray


@dataclass(frozen=True)
class OpenTURNSNAIS(RareEventMethod):
    """Nonparametric adaptive importance sampling by OpenTURNS, its error from repetitions.

    OpenTURNS draws from a density, takes the quarter of its samples that comes nearest to failure,
    fits the next density to them by a kernel around each, and so on until a quarter of them fails
    (`openturns.NAIS`). It runs in standard-normal space on the system as one event. Its own answer
    is dropped: it comes from the sample that has ended the search by failing often, and is one
    percent too high. A fresh sample of the last density answers without bias. The whole is
    repeated, and the spread of the repetitions is the error.

    Every criterion has runs of its own; what is left of `max_evals` is split into equal shares for
    the criteria that are left.

    Attributes
    ----------
    samples
        Samples of a level; fewer where the budget would pay for less than 14 repetitions.
    repetitions
        Runs of the algorithm; `max_evals` may allow fewer, then the status is
        ``budget_exhausted``. None: as many as `max_evals` pays for; without a budget 20, or what
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
    A density that has lost a region of failure says nothing of it, and no repetition does. So a
    third of the runs go into short climbs of subset simulation; the row is ``doubtful`` where
    failures that these found are rare among the samples, where the two answers do not agree, and
    where the climbs are too few to rule out another region with a tenth of pf. A frequent failure
    is counted. A system of half a million random numbers or more is ``unsupported``.
    """

    name: ClassVar[str] = "openturns-nais"
    title: ClassVar[str] = "NAIS (OpenTURNS)"
    theory: ClassVar[Theory] = NAIS
    each_alone: ClassVar[bool] = True

    samples: int = 500
    repetitions: int | None = None
    target_cov: float | None = None

    def __post_init__(self) -> None:
        keep(self, "samples", whole, at_least=SMALLEST)
        keep(self, "repetitions", or_none, whole, at_least=2)
        keep(self, "target_cov", or_none, real, above=0.0)

    def _answered(
        self, asked: NestedCriteria, rng: np.random.Generator
    ) -> Running[tuple[list[Estimate], NAISDetails]]:
        nothing = np.empty(0)
        count = yield from frequent(asked, rng)
        if count:
            estimate = yield from Sample().counted(asked, self.target_cov, [], rng)
            return [estimate], NAISDetails(asked.criteria[0], 0, nothing, nothing)
        search = ImportanceSearch(asked, rng, float(asked.event.max_evals_per_sample))
        note = yield from _looked_around(search)
        size = int(asked.left // (WISHED * LEVELS * asked.event.max_evals_per_sample))
        size = min(self.samples, max(SMALLEST, size))
        runs = Repeated(asked, rng, size)
        rounds = Rounds(
            asked, self.repetitions, self.target_cov, WITHOUT_A_BUDGET, size, what="sample"
        )
        cost = float(LEVELS * size * asked.event.max_evals_per_sample)
        try:
            yield from rounds.make(runs.drawn, cost, size * asked.event.dimension)
        except _StuckError as error:
            estimate = yield from Sample().counted(asked, self.target_cov, [str(error)], rng)
            return [estimate], NAISDetails(asked.criteria[0], 0, nothing, search.climbs)
        pf = rounds.together("high")
        doubts = runs.doubts(search, Repetitions(pf)) if pf.size > 1 and pf.any() else []
        estimate = yield from rounds.answer([note] * bool(note) + doubts, rng)
        return [estimate], NAISDetails(asked.criteria[0], size, pf, search.climbs)


def _looked_around(search: ImportanceSearch) -> Running[str]:
    """Look for failures by climbs; return why they say nothing, or nothing."""
    asked = search.asked
    most = asked.most
    search.asked = replace(asked, most=asked.session.n_evals + asked.left // PART_OF_CLIMBS)
    try:
        size = max(SMALLEST, search.affordable // 50)
        if search.affordable < 4 * size:
            return "the budget is too small to look for further regions of failure"
        pilot = yield from piloted(
            search.asked, size, LEVEL_PROBABILITY, search.affordable // 2, search.rng
        )
        if not pilot.levels or pilot.note:
            return pilot.note
        return (yield from search.find(pilot))
    except BudgetExceededError as error:
        return str(error)
    finally:
        search.asked = replace(asked, most=most)


@dataclass(eq=False)
class Repeated:
    """Runs of OpenTURNS' algorithm, each an estimate of pf.

    Attributes
    ----------
    asked
        The criterion.
    rng
        Source of seeds.
    size
        Samples of a level.
    """

    asked: NestedCriteria
    rng: np.random.Generator
    size: int
    _densities: list[Any] = field(default_factory=list)
    _largest: float = 0.0
    _powers: FloatArray = field(default_factory=lambda: np.zeros(3))

    def drawn(self, number: int) -> Running[Round]:
        """Run the algorithm some times."""
        found: list[tuple[float, float, float]] = []
        for _ in range(number):
            self.asked.session.check_time()
            try:
                found.append(self._one())
            except (BudgetExceededError, TimeLimitError):
                if not found:
                    raise
                break
        high, low, largest = np.array(found).T
        # the model is called within OpenTURNS, so that nothing is left to be asked for
        yield from ()
        return Round(high, low, np.zeros_like(high), largest)

    def _one(self) -> tuple[float, float, float]:
        """Run it once: pf, pf with failed runs as safe, and what one sample makes of it."""
        ot = openturns()
        raised: list[BaseException] = []
        deferred, stream = DeferredInterrupt(), RandomStream(int(self.rng.integers(2**31)))
        levels = 0

        def margins(u: Any) -> FloatArray:
            nonlocal levels
            try:
                with stream.put_aside(), deferred.let_in():
                    levels += 1
                    if levels > MOST_LEVELS:
                        raise _StuckError(f"{MOST_LEVELS} levels do not reach failure")
                    return self._margin(self._heights(u, phase="search", level=levels)[1])[:, None]
            except BaseException as error:
                # OpenTURNS turns it into a RuntimeError of its own
                raised.append(error)
                raise

        dimension = self.asked.event.dimension
        with deferred, silent(ot):
            function = ot.PythonFunction(dimension, 1, func_sample=margins)
            inputs = ot.RandomVector(ot.JointDistribution([ot.Normal()] * dimension))
            event = ot.ThresholdEvent(ot.CompositeRandomVector(function, inputs), ot.Greater(), 0.0)
            algorithm = ot.NAIS(event)
            algorithm.setBlockSize(self.size)
            algorithm.setMaximumOuterSampling(1)
            with stream.drawn_from():
                try:
                    algorithm.run()
                    density = algorithm.getResult().getAuxiliaryDistribution()
                    u = np.array(density.getSample(self.size))
                except (RuntimeError, TypeError) as error:
                    # of its own making where all heights are alike
                    raised.append(_StuckError(f"OpenTURNS finds no way to failure: {error}"))
        if raised:
            raise raised[0]
        ratio = np.exp(_log_normal(u) - _log_density(density, u))
        low, high = (
            self.asked.fail(heights)[0]
            for heights in self._heights(u, phase="answer", weight=ratio)
        )
        weights = np.where(high, ratio, 0.0)
        self._densities.append(density)
        self._largest = max(self._largest, float(weights.max()))
        self._powers += [np.mean(weights**power) for power in (1, 2, 3)]
        return (
            float(weights.mean()),
            float(weights[low].sum()) / self.size,
            float(weights.max()) / self.size,
        )

    def _heights(self, u: Any, **labels: Label) -> tuple[FloatArray, FloatArray]:
        return driven(self.asked.heights(np.array(u), **labels), self.asked.session.evaluate)

    def _margin(self, high: FloatArray) -> FloatArray:
        """How far beyond the limit heights (n,) are: > 0 exactly where they fail."""
        with np.errstate(invalid="ignore", over="ignore"):
            beyond = np.clip(high - self.asked.limits[0], -FURTHEST, FURTHEST)
        fails = self.asked.fail(high)[0]
        return np.where(high == np.inf, FURTHEST, np.where(fails, beyond, np.minimum(beyond, 0.0)))

    def doubts(self, search: ImportanceSearch, found: Repetitions) -> list[str]:
        """Return what the climbs of a search say against the densities."""
        doubts = []
        number = len(self._densities) * self.size
        heaviest = self._largest / (self._powers[0] * self.size)
        if heaviest > HEAVY:
            doubts.append(f"one sample makes {100.0 * heaviest:.0f} % of pf")
        elif self._skewed(number):
            doubts.append(f"few of {number} samples make pf: their weights are too skewed")
        if search.witnesses is None:
            return doubts
        climbed = Repetitions(search.climbs)
        doubts += doubts_of_unseen(search.unseen)
        apart = math.log(found.mean / climbed.mean) / math.hypot(found.cov, climbed.cov)
        if abs(apart) > APART:
            doubts.append(f"climbs found {climbed.mean:.2g}, {abs(apart):.1f} errors off")
        overlooked = self._overlooked(*search.witnesses)
        if overlooked > OVERLOOKED:
            doubts.append(
                f"{100.0 * overlooked:.0f} % of the failures that climbs found lie where samples "
                "are rare"
            )
        return doubts

    def _skewed(self, number: int) -> bool:
        """Whether an interval for a mean asks for more samples than there are.

        Cochran's rule: 25 times the squared skewness (Sampling Techniques, 1977, 2.15).
        """
        mean, square, cube = (self._powers / len(self._densities)).tolist()
        variance = square - mean**2
        third = cube - 3.0 * mean * square + 2.0 * mean**3
        return bool(number * variance**3 < ENOUGH_DRAWS * third**2)

    def _overlooked(self, u: FloatArray, shares: FloatArray) -> float:
        """Share of known failures that would weigh more than the largest sample drawn."""
        u = u[:, : self.asked.event.dimension]
        logs = [_log_density(one, u) for one in self._densities]
        density = np.logaddexp.reduce(logs) - math.log(len(logs))
        return float(shares[_log_normal(u) > math.log(self._largest) + density].sum())


def _log_density(density: Any, u: FloatArray) -> FloatArray:
    return np.array(density.computeLogPDF(u)).ravel()


def _log_normal(u: FloatArray) -> FloatArray:
    return np.asarray(-0.5 * (u**2).sum(axis=1) - 0.5 * u.shape[1] * math.log(2.0 * math.pi))


class _StuckError(Exception):
    """Levels do not rise any more."""
