"""Sums over weighted samples that both a model and its cheap partner judge.

With w the weight of a sample, m and s whether it fails by the model and by the partner, and P the
failure probability of the partner, from many more samples of the same density,

    pf = mean of w m - c (w s - P),    c = cov(w m, w s) / var(w s).
"""

from __future__ import annotations

import math

import numpy as np

from uqfold.methods.importance_search import WeightedSamples
from uqfold.methods.partner_sums import weighted_count
from uqfold.methods.result import Estimate, Status
from uqfold.methods.weighted_sums import BY_WEIGHTS, HEAVY, OVERLOOKED
from uqfold.typing import BoolArray, FloatArray

FEW_SAMPLES = 500
"""With fewer samples nothing is given up."""
PATIENCE = 3.0
"""A target is given up that seems to take more than so many times the samples there can be."""


class GuidedSums:
    """Running sums over samples of one density.

    Attributes
    ----------
    largest
        Largest weight of a sample that fails by model or partner.
    missed, invented
        Samples that fail by the model alone, and by the partner alone.
    """

    def __init__(self) -> None:
        self.largest = 0.0
        self.missed = self.invented = 0
        self._model, self._sure, self._partner = np.empty((3, 0))
        self._many = np.empty(0)
        self._heaviest_drawn = self._heaviest_judged = 0.0

    def add_partner(self, samples: WeightedSamples) -> None:
        """Add samples that only the partner judges."""
        weights = samples.weights * samples.high
        self.largest = max(self.largest, float(weights.max()))
        self._many = np.append(self._many, weights)

    def add(self, samples: WeightedSamples, by_partner: BoolArray) -> None:
        """Add samples that the model has judged, and what the partner says of them."""
        weights = samples.weights
        either = samples.high | by_partner
        heaviest = float(weights[either].max(initial=0.0))
        self.largest = max(self.largest, heaviest)
        self._heaviest_judged = max(self._heaviest_judged, heaviest)
        self._heaviest_drawn = max(self._heaviest_drawn, float(weights.max()))
        self.missed += int(np.count_nonzero(samples.high & ~by_partner))
        self.invented += int(np.count_nonzero(by_partner & ~samples.high))
        self._model = np.append(self._model, weights * samples.high)
        self._sure = np.append(self._sure, weights * samples.low)
        self._partner = np.append(self._partner, weights * by_partner)

    @property
    def n(self) -> int:
        """Samples that the model has judged."""
        return self._model.size

    @property
    def hits(self) -> int:
        """How many of them failed, failed runs counted as failures."""
        return int(np.count_nonzero(self._model))

    @property
    def partner_pf(self) -> float:
        """Failure probability of the partner."""
        return float(self._many.mean())

    @property
    def partner_error(self) -> float:
        """Standard error of that."""
        return float(self._many.std(ddof=1)) / math.sqrt(self._many.size)

    def partner_precise(self, target: float) -> bool:
        """Whether the partner's part in the error is small against a target."""
        return self._many.size > 1 and self.partner_error <= 0.2 * target * self.partner_pf

    @property
    def _slope(self) -> float:
        """c: how much of the partner's deviation is taken off."""
        spread = float(self._partner.var())
        if spread == 0.0:
            return 0.0
        return float(np.cov(self._model, self._partner, bias=True)[0, 1]) / spread

    def _terms(self, model: FloatArray) -> FloatArray:
        return model - self._slope * (self._partner - self.partner_pf)

    @property
    def pf(self) -> float:
        """Failure probability, failed runs counted as failures."""
        return float(np.clip(self._terms(self._model).mean(), 0.0, 1.0))

    @property
    def std_error(self) -> float:
        """Standard error of pf; as if one more sample, the heaviest, were judged otherwise."""
        own = float(self._terms(self._model).var(ddof=1)) / self.n
        of_partner = (self._slope * self.partner_error) ** 2
        return math.sqrt(own + of_partner + (self._heaviest_judged / self.n) ** 2)

    @property
    def heaviest(self) -> float:
        """Largest part of pf that comes from one sample, beyond what the partner says."""
        apart = np.abs(self._terms(self._model) - self.pf)
        return float(apart.max()) / (self.n * self.pf) if self.pf > 0.0 else math.inf

    def precise(self, target: float) -> bool:
        """Whether the relative standard error is at most a target, and rests on many samples."""
        return self.hits > 0 and self.std_error <= target * self.pf and self.heaviest <= HEAVY

    def hopeless(self, target: float, left: int) -> bool:
        """Whether a target is out of reach with so many samples more."""
        if self.n < FEW_SAMPLES:
            return False
        wide = self.std_error / (target * self.pf) if self.pf > 0.0 else math.inf
        return wide**2 * self.n > PATIENCE * (self.n + left)

    def estimate(self, overlooked: float, doubts: list[str], short: list[str]) -> Estimate:
        """Return the answer.

        Parameters
        ----------
        overlooked
            Share of the failures known before where samples are too rare.
        doubts
            What is doubtful for other reasons.
        short
            Why there are fewer samples than wanted; may be empty.
        """
        n = self.n
        if self.hits == 0:
            high = min(1.0, weighted_count(0.0, 0.0, self._heaviest_drawn)[1] / n)
            return Estimate(
                0.0,
                ci_low=0.0,
                ci_high=high,
                ci_kind="upper bound 95 %",
                error_kind="sampling",
                status="doubtful",
                message="; ".join([f"no failure among {n} samples", *short]),
            )
        status: Status = "budget_exhausted" if short else "converged"
        doubts = list(doubts)
        if self.hits == n:
            doubts.append(f"only failures among {n} samples")
        if self.heaviest > HEAVY:
            doubts.append(f"one sample makes {100.0 * self.heaviest:.0f} % of pf")
        if overlooked > OVERLOOKED:
            doubts.append(
                f"{100.0 * overlooked:.0f} % of known failures lie where samples are rare"
            )
        pf, squares = self.pf, (n * self.std_error) ** 2
        low, high = weighted_count(n * pf, squares, self._heaviest_judged)
        pf_low = float(np.clip(self._terms(self._sure).mean(), 0.0, pf))
        return Estimate(
            pf,
            std_error=self.std_error,
            ci_low=min(low / n, pf_low),
            ci_high=min(1.0, high / n),
            ci_kind=BY_WEIGHTS,
            pf_low=pf_low,
            pf_high=pf,
            error_kind="sampling",
            status="doubtful" if doubts else status,
            message="; ".join([*doubts, *short]),
        )
