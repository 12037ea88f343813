"""What conditional Monte Carlo sums up: estimates of blocks of shared draws, and their errors."""

from __future__ import annotations

import math

import numpy as np

from uqfold.methods.clopper_pearson import clopper_pearson
from uqfold.methods.result import Estimate, Status
from uqfold.methods.task import Task
from uqfold.system.event import Worst
from uqfold.system.failure_counts import failure_by_count
from uqfold.system.structure import SystemUnits
from uqfold.time_limit import check_time
from uqfold.typing import FloatArray, IntArray

BLOCK_DRAWS = 16
"""Shared draws of one block, stratified among themselves; part of the meaning of a seed."""
FEW = 10
"""Failures in fewer shared draws than this leave the stated error uncertain itself."""
ENOUGH_DRAWS = 25.0
"""Shared draws that an interval takes, as a multiple of the squared skewness of the draws."""
LEVEL = 0.95


class ConditionalSums:
    """Running mean and spread (2, n_criteria) of the block estimates.

    The first row counts failed runs as failures, the second as safe.
    """

    def __init__(self, task: Task, missions: int) -> None:
        self.criteria, self.missions = task.criteria, missions
        self.units = SystemUnits.of(task.problem)
        self.blocks = 0
        self.mean = np.zeros((2, len(self.criteria)))
        self.squares = np.zeros_like(self.mean)
        self.failing = np.zeros(len(self.criteria), dtype=np.int64)
        # over all draws, of pf given the shared inputs (0) and of what it lacks of its largest (1)
        self.powers = np.zeros((2, 3, len(self.criteria)))
        self.lowest = np.full(len(self.criteria), np.inf)
        self.highest = np.full(len(self.criteria), -np.inf)
        count = self.units.count
        tables = {
            (own, whole): failure_by_count(missions, 1, own)
            if whole
            else failure_by_count(missions * count, count, own)
            for own, whole in {(c.missions, self._by_missions(c.tau)) for c in self.criteria}
        }
        self.tables = [tables[c.missions, self._by_missions(c.tau)] for c in self.criteria]
        self.asked: dict[tuple[float, float | None], list[int]] = {}
        for i, c in enumerate(self.criteria):
            self.asked.setdefault((c.threshold, c.tau), []).append(i)

    def add(self, responses: FloatArray, ways: IntArray) -> FloatArray:
        """Take in the responses of some blocks, and the arrangements of these.

        Returns
        -------
        FloatArray
            The estimates (2, n_criteria, blocks) of each block, rows as those of the class.
        """
        y = responses.reshape(len(ways), BLOCK_DRAWS, -1)
        variants = (True, False) if np.isnan(y).any() else (True,)
        estimates = np.empty((2, len(self.criteria), len(ways)))
        failing, powers = np.zeros_like(self.failing), np.zeros_like(self.powers)
        lowest, highest = self.lowest.copy(), self.highest.copy()
        for j, missing_fails in enumerate(variants):
            worst = {
                whole: self._worst(y, ways, whole, missing_fails)
                for whole in {self._by_missions(tau) for _, tau in self.asked}
            }
            for (threshold, tau), rows in self.asked.items():
                check_time()
                # (blocks, arrangements, draws)
                count = worst[self._by_missions(tau)].fails(threshold, tau).sum(axis=-1)
                for i in rows:
                    table = self.tables[i]
                    found = table[count]
                    estimates[j, i] = found.mean(axis=(1, 2))
                    if j > 0:
                        continue
                    failing[i] = int((found > 0.0).any(axis=1).sum())
                    lowest[i] = min(lowest[i], found.min())
                    highest[i] = max(highest[i], found.max())
                    fails = found.mean(axis=1)
                    for k, part in enumerate((fails, table[-1] - fails)):
                        powers[k, :, i] = [(part**power).sum() for power in (1, 2, 3)]
        estimates[len(variants) :] = estimates[0]
        self.failing, self.powers = self.failing + failing, self.powers + powers
        self.lowest, self.highest = lowest, highest
        before, self.blocks = self.blocks, self.blocks + len(ways)
        share = len(ways) / self.blocks
        own = estimates.mean(axis=2)
        change = own - self.mean
        self.squares += ((estimates - own[:, :, None]) ** 2).sum(axis=2)
        self.squares += change**2 * before * share
        self.mean += change * share
        return estimates

    def _by_missions(self, tau: float | None) -> bool:
        """Whether missions are counted, since failures of units do not tell those of a mission."""
        return tau is not None or self.units.diagram is not None or self.units.of_sorts is not None

    def _worst(self, y: FloatArray, ways: IntArray, whole: bool, missing_fails: bool) -> Worst:
        """Return the worst of single responses, or of whole missions in every arrangement.

        Shape (blocks, arrangements, draws, responses or missions).
        """
        if not whole:
            alone = y[:, None, :, :, None]
            return Worst.of_missions(alone, missing_fails=missing_fails)
        arranged = np.take_along_axis(y[:, None], ways[:, :, None, :], axis=-1)
        shape = (*arranged.shape[:-1], self.missions, self.units.count)
        of_missions = arranged.reshape(shape)
        return Worst.of_missions(of_missions, missing_fails=missing_fails, units=self.units)

    def _uneven(self, i: int) -> tuple[str, float]:
        """What rests on so few of the shared draws that the stated error is not to be believed.

        Where few draws carry nearly all of the sum, a sample without them looks even, and states
        a small error. Cochran's rule for the interval of a mean asks for more than 25 times the
        squared skewness of the draws (Sampling Techniques, 1977, 2.15). That a system which flies
        no mission works is the same for every draw, and does not count.

        Returns
        -------
        tuple[str, float]
            ``"pf"``, ``"the reliability"`` or empty, and how many draws that are alike would
            scatter like these: Kish's effective size (Survey Sampling, 1965).
        """
        n = self.blocks * BLOCK_DRAWS
        rare = int(self.powers[1, 0, i] < self.powers[0, 0, i])
        total, squares, cubes = self.powers[rare, :, i].tolist()
        mean, square = total / n, squares / n
        variance = square - mean**2
        third = cubes / n - 3.0 * mean * square + 2.0 * mean**3
        if n * max(variance, 0.0) ** 3 >= ENOUGH_DRAWS * third**2:
            return "", math.inf
        if third < 0.0:
            rare = 1 - rare
            total, squares = self.powers[rare, :2, i].tolist()
        return ("pf", "the reliability")[rare], total**2 / squares

    def estimate(self, i: int, missing: int, stopped: str) -> Estimate:
        """Answer one criterion."""
        from scipy.special import stdtrit

        n, draws = self.blocks, self.blocks * BLOCK_DRAWS
        pf, pf_low = (float(mean) for mean in self.mean[:, i])
        std_error, spread_low = np.sqrt(self.squares[:, i] / (n * (n - 1))).tolist()
        status: Status = "converged"
        messages = []
        if missing > 0:
            status = "budget_exhausted"
            messages.append(f"{n} of {n + missing} blocks")
        if stopped:
            messages.append(stopped)
        reach = float(stdtrit(n - 1, 0.5 + 0.5 * LEVEL))
        ci_low = max(0.0, pf_low - reach * spread_low)
        ci_high = min(1.0, pf + reach * std_error)
        kind = "student 95 %"
        failing, most = int(self.failing[i]), float(self.tables[i][-1])
        rests, alike = self._uneven(i)
        # with 95 % confidence what no draw has shown has at most this probability
        unseen = clopper_pearson(0, draws, LEVEL)[1]
        if self.lowest[i] == self.highest[i]:
            # without both outcomes the sample says nothing about its own spread
            pf = float(self.highest[i])
            std_error, kind, status = math.nan, "clopper-pearson 95 % one-sided", "doubtful"
            ci_low = pf_low if pf == 0.0 else pf_low * (1.0 - unseen)
            ci_high = pf + unseen * (most - pf)
            messages.append(f"{'only' if pf > 0.0 else 'no'} failures in {draws} shared draws")
        elif failing < FEW:
            status, rests = "doubtful", "pf"
            messages.append(f"failures in {failing} of {draws} shared draws")
        elif rests:
            status = "doubtful"
            messages.append(f"{rests} rests on about {alike:.2g} of {draws} shared draws")
        if rests:
            kind = "student 95 %, and unseen draws"
            if rests == "pf":
                ci_high = max(ci_high, pf + unseen * (most - pf))
            else:
                ci_low = min(ci_low, pf_low * (1.0 - unseen))
        return Estimate(
            pf=pf,
            reliability=1.0 - pf,
            std_error=std_error,
            ci_low=min(ci_low, pf_low),
            ci_high=max(ci_high, pf),
            ci_kind=kind,
            pf_low=pf_low,
            pf_high=pf,
            error_kind="sampling",
            status=status,
            message="; ".join(messages),
        )
