"""What a design for a target reliability is: its value and its interval.

A design value is where pf crosses the target. The interval of pf at every value that was looked at
gives three curves; where they cross the target are the value and the ends of its interval.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, replace
from typing import Literal, TypeAlias

import numpy as np

from uqfold.checks import real, refused, several
from uqfold.methods.result import NO_ANSWER, CriterionResult, reliability_index
from uqfold.problems.base import Problem
from uqfold.problems.criterion import Criterion
from uqfold.typing import FloatArray

Seek: TypeAlias = Literal["smallest", "largest"]
DesignStatus: TypeAlias = Literal[
    "found", "unchecked", "doubtful", "met everywhere", "met nowhere", "failed"
]


@dataclass(frozen=True, eq=False)
class Scan:
    """Failure probability over the values of a design parameter.

    Attributes
    ----------
    values
        Values (n,), increasing.
    pf, low, high
        pf there (n,) and its interval; the interval is NaN where a method states none.
    notes
        For each value why pf there is doubtful or missing, or an empty text.
    unchecked
        Whether nobody estimated the errors of these answers.
    """

    values: FloatArray
    pf: FloatArray
    low: FloatArray
    high: FloatArray
    notes: tuple[str, ...]
    unchecked: bool = False

    @classmethod
    def of(cls, values: Sequence[float], rows: Sequence[CriterionResult]) -> Scan:
        """Gather the answers of a method."""
        return cls(
            np.array(values, dtype=float),
            np.array([row.pf for row in rows]),
            np.array([row.ci_low for row in rows]),
            np.array([row.ci_high for row in rows]),
            tuple(
                row.message or row.status
                if row.status in NO_ANSWER or row.status == "doubtful"
                else ""
                for row in rows
            ),
            any(row.status == "unchecked" for row in rows),
        )

    def interval(self, value: float) -> tuple[float, float]:
        """Interval of pf at a value of the range, or twice pf itself where none is stated."""
        value = real("value", value)
        bounds = [self.low, self.high]
        known = np.isfinite(self.low) & np.isfinite(self.high)
        if known.sum() < 2:
            bounds, known = [self.pf, self.pf], np.isfinite(self.pf)
        # pf bends strongly between values, its logarithm hardly
        logs = [np.log(np.maximum(one[known], 1e-300)) for one in bounds]
        low, high = (float(np.exp(np.interp(value, self.values[known], one))) for one in logs)
        return low, high


@dataclass(frozen=True, eq=False)
class Design:
    """The value of one parameter at which pf meets a target.

    Attributes
    ----------
    parameter, unit
        What is designed, and its unit.
    target_pf
        The failure probability to be met: pf <= target.
    seek
        Whether it is the smallest or the largest value that meets it.
    between
        Range that was looked at.
    status
        ``found``; ``unchecked`` (found, but the method estimates no error); ``doubtful`` (found,
        but the answers next to it are not trusted); ``met everywhere`` and ``met nowhere`` (in
        the range: there is no value to give); ``failed``.
    message
        What a reader has to know besides.
    value
        Best estimate; NaN without one.
    low, high
        Interval of 95 % that the error of the method leaves; NaN for an end outside the range,
        or where the method states no error.
    scan
        pf over the range.
    criterion
        The criterion; where the threshold is designed, its tau and missions.
    place
        Gives problem and criterion with the parameter at a value.
    method, n_evals, n_reused, seconds, seed
        Who says so, at what cost.
    """

    parameter: str
    unit: str
    target_pf: float
    seek: Seek
    between: tuple[float, float]
    status: DesignStatus
    message: str
    value: float
    low: float
    high: float
    scan: Scan = field(repr=False)
    criterion: Criterion
    method: str
    n_evals: int
    n_reused: int
    seconds: float
    seed: int
    place: Callable[[float], tuple[Problem, Criterion]] = field(repr=False)

    @property
    def safe(self) -> float:
        """The end of the interval at which the target is met with 97.5 % confidence."""
        return self.high if self.seek == "smallest" else self.low


MOST_POINTS = 10_000
"""Most values of a range that are looked at; more add nothing to a curve."""


def checked_target(
    target_pf: float, between: tuple[float, float]
) -> tuple[float, tuple[float, float]]:
    """Return target and range.

    Raises
    ------
    ValueError, TypeError
        If the target is not a probability inside (0, 1), or the range is empty or not finite.
    """
    target = real("target_pf", target_pf, above=0.0, below=1.0, what="probability")
    ends = several("between", between, real)
    if len(ends) != 2 or not ends[0] < ends[1]:
        raise refused("between", between, "give two finite numbers, the smaller one first")
    return target, ends


@dataclass(frozen=True)
class Crossing:
    """Where a curve crosses the target: the value, NaN if it does not, and why."""

    value: float
    status: DesignStatus
    message: str
    cell: tuple[int, int]


def crossing(values: FloatArray, pf: FloatArray, target_pf: float, seek: Seek) -> Crossing:
    """Find the smallest or the largest value from which on pf meets the target.

    Parameters
    ----------
    values
        Values (n,), increasing.
    pf
        pf there (n,), finite.
    target_pf, seek
        See `Design`.

    Returns
    -------
    Crossing
        The value is interpolated in the reliability index; ``cell`` holds the indices of the
        values on both sides of it.
    """
    from scipy.interpolate import PchipInterpolator
    from scipy.optimize import brentq

    if seek == "largest":
        found = crossing(-values[::-1], pf[::-1], target_pf, "smallest")
        last = values.size - 1
        first, last = (values.size - 1 - i for i in reversed(found.cell))
        return replace(found, value=-found.value, cell=(first, last))
    index = np.clip([reliability_index(one, 1.0 - one) for one in pf], -38.0, 38.0)
    above = index - reliability_index(target_pf, 1.0 - target_pf)
    met = above >= 0.0
    if met.all():
        return Crossing(math.nan, "met everywhere", "", (0, 0))
    if not met.any():
        return Crossing(math.nan, "met nowhere", "", (0, 0))
    if met[0]:
        return Crossing(
            math.nan, "met everywhere",
            "at this end of the range the target is met, further inside it is not", (0, 0),
        )  # fmt: skip
    i = int(np.argmax(met))
    curve = PchipInterpolator(values, above)
    value = float(brentq(curve, values[i - 1], values[i], xtol=1e-12 * float(np.ptp(values))))
    message = "" if met[i:].all() else "further on the target is missed again"
    return Crossing(value, "found", message, (i - 1, i))


def located(scan: Scan, target_pf: float, seek: Seek) -> tuple[Crossing, float, float]:
    """Find the design value of a scan, and the ends of its interval.

    Values without pf are left out; where one of them lies next to the crossing, or pf there is
    doubtful, so is the design.
    """
    known = np.isfinite(scan.pf)
    if known.sum() < 2:
        why = next((note for note in scan.notes if note), "no answer")
        return Crossing(math.nan, "failed", why, (0, 0)), math.nan, math.nan
    where = np.flatnonzero(known)
    found = crossing(scan.values[known], scan.pf[known], target_pf, seek)
    ends = [
        crossing(scan.values[known], bound[known], target_pf, seek).value
        if np.isfinite(bound[known]).all()
        else math.nan
        for bound in (scan.low, scan.high)
    ]
    low, high = ends if seek == "smallest" else ends[::-1]
    if found.status == "found":
        first, last = (int(where[i]) for i in found.cell)
        notes = [note for note in scan.notes[first : last + 1] if note]
        if notes:
            message = "; ".join(dict.fromkeys([found.message, *notes])).removeprefix("; ")
            found = Crossing(found.value, "doubtful", message, found.cell)
        elif scan.unchecked:
            found = replace(found, status="unchecked")
    return found, low, high
