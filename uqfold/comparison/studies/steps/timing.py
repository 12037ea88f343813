"""How long a method takes, model runs included: the one table that no second run repeats."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import replace
from statistics import median
from typing import TYPE_CHECKING, Any

from uqfold.comparison.studies.grids import MISSIONS, NUMBERS, SEED, TAUS
from uqfold.comparison.studies.keys import COUNT, TEXT, Key, Kind, RowIdentity, list_of
from uqfold.comparison.studies.registry import StepContext
from uqfold.methods.result import NO_ANSWER
from uqfold.problems.criterion import criteria

if TYPE_CHECKING:
    import pandas as pd

COLUMNS: dict[str, type] = {
    "problem": str,
    "label": str,
    "max_evals": float,
    "n_evals": int,
    "seconds": float,
}


def timing(settings: Mapping[str, Any], context: StepContext) -> pd.DataFrame:
    """Time methods on a problem.

    Parameters
    ----------
    settings
        Values of the keys of `TIMING`.
    context
        Problems, methods and how models are run; nothing is taken from a store.

    Returns
    -------
    pandas.DataFrame
        One row per method and budget: median wall time (s) of the repetitions, NaN where it has
        no answer.
    """
    import pandas as pd

    name = settings["problem"]
    problem = context.problems[name]
    grid = criteria(settings["thresholds"], settings["tau"], settings["missions"])
    rows = []
    for label in settings["methods"]:
        for budget in settings["max_evals"]:
            seconds, n_evals = [], 0
            for repetition in range(settings["repetitions"]):
                result = context.methods[label].estimate(
                    problem, grid, max_evals=budget, rng=settings["seed"] + repetition,
                    evaluator=replace(context.evaluator(name), store=None),
                )  # fmt: skip
                n_evals = result.n_evals
                if any(row.status not in NO_ANSWER for row in result):
                    seconds.append(result.seconds)
            rows.append(
                (name, label, float(budget), n_evals, median(seconds) if seconds else math.nan)
            )
    return pd.DataFrame(rows, columns=list(COLUMNS))


TIMING = Kind(
    "timing",
    "Wall time of methods, the model's included; it depends on the machine and what else it does.",
    (
        Key("problem", TEXT, "Name of the problem."),
        Key("methods", list_of(TEXT), "Labels of the methods."),
        Key("thresholds", NUMBERS, "Thresholds T."),
        Key("tau", TAUS, "Synchronization thresholds.", (None,)),
        Key("missions", MISSIONS, "Mission profiles.", (1,)),
        Key("max_evals", list_of(COUNT), "Budgets."),
        Key("repetitions", COUNT, "Repetitions with further seeds; the median counts.", 3),
        Key("seed", SEED, "First seed.", 0),
    ),
    timing,
    COLUMNS,
    # two timings are never alike, so that none is compared
    RowIdentity(index=("problem", "label", "max_evals"), sample=("seconds",), sampled=("n_evals",)),
)
