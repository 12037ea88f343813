"""The four-branch series system: four failure regions around the origin, two of them curved.

Two independent standard-normal inputs, x1 and x2; failure when g <= 0 with ::

    g = min { 3 + 0.1 (x1 - x2)^2 - (x1 + x2) / sqrt(2),
              3 + 0.1 (x1 - x2)^2 + (x1 + x2) / sqrt(2),
              (x1 - x2) + k / sqrt(2),
              (x2 - x1) + k / sqrt(2) }

A common benchmark of active learning (Waarts 2000; Schueremans and Van Gemert 2005; Echard,
Gayton and Lemaire 2011): the regions lie at similar distances in four directions, so that a search
for one design point misses most of the failure probability, and the minimum has kinks, which a
smooth surrogate must not chase.

In the coordinates s = (x1 + x2) / sqrt(2) and t = (x1 - x2) / sqrt(2), again independent standard
normals, g is the smaller of 3 + 0.2 t^2 - |s| and sqrt(2) (k / 2 - |t|). The references are
integrals over t of the tail of s, with bounds near 1e-13 of the value; for k = 7 the failure
probability is 2.22279507e-3. They are made by ``python validation/references/four_branch.py``.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from uqfold.checks import keep, real
from uqfold.inputs import normal
from uqfold.problems.base import Problem
from uqfold.problems.reference import load_references
from uqfold.typing import FloatArray

DEFAULT_K = 7.0


@dataclass(frozen=True)
class FourBranchLimitState:
    """Limit-state function of the four-branch system.

    Attributes
    ----------
    k
        Sets the distance k / 2 of the two plane branches from the origin.
    """

    k: float = DEFAULT_K

    def __post_init__(self) -> None:
        keep(self, "k", real, above=0.0)

    def __call__(self, x: FloatArray) -> FloatArray:
        """Return g (n,) of X (n, 2); failure when it is not positive."""
        x1, x2 = x.T
        s = (x1 + x2) / math.sqrt(2.0)
        curved = 3.0 + 0.1 * (x1 - x2) ** 2 - np.abs(s)
        plane = self.k / math.sqrt(2.0) - np.abs(x1 - x2)
        return np.asarray(np.minimum(curved, plane))


def four_branch(k: float = DEFAULT_K) -> Problem:
    """Return the four-branch series system as a plain limit state.

    Parameters
    ----------
    k
        Sets the distance k / 2 of the two plane branches; 6 and 7 are usual.

    Returns
    -------
    Problem
        One unit with the inputs x1 and x2; the response is y = -g. References are attached for
        k = 7, also for thresholds above zero, which make all four regions rarer.

    Raises
    ------
    ValueError, TypeError
        If `k` is not a positive number.
    """
    k = real("k", k, above=0.0)
    return Problem.from_limit_state(
        FourBranchLimitState(k),
        {"x1": normal(0.0, 1.0), "x2": normal(0.0, 1.0)},
        name="four-branch" if k == DEFAULT_K else f"four-branch (k = {k:g})",
        version=f"four-branch-{k:.17g}",
        response="-g",
        references=load_references("four_branch") if k == DEFAULT_K else None,
    )
