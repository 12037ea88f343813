"""Failures that several randomisations of the same points count, and how sure their mean is."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from uqfold.methods.counted import FEW, counted
from uqfold.methods.repetitions import FEWEST, Repetitions
from uqfold.methods.result import Estimate, Status
from uqfold.typing import FloatArray

NOT_NORMAL = 1e-3
"""Normal numbers look less normal than this by the test of Shapiro and Wilk once in a thousand."""
FEW_STEPS = 4
"""Counts with fewer different values tell that test nothing."""


@dataclass(frozen=True, eq=False)
class ScrambledCounts:
    """Failures of each randomisation under one criterion.

    Attributes
    ----------
    points
        Systems of each.
    high, low
        Failures (R,), open systems (failed runs) counted as failed, and as safe.
    """

    points: int
    high: FloatArray
    low: FloatArray

    def rarer(self, counts: FloatArray) -> Repetitions:
        """Return the estimates of pf, or of the reliability if that is smaller."""
        if self._mostly_fails:
            counts = self.points - counts
        # counts of two values only, one apart, scatter by half at most
        own = float(counts.sum())
        least = 0.5 * math.sqrt(counts.size) / own if own else math.inf
        return Repetitions(counts / self.points, least)

    @property
    def _mostly_fails(self) -> bool:
        return float(self.high.sum()) > 0.5 * self.points * self.high.size

    @property
    def fewest(self) -> float:
        """Count the failures, or the systems that work, whichever are fewer."""
        failures = float(self.high.sum())
        return min(failures, self.points * self.high.size - failures)

    def precise(self, target: float) -> bool:
        """Whether the relative standard error is at most the target, for sure."""
        return self.fewest >= FEW and self.rarer(self.high).most_cov <= target

    def _doubts(self, target: float) -> list[str]:
        """Return why the spread of the randomisations is not to be believed."""
        from scipy.stats import shapiro

        rarer = self.rarer(self.high)
        seen, doubts = int(np.count_nonzero(rarer.values)), []
        what = "systems that work" if self._mostly_fails else "failures"
        if seen < FEWEST:
            doubts.append(f"{seen} of {rarer.values.size} randomisations saw {what}")
        elif rarer.cov <= target < rarer.most_cov:
            doubts.append(
                f"from {rarer.values.size} randomisations, the standard error may be above "
                f"{target:.3g} pf"
            )
        if np.unique(rarer.values).size >= FEW_STEPS:
            chance = float(shapiro(rarer.values).pvalue)
            if chance < NOT_NORMAL:
                doubts.append(
                    f"the randomisations do not scatter like normal numbers (p = {chance:.1g})"
                )
        return doubts

    def estimate(self, target: float, short: list[str]) -> Estimate:
        """Return the answer; `short` says why there are fewer points than wanted."""
        n = self.points * self.high.size
        status: Status = "budget_exhausted" if short else "converged"
        if self.fewest < FEW:
            high, low = (round(float(counts.sum())) for counts in (self.high, self.low))
            return counted(n, high, low, status, short)
        doubts = self._doubts(target)
        pf, pf_low = (float(counts.sum()) / n for counts in (self.high, self.low))
        own, other = self.rarer(self.high), self.rarer(self.low)
        if self._mostly_fails:
            ci_low, ci_high = 1.0 - other.ends()[1], 1.0 - own.ends()[0]
        else:
            ci_low, ci_high = other.ends()[0], own.ends()[1]
        return Estimate(
            pf,
            reliability=float((self.points - self.high).sum()) / n,
            std_error=own.mean * own.stated_cov,
            ci_low=min(pf_low, ci_low),
            ci_high=max(pf, ci_high),
            ci_kind="t 95 % of log pf" if not self._mostly_fails else "t 95 % of log reliability",
            pf_low=pf_low,
            pf_high=pf,
            error_kind="sampling",
            status="doubtful" if doubts else status,
            message="; ".join([*doubts, *short]),
        )
