"""A cheap partner as control variate of conditional Monte Carlo.

With Y_b the estimate of pf from block b of the model, and L_b that of the partner from the very
same draws, whose mean is known to be l from many other draws,

    pf = mean of Y_b - c_b (L_b - l),    c_b = cov(Y, L) / var(L) / (1 + blocks / partner's blocks).

c_b takes the covariance of all blocks but b: it is independent of L_b, so that each term has the
mean pf, whatever the partner is. Where those blocks say that the partner would divide the variance
by less than `WORTH`, c_b is 0.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable
from dataclasses import dataclass, replace

import numpy as np

from uqfold.evaluation import TimeLimitError
from uqfold.methods.conditional_sums import ENOUGH_DRAWS, FEW, LEVEL, ConditionalSums
from uqfold.methods.partner_sample import Partner, PartnerError
from uqfold.methods.result import Estimate
from uqfold.methods.task import Task
from uqfold.typing import FloatArray, IntArray

WORTH = 1.5
"""A partner that divides the variance by less than this is of no use."""
FEWEST_BLOCKS = 10
"""With fewer blocks of the model the partner is not asked."""

Drawn = Callable[[int, int], Iterable[tuple[FloatArray, IntArray]]]
"""Takes the first block and how many; draws their inputs and arrangements, some blocks at once."""


@dataclass(frozen=True, eq=False)
class PartnerControl:
    """What the partner says of the blocks of the model, and of many others.

    Attributes
    ----------
    model
        Estimates (2, n_criteria, B) from the blocks of the model: failed runs as failures, as safe.
    partner
        Those of the partner (n_criteria, B) from the same draws.
    others
        Those of the partner (n_criteria, M) from other draws, where it is of use.
    ratio
        Blocks of the others that are wanted for each of the model.
    evals, failed
        Runs of the partner, and how many of them failed.
    note
        Why the partner was not asked to the end; empty where it was.
    """

    model: FloatArray
    partner: FloatArray
    others: FloatArray
    ratio: int
    evals: int
    failed: int
    note: str = ""

    @classmethod
    def of(
        cls, task: Task, missions: int, model: FloatArray, drawn: Drawn, ratio: int
    ) -> PartnerControl:
        """Run the partner on the blocks of the model, and if that is of use on many others.

        Parameters
        ----------
        task
            The question.
        missions
            Missions simulated for each shared draw.
        model
            See the attributes.
        drawn
            Draws blocks; the first of them are those of the model.
        ratio
            See the attributes.
        """
        blocks = model.shape[-1]
        nothing = np.empty((len(task.criteria), 0))
        if blocks < FEWEST_BLOCKS:
            note = f"{blocks} blocks are too few to ask the partner"
            return cls(model, nothing, nothing, ratio, 0, 0, note)
        partner, note = Partner(task), ""
        own = others = nothing

        def asked(first: int, count: int) -> FloatArray:
            sums = ConditionalSums(task, missions)
            parts = [sums.add(partner.responses(x), ways)[0] for x, ways in drawn(first, count)]
            return np.concatenate(parts, axis=-1)

        try:
            own = asked(0, blocks)
            if _coefficients(model[0], own, ratio).any():
                others = asked(blocks, ratio * blocks)
        except (PartnerError, TimeLimitError) as error:
            others, note = nothing, str(error)
        session = partner.session
        return cls(model, own, others, ratio, session.n_evals, session.n_failed, note)

    def gain(self) -> FloatArray:
        """How many times the variance was divided (n_criteria,); NaN without the partner."""
        gains = np.full(len(self.model[0]), math.nan)
        if self.others.size:
            plain = self.model[0].var(axis=1, ddof=1) / self.model.shape[-1]
            used = self._coefficients.any(axis=1)
            gains[used] = plain[used] / self._errors[used] ** 2
        return gains

    def corrected(self, estimate: Estimate, i: int) -> Estimate:
        """Return the answer of the model alone to one criterion, corrected by the partner."""
        from scipy.special import stdtrit

        if self.note or not self.others.size or not self._coefficients[i].any():
            note = self.note or "the partner is of no use: as if it had not been asked"
            return _noted(estimate, note)
        blocks = self.model.shape[-1]
        pf, pf_low = (float(np.clip(one, 0.0, 1.0)) for one in self._terms[:, i].mean(axis=1))
        std_error = float(self._errors[i])
        reach = float(stdtrit(blocks - 1, 0.5 + 0.5 * LEVEL)) * std_error
        low, high, kind = max(0.0, pf_low - reach), min(1.0, pf + reach), "student 95 %"
        doubts = self._doubts(i)
        if estimate.status == "doubtful":
            # what is doubted about the model alone no partner makes good
            low, high = min(low, estimate.ci_low), max(high, estimate.ci_high)
            kind = estimate.ci_kind
        answer = replace(
            estimate,
            pf=pf,
            reliability=1.0 - pf,
            std_error=std_error,
            ci_low=min(low, pf_low),
            ci_high=max(high, pf),
            ci_kind=kind,
            pf_low=min(pf_low, pf),
            pf_high=pf,
            status="doubtful" if doubts else estimate.status,
        )
        return _noted(answer, *doubts)

    def _doubts(self, i: int) -> list[str]:
        """Why the error of a corrected answer is not to be believed."""
        blocks = self.model.shape[-1]
        apart = int(np.count_nonzero(self.model[0, i] != self.partner[i]))
        doubts = []
        if self._terms[0, i].mean() <= 0.0 or self._terms[0, i].mean() >= 1.0:
            doubts.append("the partner corrects pf to nothing, or to more than one")
        if apart < FEW:
            doubts.append(f"model and partner differ in {apart} of {blocks} blocks only")
        elif _uneven(self._terms[0, i]):
            doubts.append("where model and partner differ rests on few of the blocks")
        if _uneven(self.others[i]):
            doubts.append("the mean of the partner rests on few of its blocks")
        return doubts

    @property
    def _coefficients(self) -> FloatArray:
        return _coefficients(self.model[0], self.partner, self.ratio)

    @property
    def _terms(self) -> FloatArray:
        """Corrected blocks (2, n_criteria, B)."""
        apart = self.partner - self.others.mean(axis=1, keepdims=True)
        return np.asarray(self.model - self._coefficients * apart)

    @property
    def _errors(self) -> FloatArray:
        """Standard errors (n_criteria,): of the corrected blocks, and of the partner's mean."""
        blocks, others = self.model.shape[-1], self.others.shape[-1]
        own = self._terms[0].var(axis=1, ddof=1) / blocks
        slope = self._coefficients.mean(axis=1)
        return np.asarray(np.sqrt(own + slope**2 * self.others.var(axis=1, ddof=1) / others))


