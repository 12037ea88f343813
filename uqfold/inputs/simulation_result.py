"""An answer in the form in which OpenTURNS has those of its own simulations."""

from __future__ import annotations

from typing import Any

from uqfold.checks import instance, refused
from uqfold.inputs.engine import openturns


def checked_event(event: Any) -> Any:
    """Return an event of OpenTURNS; None stands for one that is not known.

    Raises
    ------
    TypeError, ValueError
        If it is something else.
    """
    ot = openturns()
    if event is None:
        return ot.RandomVector()
    remedy = "give the openturns event that the problem was made of, or None"
    kinds = (ot.RandomVector, ot.UnionEvent, ot.IntersectionEvent)
    if not instance("event", event, kinds, remedy).isEvent():
        raise refused("event", event, remedy)
    return event


def simulation_result(
    event: Any, pf: float, std_error: float, runs: int, seconds: float, name: str
) -> Any:
    """Return an ``openturns.ProbabilitySimulationResult``, with blocks of one run."""
    made = openturns().ProbabilitySimulationResult(event, pf, std_error**2, runs, 1)
    made.setTimeDuration(seconds)
    made.setName(name)
    return made
