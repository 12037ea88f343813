"""Which unit matters: importance measures with the common cause in them, and without.

Given the shared inputs v, a system of independent units fails in one mission with F(f(v)), where
f_i(v) is the failure probability of unit i, and over its missions with Q(F). With F(1_i) and F(0_i)
where unit i surely fails and surely works,

    Birnbaum                  E_v[Q(F(1_i)) - Q(F(0_i))]
    Fussell and Vesely        E_v[Q(F) - Q(F(0_i))] / E_v[Q(F)]
    risk achievement worth    E_v[Q(F(1_i))] / E_v[Q(F)]
    risk reduction worth      E_v[Q(F)] / E_v[Q(F(0_i))]

Shared inputs keep their distribution: to make a unit perfect, or to take it out, says nothing about
the common cause. The same under independence puts E_v[f_i] in the place of f_i(v).

References
----------
van der Borst M, Schoonakker H. An overview of PSA importance measures. Reliab. Eng. Syst. Saf. 72
(2001) 241-245.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from uqfold.analysis.fitted_surface import SurfaceMethod, fit_surface
from uqfold.checks import refused
from uqfold.evaluation import Evaluator
from uqfold.methods.arguments import CriteriaLike, checked_criteria
from uqfold.methods.kriging import Kriging
from uqfold.methods.seeding import RandomSource
from uqfold.problems.base import Problem
from uqfold.problems.criterion import Criterion, Missions
from uqfold.system.conditional_unit import UnitResponse
from uqfold.system.missions import over_missions
from uqfold.system.structure import Diagram, SystemUnits, diagram
from uqfold.system.surface_layout import laid_out
from uqfold.system.synchronized import failure_of_units
from uqfold.time_limit import check_time
from uqfold.typing import FloatArray

if TYPE_CHECKING:
    import pandas as pd

_MEASURES = ("birnbaum", "fussell_vesely", "risk_achievement_worth", "risk_reduction_worth")


def importance_of_units(
    problem: Problem,
    criteria: CriteriaLike = None,
    method: SurfaceMethod | None = None,
    *,
    max_evals: int | None = None,
    rng: RandomSource = None,
    evaluator: Evaluator | None = None,
) -> pd.DataFrame:
    """Return how much each unit of a system matters, on a fitted surface.

    Parameters
    ----------
    problem
        Units in any structure; they may differ by their offsets.
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
        and missions; ``status`` and ``message`` of the surface's answer.

    Raises
    ------
    ValueError, TypeError
        For wrong arguments, for a criterion with tau, or where nothing is individual, so that no
        unit can fail alone.
    NoSurfaceError
        If the evaluations allow no surface.
    """
    import pandas as pd

    asked = checked_criteria(problem, criteria)
    with_tau = [one for one in asked if one.tau is not None]
    if with_tau:
        raise refused("criteria", with_tau[0], "under tau units matter together; give none")
    if problem.inputs.n_individual == 0:
        raise refused("problem", problem, "nothing is individual: its units fail together")
    fitted = fit_surface(
        problem, asked, Kriging() if method is None else method,
        max_evals=max_evals, rng=rng, evaluator=evaluator,
    )  # fmt: skip
    # a second mission, so that the shared inputs are laid out for a single unit too
    laid = [*asked, Criterion(asked[0].threshold, missions=2)]
    mean, inputs, units = fitted.surface.mean, problem.inputs, SystemUnits.of(problem)
    system = laid_out(mean, inputs.dimension, inputs.n_shared, units, laid)
    responses = system.responses(mean, noise=fitted.noise).whole[0]
    nodes = [UnitResponse([response], np.ones(1)) for response in responses]
    weights = system.weights / system.weights.sum()
    structure = diagram(problem.structure, problem.unit_names)
    rows = []
    for criterion, row in zip(asked, fitted.result, strict=True):
        fails, works = _of_units(nodes, units, criterion.threshold)
        alone = fails @ weights
        shared = _measures(structure, fails, works, weights, criterion.missions)
        apart = _measures(
            structure, alone[:, None], (works @ weights)[:, None], np.ones(1), criterion.missions
        )
        for i, name in enumerate(problem.unit_names):
            rows.append(
                {
                    "threshold": criterion.threshold,
                    "missions": str(criterion.missions),
                    "unit": name,
                    "pf_unit": alone[i],
                    **{key: values[i] for key, values in shared.items()},
                    **{f"{key}_independent": values[i] for key, values in apart.items()},
                    "status": row.status,
                    "message": row.message,
                }
            )
    return pd.DataFrame(rows)


def _of_units(
    nodes: Sequence[UnitResponse], units: SystemUnits, threshold: float
) -> tuple[FloatArray, FloatArray]:
    """How each unit fails and works at each shared node (n, K)."""
    pairs = [failure_of_units(node, units, np.array([threshold])) for node in nodes]
    index = np.zeros(units.count, dtype=int) if units.of_sorts is None else units.of_sorts
    fails, works = (np.concatenate(one, axis=1)[index] for one in zip(*pairs, strict=True))
    return fails, works


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
