"""Two problems that differ in one individual input, run with the same random numbers."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from typing import TYPE_CHECKING, Any

from uqfold.analysis.paired import paired_differences
from uqfold.comparison.studies.grids import MISSIONS, NUMBERS, SEED, TAUS
from uqfold.comparison.studies.keys import COUNT, TEXT, Key, Kind, RowIdentity, list_of
from uqfold.comparison.studies.registry import StepContext
from uqfold.problems.criterion import criteria

if TYPE_CHECKING:
    import pandas as pd

COLUMNS: dict[str, type] = {
    "problem": str,
    "other": str,
    "threshold": float,
    "tau": float,
    "missions": str,
    "draws": int,
    "difference": float,
    "std_error": float,
    "n_evals": int,
    "seed": int,
}


def paired(settings: Mapping[str, Any], context: StepContext) -> pd.DataFrame:
    """Estimate by how much the first of two problems is the more reliable.

    Parameters
    ----------
    settings
        Values of the keys of `PAIRED`.
    context
        Problems and how models are run.

    Returns
    -------
    pandas.DataFrame
        One row per criterion; ``difference`` is R of the first problem less R of the other.

    Raises
    ------
    ValueError
        If there are not exactly two problems, or `paired_differences` can not compare them.
    """
    import pandas as pd

    names = settings["problem"]
    if len(names) != 2:
        raise ValueError(f"analysis paired: problem = {', '.join(names)}: give two problems")
    first, second = names
    found = paired_differences(
        context.problems[first],
        context.problems[second],
        criteria(settings["thresholds"], settings["tau"], settings["missions"]),
        settings["draws"],
        rng=settings["seed"],
        # nobody asks for these runs again
        evaluator=replace(context.evaluator(first), store=None),
    )
    frame = found.to_frame().assign(
        problem=first,
        other=second,
        draws=settings["draws"],
        n_evals=found.n_evals,
        seed=settings["seed"],
    )
    return pd.DataFrame(frame[list(COLUMNS)])


PAIRED = Kind(
    "paired",
    "Difference of R of two problems that differ in one individual input, by the same random "
    "numbers, along lines (`uqfold.analysis.paired_differences`).",
    (
        Key("problem", list_of(TEXT), "The two problems, by name."),
        Key("draws", COUNT, "Draws of the shared inputs, 52 runs each.", 2_000),
        Key("thresholds", NUMBERS, "Thresholds T."),
        Key("tau", TAUS, "Synchronization thresholds.", (None,)),
        Key("missions", MISSIONS, "Mission profiles.", (1,)),
        Key("seed", SEED, "Seed of the draws.", 0),
    ),
    paired,
    COLUMNS,
    RowIdentity(
        ("problem", "other", "threshold", "tau", "missions"),
        sample=("draws", "seed"),
        estimates={"difference": "std_error"},
        sampled=("n_evals",),
    ),
)
