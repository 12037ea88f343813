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

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numba import njit
from scipy.stats import binom

from uqfold.problems.criterion import Binomial, Missions
from uqfold.typing import FloatArray

ARRANGEMENTS = 8


@dataclass(frozen=True)
class MissionGrid:
    """What is estimated, all combinations: arrays (taus, profiles, thresholds).

    Attributes
    ----------
    thresholds, taus, profiles
        T (finite), tau (None: not required) and mission profiles.
    missions, units
        Missions B per shared draw, and units n.

    Raises
    ------
    ValueError
        If a profile has more missions than B.
    """

    thresholds: Sequence[float]
    taus: Sequence[float | None]
    profiles: Sequence[Missions]
    missions: int = 10
    units: int = 4

    def __post_init__(self) -> None:
        for profile in self.profiles:
            if max(mission_numbers(profile)) > self.missions:
                raise ValueError(f"{self.missions} missions are too few for {profile}")

    @property
    def shape(self) -> tuple[int, int, int]:
        """Shape of the arrays of estimates."""
        return len(self.taus), len(self.profiles), len(self.thresholds)

    @property
    def replicates(self) -> int:
        """Replicates per shared draw, K = n B."""
        return self.missions * self.units

    def estimate(
        self, times: FloatArray, weights: FloatArray, rng: np.random.Generator
    ) -> FloatArray:
        """Give the estimates, averaged over the shared draws.

        Parameters
        ----------
        times
            Responses (shared draws, K, L); +inf fails every criterion.
        weights
            Weights (L,) of the responses of a replicate, which sum to 1.
        rng
            For the arrangements of replicates into missions.

        Raises
        ------
        ValueError
            If `times` has the wrong shape or holds NaN.
        """
        if times.ndim != 3 or times.shape[1:] != (self.replicates, len(weights)):
            raise ValueError(
                f"times have shape {times.shape}, not (n, {self.replicates}, {len(weights)})"
            )
        if np.isnan(times).any():
            raise ValueError("times hold NaN: a failed run has no place in a reference")
        thresholds = np.asarray(self.thresholds, dtype=np.float64)
        taus = np.array([tau for tau in self.taus if tau is not None], dtype=np.float64)
        too_late = np.minimum(late_shares(times, weights, thresholds), 1.0)
        alone = failure_of_any(np.moveaxis(too_late, 1, 0)).mean(axis=1)
        in_step = np.zeros((self.missions + 1, len(taus), len(thresholds)))
        for _ in range(ARRANGEMENTS if taus.size else 0):
            order = rng.permutation(self.replicates).reshape(self.missions, self.units)
            failed = mission_failures(np.take(times, order, axis=1), weights, thresholds, taus)
            in_step += failure_of_any(np.moveaxis(failed, 1, 0)).mean(axis=1) / ARRANGEMENTS
        estimates = np.zeros(self.shape)
        for j, profile in enumerate(self.profiles):
            for number, share in mission_numbers(profile).items():
                synchronized = iter(in_step[number])
                for i, tau in enumerate(self.taus):
                    one = alone[number * self.units] if tau is None else next(synchronized)
                    estimates[i, j] += share * one
        return estimates


def mission_numbers(profile: Missions) -> dict[int, float]:
    """Numbers of missions that a profile may have, with their probabilities."""
    if isinstance(profile, Binomial):
        numbers = range(profile.planned + 1)
        return {k: float(binom.pmf(k, profile.planned, profile.p)) for k in numbers}
    return {profile: 1.0}


def failure_of_any(failures: FloatArray) -> FloatArray:
    """Probability that at least one of r trials fails, for r = 0 ... K, without bias.

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


def late_shares(times: FloatArray, weights: FloatArray, thresholds: FloatArray) -> FloatArray:
    """Weighted share (draws, K, thresholds) of the responses (draws, K, L) beyond each T."""
    order = np.argsort(times, axis=2)
    late = np.cumsum(weights[order][..., ::-1], axis=2)[..., ::-1]
    late = np.concatenate([late, np.zeros_like(late[..., :1])], axis=2)
    working = (times[..., None] <= thresholds).sum(axis=2)
    return np.take_along_axis(late, working, axis=2)


@njit(error_model="numpy", cache=True)
def mission_failures(times: Any, weights: Any, thresholds: Any, taus: Any) -> Any:
    """Failure probability of single missions under synchronization.

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
