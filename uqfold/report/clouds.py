"""Errors and costs of methods as data, for every way of drawing them."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from uqfold.comparison.records import Records
from uqfold.report.page.scales import LARGEST, SMALLEST
from uqfold.report.wording import reference_resolution
from uqfold.typing import BoolArray, FloatArray

SIDE_STEP = 0.03
"""Distance between methods of nearly equal cost, as a part of the axis."""


@dataclass(frozen=True)
class Cloud:
    """Errors of one method: cost (n,), error (n,), and whether the reference can judge it (n,)."""

    label: str
    n_evals: FloatArray
    error: FloatArray
    judged: BoolArray

    @property
    def cost(self) -> float:
        """Median cost of a criterion."""
        return float(np.median(self.n_evals))


def error_clouds(records: Records) -> list[Cloud]:
    """Gather the errors of every method that has some."""
    clouds = []
    for label in records.finished:
        own = [
            row for row in records.rows if row["label"] == label and not math.isnan(row["error"])
        ]
        if own:
            clouds.append(
                Cloud(
                    label,
                    np.array([max(row["n_evals_row"], 1) for row in own], dtype=np.float64),
                    np.array([row["error"] for row in own]),
                    np.array([row["error"] > reference_resolution(row) for row in own]),
                )
            )
    return clouds


def side_steps(clouds: Sequence[Cloud], left: float, right: float) -> dict[str, float]:
    """Give the factor on the cost by which each method is moved aside from its neighbours."""
    step = (right / left) ** SIDE_STEP
    ordered = sorted(clouds, key=lambda cloud: cloud.cost)
    groups = [[ordered[0]]]
    for before, cloud in pairwise(ordered):
        if cloud.cost < step * before.cost:
            groups[-1].append(cloud)
        else:
            groups.append([cloud])
    return {
        cloud.label: step ** (i - (len(group) - 1) / 2)
        for group in groups
        for i, cloud in enumerate(group)
    }


def error_limits(clouds: Sequence[Cloud]) -> tuple[float, float]:
    """Give the ends of an axis for the errors; an error of zero belongs on its lower end."""
    errors = np.concatenate([cloud.error for cloud in clouds])
    positive = errors[(errors > SMALLEST) & (errors < LARGEST)]
    if positive.size == 0:
        return 1e-6, 1.0
    return float(positive.min()) / 2.0, max(float(positive.max()) * 2.0, 0.02)


def cost_limits(clouds: Sequence[Cloud]) -> tuple[float, float]:
    """Give the ends of an axis for the costs, a factor of 30 apart at least."""
    costs = np.concatenate([cloud.n_evals for cloud in clouds])
    left, right = float(costs.min()) / 2.0, float(costs.max()) * 2.0
    while right / left < 30.0:
        left, right = left / 1.5, right * 1.5
    return left, right
