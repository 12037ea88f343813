"""The paper's sampling of the conditional distribution, Eqs. (43)-(47).

From the conditional distribution at each shared node N_0 rows are drawn, each holding the responses
of all units in all missions; the share of rows in which every mission works estimates the
conditional reliability. The order-statistics integral gives the same without sampling error; this
form is kept because it is the paper's own.
"""

from __future__ import annotations

import math
from typing import Protocol, runtime_checkable

import numpy as np

from uqfold.evaluation import TimeLimitError
from uqfold.methods.factorial_answers import doubts_about_responses
from uqfold.methods.factorial_design import FFNIDetails
from uqfold.methods.result import NORMAL_95, Estimate
from uqfold.methods.task import Task
from uqfold.problems.criterion import Binomial, Missions
from uqfold.system.conditional import grouped
from uqfold.system.conditional_response import ConditionalResponse
from uqfold.system.structure import SystemUnits
from uqfold.typing import FloatArray, IntArray

_CHUNK_VALUES = 4_000_000
"""Responses held in memory at once; part of the meaning of a seed."""
_FEW = 10
"""Rows that fail, or work, below which their number says little about its own error."""


@runtime_checkable
class _Sampler(Protocol):
    """A distribution that can be drawn from."""

    def sample(self, rng: np.random.Generator, size: tuple[int, ...]) -> FloatArray: ...


