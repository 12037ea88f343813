"""Designs for a target failure probability, verified by simulation of the real model."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any

from uqfold.analysis.design import Design
from uqfold.analysis.designed_input import design_input
from uqfold.analysis.designed_threshold import design_thresholds
from uqfold.analysis.verification import Verification, verify_all
from uqfold.comparison.studies.document import Place
from uqfold.comparison.studies.grids import MISSIONS, NUMBERS, SEED, TAUS
from uqfold.comparison.studies.keys import COUNT, TEXT, Key, Kind, RowIdentity, Value, choice
from uqfold.comparison.studies.registry import StepContext
from uqfold.problems.criterion import criteria

if TYPE_CHECKING:
    import pandas as pd

_PLACES = ("value", "safe")
"""Where a design is verified, if it is found."""

COLUMNS: dict[str, type] = {
    "problem": str,
    "label": str,
    "parameter": str,
    "unit": str,
    "threshold": float,
    "tau": float,
    "missions": str,
    "seek": str,
    "target_pf": float,
    "status": str,
    "message": str,
    "value": float,
    "std_error": float,
    "low": float,
    "high": float,
    "safe": float,
    "n_evals": int,
    "seed": int,
    "verified_by": str,
    "verified_n_evals": int,
    **{
        f"{place}_{name}": kind
        for place in _PLACES
        for name, kind in (("pf", float), ("ci_low", float), ("ci_high", float), ("meets", str))
    },
    "agrees": str,
}
_IDENTITY = RowIdentity(
    index=("problem", "parameter", "threshold", "tau", "missions", "target_pf"),
    sample=("n_evals", "seed", "verified_n_evals"),
    estimates={"value": "std_error"},
    sampled=(
        "low", "high", "safe",
        *(f"{place}_{name}" for place in _PLACES for name in ("pf", "ci_low", "ci_high")),
    ),
)  # fmt: skip


def threshold_designs(settings: Mapping[str, Any], context: StepContext) -> pd.DataFrame:
    """Find the smallest thresholds for a target: settings are the keys of `THRESHOLD_DESIGN`."""
    name = settings["problem"]
    profiles = [(tau, missions) for tau in settings["tau"] for missions in settings["missions"]]
    designs = [
        design
        for target in settings["target_pf"]
        for design in design_thresholds(
            context.problems[name], target, settings["between"], profiles,
            method=context.methods[settings["method"]], points=settings["points"],
            rng=settings["seed"], evaluator=context.evaluator(name),
        )
    ]  # fmt: skip
    return _table(settings, context, designs, threshold=False)


def input_designs(settings: Mapping[str, Any], context: StepContext) -> pd.DataFrame:
    """Find the value of an input for a target: settings are the keys of `INPUT_DESIGN`."""
    name = settings["problem"]
    designs = [
        design_input(
            context.problems[name], criterion, target, settings["input"], settings["between"],
            moment=settings["moment"], seek=settings["seek"], points=settings["points"],
            method=context.methods[settings["method"]],
            rng=settings["seed"], evaluator=context.evaluator(name),
        )
        for target in settings["target_pf"]
        for criterion in criteria(settings["thresholds"], settings["tau"], settings["missions"])
    ]  # fmt: skip
    return _table(settings, context, designs, threshold=True)


def _table(
    settings: Mapping[str, Any],
    context: StepContext,
    designs: Sequence[Design],
    *,
    threshold: bool,
) -> pd.DataFrame:
    import pandas as pd

    name, label = settings["problem"], settings["method"]
    places = [
        (i, place)
        for i, design in enumerate(designs)
        for place in _PLACES
        if math.isfinite(getattr(design, place))
    ]
    checks: dict[tuple[int, str], Verification] = {}
    if settings["verify"] is not None and places:
        found = verify_all(
            [(designs[i], getattr(designs[i], place)) for i, place in places],
            context.methods[settings["verify"]],
            rng=settings["seed"] + 1, evaluator=context.evaluator(name),
        )  # fmt: skip
        checks = dict(zip(places, found, strict=True))
    rows = []
    for i, design in enumerate(designs):
        own = {place: checks[i, place] for place in _PLACES if (i, place) in checks}
        row = {
            "problem": name,
            "label": label,
            "parameter": design.parameter,
            "unit": design.unit,
            "threshold": design.criterion.threshold if threshold else math.nan,
            "tau": math.nan if design.criterion.tau is None else design.criterion.tau,
            "missions": str(design.criterion.missions),
            "seek": design.seek,
            "target_pf": design.target_pf,
            "status": design.status,
            "message": design.message,
            "value": design.value,
            "std_error": (design.high - design.low) / (2.0 * 1.96),
            "low": design.low,
            "high": design.high,
            "safe": design.safe,
            "n_evals": design.n_evals,
            "seed": design.seed,
            "verified_by": next((one.method for one in own.values()), ""),
            "verified_n_evals": sum({one.n_evals for one in own.values()}),
            "agrees": "" if not own else "yes" if all(v.agrees for v in own.values()) else "no",
        }
        for place in _PLACES:
            check = own.get(place)
            for column in ("pf", "ci_low", "ci_high"):
                row[f"{place}_{column}"] = math.nan if check is None else getattr(check, column)
            row[f"{place}_meets"] = "" if check is None else check.meets
        rows.append(row)
    return pd.DataFrame(rows, columns=list(COLUMNS))


def _range(content: Any, place: Place) -> tuple[float, float]:
    values = NUMBERS.read(content, place)
    if len(values) != 2 or not values[0] < values[1]:
        raise place.error(f"{content!r}: give two numbers, the smaller one first")
    return values[0], values[1]


_ALIKE = (
    Key("problem", TEXT, "Name of the problem."),
    Key("method", TEXT, "Label of the method."),
    Key("target_pf", NUMBERS, "Failure probabilities to be met."),
    Key("between", Value("two numbers", _range), "Range to look at."),
    Key("tau", TAUS, "Synchronization thresholds.", (None,)),
    Key("missions", MISSIONS, "Mission profiles.", (1,)),
    Key("verify", TEXT, "Label of a simulation that verifies on the real model.", None),
    Key("seed", SEED, "Seed; verification has the next one.", 0),
)
THRESHOLD_DESIGN = Kind(
    "threshold-design",
    "Smallest thresholds T for which pf <= target, with the interval that the error of the method "
    "leaves.",
    (*_ALIKE, Key("points", COUNT, "Thresholds looked at.", 129)),
    threshold_designs,
    COLUMNS,
    _IDENTITY,
)
INPUT_DESIGN = Kind(
    "input-design",
    "Smallest or largest mean or standard deviation of an input for which pf <= target, with the "
    "interval that the error of the method leaves.",
    (
        *_ALIKE,
        Key("thresholds", NUMBERS, "Thresholds T."),
        Key("input", TEXT, "Name of the input."),
        Key("moment", choice("mean", "standard deviation"), "What is designed.", "mean"),
        Key(
            "seek", choice("smallest", "largest"), "Which end of what meets the target.", "smallest"
        ),
        Key("points", COUNT, "Values looked at; by the method without it.", None),
    ),
    input_designs,
    COLUMNS,
    _IDENTITY,
)
