"""What it costs to take units for independent: correlated against independent, for n units.

Correlated: the shared inputs are one draw for all units and missions. Independent: every response
is drawn from the marginal H-bar = E_v H, over units and missions alike. Both come from the very
same conditional distributions H, so that the inequality between them (Jensen) holds exactly.

Beside it the same from sampling the model, without any distribution being fitted, where no
synchronization is asked for and the number of missions is fixed.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from uqfold.checks import or_none, refused, several, whole
from uqfold.evaluation import Evaluator
from uqfold.methods.arguments import (
    CriteriaLike,
    checked_criteria,
    checked_evaluator,
    checked_problem,
)
from uqfold.methods.base import ReliabilityMethod, checked_method
from uqfold.methods.factorial_design import FFNIDetails
from uqfold.methods.ffni_saddlepoint import FFNISaddlepoint
from uqfold.methods.seeding import RandomSource, block_generator, reduced_seed
from uqfold.problems.base import Problem
from uqfold.problems.criterion import Binomial, Criterion
from uqfold.problems.structure import Series
from uqfold.system.conditional import independent_failures, system_failures
from uqfold.system.sampled_dependence import sampled_dependence
from uqfold.typing import FloatArray

if TYPE_CHECKING:
    import pandas as pd


def independence(
    problem: Problem,
    units: Sequence[int],
    criteria: CriteriaLike = None,
    method: ReliabilityMethod | None = None,
    *,
    draws: int | None = None,
    per_draw: int = 16,
    rng: RandomSource = 0,
    evaluator: Evaluator | None = None,
) -> pd.DataFrame:
    """Failure probability of n units, correlated through their shared inputs and independent.

    Parameters
    ----------
    problem
        Model and inputs of exchangeable units in series; their number does not matter.
    units
        Numbers of units n, each at least 1.
    criteria
        Thresholds, synchronization thresholds and missions; None takes those of the problem.
    method
        A method of the FFNI family; None takes `FFNISaddlepoint`.
    draws
        Draws of the shared inputs at which the model itself is sampled; None samples nothing.
    per_draw
        Responses sampled at each draw; where units times missions are more, sampling says nothing.
    rng, evaluator
        As in `ReliabilityMethod.estimate`; the seed is that of the sampling.

    Returns
    -------
    pandas.DataFrame
        One row per number of units and criterion: ``units``, ``threshold``, ``tau`` (NaN where
        there is none), ``missions``, ``pf``, ``pf_independent`` and ``difference``, which is
        ``pf_independent`` - ``pf`` = R - R_independent; ``sampled_responses``,
        ``sampled_difference`` and ``sampled_std_error`` (NaN without samples).

    Raises
    ------
    TypeError
        If the method gives no conditional distributions.
    ValueError
        If an argument is out of range.
    """
    import pandas as pd

    checked_problem(problem)
    if not (problem.exchangeable and isinstance(problem.structure, Series)):
        raise refused("problem", problem, "give exchangeable units in series")
    grid = checked_criteria(problem, criteria)
    numbers = several("units", units, whole, at_least=1)
    if not numbers:
        raise refused("units", units, "give one number of units or more")
    draws = or_none("draws", draws, whole, at_least=2)
    per_draw = whole("per_draw", per_draw, at_least=1)
    chosen = checked_method(method) or FFNISaddlepoint(check=False)
    opened = checked_evaluator(evaluator)
    seed = reduced_seed(rng)
    result = chosen.estimate(problem, grid, rng=0, evaluator=opened)
    details = result.details
    if not isinstance(details, FFNIDetails):
        reason = "; ".join(dict.fromkeys(row.message for row in result if row.message))
        raise TypeError(
            f"method = {chosen.name}: it gives no conditional distributions, give "
            f"uqfold.methods.FFNISaddlepoint() or FFNIPearson(){': ' + reason if reason else ''}"
        )
    sampled = None if draws is None else _sampled(problem, draws, per_draw, seed, opened)
    rows = []
    for number in numbers:
        correlated = system_failures(details.responses, details.weights, number, grid)
        apart = independent_failures(details.responses, details.weights, number, grid)
        for criterion, one, other in zip(grid, correlated, apart, strict=True):
            # from the side on which nothing cancels
            near = one.pf < 0.5
            rows.append(
                {
                    "units": number,
                    "threshold": criterion.threshold,
                    "tau": math.nan if criterion.tau is None else criterion.tau,
                    "missions": str(criterion.missions),
                    "pf": one.pf,
                    "pf_independent": other.pf,
                    "difference": other.pf - one.pf
                    if near
                    else one.reliability - other.reliability,
                    **_beside(sampled, criterion, number),
                }
            )
    return pd.DataFrame(rows)


def _sampled(
    problem: Problem, draws: int, per_draw: int, seed: int, evaluator: Evaluator
) -> FloatArray:
    """Evaluate the model at draws of the shared inputs: responses (draws, per_draw)."""
    inputs, stream = problem.inputs, block_generator(seed, 0)
    shared = stream.standard_normal((draws, inputs.n_shared))
    individual = stream.standard_normal((draws * per_draw, inputs.n_individual))
    u = np.column_stack([np.repeat(shared, per_draw, axis=0), individual])
    session = evaluator.open(problem, None)
    session.expected = len(u)
    return session.evaluate(inputs.from_standard_normal(u)).reshape(draws, per_draw)


def _beside(sampled: FloatArray | None, criterion: Criterion, units: int) -> dict[str, float]:
    """Size, difference and error of the sample for one criterion; NaN where it has none."""
    names = ("sampled_responses", "sampled_difference", "sampled_std_error")
    if sampled is None or criterion.tau is not None or isinstance(criterion.missions, Binomial):
        return dict.fromkeys(names, math.nan)
    count = units * criterion.missions
    if count > sampled.shape[1]:
        return dict.fromkeys(names, math.nan)
    found = sampled_dependence(sampled, [criterion.threshold], count)
    values = (sampled.size, found.difference[0], found.std_error[0])
    return dict(zip(names, map(float, values), strict=True))
