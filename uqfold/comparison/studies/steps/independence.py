"""What it costs to take the units for independent: correlated against independent, for n units.

Correlated: the shared inputs are one draw for all units and missions. Independent: every response
is drawn from the marginal H-bar = E_v H, over units and missions alike. Both come from the very
same conditional distributions H, so that the inequality between them (Jensen) holds exactly.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

from uqfold.comparison.studies.grids import MISSIONS, NUMBERS, TAUS
from uqfold.comparison.studies.keys import COUNT, TEXT, Key, Kind, list_of
from uqfold.comparison.studies.registry import StepContext
from uqfold.methods.factorial_design import FFNIDetails
from uqfold.problems.criterion import criteria
from uqfold.system.conditional import independent_failures, system_failures

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
    responses = details.responses
    rows = []
    for units in settings["units"]:
        correlated = system_failures(responses, details.weights, units, grid)
        apart = independent_failures(responses, details.weights, units, grid)
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
                )
            )
    return pd.DataFrame(rows, columns=list(COLUMNS))


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
    ),
    independence,
    COLUMNS,
    ("problem", "label", "units", "threshold", "tau", "missions"),
)
