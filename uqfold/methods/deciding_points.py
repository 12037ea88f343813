"""Where further runs tell most about answers that a surface has given: at its limits.

A surface that is wrong where failure begins is wrong nowhere else that matters, and may foretell
all runs of its design. Runs that it was not fitted to, drawn from the limits in proportion to their
weight in pf, are missed by what pf is missed by.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from uqfold.methods.active_question import Question
from uqfold.methods.fitted_kind import FittedKind
from uqfold.methods.limit_cloud import limit_cloud
from uqfold.methods.result import Estimate
from uqfold.methods.task import Task
from uqfold.problems.criterion import Criterion
from uqfold.surrogates.designs import MAX_COORDINATE
from uqfold.system.structure import SystemUnits
from uqfold.typing import FloatArray

AT_EACH = 6
"""Runs at each threshold that is looked at."""
_FEWEST, _MOST_THRESHOLDS = 4, 3


def thresholds_looked_at(criteria: Sequence[Criterion]) -> list[float]:
    """Some finite thresholds of criteria, the smallest and the largest among them."""
    finite = np.unique([one.threshold for one in criteria if math.isfinite(one.threshold)])
    picked = np.linspace(0, finite.size - 1, min(finite.size, _MOST_THRESHOLDS)).round()
    return [float(finite[int(row)]) for row in picked]


def deciding_points(
    task: Task,
    fitted: Sequence[FittedKind],
    estimates: Sequence[Estimate],
    most: int,
    rng: np.random.Generator,
) -> list[FloatArray]:
    """Choose points (k, d) of each kind, where converged answers are decided.

    Parameters
    ----------
    task
        Problem and criteria.
    fitted
        The surface of each kind of units.
    estimates
        The answers.
    most
        Most points in all; where they are too few for a look at one threshold, there are none.
    rng
        Source of randomness.
    """
    sure = [
        one
        for one, row in zip(task.criteria, estimates, strict=True)
        if row.status == "converged" and 0.0 < row.pf < 1.0
    ]
    units = SystemUnits.of(task.problem)
    found = []
    for kind, (one, inputs) in enumerate(zip(fitted, task.problem.kinds.inputs, strict=True)):
        if len(fitted) == 1 and not units.offsets.any():
            alone = {c.threshold: replace(c, tau=None) for c in sure}
            asked = [alone[threshold] for threshold in thresholds_looked_at(sure)]
            question = Question.of(replace(task, criteria=tuple(asked)), [one.runs])
        else:
            # what one unit weighs in its system depends on all others: its own limits count
            own = units.thresholds([c.threshold for c in sure], kind).ravel().tolist()
            asked = [Criterion(t) for t in thresholds_looked_at([Criterion(t) for t in own])]
            neighbours = np.zeros((2, len(asked)), dtype=np.int64)
            question = Question(
                (inputs.dimension,), inputs.n_shared, SystemUnits(1), tuple(asked), neighbours
            )
        count = min(AT_EACH, most // (len(fitted) * max(len(asked), 1)))
        some = count >= _FEWEST and asked
        found.append(_at_limits(one, question, count, rng) if some else _none(inputs.dimension))
    return found


def _at_limits(
    one: FittedKind, question: Question, count: int, rng: np.random.Generator
) -> FloatArray:
    scatter = float(one.known.std())
    _, [answers] = question.answers([one.surface.mean])
    cloud, influence = limit_cloud(one.surface.mean, None, scatter, answers, rng)
    # models seldom mean anything further out
    within = np.abs(cloud.u).max(axis=1) <= MAX_COORDINATE
    points = [_none(answers.dimension)]
    for row in np.abs(influence) * cloud.weights * within:
        # each point once
        some = min(count, int(np.count_nonzero(row)))
        if some:
            points.append(cloud.u[rng.choice(row.size, some, replace=False, p=row / row.sum())])
    return np.concatenate(points)


def _none(dimension: int) -> FloatArray:
    return np.empty((0, dimension))
