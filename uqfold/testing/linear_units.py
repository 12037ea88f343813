"""Three linear units in any structure: equal, with offsets, or of two kinds; pf is known.

Unit i answers t_i = V / 2 + s_i U_i + o_i with standard normal V (shared) and U_i (individual).
Given V the responses are normal and independent, so that pf is one integral over V of a sum over
all states of the units: smooth, but for a jump where a unit with s_i = 0 passes its threshold.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from itertools import product

import numpy as np

from uqfold.inputs import normal
from uqfold.problems.base import Problem
from uqfold.problems.structure import (
    CutSets,
    KOutOfN,
    Parallel,
    PathSets,
    Series,
    Structure,
    SystemStructure,
)
from uqfold.problems.units import Unit
from uqfold.testing.linear_normal import normal_rule, works_as
from uqfold.typing import FloatArray

STRUCTURES: tuple[SystemStructure, ...] = (
    Series(),
    Parallel(),
    KOutOfN(2),
    CutSets([[0, 1], [1, 2]]),
    PathSets([[0, 1], [2]]),
    Structure("u0 & u1 | u1 & u2"),
)
"""One of each sort, of three units."""
OFFSETS = {
    "equal units": (0.0, 0.0, 0.0),
    "offsets": (0.0, 0.3, -0.4),
    "kinds": (0.0, 0.0, 0.2),
    "one without inputs of its own": (0.0, 0.0, 0.2),
}
STDS = {
    "equal units": (1.0, 1.0, 1.0),
    "offsets": (1.0, 1.0, 1.0),
    "kinds": (1.0, 0.7, 1.0),
    "one without inputs of its own": (1.0, 0.0, 1.0),
}


@dataclass(frozen=True)
class LinearUnits:
    """Three linear units; exact failure probabilities.

    Attributes
    ----------
    structure
        How they make up the system.
    differing
        ``equal units``, ``offsets``, ``kinds`` or ``one without inputs of its own``.
    """

    structure: SystemStructure
    differing: str

    def problem(self) -> Problem:
        """Return the system as a problem with one shared and one individual input."""
        own = zip(STDS[self.differing], OFFSETS[self.differing], strict=True)
        models = {std: _response(std) for std in STDS[self.differing]}
        return Problem(
            models[1.0],
            shared={"V": normal(0.0, 1.0)},
            individual={"U": normal(0.0, 1.0)},
            units=[
                Unit(models[std], None if std > 0.0 else [], offset=offset) for std, offset in own
            ],
            structure=self.structure,
            name="linear-units",
        )

    def pf(self, threshold: float, missions: int) -> float:
        """Exact failure probability, to about 1e-12 relative."""
        from scipy.special import ndtr

        own = list(zip(STDS[self.differing], OFFSETS[self.differing], strict=True))
        jumps = [2.0 * (threshold - offset) for std, offset in own if std == 0.0]
        v, weights = normal_rule(np.array(jumps))
        with np.errstate(divide="ignore"):
            scores = np.stack([(threshold - offset - 0.5 * v) / std for std, offset in own])
        late, in_time = ndtr(-scores), ndtr(scores)
        one = np.zeros(v.shape)
        for works in product((False, True), repeat=3):
            if not works_as(self.structure, works):
                one += np.where(np.array(works)[:, None], in_time, late).prod(axis=0)
        with np.errstate(divide="ignore"):
            log_works = np.log1p(-np.minimum(one, 1.0))
        return float(weights @ -np.expm1(missions * log_works))


def _response(std: float) -> Callable[[FloatArray], FloatArray]:
    def response(x: FloatArray) -> FloatArray:
        own = std * x[:, 1] if std > 0.0 else 0.0
        return np.asarray(0.5 * x[:, 0] + own)

    return response
