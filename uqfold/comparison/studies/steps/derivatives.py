"""Derivatives of pf by means and standard deviations of the inputs."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import fields
from typing import TYPE_CHECKING, Any, get_type_hints

from uqfold.analysis.derivatives_by_simulation import score_derivatives
from uqfold.analysis.derivatives_by_surface import surface_derivatives
from uqfold.analysis.pf_derivatives import PfDerivative
from uqfold.comparison.studies.grids import MISSIONS, NUMBERS, SEED, TAUS
from uqfold.comparison.studies.keys import TEXT, Key, Kind, RowIdentity, list_of
from uqfold.comparison.studies.registry import StepContext
from uqfold.methods.kriging import Kriging
from uqfold.methods.monte_carlo import WITHOUT_A_BUDGET, MonteCarlo
from uqfold.methods.polynomial_chaos import PolynomialChaos
from uqfold.problems.criterion import criteria

if TYPE_CHECKING:
    import pandas as pd

_NUMBERS = {float: float, int: int}
COLUMNS: dict[str, type] = {
    "problem": str,
    "label": str,
    **{
        field.name: _NUMBERS.get(get_type_hints(PfDerivative)[field.name], str)
        for field in fields(PfDerivative)
    },
    "n_evals": int,
    "seed": int,
}


def derivatives(settings: Mapping[str, Any], context: StepContext) -> pd.DataFrame:
    """Differentiate pf of one problem with one method.

    Parameters
    ----------
    settings
        Values of the keys of `DERIVATIVES`.
    context
        Problems, methods and how models are run.

    Returns
    -------
    pandas.DataFrame
        One row per criterion and parameter: the columns of `PfDerivative`, and the cost.

    Raises
    ------
    TypeError
        If the method can neither be differentiated on its surface nor by the score function.
    """
    import pandas as pd

    name, label = settings["problem"], settings["method"]
    problem, method = context.problems[name], context.methods[label]
    grid = criteria(settings["thresholds"], settings["tau"], settings["missions"])
    chosen = settings["inputs"] or None
    seed, evaluator = settings["seed"], context.evaluator(name)
    if isinstance(method, Kriging | PolynomialChaos):
        found = surface_derivatives(
            problem, grid, method, inputs=chosen, rng=seed, evaluator=evaluator
        )
    elif isinstance(method, MonteCarlo):
        found = score_derivatives(
            problem, grid, method.systems or WITHOUT_A_BUDGET,
            inputs=chosen, rng=seed, evaluator=evaluator,
        )  # fmt: skip
    else:
        raise TypeError(
            f"analysis derivatives: {label} is {method.name}; use kriging or pce (on the surface) "
            "or mc (score function)"
        )
    frame = found.to_frame()
    frame["shared"] = frame["shared"].map(lambda shared: "yes" if shared else "no")
    frame = frame.assign(problem=name, label=label, n_evals=found.n_evals, seed=seed)
    return pd.DataFrame(frame[list(COLUMNS)])


DERIVATIVES = Kind(
    "derivatives",
    "Derivatives of pf by means and standard deviations of the inputs, on the surface of kriging "
    "or pce, or by the score function on the systems of mc.",
    (
        Key("problem", TEXT, "Name of the problem."),
        Key("method", TEXT, "Label of a kriging, pce or mc method."),
        Key("thresholds", NUMBERS, "Thresholds T."),
        Key("tau", TAUS, "Synchronization thresholds.", (None,)),
        Key("missions", MISSIONS, "Mission profiles.", (1,)),
        Key("inputs", list_of(TEXT), "Inputs to differentiate by; all without it.", ()),
        Key("seed", SEED, "Seed.", 0),
    ),
    derivatives,
    COLUMNS,
    RowIdentity(
        index=("problem", "input", "moment", "threshold", "tau", "missions"),
        sample=("n_evals", "seed"),
        estimates={
            "derivative": "std_error",
            "per_std": "per_std_error",
            "elasticity": "elasticity_error",
        },
        sampled=("pf",),
    ),
)
