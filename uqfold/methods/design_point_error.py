"""The error of FORM, from a second look at its design points."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np

from uqfold.methods.design_point import Search, SecondLook
from uqfold.methods.result import NORMAL_95, Estimate
from uqfold.methods.standard_space import shown
from uqfold.problems.base import Problem
from uqfold.problems.criterion import Missions
from uqfold.system.linearised import linearised_failure
from uqfold.system.structure import SystemUnits

LEAST = 5e-3
"""Least change that is stated: a point is found within a tolerance, by rounded differences, and
what lies between the points looked at is not seen. With it none of 70 believed answers to random
problems with steps, kinks, noise and narrow bumps is three stated errors off, four with 1e-3; nor
is any of 290 believed ones, of 432, with a kink that begins 1.75 to 2.6 from the design point."""
CANCELLED = 0.25
"""Share of curvatures of opposite signs that is stated as an error, though they cancel."""


def with_error(
    estimate: Estimate,
    search: Search,
    look: SecondLook,
    problem: Problem,
    missions: Missions,
    target: float,
) -> Estimate:
    """Add to FORM's answer the error that the second look shows, and the verdict by it.

    In one unit curvatures of opposite signs cancel; in a system, where shared and individual inputs
    do different things, each counts. How units go together is also taken from where the search
    started, and the difference counts. What is
    wrong about one unit may be a cause that all of them have in common: in no structure is what is
    seen to be wrong smaller than it would be in series. FORM is believed up to the `target`, an
    error relative to the smaller probability.
    """
    from scipy.special import log_ndtr

    best = search.best
    beta = best.beta(search.threshold)
    log_small = float(log_ndtr(-abs(beta)))
    shared, shared_at_start = (
        min(1.0, float(np.sum(one.alpha[: problem.inputs.n_shared] ** 2)))
        for one in (best, search.start)
    )
    found = found_elsewhere(search)
    others = max(found, look.elsewhere)

    units = SystemUnits.of(problem)

    def distance(index: float, correlation: float, system: SystemUnits) -> float:
        """How far another answer is from FORM's, in the smaller of both probabilities."""
        if math.isnan(index):
            return 1.0
        first, other = (
            linearised_failure(*plane, system, missions)
            for plane in ((beta, shared), (index, correlation))
        )
        small = 0 if first[0] <= first[1] else 1
        return abs(other[small] - first[small])

    own = linearised_failure(beta, shared, units, missions)
    curved = look.curvature
    if problem.n_units == 1 and missions == 1:
        curved = min(curved, abs(math.log(look.second_order)) + CANCELLED * curved)
    curved = max(curved, look.sampled)
    total = LEAST + curved + look.place + others
    error = max(
        distance(index_moved(beta, sign * change), shared, system)
        for sign in (1.0, -1.0)
        for change, system in ((total, units), (total - LEAST, SystemUnits(units.count)))
    )
    error += distance(beta, shared_at_start, units)
    if error <= target * min(own) and estimate.status == "unchecked":
        half = NORMAL_95 * error
        return replace(
            estimate,
            std_error=error,
            ci_low=max(0.0, estimate.pf - half),
            ci_high=min(1.0, estimate.pf + half),
            ci_kind="second order",
            error_kind="surrogate",
            status="converged",
        )
    factor = look.second_order + found
    second = "no number"
    if math.log(factor) < -log_small:
        index = index_moved(beta, math.log(factor))
        second = f"{linearised_failure(index, shared, units, missions)[0]:.3g}"
    numbers = f"FORM gives pf = {estimate.pf:.3g}, second order {second}"
    if estimate.status == "doubtful":
        return replace(estimate, message=f"{numbers}; {estimate.message}")
    reasons = {
        "the limit state is curved": curved,
        "the limit state is not where its plane is": look.place,
        "there is a second domain of failure": others,
    }
    reason = max(reasons, key=lambda name: reasons[name])
    if total < 0.5 * target:
        reason = "the correlation of units is not the same everywhere"
    where = "; ".join(
        f"u = {shown(one.u)}, beta = {one.beta(search.threshold):.4g}"
        for one in (best, *(other for other, _ in search.others))
    )
    return replace(estimate, status="doubtful", message=f"{reason}: {numbers}: {where}")


def found_elsewhere(search: Search) -> float:
    """Probability behind other design points, as a share of that behind the best one."""
    from scipy.special import log_ndtr

    log_small = float(log_ndtr(-abs(search.best.beta(search.threshold))))
    return sum(
        factor * math.exp(float(log_ndtr(-abs(one.beta(search.threshold)))) - log_small)
        for one, factor in search.others
    )


def index_moved(beta: float, log_factor: float) -> float:
    """Return the index whose smaller probability is so many times that of beta."""
    from scipy.special import log_ndtr, ndtri_exp

    changed = float(log_ndtr(-abs(beta))) + log_factor
    return -math.copysign(1.0, beta) * float(ndtri_exp(min(changed, -1e-3)))
