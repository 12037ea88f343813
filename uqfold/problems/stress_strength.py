"""Redundant units under one stress: k out of n strengths must exceed it.

All units of a system are under the same stress S, exponential with mean 1; unit i has a strength
R_i of its own, exponential with a mean of lambda stresses. A unit works when S - R_i <= T, the
system when at least k of its n units do.

At T = 0 this is the multicomponent stress-strength model of Bhattacharyya and Johnson (1974), the
common ground of a large literature. The units that fail are those whose strengths are smallest, and
the (n - k + 1)-th smallest strength is a sum of independent exponential variables with the rates
n / lambda, (n - 1) / lambda, ..., k / lambda, so that ::

    pf = Pr{S > T + R_(n-k+1)} = exp(-T) prod_{j=k}^{n} j / (j + lambda),    T >= 0,

for instance 1/4 for one out of three and 2/5 for two out of four, both with lambda = 1. A further
unit in parallel divides pf by 1 + lambda / n only; were the stresses of the units independent, it
would always divide it by 1 + lambda.

Over m missions the stress is kept and strengths are drawn anew. With u = 1 - exp(-(s - T) / lambda)
for the failure of a unit under the stress s, and I_u, the regularised incomplete beta function, ::

    pf = lambda exp(-T) int_0^1 {1 - [1 - I_u(n - k + 1, k)]^m} (1 - u)^(lambda - 1) du,

a polynomial in u against the weight of Jacobi: the rule of Gauss that is used here is exact for it.

References
----------
Bhattacharyya GK, Johnson RA. Estimation of reliability in a multicomponent stress-strength model.
J. Am. Stat. Assoc. 69 (1974) 966-970.
"""

from __future__ import annotations

import math
from itertools import product

import numpy as np
from scipy.special import betainc, roots_jacobi

from uqfold.checks import real, whole
from uqfold.problems.base import Problem
from uqfold.problems.criterion import Criteria, Criterion
from uqfold.problems.reference import Reference, ReferenceTable
from uqfold.problems.structure import KOutOfN
from uqfold.typing import FloatArray

MOST_UNITS = 100
"""So many units, and missions of all units at most ten times this, have exact references."""

_THRESHOLDS = (0.0, 1.0, 3.0, 6.0)
_MISSIONS = (1, 3, 10)
_ROUNDING = 1e-12


def stress_strength(units: int = 4, works: int = 1, strength: float = 20.0) -> Problem:
    """Return units under one stress, of which some must withstand it.

    Parameters
    ----------
    units
        Number of units n, up to `MOST_UNITS`.
    works
        How many of them must work, k: 1 in parallel, n in series.
    strength
        Mean strength lambda, in mean stresses.

    Returns
    -------
    Problem
        Shared input S, individual input R; the response is the excess of stress S - R. References
        are exact to rounding.

    Raises
    ------
    ValueError, TypeError
        If `works` is not one of 1 to `units`, or `strength` is not positive.
    """
    from scipy.stats import expon

    units = whole("units", units, at_least=1, at_most=MOST_UNITS)
    works = whole("works", works, at_least=1, at_most=units)
    strength = real("strength", strength, above=0.0)
    name = f"stress-strength ({works} of {units}, {strength:g})"
    references = {}
    for threshold, missions in product(_THRESHOLDS, _MISSIONS):
        one = Criterion(threshold, missions=missions)
        pf = failure_probability(threshold, missions, units, works, strength)
        references[one] = Reference(one, pf, _ROUNDING * pf)
    return Problem(
        excess_of_stress,
        shared={"S": expon()},
        individual={"R": expon(scale=strength)},
        units=units,
        structure=KOutOfN(works),
        name="stress-strength" if (units, works, strength) == (4, 1, 20.0) else name,
        version=f"stress-strength-{units}-{works}-{strength!r}",
        response="excess of stress",
        default_criteria=Criteria(list(references)),
        references=ReferenceTable(
            problem=name,
            kind="integration",
            how="Rule of Gauss and Jacobi, exact for the polynomial that it integrates.",
            command="uqfold.problems.stress_strength",
            entries=references,
        ),
    )


def excess_of_stress(x: FloatArray) -> FloatArray:
    """Return S - R (n,) of X (n, 2): stress S and strength R."""
    return np.asarray(x[:, 0] - x[:, 1])


def failure_probability(
    threshold: float, missions: int, units: int, works: int, strength: float
) -> float:
    """Return pf for T >= 0: exact to rounding, as derived above."""
    degree = units * missions
    node, weight = roots_jacobi(degree // 2 + 1, strength - 1.0, 0.0)
    # from [-1, 1] to [0, 1], where the weight is (1 - u)^(lambda - 1)
    u, weight = 0.5 * (1.0 + node), weight * 0.5**strength
    one = betainc(units - works + 1, works, u)
    with np.errstate(divide="ignore"):
        fails = -np.expm1(missions * np.log1p(-one))
    return strength * math.exp(-threshold) * float(fails @ weight)
