"""How much an answer scatters because the model does: the same nodes, one input nudged.

The first impacts in the joints are chaotic, and every time step has its error, so that a deployment
time carries a scatter that no method sees. Here the same method answers several times with one
input of every run changed by a tiny relative amount; what its answers differ by is that scatter.
"""

from __future__ import annotations

import hashlib
import math
from collections.abc import Mapping
from copy import copy
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any

import numpy as np

from uqfold.comparison.studies.grids import MISSIONS, NUMBERS, TAUS
from uqfold.comparison.studies.keys import COUNT, TEXT, Key, Kind, RowIdentity, list_of
from uqfold.comparison.studies.registry import StepContext
from uqfold.problems.base import Problem
from uqfold.problems.criterion import criteria
from uqfold.typing import FloatArray, Model

if TYPE_CHECKING:
    import pandas as pd

COLUMNS: dict[str, type] = {
    "problem": str,
    "label": str,
    "relative": float,
    "threshold": float,
    "tau": float,
    "missions": str,
    "repeats": int,
    "pf": float,
    "pf_mean": float,
    "pf_std": float,
    "pf_low": float,
    "pf_high": float,
}


@dataclass(frozen=True)
class Nudged:
    """A model that sees one of its inputs changed by a tiny relative amount.

    The change is a standard-normal number made from the row itself and the seed, so that a row has
    one response, whatever batch it comes in.

    Attributes
    ----------
    model
        The model itself.
    column
        Which input.
    relative
        Standard deviation of the relative change.
    seed
        Another one gives other changes.
    """

    model: Model
    column: int
    relative: float
    seed: int

    def __call__(self, x: FloatArray) -> FloatArray:
        """Give the responses (n,) of X (n, d)."""
        from scipy.special import ndtri

        salt = self.seed.to_bytes(8, "little")
        digests = [hashlib.blake2b(row.tobytes(), digest_size=8, salt=salt) for row in x]
        numbers = [int.from_bytes(one.digest(), "little") for one in digests]
        nudged = np.array(x, dtype=np.float64)
        nudged[:, self.column] *= 1.0 + self.relative * ndtri((np.array(numbers) + 0.5) / 2.0**64)
        responses: FloatArray = self.model(nudged)
        return responses


def scatter(settings: Mapping[str, Any], context: StepContext) -> pd.DataFrame:
    """Give pf of a method, and how it scatters when one input is nudged.

    Parameters
    ----------
    settings
        Values of the keys of `SCATTER`.
    context
        Problems, methods and how models are run.

    Returns
    -------
    pandas.DataFrame
        One row per problem, nudge and criterion: pf of the method as it is; mean, standard
        deviation and extremes of its repeats.

    Raises
    ------
    ValueError
        If the problem has no such input, or there are fewer than two repeats.
    """
    import pandas as pd

    label, repeats = settings["method"], settings["repeats"]
    if repeats < 2:
        raise ValueError(f"analysis scatter: repeats = {repeats}: give at least 2")
    method = context.methods[label]
    grid = criteria(settings["thresholds"], settings["tau"], settings["missions"])
    rows = []
    for name in settings["problem"]:
        problem = context.problems[name]
        if settings["input"] not in problem.inputs.names:
            raise ValueError(
                f"analysis scatter: {name!r} has no input {settings['input']!r}, only "
                f"{', '.join(problem.inputs.names)}"
            )
        column = problem.inputs.names.index(settings["input"])
        plain = method.estimate(problem, grid, rng=0, evaluator=context.evaluator(name)).pf
        for relative in settings["relative"]:
            found = np.empty((repeats, len(grid)))
            for seed in range(repeats):
                # an evaluator each, so that all runs are counted; nobody asks for these runs again
                unstored = replace(context.evaluator(name), store=None)
                nudged = _nudged(problem, column, relative, seed)
                found[seed] = method.estimate(nudged, grid, rng=0, evaluator=unstored).pf
            for i, criterion in enumerate(grid):
                pf = found[:, i]
                rows.append(
                    (
                        name,
                        label,
                        relative,
                        criterion.threshold,
                        math.nan if criterion.tau is None else criterion.tau,
                        str(criterion.missions),
                        repeats,
                        float(plain[i]),
                        float(pf.mean()),
                        float(pf.std(ddof=1)),
                        float(pf.min()),
                        float(pf.max()),
                    )
                )
    return pd.DataFrame(rows, columns=list(COLUMNS))


def _nudged(problem: Problem, column: int, relative: float, seed: int) -> Problem:
    changed = copy(problem)
    object.__setattr__(changed, "model", Nudged(problem.model, column, relative, seed))
    return changed


SCATTER = Kind(
    "scatter",
    "What the answers of a method scatter by when one input of every run is nudged.",
    (
        Key("problem", list_of(TEXT), "Problems, by name."),
        Key("method", TEXT, "Method that answers."),
        Key("input", TEXT, "Input that is nudged."),
        Key("relative", NUMBERS, "Relative sizes of the nudge."),
        Key("repeats", COUNT, "How often, at least 2.", 20),
        Key("thresholds", NUMBERS, "Thresholds T."),
        Key("tau", TAUS, "Synchronization thresholds.", (None,)),
        Key("missions", MISSIONS, "Mission profiles.", (1,)),
    ),
    scatter,
    COLUMNS,
    RowIdentity(("problem", "label", "relative", "threshold", "tau", "missions")),
)
