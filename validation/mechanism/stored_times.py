"""Times of other codes: as stored, since they take long, computed anew, or with a fault."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping

from uqfold.mechanism import WingParameters
from uqfold.validation import Finding, Work

Times = Mapping[str, list[float]]


def late_onset(wing: WingParameters) -> WingParameters:
    """Return the wing whose damping is that of an onset velocity 2 % too large, by Eq. (5)."""
    return wing.replace(C_e=math.sqrt(1.0 - (1.0 - wing.C_e**2) / 1.02))


def expected_times(
    work: Work,
    computations: Mapping[str, Callable[[], list[float]]],
    stored: Times,
    what: str,
    which: int,
    agreement: float,
) -> tuple[Times, list[Finding]]:
    """Return the times to compare with: as stored, or in the full tier computed anew.

    Parameters
    ----------
    work
        The order; knows the fault ``stale reference``.
    computations, stored
        Name of each wing -> what computes its times (s), and these times as stored.
    what
        What to call the largest change since they were stored.
    which, agreement
        Index of the time that is compared, and the largest change of it (s).
    """
    if work.fault == "stale reference":
        # of a model that has changed since: later by a ten-thousandth
        return {name: [1.0001 * time for time in times] for name, times in stored.items()}, []
    if work.tier != "full":
        return stored, []
    computed = work.parts(computations)
    changes = [abs(computed[name][which] - stored[name][which]) for name in computations]
    return computed, [Finding(what, max(changes), agreement, "s")]
