"""Unbiased estimates of the failure probability of a system from simulated responses.

For each draw of the shared inputs there are B missions of n units: K = n B responses that are
independent and exchangeable given that draw. A power of an estimated probability is biased, but
the share of all ways to choose responses (or missions) none of which failed is not: with F
failures among K, any r of them all work with a probability that C(K - F, r) / C(K, r) estimates
without bias. The counts are whole numbers, so that the complement is exact.

- No synchronization: r = n m responses out of K.
- Synchronization, one mission: all C(K, n) ways to form a mission are counted.
- Synchronization, more missions: m missions out of B, averaged over several arrangements of the
  K responses into missions.
- A binomial number of missions: the same, weighted with the probabilities of that number.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from fractions import Fraction
from functools import cached_property
from math import comb

import numpy as np

from uqfold.problems.criterion import Binomial, Missions
from uqfold.typing import FloatArray, IntArray

ARRANGEMENTS = 8


@dataclass(frozen=True)
class MissionGrid:
    """What is estimated, all combinations: arrays (taus, profiles, thresholds).

    Attributes
    ----------
    thresholds, taus, profiles
        T, tau (None: not required) and mission profiles.
    missions, units
        Missions B per shared draw, and units n.
    """

    thresholds: Sequence[float]
    taus: Sequence[float | None]
    profiles: Sequence[Missions]
    missions: int = 10
    units: int = 4

    @property
    def shape(self) -> tuple[int, int, int]:
        """Shape of the arrays of estimates."""
        return len(self.taus), len(self.profiles), len(self.thresholds)

    @cached_property
    def by_responses(self) -> list[FloatArray]:
        """For each profile, the estimate by the number of failed responses."""
        total = self.missions * self.units
        return [failure_by_count(total, self.units, profile) for profile in self.profiles]

    @cached_property
    def by_missions(self) -> list[FloatArray]:
        """For each profile, the estimate by the number of failed missions."""
        return [failure_by_count(self.missions, 1, profile) for profile in self.profiles]

    def estimate(self, times: FloatArray, rng: np.random.Generator) -> FloatArray:
        """Give the estimates, averaged over the shared draws.

        Parameters
        ----------
        times
            Responses (shared draws, B, n); +inf fails every criterion.
        rng
            For the arrangements of responses into missions.

        Raises
        ------
        ValueError
            If `times` has the wrong shape or holds NaN.
        """
        if times.ndim != 3 or times.shape[1:] != (self.missions, self.units):
            raise ValueError(f"times have shape {times.shape}, not (n, B, units) of {self}")
        if np.isnan(times).any():
            raise ValueError("times hold NaN: a failed run has no place in a reference")
        sorted_times = np.sort(times.reshape(len(times), -1), axis=1)
        # how many responses of each shared draw work under each threshold
        working = np.array(
            [(sorted_times <= threshold).sum(axis=1) for threshold in self.thresholds]
        )
        estimates = np.empty(self.shape)
        for i, tau in enumerate(self.taus):
            if tau is None:
                for j, table in enumerate(self.by_responses):
                    estimates[i, j] = table[sorted_times.shape[1] - working].mean(axis=1)
            else:
                failed = self._failed_missions(times, tau, rng)
                for j, table in enumerate(self.by_missions):
                    estimates[i, j] = table[failed].mean(axis=(0, 2))
                if 1 in self.profiles:
                    estimates[i, self.profiles.index(1)] = self._one_mission(
                        sorted_times, working, tau
                    )
        return estimates

    def _failed_missions(self, times: FloatArray, tau: float, rng: np.random.Generator) -> IntArray:
        """Failed missions (arrangements, thresholds, shared draws)."""
        draws = len(times)
        pool = times.reshape(draws, -1)
        failed = np.empty((ARRANGEMENTS, len(self.thresholds), draws), dtype=np.int64)
        for a in range(ARRANGEMENTS):
            arranged = pool[:, rng.permutation(pool.shape[1])].reshape(times.shape)
            last = arranged.max(axis=2)
            with np.errstate(invalid="ignore"):  # inf - inf is NaN, which is not <= tau
                in_step = last - arranged.min(axis=2) <= tau
            for k, threshold in enumerate(self.thresholds):
                failed[a, k] = (~(in_step & (last <= threshold))).sum(axis=1)
        return failed

    def _one_mission(self, sorted_times: FloatArray, working: IntArray, tau: float) -> FloatArray:
        """Share of all possible missions that fail (thresholds,), over all shared draws."""
        with np.errstate(invalid="ignore"):
            near = sorted_times[:, :, None] - sorted_times[:, None, :] <= tau
        # for each response as the last one: how many earlier ones are near enough, and in how
        # many ways they complete a mission
        earlier = np.tril(near, -1).sum(axis=2)
        total = sorted_times.shape[1]
        ways = np.array([comb(c, self.units - 1) for c in range(total)])[earlier]
        upto = np.concatenate([np.zeros((len(ways), 1), dtype=np.int64), ways.cumsum(axis=1)], 1)
        good = np.take_along_axis(upto, working.T, axis=1)
        whole = comb(total, self.units)
        failed: FloatArray = ((whole - good) / whole).mean(axis=0)
        return failed


def failure_by_count(total: int, per_mission: int, profile: Missions) -> FloatArray:
    """Unbiased estimate that a profile fails, by the number F of failures among `total` trials.

    Parameters
    ----------
    total
        Trials K.
    per_mission
        Trials that one mission takes.
    profile
        Number of missions.

    Returns
    -------
    FloatArray
        Estimates (K + 1,) for F = 0 ... K.

    Raises
    ------
    ValueError
        If the trials do not suffice for the profile.
    """
    if isinstance(profile, Binomial):
        p = Fraction(profile.p)
        numbers = {
            k: comb(profile.planned, k) * p**k * (1 - p) ** (profile.planned - k)
            for k in range(profile.planned + 1)
        }
    else:
        numbers = {profile: Fraction(1)}
    if max(numbers) * per_mission > total:
        raise ValueError(f"{total} trials are too few for {max(numbers)} missions")

    def estimate(failed: int) -> float:
        exact = Fraction(0)
        for k, weight in numbers.items():
            chosen = k * per_mission
            exact += weight * (1 - Fraction(comb(total - failed, chosen), comb(total, chosen)))
        return float(exact)

    return np.array([estimate(failed) for failed in range(total + 1)])
