"""Events as OpenTURNS states them: a response, a distribution, and when it fails."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np

from uqfold.checks import instance, refused
from uqfold.inputs.engine import openturns
from uqfold.typing import FloatArray

_REMEDY = "give an openturns.ThresholdEvent, or a UnionEvent or IntersectionEvent made of such"


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
    """Several events as one response that fails above zero.

    Attributes
    ----------
    parts
        The events, which may be joined ones themselves.
    all_fail
        Whether all of them have to occur (an intersection), or any (a union).
    """

    parts: tuple[Exceedance | JoinedExceedances, ...]
    all_fail: bool
    threshold: ClassVar[float] = 0.0

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
    instance("event", event, (ot.RandomVector, ot.UnionEvent, ot.IntersectionEvent), _REMEDY)
    if not event.isEvent():
        raise refused("event", event, _REMEDY)
    response = _response(event)
    return response, event.getAntecedent().getDistribution(), response.threshold


def _response(event: Any) -> Exceedance | JoinedExceedances:
    kind = event.getImplementation() if isinstance(event, openturns().RandomVector) else event
    if not hasattr(kind, "getEventCollection"):
        return _exceedance(event)
    parts = tuple(map(_response, kind.getEventCollection()))
    return JoinedExceedances(parts, all_fail=isinstance(kind, openturns().IntersectionEvent))


def _exceedance(event: Any) -> Exceedance:
    try:
        operator, threshold = event.getOperator(), event.getThreshold()
        function = event.getFunction()
    except (RuntimeError, TypeError, NotImplementedError):
        raise refused("event", event, _REMEDY) from None
    above, below = operator.compare(1.0, 0.0), operator.compare(-1.0, 0.0)
    if above == below:
        raise refused("event", event, "compare by Less, LessOrEqual, Greater or GreaterOrEqual")
    sign = 1.0 if above else -1.0
    limit = sign * threshold + 0.0  # zero without a sign
    at_limit = operator.compare(0.0, 0.0)
    return Exceedance(function, sign, float(np.nextafter(limit, -np.inf)) if at_limit else limit)
