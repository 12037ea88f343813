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
from uqfold.typing import FloatArray


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
        Estimates (K + 1,) for F = 0 ... K failures; each from whole numbers, rounded once.

    Raises
    ------
    ValueError
        If the trials do not suffice for the largest number of missions.

    Examples
    --------
    >>> failure_by_count(4, 2, 1).tolist()
    [0.0, 0.5, 0.8333333333333334, 1.0, 1.0]
    """
    if isinstance(missions, Binomial):
        planned, p = missions.planned, Fraction(missions.p)
        shares = {k: comb(planned, k) * p**k * (1 - p) ** (planned - k) for k in range(planned + 1)}
    else:
        shares = {missions: Fraction(1)}
    if max(shares) * per_mission > trials:
        raise ValueError(f"{trials} trials are too few for {max(shares)} missions")

    def works(failed: int, chosen: int) -> Fraction:
        return Fraction(comb(trials - failed, chosen), comb(trials, chosen))

    return np.array(
        [
            float(sum(share * (1 - works(failed, k * per_mission)) for k, share in shares.items()))
            for failed in range(trials + 1)
        ]
    )