def sampled_failure(
    task: Task,
    responses: list[ConditionalResponse],
    details: FFNIDetails,
    rows: int,
    doubts: list[str],
) -> list[Estimate]:
    """Estimate every criterion of the task from sampled rows.

    All nodes take turns, so that the rows drawn before a limit on time are an answer.

    Parameters
    ----------
    task
        Criteria, number of units and seed; each shared node has its own random stream.
    responses, details
        From `conditional_responses`.
    rows
        N_0, rows drawn at each node.
    doubts
        Why every answer is ``doubtful``, besides infinite responses.

    Returns
    -------
    list[Estimate]
        With the standard error of sampling; the error of the quadrature is not in it.

    Raises
    ------
    ValueError
        If a single row does not fit into memory.
    TimeLimitError
        If the time is over before every node has had its first turn.
    """
    units, missions = SystemUnits.of(task.problem), max(c.max_missions for c in task.criteria)
    per_row = missions * task.problem.n_units
    if per_row > _CHUNK_VALUES:
        raise ValueError(
            f"{missions} missions of {task.problem.n_units} units are {per_row} responses in one "
            f"row, more than {_CHUNK_VALUES}: integrate instead (rows=None)"
        )
    chunk = max(1, _CHUNK_VALUES // per_row)
    streams = [task.generator(k) for k in range(len(responses))]
    # sum and sum of squares over rows, at each node and for each criterion
    sums = np.zeros((2, len(responses), len(task.criteria)))
    drawn, stopped = 0, ""
    try:
        while drawn < rows:
            size = min(chunk, rows - drawn)
            turn = np.empty_like(sums)
            for k, (response, rng) in enumerate(zip(responses, streams, strict=True)):
                task.session.check_time()
                y = _sample(response, rng, (size, missions, task.problem.n_units))
                turn[:, k] = _sums(task, y, units)
            sums += turn
            drawn += size
    except TimeLimitError as error:
        if drawn == 0:
            raise
        stopped = f"{drawn} of {rows} rows; {error}"
    mean = sums[0] / drawn
    variance = np.maximum(sums[1] / drawn - mean**2, 0.0)
    weights, complete = details.weights, details.complete
    pf = np.minimum(weights @ mean, 1.0)
    std_error = np.sqrt(weights**2 @ variance / drawn)
    # a failed run may have had any response, and then any distribution belongs to its node
    lowest, unknown = weights @ (mean * complete[:, None]), float(weights @ ~complete)
    rarer = np.minimum(sums[0].sum(axis=0), (drawn - sums[0]).sum(axis=0))
    doubts = [*doubts, *doubts_about_responses(details)]
    estimates = []
    for i, value in enumerate(pf.tolist()):
        certain = not 0.0 < value < 1.0
        own = [f"all {drawn} rows agree at every node"] if certain else []
        if not certain and rarer[i] < _FEW:
            own = [f"fewer than {_FEW} rows of all nodes differ from the others"]
        reasons = [*own, *doubts]
        spread = math.nan if certain or unknown > 0.0 else float(std_error[i])
        estimates.append(
            Estimate(
                pf=value,
                pf_low=min(float(lowest[i]), value),
                pf_high=max(min(float(lowest[i]) + unknown, 1.0), value),
                std_error=spread,
                ci_low=max(value - NORMAL_95 * spread, 0.0),
                ci_high=min(value + NORMAL_95 * spread, 1.0),
                ci_kind="" if math.isnan(spread) else "normal 95 %, sampling only",
                error_kind="sampling",
                status="doubtful" if reasons else "budget_exhausted" if stopped else "unchecked",
                message="; ".join([*reasons, stopped] if stopped else reasons),
            )
        )
    return estimates


def _sums(task: Task, y: FloatArray, units: SystemUnits) -> FloatArray:
    """Sum and sum of squares (2, C) of the failure of rows y (size, missions, units).

    A row's failure is 0 or 1, or its mean over the binomial number of missions. Whether its first
    k missions fail depends on T through one number, so that sorting it answers all thresholds.
    """
    found = np.zeros((2, len(task.criteria)))
    y = units.shifted(y)
    for tau, rows in grouped(task.criteria, lambda criterion: criterion.tau):
        criteria = [task.criteria[row] for row in rows]
        thresholds = np.array([criterion.threshold for criterion in criteria])
        profiles = [
            (_shares(missions), some)
            for missions, some in grouped(criteria, lambda criterion: criterion.missions)
        ]
        late = np.maximum.accumulate(_latest(y, tau, units), axis=1)
        sums = np.zeros((2, len(rows)))
        for k in range(y.shape[1]):
            concerned = [
                (shares[:, k], some)
                for shares, some in profiles
                if k < shares.shape[1] and shares[0, k] > 0.0
            ]
            if concerned:
                task.session.check_time()
                failing = _above(late[:, k], thresholds)
                for share, some in concerned:
                    sums[:, some] += share[:, None] * failing[some]
        found[:, rows] = sums
    return found


def _latest(y: FloatArray, tau: float | None, units: SystemUnits) -> FloatArray:
    """Largest response (size, missions) of each mission, or that which decides its structure.

    +inf where it fails whatever T is.
    """
    if units.diagram is not None:
        return units.response(np.where(np.isnan(y), np.inf, y))
    highest = y.max(axis=2)  # NaN, a failed run, stays NaN
    fails = np.isnan(highest)
    if tau is not None:
        lowest = y.min(axis=2)
        with np.errstate(invalid="ignore", over="ignore"):
            fails |= (highest - lowest > tau) | np.isinf(lowest)
    return np.where(fails, np.inf, highest)


def _above(late: FloatArray, thresholds: FloatArray) -> IntArray:
    """How many of the responses fail at each threshold; +inf fails at every one."""
    order = np.sort(late)
    below = np.searchsorted(order, thresholds, side="right")
    finite = np.searchsorted(order, np.inf, side="left")
    return np.asarray(late.size - np.minimum(below, finite))


def _shares(missions: Missions) -> FloatArray:
    """Weights (2, m) of "one of the first k missions fails", k = 1 ... m, in a row's failure.

    The first set gives the failure itself, the second its square.
    """
    if not isinstance(missions, Binomial):
        shares = np.zeros((2, missions))
        shares[:, -1] = 1.0
        return shares
    from scipy.stats import binom

    chance = binom.pmf(np.arange(1, missions.planned + 1), missions.planned, missions.p)
    # failure of a row whose first failed mission is the k-th
    tails = np.append(np.cumsum(chance[::-1])[::-1], 0.0)
    return np.stack([chance, tails[:-1] ** 2 - tails[1:] ** 2])


def _sample(
    response: ConditionalResponse, rng: np.random.Generator, shape: tuple[int, ...]
) -> FloatArray:
    """Draw responses; +-inf and NaN (failed runs) with their own probabilities."""
    lost = response.p_never, response.p_always, response.p_missing
    if response.distribution is None:
        y = np.full(shape, np.nan)
    elif isinstance(response.distribution, _Sampler):
        y = response.distribution.sample(rng, shape)
    else:
        raise TypeError(f"{response.distribution!r} cannot be sampled")
    if sum(lost) > 0.0:
        u = rng.random(shape)
        y = np.where(u < lost[0], np.inf, y)
        y = np.where((u >= lost[0]) & (u < lost[0] + lost[1]), -np.inf, y)
        y = np.where((u >= lost[0] + lost[1]) & (u < sum(lost)), np.nan, y)
    return y
