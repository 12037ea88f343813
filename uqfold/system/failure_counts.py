"""Failure over several missions from a number of failures among exchangeable trials.

Given the shared inputs, responses (and missions) are independent and alike. Powers of an estimated
probability are biased; the share of all ways to choose trials without a failed one is not: with F
failures among K trials, C(K - F, r) / C(K, r) estimates without bias the probability that r trials
all work.
"""

from __future__ import annotations

from fractions import Fraction
from math import comb

import numpy as np

from uqfold.problems.criterion import Binomial, Missions
from uqfold.time_limit import check_time
from uqfold.typing import FloatArray

EXACT_TERMS = 20_000
"""Up to so many terms are whole numbers; more of them take logarithms, good to about 1e-12."""
_NEGLIGIBLE = 1e-30
"""Probability of a number of missions that adds nothing to a double."""


def failure_by_count(trials: int, per_mission: int, missions: Missions) -> FloatArray:
    """Unbiased estimate that some mission fails, for every possible number of failed trials.

    Parameters
    ----------
    trials
        Trials K: responses of one unit, or whole missions.
    per_mission
        Trials that one mission takes: the number of units, or 1.
    missions
        A fixed number, or a binomial one, whose estimates are weighted with its probabilities.

    Returns
    -------
    FloatArray
        Estimates (K + 1,) for F = 0 ... K failures; each from whole numbers, rounded once, unless
        that takes more than `EXACT_TERMS` of them.

    Raises
    ------
    ValueError
        If the trials do not suffice for the largest number of missions.

    Examples
    --------
    >>> failure_by_count(4, 2, 1).tolist()
    [0.0, 0.5, 0.8333333333333334, 1.0, 1.0]
    """
    most = missions.planned if isinstance(missions, Binomial) else missions
    if most * per_mission > trials:
        raise ValueError(f"{trials} trials are too few for {most} missions")
    terms = (trials + 1) * (most + 1 if isinstance(missions, Binomial) else 1)
    if terms > EXACT_TERMS or most > 64:
        return _by_logarithms(trials, per_mission, missions)
    if isinstance(missions, Binomial):
        p = Fraction(missions.p)
        shares = {k: comb(most, k) * p**k * (1 - p) ** (most - k) for k in range(most + 1)}
    else:
        shares = {missions: Fraction(1)}

    def works(failed: int, chosen: int) -> Fraction:
        return Fraction(comb(trials - failed, chosen), comb(trials, chosen))

    return np.array(
        [
            float(sum(share * (1 - works(failed, k * per_mission)) for k, share in shares.items()))
            for failed in range(trials + 1)
        ]
    )


def _by_logarithms(trials: int, per_mission: int, missions: Missions) -> FloatArray:
    """Do what `failure_by_count` does, from the ratios of neighbouring chances."""
    from scipy.stats import binom

    shares = np.array([[missions, 1.0]]) if isinstance(missions, int) else np.empty((0, 2))
    if isinstance(missions, Binomial):
        k = np.arange(missions.planned + 1)
        chance = binom.pmf(k, missions.planned, missions.p)
        shares = np.column_stack([k, chance])[chance > _NEGLIGIBLE]
    failing = np.zeros(trials + 1)
    left = trials - np.arange(trials)
    for count, share in shares.tolist():
        check_time()
        # C(K - F - 1, r) / C(K - F, r) = (K - F - r) / (K - F)
        with np.errstate(divide="ignore"):
            steps = np.log1p(-np.minimum(count * per_mission / left, 1.0))
        failing[1:] -= share * np.expm1(np.cumsum(steps))
    return np.clip(failing, 0.0, 1.0)
