"""Designs as a table, verified where that is asked for."""

import math

import pytest

from uqfold import criteria
from uqfold.analysis import design_input, design_thresholds, designs_to_frame
from uqfold.methods import FFNISaddlepoint, MonteCarlo, PolynomialChaos
from uqfold.problems import series

SURFACE, FFNI = PolynomialChaos(runs=30), FFNISaddlepoint()
SIMULATION = MonteCarlo(systems=2_000)


def test_designs_are_found_and_verified() -> None:
    profiles = [(None, 1), (None, 2)]
    designs = design_thresholds(
        series(), 1e-2, (0.0, 6.0), profiles, method=SURFACE, points=17, rng=1
    )
    frame = designs_to_frame(designs, SIMULATION, rng=2)
    assert frame["value"].tolist() == [one.value for one in designs]
    row = frame.iloc[0]
    assert (row["label"], row["status"], row["missions"]) == ("pce", "found", "1")
    assert (row["verified_by"], row["verified_n_evals"]) == ("mc", 16_000)
    assert row["agrees"] == "yes"
    assert row["value_ci_low"] < row["value_pf"] < row["value_ci_high"]
    assert math.isnan(row["threshold"])
    alone = designs_to_frame(designs)
    assert alone["verified_by"].tolist() == ["", ""]
    assert alone[["value_pf", "safe_pf"]].isna().all(axis=None)


def test_where_nothing_is_found_nothing_is_simulated() -> None:
    [hopeless] = design_thresholds(
        series(), 1e-9, (0.0, 1.0), [(None, 1)], method=FFNI, points=9, rng=0
    )
    frame = designs_to_frame([hopeless], SIMULATION)
    assert frame["status"].tolist() == ["met nowhere"]
    assert frame["verified_n_evals"].tolist() == [0]


def test_a_designed_input_names_its_threshold() -> None:
    design = design_input(
        series(), criteria(2.0)[0], 1e-2, "X2", (1.1, 1.4), method=FFNI, points=7, rng=1
    )
    frame = designs_to_frame([design])
    assert frame["parameter"].tolist() == ["mean of X2"]
    assert frame["threshold"].tolist() == [2.0]
    with pytest.raises(TypeError, match=r"designs\[0\]"):
        designs_to_frame(["mean of X2"])
