"""Questions about strongly scaled responses, asked about transformed ones.

Whether one response exceeds its threshold does not change under an increasing transformation of
both. Differences of responses do, and so do responses of units that differ by an offset: a
synchronization threshold, and offsets, are asked about the responses themselves.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from uqfold.methods.design_runs import DesignRuns
from uqfold.methods.fitted_kind import ResponseSurface
from uqfold.methods.task import Task
from uqfold.surrogates.warping import Warp, find_warp
from uqfold.system.structure import SystemUnits
from uqfold.system.surface_rule import Surface
from uqfold.typing import FloatArray


def warp_for(task: Task, runs: DesignRuns) -> Warp | None:
    """Return a transformation that leaves the task's questions what they are; None: none helps."""
    units = SystemUnits.of(task.problem)
    asked = [criterion.threshold for criterion in task.criteria]
    if units.n_kinds > 1 or units.offsets.any():
        return None
    if any(criterion.tau is not None for criterion in task.criteria):
        return None
    warp = find_warp(runs.u[runs.finite], runs.y[runs.finite])
    return warp if warp is not None and all(map(warp.takes, asked)) else None


def transformed(task: Task, runs: DesignRuns, warp: Warp) -> tuple[Task, DesignRuns]:
    """Return a task and its runs, thresholds and responses transformed."""
    thresholds = warp(np.array([criterion.threshold for criterion in task.criteria]))
    criteria = tuple(
        replace(criterion, threshold=threshold)
        for criterion, threshold in zip(task.criteria, thresholds.tolist(), strict=True)
    )
    return replace(task, criteria=criteria), replace(runs, y=warp(runs.y))


@dataclass(frozen=True, eq=False)
class WarpedSurface:
    """A surface of transformed responses, asked for the responses themselves.

    Attributes
    ----------
    surface
        Of the transformed responses.
    warp
        The transformation.
    """

    surface: ResponseSurface
    warp: Warp

    def mean(self, u: FloatArray) -> FloatArray:
        """Responses (m,) at u (m, d) whose transforms are the best values of the surface."""
        return self.warp.inverse(self.surface.mean(u))

    def sample_paths(self, rng: np.random.Generator, count: int) -> Surface:
        """Draw `count` plausible surfaces: a function of u (m, d) with values (count, m)."""
        paths = self.surface.sample_paths(rng, count)
        return lambda u: self.warp.inverse(paths(u))
