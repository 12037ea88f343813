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

from uqfold.methods.base import Task
from uqfold.methods.factorial_design import FFNIDetails, doubts_about_responses
from uqfold.methods.result import Estimate
from uqfold.problems.criterion import Binomial, Criterion
from uqfold.system.conditional import ConditionalResponse
from uqfold.system.event import mission_fails
from uqfold.typing import FloatArray

_NORMAL_95 = 1.959963984540054
_CHUNK_VALUES = 4_000_000
"""Responses held in memory at once; part of the meaning of a seed."""


@runtime_checkable
class _Sampler(Protocol):
    """A distribution that can be drawn from."""

    def sample(self, rng: np.random.Generator, size: tuple[int, ...]) -> FloatArray: ...


def sampled_failure(
    task: Task, responses: list[ConditionalResponse], details: FFNIDetails, rows: int
) -> list[Estimate]:
    """Estimate every criterion of the task from sampled rows.

    Parameters
    ----------
    task
        Criteria, number of units and seed; each shared node has its own random stream.
    responses, details
        From `conditional_responses`.
    rows
        N_0, rows drawn at each node.

    Returns
    -------
    list[Estimate]
        With the standard error of sampling; the error of the quadrature is not in it.
    """
    shape = (len(responses), len(task.criteria))
    failing, variance = np.zeros(shape), np.zeros(shape)
    for k, response in enumerate(responses):
        failing[k], variance[k] = _node(task, response, rows, task.generator(k))
    weights, complete = details.weights, details.complete
    # a failed run may have had any response, and then any distribution belongs to its node
    lowest = weights @ (failing * complete[:, None])
    unknown = float(weights @ ~complete)
    estimates = []
    for i in range(len(task.criteria)):
        pf = min(float(weights @ failing[:, i]), 1.0)
        error = math.sqrt(float(weights**2 @ variance[:, i]) / rows)
        certain = not 0.0 < pf < 1.0
        doubts = [f"all {rows} rows agree at every node"] if certain else []
        doubts += doubts_about_responses(details)
        spread = math.nan if certain or unknown > 0.0 else error
        estimates.append(
            Estimate(
                pf=pf,
                pf_low=min(float(lowest[i]), pf),
                pf_high=max(min(float(lowest[i]) + unknown, 1.0), pf),
                std_error=spread,
                ci_low=max(pf - _NORMAL_95 * spread, 0.0),
                ci_high=min(pf + _NORMAL_95 * spread, 1.0),
                ci_kind="" if math.isnan(spread) else "normal 95 %, sampling only",
                error_kind="sampling",
                status="doubtful" if doubts else "unchecked",
                message="; ".join(doubts) or "only the error of sampling is estimated",
            )
        )
    return estimates


def _node(
    task: Task, response: ConditionalResponse, rows: int, rng: np.random.Generator
) -> tuple[FloatArray, FloatArray]:
    """Mean and variance of failure per criterion, failed runs counted as failing."""
    missions = max(c.max_missions for c in task.criteria)
    n_units, n = task.problem.n_units, len(task.criteria)
    chunk = max(1, _CHUNK_VALUES // (missions * n_units))
    total, squares = np.zeros(n), np.zeros(n)
    for start in range(0, rows, chunk):
        size = min(chunk, rows - start)
        y = _sample(response, rng, (size, missions, n_units))
        for i, criterion in enumerate(task.criteria):
            value = _row_failure(y, criterion)
            total[i] += value.sum()
            squares[i] += (value**2).sum()
    mean = total / rows
    return mean, np.maximum(squares / rows - mean**2, 0.0)


def _row_failure(y: FloatArray, criterion: Criterion) -> FloatArray:
    """Failure of each row (size,): 0 or 1, or its mean over the binomial number of missions."""
    fails = mission_fails(y, criterion.threshold, criterion.tau, missing_fails=True)
    if not isinstance(criterion.missions, Binomial):
        return np.asarray(fails[:, : criterion.missions].any(axis=1), dtype=np.float64)
    planned, p = criterion.missions.planned, criterion.missions.p
    failed_by = np.logical_or.accumulate(fails[:, :planned], axis=1)
    chance = [math.comb(planned, k) * p**k * (1.0 - p) ** (planned - k) for k in range(planned + 1)]
    return np.asarray(failed_by @ np.array(chance[1:]))


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
