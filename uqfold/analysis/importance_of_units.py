"""Which unit matters: importance measures with the common cause in them, and without.

Given the shared inputs v, a system of independent units fails in one mission with F(f(v)), where
f_i(v) is the failure probability of unit i, and over its missions with Q(F). With F(1_i) and F(0_i)
where unit i surely fails and surely works,

    Birnbaum                  E_v[Q(F(1_i)) - Q(F(0_i))]
    Fussell and Vesely        E_v[Q(F) - Q(F(0_i))] / E_v[Q(F)]
    risk achievement worth    E_v[Q(F(1_i))] / E_v[Q(F)]
    risk reduction worth      E_v[Q(F)] / E_v[Q(F(0_i))]

Shared inputs keep their distribution: to make a unit perfect, or to take it out, says nothing about
the common cause. The same under independence puts E_v[f_i] in the place of f_i(v). How
much of pf the shared inputs carry is told in two ways, by what independence leaves out of it and by
the part of the variance of "the system fails" that v alone explains,

    1 - pf_independent / pf    and    Var_v[Q(F)] / (pf (1 - pf)),

of which the latter is also the correlation between the failures of two systems under the same v.

References
----------
van der Borst M, Schoonakker H. An overview of PSA importance measures. Reliab. Eng. Syst. Saf. 72
(2001) 241-245.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from functools import partial
from typing import TYPE_CHECKING

import numpy as np

from uqfold.analysis.fitted_surface import SurfaceMethod
from uqfold.analysis.units_given_shared import correlation_of_failures, units_given_shared
from uqfold.evaluation import Evaluator
from uqfold.methods.arguments import CriteriaLike
from uqfold.methods.seeding import RandomSource
from uqfold.problems.base import Problem
from uqfold.problems.criterion import Missions
from uqfold.system.decision_diagram import Diagram, diagram
from uqfold.system.missions import over_missions
from uqfold.time_limit import check_time
from uqfold.typing import FloatArray

if TYPE_CHECKING:
    import pandas as pd

_MEASURES = ("birnbaum", "fussell_vesely", "risk_achievement_worth", "risk_reduction_worth")
_WITH_ERRORS = ("pf_unit", *_MEASURES, "shared_share", "shared_correlation")


def importance_of_units(
    problem: Problem,
    criteria: CriteriaLike = None,
    method: SurfaceMethod | None = None,
    *,
    max_evals: int | None = None,
    rng: RandomSource = None,
    evaluator: Evaluator | None = None,
) -> pd.DataFrame:
    """Return how much each unit of a system matters, on a fitted surface of each kind.

    Parameters
    ----------
    problem
        Units in any structure; they may differ, but each needs an individual input.
    criteria
        What "works" means, without tau; None takes the problem's own default criteria.
    method
        `Kriging` (None: with its default settings) or `PolynomialChaos`.
    max_evals, rng, evaluator
        As in `ReliabilityMethod.estimate`.

    Returns
    -------
    pandas.DataFrame
        One row per criterion and unit: ``threshold``, ``missions``, ``unit``; ``pf_unit``, of that
        unit alone in one mission; ``pf`` of the system, ``birnbaum``, ``fussell_vesely``,
        ``risk_achievement_worth`` and ``risk_reduction_worth`` (inf where the others cannot fail
        the system); the last five again with ``_independent``, as if nothing were shared by units
        and missions; ``shared_share``, 1 - ``pf_independent`` / ``pf``, and ``shared_correlation``
        of the failures of two systems with the same shared inputs; ``std_error``, ``status`` and
        ``message`` of the surface's answer for pf; and standard errors of ``pf_unit``, the four
        measures and the two last as ``pf_unit_error``, ``birnbaum_error`` and so on, NaN where none
        is stated of pf. Those with ``_independent`` have none of their own.

    Raises
    ------
    ValueError, TypeError
        For wrong arguments, for a criterion with tau, or where a unit has no individual input, so
        that it cannot fail alone.
    NoSurfaceError
        If the evaluations allow no surface.
    """
    import pandas as pd

    found = units_given_shared(
        problem, criteria, method, max_evals=max_evals, rng=rng, evaluator=evaluator
    )
    structure = diagram(problem.structure, problem.unit_names)
    rows = []
    for given in found:
        weights, missions = given.weights, given.criterion.missions
        numbers = partial(_columns, structure, weights=weights, missions=missions)
        columns = numbers(given.fails, given.works)
        table = partial(_with_errors, numbers)
        errors = dict(zip(_WITH_ERRORS, given.error(table), strict=True))
        for i, name in enumerate(problem.unit_names):
            rows.append(
                {
                    "threshold": given.criterion.threshold,
                    "missions": str(missions),
                    "unit": name,
                    **{key: values[i] for key, values in columns.items()},
                    **{f"{key}_error": values[i] for key, values in errors.items()},
                    "std_error": given.answer.std_error,
                    "status": given.answer.status,
                    "message": given.answer.message,
                }
            )
    return pd.DataFrame(rows)


def _columns(
    structure: Diagram,
    fails: FloatArray,
    works: FloatArray,
    weights: FloatArray,
    missions: Missions,
) -> dict[str, FloatArray]:
    """All numbers (n,) of units that fail and work with these probabilities (n, K)."""
    alone, at_work = (one @ weights for one in (fails, works))
    shared = _measures(structure, fails, works, weights, missions)
    whole = over_missions(*structure.probabilities(fails, works), missions)[0]
    apart = _measures(structure, alone[:, None], at_work[:, None], np.ones(1), missions)
    with np.errstate(divide="ignore", invalid="ignore"):
        share = 1.0 - apart["pf"] / shared["pf"]
    return {
        "pf_unit": alone,
        **shared,
        **{f"{key}_independent": values for key, values in apart.items()},
        "shared_share": np.where(shared["pf"] > 0.0, share, math.nan),
        "shared_correlation": np.full(len(fails), correlation_of_failures(whole, whole, weights)),
    }


def _with_errors(
    numbers: Callable[[FloatArray, FloatArray], dict[str, FloatArray]],
    fails: FloatArray,
    works: FloatArray,
) -> FloatArray:
    """Return those numbers that have errors, one column in each row."""
    found = numbers(fails, works)
    return np.array([found[name] for name in _WITH_ERRORS])


def _measures(
    structure: Diagram,
    fails: FloatArray,
    works: FloatArray,
    weights: FloatArray,
    missions: Missions,
) -> dict[str, FloatArray]:
    """The measures (n,) of all units that fail and work with these probabilities (n, K)."""

    def failure(unit: int | None, fate: float) -> FloatArray:
        check_time()
        f, w = fails.copy(), works.copy()
        if unit is not None:
            f[unit], w[unit] = fate, 1.0 - fate
        return over_missions(*structure.probabilities(f, w), missions)[0]

    whole = failure(None, 0.0)
    broken, perfect = (
        np.stack([failure(unit, fate) for unit in range(len(fails))]) for fate in (1.0, 0.0)
    )
    pf = float(whole @ weights)
    with np.errstate(divide="ignore", invalid="ignore"):
        measures = (
            (broken - perfect) @ weights,
            (whole - perfect) @ weights / pf,
            broken @ weights / pf,
            pf / (perfect @ weights),
        )
    return {"pf": np.full(len(fails), pf), **dict(zip(_MEASURES, measures, strict=True))}
