"""Sums over weighted samples: an estimate without bias, its error, and doubts about it."""

from __future__ import annotations

import math

import numpy as np

from uqfold.methods.importance_search import ONE_IN_TWENTY, WeightedSamples
from uqfold.methods.partner_sums import weighted_count
from uqfold.methods.repetitions import Repetitions
from uqfold.methods.result import Estimate, Status

BY_WEIGHTS = "gamma 95 %"
"""What the interval of weighted samples is."""
HEAVY = 0.02
"""One sample that makes more than this of pf says that there are others like it, not seen."""
OVERLOOKED = 0.03
"""More than this share of known failures where samples are too rare is a doubt."""
MOST_UNSEEN, MOST_ADDED = 0.1, 0.95
"""Largest part of pf that may go unseen where the error does not say so; and to which the interval
may be extended."""
APART = 3.5
"""Standard errors by which another estimate may differ."""


class WeightedSums:
    """Running sums of the weights of samples that fail, failed runs as failures and as safe.

    Attributes
    ----------
    n
        Samples.
    hits, sure
        How many of them fail, failed runs counted as failures, and as safe.
    largest
        Largest weight of one that fails.
    """

    def __init__(self) -> None:
        self.n = self.hits = self.sure = 0
        self.largest = 0.0
        self._totals, self._squares = np.zeros(2), np.zeros(2)

    def add(self, samples: WeightedSamples) -> None:
        """Add some samples."""
        self.n += len(samples.u)
        self.hits += int(np.count_nonzero(samples.high))
        self.sure += int(np.count_nonzero(samples.low))
        for i, fails in enumerate((samples.high, samples.low)):
            weights = samples.weights[fails]
            self._totals[i] += weights.sum()
            self._squares[i] += np.sum(weights**2)
            self.largest = max(self.largest, float(weights.max(initial=0.0)))

    @property
    def pf(self) -> float:
        """Failure probability, failed runs counted as failures."""
        return min(1.0, float(self._totals[0]) / self.n)

    @property
    def cov(self) -> float:
        """Relative standard error; infinite where nothing failed."""
        if self._totals[0] == 0.0:
            return math.inf
        return math.sqrt(self._variance(0)) / float(self._totals[0])

    @property
    def alike(self) -> float:
        """How many samples of equal weight would scatter like those that failed (Kish)."""
        return 0.0 if self.hits == 0 else float(self._totals[0] ** 2 / self._squares[0])

    @property
    def heaviest(self) -> float:
        """Part of pf that comes from one sample."""
        return 0.0 if self.hits == 0 else self.largest / float(self._totals[0])

    def _variance(self, i: int) -> float:
        """Variance of a total, estimated."""
        spread = float(self._squares[i]) - float(self._totals[i]) ** 2 / self.n
        return max(0.0, spread) * self.n / max(1, self.n - 1)

    def ends(self, i: int = 0) -> tuple[float, float]:
        """Ends of the 95 % interval after Fay and Feuer; 1: failed runs counted as safe."""
        largest = self.largest
        low, high = weighted_count(float(self._totals[i]), self._variance(i), largest)
        return low / self.n, min(1.0, high / self.n)

    def estimate(
        self,
        target: float,
        other: Repetitions,
        *,
        overlooked: float,
        unseen: float,
        short: list[str],
    ) -> Estimate:
        """Return the answer.

        Parameters
        ----------
        target
            Largest relative standard error of a row that is not doubtful.
        other
            Other estimates of pf, independent of these samples.
        overlooked
            Share of known failures where samples are too rare.
        unseen
            Mean part t of all failures in a region that the search may have missed. The standard
            error contains it, and the interval goes on to what is missed once in twenty times.
        short
            Why there are fewer samples than wanted; may be empty.
        """
        status: Status = "budget_exhausted" if short else "converged"
        doubts = []
        if self.hits == 0:
            doubts.append(
                f"no failure among {self.n} samples; {other.mean:.2g} by the first climbs"
            )
        elif self.heaviest > HEAVY:
            doubts.append(f"one sample makes {100.0 * self.heaviest:.0f} % of pf")
        error = math.hypot(self.cov, unseen)
        if self.cov <= target < error:
            doubts.append(unseen_part(unseen))
        if self.hits and self.cov <= target:
            apart = math.log(self.pf / other.mean) / math.hypot(self.cov, other.cov)
            if abs(apart) > APART:
                doubts.append(
                    f"the first climbs found {other.mean:.2g}, {abs(apart):.1f} errors off"
                )
        if self.hits and overlooked > OVERLOOKED:
            doubts.append(
                f"{100.0 * overlooked:.0f} % of the failures that the climbs found lie where "
                "samples are rare"
            )
        if doubts:
            status = "doubtful"
        seen = self.hits > 0
        low, high = self.ends(1)[0], self.ends()[1]
        pf = self.pf
        return Estimate(
            pf,
            std_error=pf * error if seen else math.nan,
            ci_low=low,
            ci_high=with_unseen(max(pf, high), unseen) if seen else other.ends()[1],
            ci_kind=BY_WEIGHTS if seen else "upper bound 95 %",
            pf_low=min(pf, float(self._totals[1]) / self.n),
            pf_high=pf,
            error_kind="sampling",
            status=status,
            message="; ".join([*doubts, *short]),
        )


def with_unseen(high: float, unseen: float) -> float:
    """Return an upper end with what may be missed once in twenty times, of a mean part unseen."""
    return min(1.0, high / (1.0 - min(ONE_IN_TWENTY * unseen, MOST_ADDED)))


def doubts_of_unseen(unseen: float) -> list[str]:
    """Return the doubt that a region has been missed, if that may be a large part of pf.

    A mean part is given; what is missed once in twenty times is judged.
    """
    return [unseen_part(unseen)] if ONE_IN_TWENTY * unseen > MOST_UNSEEN else []


def unseen_part(unseen: float) -> str:
    """Say what part of pf may be missed."""
    part = min(ONE_IN_TWENTY * unseen, 1.0)
    return f"a region elsewhere with {100.0 * part:.0f} % of pf might be missed"
