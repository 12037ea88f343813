"""Which units fail together: pairs of units with a common cause.

Given the shared inputs v, units fail independently of each other with f_i(v), so that

    Pr{i and j fail} = E_v[f_i f_j],    against E_v[f_i] E_v[f_j] if nothing were shared.
"""

from __future__ import annotations

from functools import partial
from itertools import combinations
from typing import TYPE_CHECKING

import numpy as np

from uqfold.analysis.fitted_surface import SurfaceMethod
from uqfold.analysis.units_given_shared import correlation_of_failures, units_given_shared
from uqfold.checks import refused
from uqfold.evaluation import Evaluator
from uqfold.methods.arguments import CriteriaLike, checked_problem
from uqfold.methods.seeding import RandomSource
from uqfold.problems.base import Problem
from uqfold.typing import FloatArray

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
        shared; ``correlation`` of the two failures; standard errors of ``pf_both`` and of the
        correlation as ``pf_both_error`` and ``correlation_error``, NaN where none is stated of the
        system's pf; ``status`` and ``message`` of the surface's answer for the system.
    """
    import pandas as pd

    if checked_problem(problem).n_units == 1:
        raise refused("problem", problem, "it has a single unit, and no pair")
    found = units_given_shared(
        problem, criteria, method, max_evals=max_evals, rng=rng, evaluator=evaluator
    )
    rows = []
    for given in {one.criterion.threshold: one for one in found}.values():
        weights = given.weights
        table = partial(_of_pairs, weights=weights)
        alone = given.fails @ weights
        numbers, errors = table(given.fails, given.works), given.error(table)
        for pair, (i, j) in enumerate(combinations(range(len(alone)), 2)):
            rows.append(
                {
                    "threshold": given.criterion.threshold,
                    "unit": problem.unit_names[i],
                    "other": problem.unit_names[j],
                    "pf_unit": alone[i],
                    "pf_other": alone[j],
                    "pf_both": numbers[0, pair],
                    "pf_both_independent": alone[i] * alone[j],
                    "correlation": numbers[1, pair],
                    "pf_both_error": errors[0, pair],
                    "correlation_error": errors[1, pair],
                    "status": given.answer.status,
                    "message": given.answer.message,
                }
            )
    return pd.DataFrame(rows)


def _of_pairs(fails: FloatArray, _: FloatArray, weights: FloatArray) -> FloatArray:
    """How often both units of each pair fail, and the correlation of their failures (2, pairs)."""
    pairs = list(combinations(fails, 2))
    both = [float((first * second) @ weights) for first, second in pairs]
    return np.array([both, [correlation_of_failures(*one, weights) for one in pairs]])
