"""What a method can say while it is still at work."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class RunningEstimate:
    """Where an estimate stands, for the progress display.

    Attributes
    ----------
    criterion
        The criterion as text.
    pf, ci_low, ci_high
        Failure probability so far, and its interval.
    """

    criterion: str
    pf: float
    ci_low: float
    ci_high: float
