"""What runs say against the stated error of a surface: residuals near a threshold, and plateaus."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from uqfold.methods.fitted_kind import FittedKind, HeldOut
from uqfold.problems.criterion import Criterion
from uqfold.surrogates.cross_validation import LeaveOneOut
from uqfold.system.structure import SystemUnits
from uqfold.typing import FloatArray, IntArray

# The runs nearest to a threshold, at least so many and this share of all, and how many times
# their residuals may exceed what the surface states for them by chance.
_FEWEST_NEAR, _SHARE_NEAR, _BY_CHANCE = 10, 0.1, 1.4
# Standard errors from which the mean residual near a threshold leans to one side.
_ONE_SIDED = 1.5
# The same of runs that the surface was not fitted to, all of which lie near some threshold: one of
# them alone may stand for the part of the limit that is missed.
_HELD_OUT_NEAR, _HELD_ONE_SIDED = 6, 1.0


def overconfidence(
    validated: LeaveOneOut, y: FloatArray, threshold: float, held: HeldOut | None = None
) -> float:
    """Factor by which residuals exceed what the surface states, near a threshold or everywhere."""
    near = [validated.among(_near(y, threshold))]
    if held is not None and held.foretold.size:
        near.append(held.errors.among(_near(held.foretold, threshold, _HELD_OUT_NEAR)))
    return max(1.0, validated.ratio, *(one.ratio for one in near if one.ratio > _BY_CHANCE))


def _near(y: FloatArray, threshold: float, fewest: int = _FEWEST_NEAR) -> IntArray:
    """Runs (k,) whose responses are nearest to a threshold."""
    count = max(fewest, int(_SHARE_NEAR * y.size))
    return np.argsort(np.abs(y - threshold), kind="stable")[:count]


def lean(
    fitted: Sequence[FittedKind],
    criterion: Criterion,
    units: SystemUnits,
    held: Sequence[HeldOut] = (),
) -> float:
    """Mean of what left-out runs near a threshold are missed by, if most to one side; 0 otherwise.

    Beyond the last runs a surface errs to the side to which it misses them. Runs held out of each
    kind's surface count as well.
    """
    most = 0.0
    for kind, one in enumerate(fitted):
        for threshold in units.thresholds(criterion.threshold, kind).tolist():
            residuals = [(one.validated.residuals[_near(one.known, threshold)], _ONE_SIDED)]
            if held and held[kind].foretold.size:
                near = _near(held[kind].foretold, threshold, _HELD_OUT_NEAR)
                residuals.append((held[kind].errors.residuals[near], _HELD_ONE_SIDED))
            for some, limit in residuals:
                mean, error = float(some.mean()), float(some.std()) / math.sqrt(some.size)
                if abs(mean) > max(limit * error, abs(most)):
                    most = mean
    return most


def step(
    fitted: Sequence[FittedKind], criterion: Criterion, units: SystemUnits
) -> tuple[Criterion, Criterion]:
    """Return a criterion at both ends of the step of the responses in which its threshold lies.

    Different inputs that give the same response to the last bit lie on a plateau, in which a
    smooth surface bends: where it crosses the threshold says nothing of where the step is. Beside
    the plateau it bends all along the edge to the same side, by about what left-out runs are
    missed by, of which twice as much is taken for a step.
    """
    low = high = criterion.threshold
    for kind, one in enumerate(fitted):
        y = one.known
        values, counts = np.unique(y, return_counts=True)
        for threshold in units.thresholds(criterion.threshold, kind).tolist():
            offset = criterion.threshold - threshold
            above = int(np.searchsorted(values, threshold, side="right"))
            ends = [i for i in (above - 1, above) if 0 <= i < values.size]
            if any(counts[i] > 1 for i in ends):
                low = min(low, float(values[ends[0]]) + offset)
                high = max(high, float(values[ends[-1]]) + offset)
            near = _near(y, threshold)
            if (counts[np.searchsorted(values, y[near])] > 1).any():
                bent = 2.0 * one.validated.among(near).rms
                low, high = (
                    min(low, criterion.threshold - bent),
                    max(high, criterion.threshold + bent),
                )
    return replace(criterion, threshold=low), replace(criterion, threshold=high)
