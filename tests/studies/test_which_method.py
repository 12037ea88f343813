"""The summary of repeated runs against known answers."""

import math

import pandas as pd
import pytest

from tests.studies.test_studies import STUDIES, loaded

STUDY = loaded(STUDIES / "which-method")

ROW = {
    "problem": "series",
    "label": "mine",
    "max_evals": 1000.0,
    "tau": math.nan,
    "seed": 0,
    "pf": 0.05,
    "std_error": 0.01,
    "ci_low": 0.03,
    "ci_high": 0.07,
    "n_evals": 1000,
    "reference_pf": 0.05,
    "reference_std_error": 0.0,
}


def summary(*changes: dict[str, object]) -> dict[str, object]:
    frame = pd.DataFrame([{**ROW, **one} for one in changes])
    found = STUDY.summary(frame)
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
    found = summary({"pf": math.nan}, {"seed": 1})
    assert (found["answers"], found["runs"]) == (1, 2)
    nothing = summary({"pf": math.nan})
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


def test_the_upper_end_of_a_decade_belongs_to_it() -> None:
    edge = summary({"reference_pf": 0.1, "pf": 0.1, "tau": 3.0})
    assert (edge["decade"], edge["synchronized"]) == (-2, True)
