"""Events as OpenTURNS states them: a response, a distribution, and when it fails."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from uqfold.checks import instance, refused
from uqfold.inputs.engine import openturns
from uqfold.typing import FloatArray

_REMEDY = "give an openturns.ThresholdEvent, or a UnionEvent or IntersectionEvent of such"


@dataclass(frozen=True)
class Exceedance:
    """One threshold event as a response that fails above a threshold.

    Attributes
    ----------
    function
        An ``openturns.Function`` of one output.
    sign
        -1.0 where small outputs fail, otherwise 1.0.
    threshold
        The response sign * function(x) fails above it.
    """

    function: Any
    sign: float
    threshold: float

    def __call__(self, x: FloatArray) -> FloatArray:
        """Response (n,) at x (n, d)."""
        return self.sign * np.asarray(self.function(x), dtype=np.float64)[:, 0]


@dataclass(frozen=True)
class JoinedExceedances:
    """Several threshold events as one response that fails above zero.

    Attributes
    ----------
    parts
        The events.
    all_fail
        Whether all of them have to occur (an intersection), or any (a union).
    """

    parts: tuple[Exceedance, ...]
    all_fail: bool

    def __call__(self, x: FloatArray) -> FloatArray:
        """Margin (n,) at x (n, d)."""
        margins = np.array([part(x) - part.threshold for part in self.parts])
        joined: FloatArray = (np.min if self.all_fail else np.max)(margins, axis=0)
        return joined


def taken_apart(event: Any) -> tuple[Exceedance | JoinedExceedances, Any, float]:
    """Return response, distribution of the inputs, and threshold of an event of OpenTURNS.

    Raises
    ------
    TypeError, ValueError
        If it is not an event, or one of another kind.
    """
    ot = openturns()
    joined = (ot.UnionEvent, ot.IntersectionEvent)
    instance("event", event, (ot.ThresholdEvent, *joined), _REMEDY)
    members = event.getEventCollection() if isinstance(event, joined) else [event]
    parts = tuple(map(_exceedance, members))
    distribution = members[0].getAntecedent().getDistribution()
    if len(parts) == 1:
        return parts[0], distribution, parts[0].threshold
    return JoinedExceedances(parts, isinstance(event, ot.IntersectionEvent)), distribution, 0.0


def _exceedance(event: Any) -> Exceedance:
    try:
        operator, threshold = event.getOperator(), event.getThreshold()
        function = event.getFunction()
    except (RuntimeError, TypeError, NotImplementedError):
        raise refused("event", event, f"{_REMEDY}, none of them within another") from None
    above, below = operator.compare(1.0, 0.0), operator.compare(-1.0, 0.0)
    if above == below:
        raise refused("event", event, "compare by Less, LessOrEqual, Greater or GreaterOrEqual")
    sign = 1.0 if above else -1.0
    limit = sign * threshold
    at_limit = operator.compare(0.0, 0.0)
    return Exceedance(function, sign, float(np.nextafter(limit, -np.inf)) if at_limit else limit)
