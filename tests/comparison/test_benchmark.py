"""The summary of repeated runs against known answers."""

import math

import numpy as np
import pandas as pd
import pytest

import uqfold
from uqfold.comparison.benchmark import NEEDS, benchmark_summary
from uqfold.methods import MonteCarlo

ROW = {
    "problem": "toy",
    "label": "mine",
    "max_evals": 1000.0,
    "threshold": 1.0,
    "tau": math.nan,
    "missions": "1",
    "seed": 0,
    "pf": 0.05,
    "std_error": 0.01,
    "ci_low": 0.03,
    "ci_high": 0.07,
    "status": "converged",
    "n_evals": 1000,
    "reference_pf": 0.05,
    "reference_std_error": 0.0,
}


def summary(*changes: dict[str, object]) -> dict[str, object]:
    frame = pd.DataFrame([{**ROW, **one} for one in changes])
    assert list(frame.columns) == list(NEEDS)
    found = benchmark_summary(frame, {"toy": 4})
    assert len(found) == 1
    return dict(found.iloc[0])


def test_numbers_by_hand() -> None:
    found = summary({"seed": 0, "pf": 0.04}, {"seed": 1, "pf": 0.08, "ci_low": 0.06})
    # relative errors -0.2 and 0.6
    assert found["bias"] == pytest.approx(0.2)
    assert found["bias_error"] == pytest.approx(0.8 / math.sqrt(2) / math.sqrt(2))
    assert found["rms"] == pytest.approx(math.sqrt((0.04 + 0.36) / 2))
    assert found["coverage"] == 0.5
    # errors of one and three stated standard errors
    assert found["error_ratio"] == pytest.approx(math.sqrt((1 + 9) / 2))
    # 250 systems of four units
    expected = math.sqrt(0.95 / (0.05 * 250))
    assert found["monte_carlo_rms"] == pytest.approx(expected)
    assert found["efficiency"] == pytest.approx(expected**2 / 0.2)
    assert (found["decade"], found["synchronized"]) == (-2, False)
    assert found["judged"]


def test_rows_without_answer_count_as_such() -> None:
    found = summary({"pf": math.nan, "status": "failed"}, {"seed": 1})
    assert (found["answers"], found["runs"]) == (1, 2)
    nothing = summary({"pf": math.nan, "status": "failed"})
    assert nothing["answers"] == 0
    assert math.isnan(nothing["rms"])
    assert not nothing["judged"]


def test_a_blurred_reference_does_not_judge() -> None:
    assert not summary({"pf": 0.051, "reference_std_error": 0.005})["judged"]
    assert summary({"pf": 0.07, "reference_std_error": 0.005})["judged"]


def test_methods_without_an_error_have_no_ratio() -> None:
    found = summary({"std_error": math.nan, "ci_low": math.nan, "ci_high": math.nan})
    assert math.isnan(found["coverage"])
    assert math.isnan(found["error_ratio"])


def test_decades_and_missions() -> None:
    edge = summary({"reference_pf": 0.1, "pf": 0.1, "tau": 3.0, "missions": "binomial(10, 0.5)"})
    assert (edge["decade"], edge["synchronized"]) == (-2, True)
    assert edge["monte_carlo_rms"] == pytest.approx(math.sqrt(0.9 / (0.1 * 1000 / 20)))


def test_monte_carlo_has_efficiency_one_and_honest_errors() -> None:
    problem = uqfold.problems.series()
    frames = [
        uqfold.compare(problem, {"mc": MonteCarlo()}, uqfold.criteria(0.0), max_evals=4_000, rng=s)
        for s in range(60)
    ]
    frame = pd.concat(frames).assign(max_evals=4_000.0)
    found = benchmark_summary(frame, {"series": 4}).iloc[0]
    # the relative error of a mean square of 60 is sqrt(2 / 60)
    assert abs(found["efficiency"] - 1.0) < 4.0 * math.sqrt(2 / 60)
    assert abs(found["error_ratio"] - 1.0) < 4.0 / math.sqrt(120)
    assert abs(found["bias"]) < 4.0 * found["bias_error"]
    assert found["coverage"] > 0.85
    # a method that claims half of its error is found out
    boast = frame.assign(std_error=frame["std_error"] / 2)
    assert benchmark_summary(boast, {"series": 4})["error_ratio"][0] > 1.6
    assert np.isclose(found["n_evals"], 4_000)
