"""Figures of analyses: everything asked for is drawn, where it belongs."""

import math
from typing import Any

import numpy as np
import pandas as pd
import pytest

import uqfold
from uqfold import plots
from uqfold.analysis import chaos_sobol, pick_freeze

SOBOL = pd.DataFrame(
    [
        (label, name, order, value, value - 0.02, value + 0.02)
        for label in ("pce", "pick-freeze")
        for name, value in (("a", 0.7), ("b", 0.2), ("c", 1e-9))
        for order in ("main", "total")
    ],
    columns=["label", "input", "order", "index", "ci_low", "ci_high"],
)
DERIVATIVES = pd.DataFrame(
    [
        (label, name, moment, t, t * sign, 0.1)
        for label in ("kriging", "mc")
        for name, sign in (("a", 1.0), ("b", -2.0))
        for moment in ("mean", "standard deviation")
        for t in (1.0, 2.0)
    ],
    columns=["label", "input", "moment", "threshold", "per_std", "per_std_error"],
)
FOUND = {
    "label": "kriging", "parameter": "threshold on y", "unit": "s", "threshold": math.nan,
    "tau": math.nan, "missions": "1", "seek": "smallest", "target_pf": 1e-3, "status": "found",
    "value": 0.5717, "low": 0.57166, "high": 0.57174, "value_pf": 0.00104, "value_ci_low": 0.0009,
    "value_ci_high": 0.0012, "safe_pf": 0.0007, "safe_ci_low": 0.0005, "safe_ci_high": 0.0009,
}  # fmt: skip
NOTHING = {
    name: math.nan if isinstance(value, float) else value for name, value in FOUND.items()
} | {"tau": 0.04, "missions": "5", "target_pf": 1e-3, "status": "met nowhere"}


def legend(axes: Any) -> list[str]:
    return [text.get_text() for text in axes.get_legend().get_texts()]


def test_sobol_indices_of_every_input_and_method() -> None:
    axes = plots.sobol(SOBOL)
    assert [tick.get_text() for tick in axes.get_yticklabels()] == ["a", "b", "c"]
    assert legend(axes) == ["pce", "pick-freeze", "main", "total"]
    # two methods, main and total, of which c is too small to be drawn
    assert [np.isfinite(line.get_xdata()).sum() for line in axes.lines] == [2] * 4
    assert axes.get_xlim()[0] > 0.0


def test_answers_of_an_analysis_are_drawn_as_they_are() -> None:
    """Their frames had to be joined, and labelled by hand."""
    problem = uqfold.problems.series()
    surface = uqfold.methods.PolynomialChaos(runs=15, max_degree=2)
    found = [chaos_sobol(problem, surface), pick_freeze(problem, samples=32)]
    axes = plots.sobol(found)
    assert legend(axes) == ["pce", "pick-freeze", "main", "total"]
    one = plots.sobol(found[1])
    assert legend(one) == ["pick-freeze", "main", "total"]
    drawn = {round(x, 12) for line in one.lines for x in line.get_xdata() if math.isfinite(x)}
    assert {round(row.index, 12) for row in found[1] if row.index > 1e-6} == drawn


def test_derivatives_method_beside_method() -> None:
    axes = plots.derivatives(DERIVATIVES[DERIVATIVES["threshold"] == 2.0])
    points = [line for line in axes.lines if len(line.get_xdata()) == 4]
    assert [sorted(line.get_xdata()) for line in points] == [[-4.0, -4.0, 2.0, 2.0]] * 2
    # side by side, not on top of each other
    assert np.ptp([line.get_ydata()[0] for line in points]) > 0.2
    assert legend(axes) == ["kriging", "mc"]


def test_designs_at_both_places_and_where_there_is_none() -> None:
    left, right = plots.design(pd.DataFrame([FOUND, NOTHING])).axes
    assert "met nowhere" in [text.get_text() for text in left.texts]
    drawn = {x for line in right.lines for x in line.get_xdata() if math.isfinite(x)}
    assert {0.00104, 0.0007, 1e-3} <= drawn
    assert left.get_xlabel() == "smallest threshold on y (s)"
    labels = [tick.get_text() for tick in left.get_yticklabels()]
    assert labels == ["1 mission", "tau = 0.04, 5 missions"]


def test_importance_with_and_without_the_common_cause() -> None:
    table = pd.DataFrame(
        {"unit": ["a", "b"] * 2, "threshold": [1.0, 1.0, 2.0, 2.0], "missions": "3",
         "risk_reduction_worth": [2.0, math.inf, 1.5, 4.0],
         "risk_reduction_worth_independent": [2.5, 1.1, 1.6, 9.0]}
    )  # fmt: skip
    axes = plots.importance(table, "risk_reduction_worth")
    assert [tick.get_text() for tick in axes.get_yticklabels()] == ["a", "b"]
    assert legend(axes) == [
        "T = 1, 3 missions", "T = 2, 3 missions", "causes shared", "as if independent",
    ]  # fmt: skip
    drawn = [line.get_xdata() for line in axes.lines]
    np.testing.assert_array_equal(drawn, [[2.0, math.nan], [2.5, 1.1], [1.5, 4.0], [1.6, 9.0]])


def test_panels_share_one_legend() -> None:
    axes = plots.derivatives(DERIVATIVES[DERIVATIVES["threshold"] == 2.0])
    plots.one_legend(axes.figure)
    assert axes.get_legend() is None
    (below,) = axes.figure.legends
    assert [text.get_text() for text in below.get_texts()] == ["kriging", "mc"]


@pytest.mark.parametrize(
    "axes", [plots.sobol(SOBOL), plots.derivatives(DERIVATIVES)], ids=["sobol", "derivatives"]
)
def test_figures_fit_a_column(axes: Any) -> None:
    width, height = axes.figure.get_size_inches()
    assert width <= 3.6
    assert height <= 9.0
