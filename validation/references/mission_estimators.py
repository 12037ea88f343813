"""Unbiased estimates of the failure probability of a system from weighted responses of its units.

For each draw of the shared inputs there are K = n B replicates (B missions of n units). A replicate
estimates the distribution of one unit by a few weighted responses; replicates are independent
given that draw. A power of an estimated probability is biased, but a product of estimates from
different replicates is not, nor is its mean over the ways to choose them:

- no synchronization: the mean of (1 - S_1) ... (1 - S_r) over all choices of r = n m replicates,
  with S the weighted share of responses that are too late;
- synchronization: n replicates make a mission, whose failure probability is the weighted share of
  all ways to take one response from each; m missions out of B follow as above, averaged over
  several arrangements of the replicates into missions;
- a binomial number of missions: the same, weighted with the probabilities of that number.

Complements are carried through, so that nothing cancels however small the answer is.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from numba import njit
from scipy.stats import binom
from tables import Grid

from uqfold.problems.criterion import Binomial, Missions
from uqfold.typing import FloatArray

ARRANGEMENTS = 8


def missions_of(grid: Grid) -> int:
    """Return the missions B that a shared draw needs: the most that a profile can have."""
    return max(criterion.max_missions for criterion in grid.criteria)


def estimate(
    grid: Grid, times: FloatArray, weights: FloatArray, rng: np.random.Generator
) -> FloatArray:
    """Return estimates of the shape of the grid, averaged over the shared draws.

    Parameters
    ----------
    grid
        What is estimated.
    times
        Responses (shared draws, K, L); +inf fails every criterion.
    weights
        Weights (L,) of the responses of a replicate, which sum to 1.
    rng
        For the arrangements of replicates into missions.

    Raises
    ------
    ValueError
        If `times` hold NaN.
    """
    if np.isnan(times).any():
        raise ValueError("times hold NaN: a failed run has no place in a reference")
    missions = missions_of(grid)
    thresholds = np.asarray(grid.thresholds, dtype=np.float64)
    taus = np.array([tau for tau in grid.taus if tau is not None], dtype=np.float64)
    # without synchronization every replicate counts by itself, like a mission of one unit
    too_late = mission_failures(times[:, :, None], weights, thresholds, np.array([np.inf]))
    alone = failure_of_any(np.moveaxis(too_late[:, :, 0], 1, 0)).mean(axis=1)
    in_step = np.zeros((missions + 1, len(taus), len(thresholds)))
    for _ in range(ARRANGEMENTS if taus.size else 0):
        order = rng.permutation(missions * grid.units).reshape(missions, grid.units)
        failed = mission_failures(np.take(times, order, axis=1), weights, thresholds, taus)
        in_step += failure_of_any(np.moveaxis(failed, 1, 0)).mean(axis=1) / ARRANGEMENTS
    estimates = np.zeros(grid.shape)
    for j, profile in enumerate(grid.profiles):
        for number, share in _mission_numbers(profile).items():
            synchronized = iter(in_step[number])
            for i, tau in enumerate(grid.taus):
                one = alone[number * grid.units] if tau is None else next(synchronized)
                estimates[i, j] += share * one
    return estimates


def _mission_numbers(profile: Missions) -> dict[int, float]:
    """Return the numbers of missions that a profile may have, with their probabilities."""
    if isinstance(profile, Binomial):
        numbers = range(profile.planned + 1)
        return {k: float(binom.pmf(k, profile.planned, profile.p)) for k in numbers}
    return {profile: 1.0}


def failure_of_any(failures: FloatArray) -> FloatArray:
    """Return the probability that at least one of r trials fails, for r = 0 ... K, without bias.

    The mean over all choices of r different replicates of 1 - (1 - f_1) ... (1 - f_r), by
    recurrence over the replicates: the next one is among r chosen ones of the first k with
    probability r / k.

    Parameters
    ----------
    failures
        Independent unbiased estimates (K, ...) of the failure probability of one trial.

    Returns
    -------
    FloatArray
        Estimates (K + 1, ...).
    """
    found = np.zeros((len(failures) + 1, *failures.shape[1:]))
    for k, f in enumerate(failures, start=1):
        # downwards: found[r - 1] still belongs to the first k - 1 replicates
        for r in range(k, 0, -1):
            share = r / k
            found[r] = (1.0 - share) * found[r] + share * (found[r - 1] * (1.0 - f) + f)
    return found


@njit(error_model="numpy", cache=True)
def mission_failures(times: Any, weights: Any, thresholds: Any, taus: Any) -> Any:
    """Return the failure probability of single missions under synchronization.

    Parameters
    ----------
    times
        Responses (draws, B, n, L): of each unit one replicate.
    weights
        Weights (L,).
    thresholds, taus
        T, finite, and tau.

    Returns
    -------
    FloatArray
        Weighted share (draws, B, taus, thresholds) of the ways to take one response of each unit
        of which the last is later than T, or the first more than tau earlier than the last.
    """
    n_draws, n_missions, n_units, n_strata = times.shape
    found = np.zeros((n_draws, n_missions, len(taus), len(thresholds)))
    size = n_units * n_strata
    late, apart = np.empty(size + 1), np.empty(size + 1)
    before, far = np.empty(n_units), np.empty(n_units)
    for draw in range(n_draws):
        for mission in range(n_missions):
            flat = times[draw, mission].reshape(size)
            order = np.argsort(flat)
            for i in range(len(taus)):
                before[:], far[:] = 0.0, 0.0
                first = 0
                for j in range(size):
                    # ways whose last response is this one: the others come from before it
                    unit, stratum = divmod(order[j], n_strata)
                    t = flat[order[j]]
                    while first < j and t - flat[order[first]] > taus[i]:
                        far[order[first] // n_strata] += weights[order[first] % n_strata]
                        first += 1
                    # all of them, and those with one too early; nothing cancels in the latter
                    whole, broken, kept = 1.0, 0.0, 1.0
                    for other in range(n_units):
                        if other != unit:
                            whole *= before[other]
                            broken = broken * before[other] + kept * far[other]
                            kept *= before[other] - far[other]
                    late[j] = weights[stratum] * whole
                    apart[j] = weights[stratum] * broken
                    before[unit] += weights[stratum]
                for k in range(len(thresholds)):
                    total = 0.0
                    for j in range(size):
                        total += apart[j] if flat[order[j]] <= thresholds[k] else late[j]
                    found[draw, mission, i, k] = min(total, 1.0)
    return found
