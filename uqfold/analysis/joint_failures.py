"""Which units fail together: pairs of units with a common cause.

Given the shared inputs v, units fail independently of each other with f_i(v), so that

    Pr{i and j fail} = E_v[f_i f_j],    against E_v[f_i] E_v[f_j] if nothing were shared.
"""

from __future__ import annotations

from itertools import combinations
from typing import TYPE_CHECKING

from uqfold.analysis.fitted_surface import SurfaceMethod
from uqfold.analysis.units_given_shared import correlation_of_failures, units_given_shared
from uqfold.checks import refused
from uqfold.evaluation import Evaluator
from uqfold.methods.arguments import CriteriaLike, checked_problem
from uqfold.methods.seeding import RandomSource
from uqfold.problems.base import Problem

if TYPE_CHECKING:
    import pandas as pd


def joint_failures(
    problem: Problem,
    criteria: CriteriaLike = None,
    method: SurfaceMethod | None = None,
    *,
    max_evals: int | None = None,
    rng: RandomSource = None,
    evaluator: Evaluator | None = None,
) -> pd.DataFrame:
    """Return how often two units of a system fail in one mission, for all pairs.

    Parameters and errors as in `importance_of_units`; the structure does not matter here, and of
    missions only one is looked at.

    Returns
    -------
    pandas.DataFrame
        One row per threshold and pair: ``threshold``, ``unit`` and ``other``; ``pf_unit`` and
        ``pf_other`` of each alone; ``pf_both``, and ``pf_both_independent`` as if nothing were
        shared; ``correlation`` of the two failures; ``status`` and ``message`` of the surface's
        answer for the system. The numbers of pairs have no errors of their own.
    """
    import pandas as pd

    if checked_problem(problem).n_units == 1:
        raise refused("problem", problem, "it has a single unit, and no pair")
    found = units_given_shared(
        problem, criteria, method, max_evals=max_evals, rng=rng, evaluator=evaluator
    )
    rows = []
    for given in {one.criterion.threshold: one for one in found}.values():
        alone = given.fails @ given.weights
        for i, j in combinations(range(len(alone)), 2):
            first, second = given.fails[i], given.fails[j]
            rows.append(
                {
                    "threshold": given.criterion.threshold,
                    "unit": problem.unit_names[i],
                    "other": problem.unit_names[j],
                    "pf_unit": alone[i],
                    "pf_other": alone[j],
                    "pf_both": float((first * second) @ given.weights),
                    "pf_both_independent": alone[i] * alone[j],
                    "correlation": correlation_of_failures(first, second, given.weights),
                    "status": given.answer.status,
                    "message": given.answer.message,
                }
            )
    return pd.DataFrame(rows)
