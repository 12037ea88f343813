"""Learning functions: where the next evaluations teach most about the failure probabilities.

``u`` and ``eff`` look at one point at a time and know levels only; ``variance`` asks how much a
run would reduce the posterior variance of the failure probabilities themselves, all criteria and
all of the surface at once, to first order in the surface (stepwise uncertainty reduction).

References
----------
Echard B., Gayton N., Lemaire M. AK-MCS. Structural Safety 33 (2011) 145-154 (U).
Bichon B. J. et al. Efficient global reliability analysis. AIAA Journal 46 (2008) 2459-2468 (EFF).
Bect J. et al. Sequential design of computer experiments for the estimation of a probability of
failure. Statistics and Computing 22 (2012) 773-793 (stepwise uncertainty reduction).
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal, TypeAlias

import numpy as np

from uqfold.typing import FloatArray

LearningFunction: TypeAlias = Literal["variance", "u", "eff"]
_ROOT_TWO_PI = math.sqrt(2.0 * math.pi)


@dataclass(frozen=True, eq=False)
class Candidates:
    """Points that may be run next, and what the process says about them.

    Attributes
    ----------
    mean
        Posterior means (M,).
    covariance
        Posterior covariances (M, M).
    with_answers
        Posterior covariances (M, C) with the C answers, each answer in units in which the
        uncertainties of all of them compare.
    levels
        Responses (M, L) that decide between failure and success, at each point.
    noise_variance
        Variances (M,) of a run's noise.
    """

    mean: FloatArray
    covariance: FloatArray
    with_answers: FloatArray
    levels: FloatArray
    noise_variance: FloatArray

    def scores(self, learning: LearningFunction) -> FloatArray:
        """Score (M,) of each candidate, the highest being the best."""
        variance = np.maximum(np.diag(self.covariance), 0.0)
        if learning == "variance":
            explained = (self.with_answers**2).sum(axis=1)
            return np.asarray(explained / self._spread)
        std = np.sqrt(np.maximum(variance, 1e-300))
        if learning == "u":
            return np.asarray(-u_function(self.mean, std, self.levels))
        return expected_feasibility(self.mean, std, self.levels)

    @property
    def _spread(self) -> FloatArray:
        """Variances (M,) of what runs will answer, no less than rounding leaves of them."""
        variance = np.diag(self.covariance)
        least = max(1e-12 * float(variance.max()), 1e-300)
        return np.maximum(variance, 0.0) + np.maximum(self.noise_variance, least)

    def after(self, index: int) -> Candidates:
        """What is left to learn once candidate `index` has been run, whatever it answers."""
        column = self.covariance[:, index]
        gain = column / self._spread[index]
        return Candidates(
            mean=self.mean,
            covariance=self.covariance - np.outer(gain, column),
            with_answers=self.with_answers - np.outer(gain, self.with_answers[index]),
            levels=self.levels,
            noise_variance=self.noise_variance,
        )

    @classmethod
    def of_all(cls, each: Sequence[Candidates]) -> Candidates:
        """Join the candidates of several processes, which know nothing of each other."""
        from scipy.linalg import block_diag

        most = max(one.levels.shape[1] for one in each)
        return cls(
            np.concatenate([one.mean for one in each]),
            block_diag(*(one.covariance for one in each)),
            np.concatenate([one.with_answers for one in each]),
            # the last level once more where others have more of them
            np.concatenate(
                [np.pad(one.levels, ((0, 0), (0, most - one.levels.shape[1])), "edge")
                 for one in each]
            ),
            np.concatenate([one.noise_variance for one in each]),
        )  # fmt: skip

    def batch(self, learning: LearningFunction, size: int) -> list[int]:
        """Choose runs that are to be made together: each as if those before it were done.

        A Gaussian process knows how uncertain it will be after a run before the run has answered,
        so the choice needs no guessed responses.
        """
        rest = self
        chosen: list[int] = []
        for _ in range(min(size, self.mean.size)):
            scores = rest.scores(learning)
            scores[chosen] = -np.inf
            chosen.append(int(np.argmax(scores)))
            rest = rest.after(chosen[-1])
        return chosen


def u_function(mean: FloatArray, std: FloatArray, levels: FloatArray) -> FloatArray:
    """Return U (M,): standard deviations between the mean and the nearest level; small is near.

    Levels are the same for all (L,), or of each (M, L), in `expected_feasibility` as well.
    """
    if levels.size == 0:
        return np.full(mean.shape, np.inf)
    distance = np.abs(mean[:, None] - levels).min(axis=1)
    return np.asarray(distance / std)


def expected_feasibility(mean: FloatArray, std: FloatArray, levels: FloatArray) -> FloatArray:
    """Expected feasibility function (M,) with the half width of two standard deviations.

    It is E[max(0, 2 std - |f - T|)], the largest over all levels T.
    """
    from scipy.special import ndtr

    if levels.size == 0:
        return np.zeros(mean.shape)
    z = (levels - mean[:, None]) / std[:, None]
    low, high = z - 2.0, z + 2.0

    def density(x: FloatArray) -> FloatArray:
        return np.asarray(np.exp(-0.5 * x * x) / _ROOT_TWO_PI)

    relative = (
        -z * (2.0 * ndtr(z) - ndtr(low) - ndtr(high))
        - (2.0 * density(z) - density(low) - density(high))
        + 2.0 * (ndtr(high) - ndtr(low))
    )
    return np.asarray((std[:, None] * relative).max(axis=1))
