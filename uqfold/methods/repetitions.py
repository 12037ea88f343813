"""The mean of independent, unbiased estimates of a probability, and how sure it is."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from uqfold.methods.result import NORMAL_95, Estimate, Status
from uqfold.typing import FloatArray

FEWEST = 10
"""So many repetitions must have seen failures, or the answer is doubtful."""
FEWEST_FOR_SPREAD = 3
"""With fewer of them the interval is all that an event that contains failure leaves open."""


@dataclass(frozen=True)
class Repetitions:
    """Independent estimates of one probability, each without bias.

    They are zero or have a long tail towards large values, more like a lognormal law the rarer the
    event is. So the interval is that of Student's t for the logarithm of the mean; and the relative
    error is the larger one of two: from the variance of the estimates, which in a few draws from a
    long tail often comes out too small, and from the variance of their logarithms, as it would
    follow if they were lognormal (Zhou and Gao 1997).

    Attributes
    ----------
    values
        The estimates (R,), R at least 2.
    least
        Relative error that they have in common, which their spread does not show.
    """

    values: FloatArray
    least: float = 0.0

    @property
    def mean(self) -> float:
        """The combined estimate."""
        return float(np.mean(self.values))

    @property
    def cov(self) -> float:
        """Relative standard error of the mean; infinite where no estimate is above zero."""
        return math.hypot(self._spread, self.least)

    @property
    def _spread(self) -> float:
        """What their spread says of it."""
        mean, n = self.mean, self.values.size
        if mean == 0.0:
            return math.inf
        # scaled, since the square of 1e-200 is no number
        cov = float(np.std(self.values / mean, ddof=1)) / math.sqrt(n)
        if np.all(self.values > 0.0):
            spread = float(np.var(np.log(self.values), ddof=1))
            cov = max(cov, math.sqrt(spread / n + spread**2 / (2.0 * (n - 1))))
        return cov

    @property
    def stated_cov(self) -> float:
        """Relative standard error to be stated: that of a normal law with the same interval.

        The spread of few repetitions is uncertain itself: with 14 of them, one answer in a hundred
        is more than three times its own estimate of it off.
        """
        return self._width(0.95) / NORMAL_95

    @property
    def most_cov(self) -> float:
        """Upper bound on the relative standard error, which few repetitions leave uncertain.

        It is that at 90 % if they were normal. Whether the error is small enough is judged by it:
        those runs whose error comes out too small would be taken for precise ones else.
        """
        from scipy.special import chdtri

        free = self.values.size - 1
        return math.hypot(self._spread * math.sqrt(free / float(chdtri(free, 0.9))), self.least)

    def ends(self, level: float = 0.95) -> tuple[float, float]:
        """Ends of the interval on the mean; (0, 1) where nothing is known."""
        if self.mean == 0.0:
            return 0.0, 1.0
        # a tail probability of 1e-9 of t with one degree of freedom is far beyond exp
        factor = math.exp(min(self._width(level), 700.0))
        return self.mean / factor, min(1.0, self.mean * factor)

    def _width(self, level: float) -> float:
        """Half of the interval, relative: Student's for the spread, a normal one for the rest."""
        from scipy.special import ndtri, stdtrit

        end = 0.5 + 0.5 * level
        student, normal = stdtrit(self.values.size - 1, end), ndtri(end)
        return math.hypot(float(student) * self._spread, float(normal) * self.least)


def combined(
    high: Repetitions,
    low: Repetitions,
    above: Repetitions,
    target: float,
    status: Status,
    messages: list[str],
) -> Estimate:
    """Return the answer that repetitions give.

    Parameters
    ----------
    high, low
        Estimates of pf, failed runs counted as failures (high), and as safe (low).
    above
        Estimates of an event that contains failure, for an upper bound where hardly any of the
        repetitions saw failures.
    target
        Largest relative standard error of a row that is not doubtful; see `most_cov`.
    status, messages
        What is known of the run; more is added here.
    """
    seen = int(np.count_nonzero(high.values))
    pf = min(1.0, high.mean)
    if pf == 0.0:
        bound = above.ends()[1]
        messages = ["no failure was seen: the interval is an upper bound", *messages]
        return Estimate(
            0.0,
            ci_low=0.0,
            ci_high=bound,
            ci_kind="upper bound 95 %",
            error_kind="sampling",
            status="doubtful",
            message="; ".join(messages),
        )
    if seen < FEWEST:
        status = "doubtful"
        messages = [f"{seen} of {high.values.size} repetitions saw failures", *messages]
    elif high.cov <= target < high.most_cov:
        status = "doubtful"
        why = (
            f"from {high.values.size} repetitions, the standard error may be above {target:.3g} pf"
        )
        messages = [why, *messages]
    ci_low, ci_high, ci_kind = low.ends()[0], high.ends()[1], "t 95 % of log pf"
    if seen < FEWEST_FOR_SPREAD:
        # one climb that has come far says nothing of how far others come
        ci_low, ci_high, ci_kind = 0.0, max(ci_high, above.ends()[1]), "upper bound 95 %"
    return Estimate(
        pf,
        std_error=pf * high.stated_cov,
        ci_low=ci_low,
        ci_high=max(pf, ci_high),
        ci_kind=ci_kind,
        pf_low=min(pf, low.mean),
        pf_high=pf,
        error_kind="sampling",
        status=status,
        message="; ".join(messages),
    )
