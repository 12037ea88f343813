"""Faults to plant in a wing, or in the times it is compared with."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence

from uqfold.mechanism import WingParameters


def late_onset(wing: WingParameters) -> WingParameters:
    """Return the wing whose damping is that of an onset velocity 2 % too large, by Eq. (5)."""
    return wing.replace(C_e=math.sqrt(1.0 - (1.0 - wing.C_e**2) / 1.02))


def stale(times: Mapping[str, Sequence[float]]) -> dict[str, list[float]]:
    """Return reference times of a model that has changed since: later by a ten-thousandth."""
    return {name: [1.0001 * time for time in found] for name, found in times.items()}