def _coefficients(model: FloatArray, partner: FloatArray, ratio: int) -> FloatArray:
    """How much of the partner's deviation is taken off each block (n_criteria, B)."""
    blocks = model.shape[1]
    y, low = (one - one.mean(axis=1, keepdims=True) for one in (model, partner))

    def without_own(product: FloatArray) -> FloatArray:
        """Sums over all blocks but one, about the mean of these."""
        return np.asarray(product.sum(axis=1, keepdims=True) - blocks / (blocks - 1) * product)

    of_both, of_model, of_partner = (without_own(one) for one in (y * low, y * y, low * low))
    known = 1.0 / (1.0 + 1.0 / ratio)
    with np.errstate(divide="ignore", invalid="ignore"):
        slope = np.asarray(known * of_both / of_partner)
        explained = slope * of_both / of_model
    return np.where(explained >= 1.0 - 1.0 / WORTH, slope, 0.0)


def _uneven(blocks: FloatArray) -> bool:
    """Whether a mean is that of blocks (B,) too skewed for it, by the rule of Cochran."""
    apart = blocks - blocks.mean()
    variance, third = float(np.mean(apart**2)), float(np.mean(apart**3))
    return bool(blocks.size * variance**3 < ENOUGH_DRAWS * third**2)


def _noted(estimate: Estimate, *notes: str) -> Estimate:
    return replace(estimate, message="; ".join(filter(None, (estimate.message, *notes))))
