"""What a sample chosen by a partner sums up: the estimate of pf, its error and its interval.

    pf = (systems that fail by the partner + failures it misses - failures it invents) / systems

where the last two are sums over the sample, each system weighted by the reciprocal of the
probability with which it was chosen; see docs/multifidelity.md.
"""

from __future__ import annotations

import math

import numpy as np

from uqfold.evaluation import RunningEstimate
from uqfold.methods.clopper_pearson import clopper_pearson
from uqfold.methods.partner_sample import ChosenSystems
from uqfold.methods.result import NORMAL_95, TARGET_COV, Estimate, Status
from uqfold.methods.task import Task
from uqfold.typing import FloatArray

FEW = 10
"""Fewer failures (or systems that work) than this leave pf uncertain by a third or more."""
LEVEL = 0.95


def weighted_count(total: float, squares: float, largest: float) -> tuple[float, float]:
    """Interval at 95 % on the mean of a sum of Poisson counts with weights.

    It is exact where all weights are equal, and keeps its level in all that is known of others.

    Parameters
    ----------
    total, squares
        Sum of the weights that occurred, and of their squares.
    largest
        Largest weight that could have occurred; 0: nothing is left to chance.

    References
    ----------
    Fay M.P., Feuer E.J. Confidence intervals for directly standardized rates: a method based on
    the gamma distribution. Statistics in Medicine 16 (1997) 791-801.
    """
    from scipy.special import gammaincinv

    if largest <= 0.0:
        return total, total
    outside = 0.5 * (1.0 - LEVEL)
    low = 0.0
    if squares > 0.0:
        low = float(gammaincinv(total**2 / squares, outside)) * squares / total
    above, spread = total + largest, squares + largest**2
    high = float(gammaincinv(above**2 / spread, 1.0 - outside)) * spread / above
    return min(low, total), max(high, total)


