"""FORM's answer for units that differ: one design point for each sort of them.

Each point gives a plane; what units share ties the planes together, see
`uqfold.system.linearised_units`. The errors that a second look shows at each point move all planes
at once, forth and back. In series the error of the system follows from them; where units stand in
for each other they fail together elsewhere than at their own points, and are looked at there, too;
where the planes miss too much, others are tried that touch the limit states there.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from uqfold.evaluation import BudgetExceededError
from uqfold.methods.design_point import Search
from uqfold.methods.design_point_error import LEAST, found_elsewhere, index_moved
from uqfold.methods.design_point_of_system import SystemLook, look_at_system, planes_at
from uqfold.methods.result import NORMAL_95, Estimate, Status
from uqfold.methods.standard_space import StandardSpaceResponse
from uqfold.problems.criterion import Missions
from uqfold.system.linearised_units import Planes, failure_of_planes
from uqfold.system.structure import SystemUnits
from uqfold.typing import FloatArray

MOST_BENT = 0.3
"""Change of a unit's probability, as a logarithm, from which its plane is not believed anywhere."""
_WORSE: tuple[Status, ...] = ("unchecked", "budget_exhausted", "doubtful", "failed")
"""Statuses of searches, the worse ones last."""


def estimate_of_units(
    responses: Sequence[StandardSpaceResponse],
    searches: Sequence[Search],
    verdicts: Sequence[tuple[Status, str]],
    n_shared: int,
    units: SystemUnits,
    missions: Missions,
    target: float,
) -> Estimate:
    """Answer one criterion from the searches of all sorts of units.

    Parameters
    ----------
    responses, searches
        Of each sort (J,), the search at its own threshold.
    verdicts
        Status and reason of each; the worst is that of the system.
    n_shared
        Number of shared inputs.
    units, missions
        The system.
    target
        Largest stated error, relative to the smaller probability, of one that is converged.
    """
    status, message = max(verdicts, key=lambda one: _WORSE.index(one[0]))
    if status == "failed":
        return Estimate.without_answer("failed", message)
    found = failure_of_planes(_planes(searches, n_shared), units, missions)
    estimate = Estimate(found.pf, found.reliability, status=status, message=message)
    if status != "unchecked" or any(one.look is None or one.cut for one in searches):
        return estimate

    def looked_at(searches: Sequence[Search]) -> tuple[Estimate, SystemLook]:
        look = look_at_system(responses, searches, n_shared, units, missions)
        return _with_error(searches, n_shared, units, missions, target, look.departure), look

    try:
        estimate, look = looked_at(searches)
        if estimate.status == "doubtful" and _too_much(look.departure, target):
            other, _ = looked_at(planes_at(responses, searches, look.centre))
            if other.status == "converged":
                return other
            message = (
                f"{estimate.message}; planes that touch limit states there give {other.pf:.3g}"
            )
            estimate = replace(estimate, message=message)
    except BudgetExceededError as problem:
        message = f"not looked at where the system fails: {problem}"
        return replace(estimate, status="budget_exhausted", message=message)
    return estimate


def _too_much(departure: float, target: float) -> bool:
    """Whether other planes might do, since these miss too much where the system fails."""
    return 0.5 * target < departure < math.inf


def _planes(searches: Sequence[Search], n_shared: int) -> Planes:
    betas = np.array([one.beta for one in searches])
    return Planes(betas, np.array([one.best.alpha[:n_shared] for one in searches]))


def _with_error(
    searches: Sequence[Search],
    n_shared: int,
    units: SystemUnits,
    missions: Missions,
    target: float,
    departure: float,
) -> Estimate:
    """Answer by the planes, with the error that all looks at them show, and the verdict by it."""
    planes = _planes(searches, n_shared)
    betas = planes.betas
    found = failure_of_planes(planes, units, missions)
    small = min(found.pf, found.reliability)

    def distance(other: Planes, system: SystemUnits) -> float:
        """How far another answer is from that of the planes, in the smaller probability."""
        pair = [failure_of_planes(one, system, missions) for one in (planes, other)]
        name = "pf" if pair[0].pf <= pair[0].reliability else "reliability"
        return float(abs(getattr(pair[1], name) - getattr(pair[0], name))) + pair[1].error

    bent = np.array([_bent(one) for one in searches])
    wrong = np.array([_elsewhere(one) for one in searches], dtype=float)
    # where the system fails the planes are looked at themselves, but for other domains of failure
    seen_there = units.diagram is not None and bent.max() < MOST_BENT
    if not seen_there:
        wrong += bent
    asked = [(wrong + LEAST, units)]
    if wrong.any():
        asked.append((wrong, replace(units, diagram=None)))
    error = departure * small + found.error
    error += max(
        distance(planes.with_betas(_moved(betas, sign * change)), system)
        for sign in (1.0, -1.0)
        for change, system in asked
    )
    if not seen_there:
        at_start = np.array([one.start.alpha[:n_shared] for one in searches])
        error += distance(replace(planes, shared=at_start), units)
    if error > target * small:
        reason = f"a limit state is not its plane, most at beta = {betas[bent.argmax()]:.4g}"
        if departure * small > 0.5 * error:
            reason = "the response is not that of the planes where the system fails"
        if math.isinf(departure):
            reason = "far out for shared inputs the system fails where by the planes it works"
        reason = f"{reason}: pf = {found.pf:.3g} may be {min(1.0, error):.2g} off"
        return Estimate(found.pf, found.reliability, status="doubtful", message=reason)
    return Estimate(
        found.pf,
        found.reliability,
        std_error=error,
        ci_low=max(0.0, found.pf - NORMAL_95 * error),
        ci_high=min(1.0, found.pf + NORMAL_95 * error),
        ci_kind="second order",
        error_kind="surrogate",
        status="converged",
    )


def _bent(search: Search) -> float:
    """By how much a unit's limit state changes its smaller probability, as a logarithm."""
    look = search.look
    return math.inf if look is None else max(look.curvature, look.sampled) + look.place


def _elsewhere(search: Search) -> float:
    """By how much other domains of failure may change it."""
    return 0.0 if search.look is None else max(found_elsewhere(search), search.look.elsewhere)


def _moved(betas: FloatArray, changes: FloatArray) -> FloatArray:
    return np.array([index_moved(*one) for one in zip(betas, changes, strict=True)])
