"""What line sampling and directional sampling share: where they begin, their rounds, their answer.

Both average probabilities along lines, each of which may be as good as exact. So they ask whether
failure is frequent first, which plain counting answers as well, and are doubtful wherever a run
contradicts what is believed of a line and pf hangs on it.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, field, replace

import numpy as np

from uqfold.evaluation import BudgetExceededError, RunningEstimate, TimeLimitError
from uqfold.methods.counted import counted
from uqfold.methods.rare_event import NestedCriteria, Running
from uqfold.methods.repetitions import FEWEST, Repetitions, combined
from uqfold.methods.result import TARGET_COV, Estimate, Status
from uqfold.methods.system_sample import BLOCK_VALUES
from uqfold.methods.weighted_sums import HEAVY
from uqfold.typing import FloatArray

FIRST = 40
"""Systems drawn to begin with."""
FREQUENT = 4
"""With so many failures among them, or more, systems are counted."""
WITHOUT_A_BUDGET = 20_000
"""Systems to count where neither a target nor a budget is given."""
ROUNDING = 1e-3
"""Relative error of every answer: of crossings that are known to a tolerance, and of what lies
beyond the ends of lines."""
OUTSTANDING = 5.0
"""One line may make so many times the mean of a repetition before it is a doubt, if it makes more
than a fiftieth of pf."""
DRIFT = 3.5
"""So many standard errors apart, earlier and later lines contradict one another."""
RESERVE = 1.3
"""A round may cost so much more than the rounds before it."""
KEPT, KEPT_ALIKE, ALIKE, LEFT = 0.1, 0.5, 0.05, 0.8
"""Part of the runs that is kept to look between lines: less, and more from so small a relative
error on; some are left to follow what is found."""
MOST_LOOKS = 5_000
"""Systems looked at between lines at most."""


@dataclass(eq=False)
class Sample:
    """Systems drawn by the law of the inputs, and how many of them failed.

    Attributes
    ----------
    n, high, low
        Systems, and how many failed, failed runs counted as failures and as safe.
    """

    n: int = 0
    high: int = 0
    low: int = 0

    def drawn(self, asked: NestedCriteria, size: int, rng: np.random.Generator) -> Running[None]:
        """Draw more systems."""
        low, high = yield from asked.heights(rng.standard_normal((size, asked.event.dimension)))
        self.n += size
        self.high += int(np.count_nonzero(asked.fail(high)))
        self.low += int(np.count_nonzero(asked.fail(low)))

    def counted(
        self, asked: NestedCriteria, target: float | None, doubts: list[str],
        rng: np.random.Generator,
    ) -> Running[Estimate]:  # fmt: skip
        """Count failures until the target is met, or the runs are spent."""
        most = WITHOUT_A_BUDGET
        if asked.session.max_evals is not None or target is not None:
            most = asked.left
        status: Status = "doubtful" if doubts else "converged"
        notes = list(doubts)
        try:
            while self.n < most and not self._precise(target):
                size = min(max(self.n, FIRST), BLOCK_VALUES // asked.event.dimension + 1)
                size = min(size, most - self.n, asked.left // asked.event.max_evals_per_sample)
                if size == 0:
                    break
                yield from self.drawn(asked, size, rng)
        except (TimeLimitError, BudgetExceededError) as error:
            if self.n == 0:
                raise
            status = "doubtful" if doubts else "budget_exhausted"
            notes.append(str(error))
        if self.n == 0:
            raise BudgetExceededError("no system fits into the runs that are left")
        return counted(self.n, self.high, self.low, status, notes)

    def _precise(self, target: float | None) -> bool:
        """Whether the target, if there is one, is met."""
        if target is None or self.high < 10:
            return False
        return (self.n - self.high) / (self.n * self.high) <= target**2


def frequent(asked: NestedCriteria, rng: np.random.Generator) -> Running[bool]:
    """Whether failures are so frequent that counting will do, or the runs so few that it must.

    The systems drawn for it are forgotten: an answer that rests on them would have a bias.
    """
    size = asked.left // asked.event.max_evals_per_sample
    if size < 2 * FIRST:
        return True
    first = Sample()
    yield from first.drawn(asked, FIRST, rng)
    return first.high >= FREQUENT


@dataclass(frozen=True, eq=False)
class Round:
    """Some repetitions: independent estimates of pf (R,), each without bias.

    Attributes
    ----------
    high, low
        Failed runs counted as failures, and as safe.
    contradicted
        The largest part (R,) of each that comes from a run that contradicts what was believed.
    largest
        The largest part (R,) of each that comes from one line.
    """

    high: FloatArray
    low: FloatArray
    contradicted: FloatArray
    largest: FloatArray


@dataclass(eq=False)
class Rounds:
    """The repetitions so far, made round by round until the target is met or the runs are spent.

    Attributes
    ----------
    asked
        The criterion.
    wanted
        Repetitions to make; None: as many as the runs pay for.
    target
        Relative standard error to stop at; None: never.
    without_a_budget
        Repetitions where neither of these is given, and no budget.
    lines
        Lines of a repetition that stand for each other.
    heaviest
        What one failure that contradicts its line adds to a repetition at most, times these lines.
    what
        What they are called.
    hidden
        Relative error of what they may have stepped over.
    looking
        Whether a part of the runs is kept to look between the lines.
    looked
        Places of further lines that were looked at, and explained.
    done
        The rounds.
    short
        Why there are fewer repetitions than wanted; may be empty.
    """

    asked: NestedCriteria
    wanted: int | None
    target: float | None
    without_a_budget: int
    lines: int = 1
    heaviest: float = math.inf
    what: str = "line"
    hidden: float = 0.0
    looking: bool = False
    looked: int = 0
    done: list[Round] = field(default_factory=list)
    short: list[str] = field(default_factory=list)
    _given: int = field(init=False)
    _start: int = field(init=False)

    def __post_init__(self) -> None:
        self._given, self._start = self.asked.left, self.asked.session.n_evals

    @property
    def looks(self) -> int:
        """Systems to look at between the lines; without a budget half of what these took."""
        most = LEFT * self.asked.left
        if self.asked.session.max_evals is None:
            most = min(most, 0.5 * (self.asked.session.n_evals - self._start))
        return min(int(most / self.asked.event.max_evals_per_sample), MOST_LOOKS)

    @property
    def _kept(self) -> float:
        """Runs kept for it: more, once the lines hardly differ."""
        if not self.looking or self.asked.session.max_evals is None:
            return 0.0
        alike = self.made >= 2 * FEWEST
        alike = alike and Repetitions(self.together("high"), self.least).most_cov <= ALIKE
        return self._given * (KEPT_ALIKE if alike else KEPT)

    @property
    def made(self) -> int:
        """Count the repetitions."""
        return sum(one.high.size for one in self.done)

    @property
    def least(self) -> float:
        """Relative error at least: what n lines have not met may be met by one in n."""
        return math.hypot(ROUNDING, 1.0 / (self.made * self.lines + self.looked), self.hidden)

    def together(self, name: str) -> FloatArray:
        """Return a column (R,) of all rounds."""
        return np.concatenate([np.empty(0), *(getattr(one, name) for one in self.done)])

    def make(
        self, next_round: Callable[[int], Running[Round]], cost: float, values: int
    ) -> Running[None]:
        """Make rounds.

        Parameters
        ----------
        next_round
            Makes a number of repetitions.
        cost
            Runs of one repetition, as guessed.
        values
            Random numbers of one.
        """
        session = self.asked.session
        before = session.n_evals
        try:
            while number := self._next(cost, values):
                self.done.append((yield from next_round(number)))
                cost = (session.n_evals - before) / self.made
                if session.watched and self.made > 1:
                    high = Repetitions(self.together("high"), self.least)
                    ends = high.ends()
                    named = str(self.asked.criteria[0])
                    session.report(RunningEstimate(named, high.mean, *ends))
        except TimeLimitError as error:
            if not self.done:
                raise
            self.short.append(str(error))
        except BudgetExceededError:
            # with a budget alone they end where it ends
            pass
        if self.wanted is not None and self.made < self.wanted and not self._precise():
            self.short.insert(0, f"{self.made} of {self.wanted} repetitions")

    def _next(self, cost: float, values: int) -> int:
        """Return how many repetitions to make next; 0: no more."""
        if self._precise():
            return 0
        # the first lines tell what a line costs
        number = max(FEWEST if self.made else -(-FEWEST // self.lines), self.made, 2)
        most = self.wanted
        if most is None and self.asked.session.max_evals is None and self.target is None:
            most = self.without_a_budget
        if most is not None:
            number = min(number, most - self.made)
        number = min(number, max(1, BLOCK_VALUES // values))
        return max(0, min(number, int((self.asked.left - self._kept) / (RESERVE * cost))))

    def _precise(self) -> bool:
        """Whether the target, if there is one, is met for sure."""
        if self.target is None or self.made < 2 * FEWEST:
            return False
        return Repetitions(self.together("high"), self.least).most_cov <= self.target

    def answer(self, doubts: list[str], rng: np.random.Generator) -> Running[Estimate]:
        """Return the answer; see `combined`. Runs too few for two repetitions go into a count."""
        few = ["the runs are too few for two repetitions"]
        if self.made < 2 and self.asked.left >= self.asked.event.max_evals_per_sample:
            return (yield from Sample().counted(self.asked, self.target, few, rng))
        target = TARGET_COV if self.target is None else self.target
        if self.made < 2:
            return Estimate(
                0.0, ci_low=0.0, ci_high=1.0, ci_kind="upper bound 95 %", error_kind="sampling",
                status="doubtful", message=few[0],
            )  # fmt: skip
        high, low = (self.together(name) for name in ("high", "low"))
        total = float(high.sum())
        if total <= 0.0:
            high = np.zeros_like(high)
        if low.sum() <= 0.0:
            low = np.zeros_like(low)
        status: Status = "budget_exhausted" if self.short else "converged"
        above = Repetitions(np.full_like(high, 1.0 if total > 0.0 else self._bound()))
        estimate = combined(
            Repetitions(high, self.least), Repetitions(low, self.least), above, target, status,
            self.short,
        )  # fmt: skip
        doubts = list(doubts)
        if self.asked.flat:
            doubts.append("the response is constant until it fails: nothing leads to thin regions")
        if total > 0.0:
            most = float(self.together("largest").max()) / total
            if most > max(HEAVY, OUTSTANDING / high.size):
                doubts.append(f"one {self.what} makes {100.0 * most:.0f} % of pf")
            contradicted = float(self.together("contradicted").max()) / total
            if contradicted > HEAVY:
                doubts.append(
                    f"{100.0 * contradicted:.0f} % of pf hang on one run that contradicts its line"
                )
            doubts += self._drift()
        if doubts:
            message = "; ".join([*doubts, *filter(None, [estimate.message])])
            estimate = replace(estimate, status="doubtful", message=message)
        return estimate

    def _bound(self) -> float:
        """Bound pf at 95 % where no run of so many lines has failed, those that contradict too."""
        return min(1.0, self.heaviest * -math.expm1(math.log(0.05) / (self.made * self.lines)))

    def _drift(self) -> list[str]:
        """Return a doubt where later lines, which know more, find another pf than earlier ones."""
        for i in range(1, len(self.done)):
            parts = [
                Repetitions(np.concatenate([one.high for one in some]), ROUNDING)
                for some in (self.done[:i], self.done[i:])
            ]
            if min(one.values.size for one in parts) < 2:
                continue
            earlier, later = parts
            apart = abs(earlier.mean - later.mean)
            error = math.hypot(earlier.mean * earlier.cov, later.mean * later.cov)
            if apart > max(DRIFT * error, HEAVY * later.mean):
                return ["later lines find what earlier ones overlooked"]
        return []
