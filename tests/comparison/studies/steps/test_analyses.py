"""Analyses of a study that ask what pf answers to: they hand on what the library finds."""

import math
from typing import Any

import pandas as pd
import pytest

from uqfold import Evaluator
from uqfold.analysis import (
    design_threshold,
    paired_differences,
    pick_freeze,
    score_derivatives,
    surface_derivatives,
)
from uqfold.comparison.studies.keys import Kind
from uqfold.comparison.studies.registry import StepContext, step_kinds
from uqfold.methods import FFNIPearson, Kriging, MonteCarlo, PolynomialChaos
from uqfold.problems import series
from uqfold.problems.criterion import criteria

METHODS = {
    "kriging": Kriging(runs=30),
    "pce": PolynomialChaos(runs=30),
    "mc": MonteCarlo(systems=2_000),
    "ffni": FFNIPearson(),
}
CONTEXT = StepContext({"series": series()}, METHODS, lambda name: Evaluator())


def run(kind: str, **settings: Any) -> pd.DataFrame:
    chosen: Kind = step_kinds()[kind]
    defaults = {key.name: key.default for key in chosen.keys}
    frame = chosen.call({**defaults, "problem": "series", **settings}, CONTEXT)
    assert list(frame.columns) == list(chosen.columns)
    assert not frame.duplicated(list(chosen.identity.index)).any()
    assert set(chosen.identity.estimates) < set(chosen.columns)
    return frame


def test_derivatives_on_a_surface_and_by_simulation() -> None:
    grid = criteria(0.0)
    frame = run("derivatives", method="kriging", thresholds=(0.0,), seed=1)
    found = surface_derivatives(series(), grid, METHODS["kriging"], rng=1)
    assert frame["derivative"].tolist() == [row.derivative for row in found]
    assert frame["shared"].tolist() == ["yes", "no", "no"] * 2
    assert set(frame["n_evals"]) == {30}
    frame = run("derivatives", method="mc", thresholds=(0.0,), inputs=("X2",), seed=1)
    simulated = score_derivatives(series(), grid, 2_000, inputs=["X2"], rng=1)
    assert frame["per_std"].tolist() == [row.per_std for row in simulated]
    with pytest.raises(TypeError, match="ffni is ffni-pearson; use kriging or pce"):
        run("derivatives", method="ffni", thresholds=(0.0,))


def test_sobol_indices_of_both_kinds() -> None:
    frame = run("sobol", samples=32, repetitions=3, seed=1)
    found = pick_freeze(series(), 32, 3, rng=1)
    assert frame["index"].tolist() == [row.index for row in found]
    assert set(frame["label"]) == {"pick-freeze"}
    assert set(run("sobol", method="pce")["label"]) == {"pce"}
    with pytest.raises(TypeError, match="mc is mc; use pce"):
        run("sobol", method="mc")


def test_paired_differences_of_two_problems() -> None:
    small = series()
    pair = {"small": small, "large": small.with_moments(standard_deviations={"X3": 0.11})}
    context = StepContext(pair, {}, lambda name: Evaluator())
    kind = step_kinds()["paired"]
    settings = {
        "problem": ("small", "large"), "draws": 4, "thresholds": (4.0,), "tau": (None,),
        "missions": (2,), "seed": 1,
    }  # fmt: skip
    frame = kind.call(settings, context)
    found = paired_differences(pair["small"], pair["large"], criteria(4.0, None, 2), 4, rng=1)
    assert list(frame.columns) == list(kind.columns)
    assert frame["difference"].tolist() == [row.difference for row in found.rows]
    assert frame["n_evals"].tolist() == [4 * 52 + 2]
    assert (frame["difference"] > 0.0).all()
    with pytest.raises(ValueError, match="give two problems"):
        kind.call({**settings, "problem": ("small",)}, context)


def test_designs_are_found_and_verified() -> None:
    frame = run(
        "threshold-design", method="kriging", target_pf=(1e-2,), between=(0.0, 6.0),
        missions=(1, 2), points=17, verify="mc", seed=1,
    )  # fmt: skip
    single = design_threshold(
        series(), 1e-2, (0.0, 6.0), method=METHODS["kriging"], points=17, rng=1
    )
    row = frame.iloc[0]
    assert row["value"] == pytest.approx(single.value, rel=1e-9)
    assert row["status"] == "found"
    assert (row["verified_by"], row["verified_n_evals"]) == ("mc", 16_000)
    assert row["agrees"] == "yes"
    assert math.isnan(row["threshold"])
    hopeless = run(
        "threshold-design", method="kriging", target_pf=(1e-9,), between=(0.0, 1.0), points=9,
        verify="mc",
    )  # fmt: skip
    assert hopeless["status"].tolist() == ["met nowhere"]
    assert hopeless["verified_n_evals"].tolist() == [0]


def test_designs_of_an_input() -> None:
    frame = run(
        "input-design", method="kriging", target_pf=(1e-2,), between=(1.1, 1.4), input="X2",
        thresholds=(2.0,), points=7, seed=1,
    )  # fmt: skip
    assert frame["parameter"].tolist() == ["mean of X2"]
    assert 1.2 < frame["value"][0] < 1.3
    assert frame["verified_by"].tolist() == [""]
