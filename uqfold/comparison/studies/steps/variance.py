"""Sobol' indices of the response."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

from uqfold.analysis.sobol import PICK_FREEZE, chaos_sobol, pick_freeze
from uqfold.comparison.studies.grids import SEED
from uqfold.comparison.studies.keys import COUNT, TEXT, Key, Kind, RowIdentity
from uqfold.comparison.studies.registry import StepContext
from uqfold.methods.polynomial_chaos import PolynomialChaos

if TYPE_CHECKING:
    import pandas as pd

COLUMNS: dict[str, type] = {
    "problem": str,
    "label": str,
    "input": str,
    "shared": str,
    "order": str,
    "index": float,
    "std_error": float,
    "ci_low": float,
    "ci_high": float,
    "error_kind": str,
    "response_mean": float,
    "response_std": float,
    "n_evals": int,
    "seed": int,
}


def sobol(settings: Mapping[str, Any], context: StepContext) -> pd.DataFrame:
    """Estimate the Sobol' indices of one problem's response.

    Parameters
    ----------
    settings
        Values of the keys of `SOBOL`.
    context
        Problems, methods and how models are run.

    Returns
    -------
    pandas.DataFrame
        One row per input and order.

    Raises
    ------
    TypeError
        If the method is no polynomial chaos expansion.
    """
    import pandas as pd

    name, label, seed = settings["problem"], settings["method"], settings["seed"]
    problem, evaluator = context.problems[name], context.evaluator(name)
    if label is None:
        found = pick_freeze(
            problem, settings["samples"], settings["repetitions"], rng=seed, evaluator=evaluator
        )
    else:
        method = context.methods[label]
        if not isinstance(method, PolynomialChaos):
            raise TypeError(f"analysis sobol: {label} is {method.name}; use pce, or no method")
        found = chaos_sobol(problem, method, rng=seed, evaluator=evaluator)
    frame = found.to_frame().assign(
        problem=name,
        label=PICK_FREEZE if label is None else label,
        response_mean=found.mean,
        response_std=found.std,
        n_evals=found.n_evals,
        seed=seed,
    )
    frame["shared"] = frame["shared"].map(lambda shared: "yes" if shared else "no")
    return pd.DataFrame(frame[list(COLUMNS)])


SOBOL = Kind(
    "sobol",
    "Sobol' indices of the response: from a polynomial chaos expansion, or by pick-freeze sampling "
    "of the model itself.",
    (
        Key("problem", TEXT, "Name of the problem."),
        Key("method", TEXT, "Label of a pce method; without it, pick-freeze.", None),
        Key("samples", COUNT, "Pick-freeze: size of each sample, a power of two.", 1024),
        Key("repetitions", COUNT, "Pick-freeze: independent repetitions.", 8),
        Key("seed", SEED, "Seed.", 0),
    ),
    sobol,
    COLUMNS,
    RowIdentity(
        index=("problem", "label", "input", "order"),
        sample=("n_evals", "seed"),
        estimates={"index": "std_error"},
        sampled=("ci_low", "ci_high", "response_mean", "response_std"),
    ),
)
