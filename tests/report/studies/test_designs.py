"""Figure and table of designs."""

import math

import pandas as pd

from uqfold.comparison.studies.steps.designs import COLUMNS
from uqfold.report.studies.registry import figure_kinds, table_kinds

FOUND = {
    "problem": "toy", "label": "kriging", "parameter": "threshold on y", "unit": "s",
    "threshold": math.nan, "tau": math.nan, "missions": "1", "seek": "smallest",
    "target_pf": 1e-3, "status": "found", "message": "", "value": 0.5717, "std_error": 2e-5,
    "low": 0.57166, "high": 0.57174, "safe": 0.57174, "n_evals": 100, "seed": 0,
    "verified_by": "mc", "verified_n_evals": 4000, "value_pf": 0.00104, "value_ci_low": 0.0009,
    "value_ci_high": 0.0012, "value_meets": "undecided", "safe_pf": 0.0007, "safe_ci_low": 0.0005,
    "safe_ci_high": 0.0009, "safe_meets": "yes", "agrees": "yes",
}  # fmt: skip
NOTHING = {
    **{name: math.nan for name, kind in COLUMNS.items() if kind is float},
    **{name: "" for name, kind in COLUMNS.items() if kind is str},
    "problem": "toy", "label": "kriging", "parameter": "threshold on y", "unit": "s", "tau": 0.04,
    "missions": "5", "seek": "smallest", "target_pf": 1e-3, "status": "met nowhere",
    "n_evals": 100, "seed": 0, "verified_n_evals": 0,
}  # fmt: skip
TABLES = {
    "problems": pd.DataFrame({"problem": ["toy"], "response": ["y"], "response_unit": ["s"]}),
    "designs": pd.DataFrame([FOUND, NOTHING], columns=list(COLUMNS)),
}
SETTINGS = {"table": ("designs",), "where": {}}


def test_values_intervals_and_verdicts() -> None:
    table = table_kinds()["designs"].call(SETTINGS, TABLES)
    assert table["threshold on y (s)"].tolist() == ["0.571700", "met nowhere"]
    assert table["interval, 95 %"].tolist() == ["0.571660 to 0.571740", "-"]
    assert table["at the safe value"][0] == "7.00e-4 (5.0e-4 to 9.0e-4): met"
    assert table["simulated pf at the value"][0].endswith("undecided")
    assert table["criterion"].tolist() == ["no τ, m = 1", "τ = 0.04 s, m = 5"]


def test_the_figure_shows_both_places_and_says_where_there_is_none() -> None:
    figure = figure_kinds()["designs"].call(SETTINGS, TABLES)
    left, right = figure.axes
    assert "met nowhere" in [text.get_text() for text in left.texts]
    drawn = {x for line in right.lines for x in line.get_xdata() if math.isfinite(x)}
    assert {0.00104, 0.0007, 1e-3} <= drawn
    assert left.get_xlabel() == "smallest threshold on y (s)"
