"""What it costs to take units for independent: correlated against independent, for n units.

Correlated: the shared inputs are one draw for all units and missions. Independent: every response
is drawn from the marginal H-bar = E_v H, over units and missions alike. Both come from the very
same conditional distributions H, so that the inequality between them (Jensen) holds exactly.

Beside it the same from sampling the model, without any distribution being fitted, where no
synchronization is asked for and the number of missions is fixed.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

import numpy as np

from uqfold.comparison.studies.grids import MISSIONS, NUMBERS, SEED, TAUS
from uqfold.comparison.studies.keys import COUNT, TEXT, Key, Kind, RowIdentity, list_of
from uqfold.comparison.studies.registry import StepContext
from uqfold.methods.factorial_design import FFNIDetails
from uqfold.methods.seeding import block_generator
from uqfold.problems.criterion import Binomial, Criterion, criteria
from uqfold.system.conditional import independent_failures, system_failures
from uqfold.system.sampled_dependence import sampled_dependence
from uqfold.typing import FloatArray

if TYPE_CHECKING:
    import pandas as pd

COLUMNS: dict[str, type] = {
    "problem": str,
    "label": str,
    "units": int,
    "threshold": float,
    "tau": float,
    "missions": str,
    "pf": float,
    "pf_independent": float,
    "difference": float,
    "sampled_responses": float,
    "sampled_difference": float,
    "sampled_std_error": float,
}


def independence(settings: Mapping[str, Any], context: StepContext) -> pd.DataFrame:
    """Give pf of n units, correlated and independent, and their difference.

    Parameters
    ----------
    settings
        Values of the keys of `INDEPENDENCE`.
    context
        Problems, methods and how models are run.

    Returns
    -------
    pandas.DataFrame
        One row per number of units and criterion; ``difference`` = ``pf_independent`` - ``pf``,
        which is R - R_independent.

    Raises
    ------
    TypeError
        If the method gives no conditional distributions.
    RuntimeError
        If the method has no answer.
    """
    import pandas as pd

    name, label = settings["problem"], settings["method"]
    grid = criteria(settings["thresholds"], settings["tau"], settings["missions"])
    result = context.methods[label].estimate(
        context.problems[name], grid, rng=0, evaluator=context.evaluator(name)
    )
    details = result.details
    if not isinstance(details, FFNIDetails):
        reason = "; ".join(dict.fromkeys(row.message for row in result if row.message))
        raise TypeError(
            f"analysis independence: {label} gives no conditional distributions (use ffni-spa or "
            f"ffni-pearson){': ' + reason if reason else ''}"
        )
    sampled = _sampled(settings, context)
    rows = []
    for units in settings["units"]:
        correlated = system_failures(details.responses, details.weights, units, grid)
        apart = independent_failures(details.responses, details.weights, units, grid)
        for criterion, one, other in zip(grid, correlated, apart, strict=True):
            rows.append(
                (
                    name,
                    label,
                    units,
                    criterion.threshold,
                    math.nan if criterion.tau is None else criterion.tau,
                    str(criterion.missions),
                    one.pf,
                    other.pf,
                    # from the side on which nothing cancels
                    other.pf - one.pf if one.pf < 0.5 else one.reliability - other.reliability,
                    *_beside(sampled, criterion, units),
                )
            )
    return pd.DataFrame(rows, columns=list(COLUMNS))


def _sampled(settings: Mapping[str, Any], context: StepContext) -> FloatArray | None:
    """Run the model at draws of the shared inputs: responses (N, K), or None if not asked for."""
    draws, per_draw = settings["sampled_draws"], settings["sampled_per_draw"]
    if draws is None:
        return None
    problem = context.problems[settings["problem"]]
    inputs, rng = problem.inputs, block_generator(settings["seed"], 0)
    shared = rng.standard_normal((draws, inputs.n_shared))
    individual = rng.standard_normal((draws * per_draw, inputs.n_individual))
    u = np.column_stack([np.repeat(shared, per_draw, axis=0), individual])
    session = context.evaluator(settings["problem"]).open(problem, None)
    session.expected = len(u)
    return session.evaluate(inputs.from_standard_normal(u)).reshape(draws, per_draw)


def _beside(
    sampled: FloatArray | None, criterion: Criterion, units: int
) -> tuple[float, float, float]:
    """Give size, difference and error of the sample for one criterion; NaN where it has none."""
    nothing = (math.nan,) * 3
    if sampled is None or criterion.tau is not None or isinstance(criterion.missions, Binomial):
        return nothing
    count = units * criterion.missions
    if count > sampled.shape[1]:
        return nothing
    found = sampled_dependence(sampled, [criterion.threshold], count)
    return float(sampled.size), float(found.difference[0]), float(found.std_error[0])


INDEPENDENCE = Kind(
    "independence",
    "Failure probability of n units, correlated through their shared inputs and taken for "
    "independent, from the same conditional distributions.",
    (
        Key("problem", TEXT, "Name of the problem."),
        Key("method", TEXT, "A method of the FFNI family."),
        Key("units", list_of(COUNT), "Numbers of units n."),
        Key("thresholds", NUMBERS, "Thresholds T."),
        Key("tau", TAUS, "Synchronization thresholds.", (None,)),
        Key("missions", MISSIONS, "Mission profiles.", (1,)),
        Key("sampled_draws", COUNT, "Draws of the shared inputs to sample the model at.", None),
        Key(
            "sampled_per_draw",
            COUNT,
            "Responses at each; where units times missions are more, sampling says nothing.",
            16,
        ),
        Key("seed", SEED, "Seed of the sampling.", 0),
    ),
    independence,
    COLUMNS,
    RowIdentity(
        ("problem", "label", "units", "threshold", "tau", "missions"),
        sample=("sampled_responses",),
        estimates={"sampled_difference": "sampled_std_error"},
    ),
)
