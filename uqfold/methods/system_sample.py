"""Whole systems drawn at random, for crude simulation: which rows to run, and who failed.

Each system draws its shared inputs once and its individual inputs for every unit and every
mission. All criteria are read off the same systems.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from uqfold.problems.base import Problem
from uqfold.problems.criterion import Binomial, Criterion
from uqfold.system.event import mission_fails
from uqfold.typing import BoolArray, FloatArray, IntArray

BLOCK_SYSTEMS = 4096
"""Systems drawn from one random stream; part of the meaning of a seed."""


@dataclass(frozen=True, eq=False)
class SystemBlock:
    """One block of systems: the rows to run, and what is needed to judge their responses.

    Attributes
    ----------
    criteria
        What is asked of them.
    x
        Inputs (n_rows, d) of the units that some criterion looks at.
    rows
        Which (size, missions, units) these are.
    active
        Which missions (size, missions) each criterion looks at.
    """

    criteria: Sequence[Criterion]
    x: FloatArray
    rows: BoolArray
    active: list[BoolArray]

    def failed(self, responses: FloatArray, *, missing_fails: bool) -> BoolArray:
        """Which systems fail each criterion (n_criteria, size).

        Parameters
        ----------
        responses
            Responses (n_rows,) to `x`; NaN marks failed runs.
        missing_fails
            Whether a mission with a failed run counts as failed, see `mission_fails`.
        """
        y = np.zeros(self.rows.shape)
        y[self.rows] = responses
        return np.array(
            [
                np.any(
                    mask & mission_fails(y, c.threshold, c.tau, missing_fails=missing_fails), axis=1
                )
                for c, mask in zip(self.criteria, self.active, strict=True)
            ]
        )

    def counts(self, responses: FloatArray) -> tuple[int, IntArray, IntArray]:
        """Systems, and failures of each criterion: open ones as failed, and as safe."""
        high, low = (
            self.failed(responses, missing_fails=missing).sum(axis=1) for missing in (True, False)
        )
        return len(self.rows), high, low


def draw_systems(
    problem: Problem, criteria: Sequence[Criterion], rng: np.random.Generator, size: int
) -> SystemBlock:
    """Draw a block of systems.

    Parameters
    ----------
    problem
        Inputs and number of exchangeable units.
    criteria
        What will be asked of the systems; they fly as many missions as the longest of them.
    rng
        Stream of the block.
    size
        Number of systems.
    """
    inputs, missions = problem.inputs, max(c.max_missions for c in criteria)
    shape = (size, missions, problem.n_units)
    u = np.empty((*shape, inputs.dimension))
    u[..., : inputs.n_shared] = rng.standard_normal((size, 1, 1, inputs.n_shared))
    u[..., inputs.n_shared :] = rng.standard_normal((*shape, inputs.n_individual))
    flown = rng.random((size, missions))
    x = inputs.from_standard_normal(u.reshape(-1, inputs.dimension))
    active = [_active_missions(criterion, flown) for criterion in criteria]
    # missions that no criterion looks at are drawn, to keep the stream in step, but not run
    needed = np.logical_or.reduce(active)
    rows = np.repeat(needed[:, :, None], problem.n_units, axis=2)
    return SystemBlock(criteria, x[rows.ravel()], rows, active)


def _active_missions(criterion: Criterion, flown: FloatArray) -> BoolArray:
    """Which missions (size, missions) this criterion looks at."""
    index = np.arange(flown.shape[1])
    if isinstance(criterion.missions, Binomial):
        planned, p = criterion.missions.planned, criterion.missions.p
        count = (flown[:, :planned] < p).sum(axis=1)
        return np.asarray(index[None, :] < count[:, None])
    return np.broadcast_to(index < criterion.missions, flown.shape)
