"""Failure over several missions from the failure of one (Eqs. 28-30, 39-40).

Given the shared inputs, missions are independent. With q = 1 - p the probability that one mission
works, m missions work with q^m, and a number of missions that is binomial(N, r) with
sum_k C(N, k) r^k (1 - r)^(N - k) q^k = (1 - r p)^N.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from uqfold.problems.criterion import Binomial, Missions
from uqfold.typing import FloatArray


def over_missions(
    failure: ArrayLike, success: ArrayLike, missions: Missions
) -> tuple[FloatArray, FloatArray]:
    """Failure and success probability over all missions.

    Parameters
    ----------
    failure, success
        Probabilities p and 1 - p that one mission fails and works; both are used, each where it
        is the accurate one, so that neither result loses digits when it is tiny.
    missions
        A fixed number m >= 1, or a binomial one.

    Returns
    -------
    failure, success
        Over all missions, same shape.

    Raises
    ------
    ValueError
        If the number of missions is below 1.
    """
    p = np.asarray(failure, dtype=float)
    q = np.asarray(success, dtype=float)
    if isinstance(missions, Binomial):
        count, flown = missions.planned, missions.p
    else:
        count, flown = int(missions), 1.0
    if count < 1:
        raise ValueError(f"missions = {missions}: give at least 1")
    with np.errstate(divide="ignore"):
        log_works = np.where(
            p < 0.5, np.log1p(-flown * np.minimum(p, 0.5)), np.log((1.0 - flown) + flown * q)
        )
    return np.asarray(-np.expm1(count * log_works)), np.asarray(np.exp(count * log_works))