class PartnerSums:
    """Running sums (2, 2, n_criteria): failed runs as failures and as safe; missed and invented.

    Parameters
    ----------
    task
        The question.
    """

    def __init__(self, task: Task) -> None:
        self.criteria = task.criteria
        count = len(self.criteria)
        self.population = self.systems = 0
        self.by_partner = np.zeros(count)
        self.total, self.unseen, self.squares = np.zeros((3, 2, 2, count))
        self.largest = np.zeros((2, count))
        self.wrong = np.zeros((2, count), dtype=np.int64)

    def add(self, chosen: ChosenSystems, responses: FloatArray) -> None:
        """Take in systems with the model's responses (n_rows,) to the rows of their block."""
        weight = 1.0 / chosen.chance
        # of a system that was certain to be chosen nothing is left to chance
        unsure = weight - 1.0
        for variant, missing_fails in enumerate((True, False)):
            fails = chosen.block.failed(responses, missing_fails=missing_fails)
            wrong = np.array([fails & ~chosen.fails, chosen.fails & ~fails])
            self.total[variant] += wrong @ weight
            self.unseen[variant] += wrong @ unsure
            self.squares[variant] += wrong @ (unsure * weight)
            if missing_fails:
                self.wrong += wrong.sum(axis=2)
        self.largest = np.maximum(self.largest, 1.0 / chosen.least - 1.0)
        self.population += chosen.population
        self.systems += chosen.chance.size
        self.by_partner += chosen.failing

    def pf(self, variant: int = 0) -> FloatArray:
        """Failure probabilities (n_criteria,); variant 1 takes failed runs for safe ones."""
        missed, invented = self.total[variant]
        share = (self.by_partner + missed - invented) / self.population
        return np.asarray(np.clip(share, 0.0, 1.0))

    def std_error(self) -> FloatArray:
        """Standard errors (n_criteria,)."""
        pf = self.pf()
        by_runs = self.squares[0].sum(axis=0) / self.population**2
        return np.asarray(np.sqrt(pf * (1.0 - pf) / self.population + by_runs))

    def interval(self, i: int, variant: int = 0) -> tuple[float, float]:
        """Interval at 95 % of one criterion.

        The errors of the three parts are independent, and the ends of their own intervals are
        joined as their variances are (MOVER).

        References
        ----------
        Zou G.Y., Donner A. Construction of confidence limits about effect measures: a general
        approach. Statistics in Medicine 27 (2008) 1693-1702.
        """
        n, pf = self.population, float(self.pf(variant)[i])
        below, above = clopper_pearson(min(n, round(n * pf)), n, LEVEL)
        down, up = max(0.0, pf - below) ** 2, max(0.0, above - pf) ** 2
        for sign in (0, 1):
            total = float(self.unseen[variant, sign, i]) / n
            squares = float(self.squares[variant, sign, i]) / n**2
            low, high = weighted_count(total, squares, float(self.largest[sign, i]) / n)
            shorter, longer = (total - low) ** 2, (high - total) ** 2
            down += (shorter, longer)[sign]
            up += (longer, shorter)[sign]
        return max(0.0, pf - math.sqrt(down)), min(1.0, pf + math.sqrt(up))

    def hidden(self, i: int) -> float:
        """By how much of pf the interval is wide, as a standard error is."""
        low, high = self.interval(i)
        pf = float(self.pf()[i])
        return (high - low) / (2.0 * NORMAL_95 * pf) if pf > 0.0 else math.inf

    def alike(self, i: int) -> float:
        """How many wrong verdicts of equal weight scatter like those seen; inf if they matter not.

        Kish's effective size. They matter where most of the variance comes from them.
        """
        unseen, squares = (float(one[0, :, i].sum()) for one in (self.unseen, self.squares))
        by_runs = squares / self.population**2
        if 2.0 * by_runs <= float(self.std_error()[i]) ** 2:
            return math.inf
        return unseen**2 / squares

    def estimate(self, i: int, target: float, short: list[str], note: str) -> Estimate:
        """Answer one criterion.

        Parameters
        ----------
        i
            Which.
        target
            Largest error, relative to pf, that is not doubtful.
        short
            Why there are fewer systems than wanted; may be empty.
        note
            What is to be said in any case; may be empty.
        """
        n, pf, pf_low = self.population, float(self.pf()[i]), float(self.pf(1)[i])
        bound = pf in (0.0, 1.0)
        status: Status = "budget_exhausted" if short else "converged"
        messages = list(short)
        failures = round(n * min(pf, 1.0 - pf))
        if bound:
            messages.append(f"{'no' if pf == 0.0 else 'only'} failures among {n} systems")
        elif failures < FEW:
            kind = "failures" if pf < 0.5 else "systems that work"
            messages.append(f"about {failures} {kind} among {n} systems")
        if bound or failures < FEW:
            status = "doubtful"
        elif self.alike(i) < FEW:
            status = "doubtful"
            messages.append(
                f"the error rests on about {self.alike(i):.2g} systems with a wrong verdict of "
                "the partner"
            )
        elif self.largest[:, i].any() and self.hidden(i) > max(TARGET_COV, target):
            status = "doubtful"
            messages.append(
                f"{self.systems} systems do not tell whether the partner is wrong elsewhere: the "
                "interval goes on to what it may hide there"
            )
        if note:
            messages.append(note)
        ci_low, ci_high = self.interval(i, 1)[0], self.interval(i)[1]
        return Estimate(
            pf=pf,
            reliability=1.0 - pf,
            std_error=math.nan if bound else float(self.std_error()[i]),
            ci_low=min(ci_low, pf_low),
            ci_high=max(ci_high, pf),
            ci_kind="clopper-pearson 95 %" + (" and gamma" if self.largest[:, i].any() else ""),
            pf_low=min(pf_low, pf),
            pf_high=pf,
            error_kind="sampling",
            status=status,
            message="; ".join(messages),
        )

    def running(self) -> RunningEstimate:
        """Return the state of the criterion that is least certain so far."""
        pf = self.pf()
        relative = np.divide(self.std_error(), pf, out=np.full_like(pf, np.inf), where=pf > 0.0)
        i = int(np.argmax(relative))
        return RunningEstimate(str(self.criteria[i]), float(pf[i]), *self.interval(i))

    def precise(self, target: float) -> bool:
        """Whether every criterion has its error at most at the target, and hides no more."""
        pf, error = self.pf(), self.std_error()
        if not np.all((pf > 0.0) & (pf < 1.0) & (error <= target * pf)):
            return False
        return all(self.hidden(i) <= max(TARGET_COV, target) for i in range(pf.size))
