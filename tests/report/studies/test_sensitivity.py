"""Figures and tables of what matters: everything asked for is drawn, where it belongs."""

import math

import numpy as np
import pandas as pd
import pytest

from uqfold.comparison.studies.keys import Kind
from uqfold.report.studies.registry import figure_kinds, table_kinds

PROBLEMS = pd.DataFrame({"problem": ["toy"], "response": ["y"], "response_unit": ["s"]})
SOBOL = pd.DataFrame(
    [
        ("toy", label, name, order, value, 0.01, value - 0.02, value + 0.02)
        for label in ("pce", "pick-freeze")
        for name, value in (("a", 0.7), ("b", 0.2), ("c", 1e-9))
        for order in ("main", "total")
    ],
    columns=["problem", "label", "input", "order", "index", "std_error", "ci_low", "ci_high"],
)
DERIVATIVES = pd.DataFrame(
    [
        ("toy", label, name, moment, t, tau, "1", t * sign, 0.1)
        for label in ("kriging", "mc")
        for name, sign in (("a", 1.0), ("b", -2.0))
        for moment in ("mean", "standard deviation")
        for t in (1.0, 2.0)
        for tau in (math.nan, 0.5)
    ],
    columns=[
        "problem", "label", "input", "moment", "threshold", "tau", "missions", "per_std",
        "per_std_error",
    ],
)  # fmt: skip
TABLES = {"problems": PROBLEMS, "sobol": SOBOL, "derivatives": DERIVATIVES}


def made(kinds: dict[str, Kind], name: str, **settings: object) -> object:
    kind = kinds[name]
    defaults = {key.name: key.default for key in kind.keys}
    return kind.call({**defaults, **settings}, TABLES)


def legend(figure: object) -> list[str]:
    return [text.get_text() for text in figure.legends[0].get_texts()]  # type: ignore[attr-defined]


def test_sobol_indices_of_every_input_and_method() -> None:
    figure = made(figure_kinds(), "sobol", table=("sobol",))
    [axes] = figure.axes  # type: ignore[attr-defined]
    assert [tick.get_text() for tick in axes.get_yticklabels()] == ["a", "b", "c"]
    assert legend(figure) == ["pce", "pick-freeze", "main", "total"]
    # two methods, main and total, of which c is too small to be drawn
    assert [len(line.get_xdata()) for line in axes.lines] == [2] * 4
    assert axes.get_xlim()[0] > 0.0


def test_derivatives_method_beside_method() -> None:
    figure = made(
        figure_kinds(), "derivatives", table=("derivatives",), where={"threshold": 2.0},
        panels="tau",
    )  # fmt: skip
    titles = [axes.get_title() for axes in figure.axes]  # type: ignore[attr-defined]
    assert titles == ["no $\\tau$", "$\\tau$ = 0.5 s"]
    points = [line for line in figure.axes[0].lines if len(line.get_xdata()) == 4]  # type: ignore[attr-defined]
    assert [sorted(line.get_xdata()) for line in points] == [[-4.0, -4.0, 2.0, 2.0]] * 2
    # side by side, not on top of each other
    assert np.ptp([line.get_ydata()[0] for line in points]) > 0.2
    assert legend(figure) == ["kriging", "mc"]


def test_derivatives_over_the_threshold() -> None:
    figure = made(
        figure_kinds(), "derivative-curves", table=("derivatives",),
        where={"label": "kriging", "tau": "none"},
    )  # fmt: skip
    assert len(figure.axes) == 2  # type: ignore[attr-defined]
    assert legend(figure) == ["a", "b"]


def test_agreement_in_joint_standard_errors() -> None:
    table = made(
        table_kinds(), "agreement", table=("derivatives",), value="per_std", error="per_std_error",
        where={"threshold": 1.0, "tau": "none"},
    )  # fmt: skip
    assert isinstance(table, pd.DataFrame)
    assert table["kriging"].tolist() == ["1.00 ± 0.10"] * 2 + ["-2.00 ± 0.10"] * 2
    assert set(table["distance (joint std. errors)"]) == {"+0.0"}
    moved = DERIVATIVES.copy()
    moved.loc[moved["label"] == "mc", "per_std"] += 0.5
    kind = table_kinds()["agreement"]
    settings = {"table": ("d",), "where": {}, "value": "per_std", "error": "per_std_error"}
    apart = kind.call(settings, {"problems": PROBLEMS, "d": moved})
    assert set(apart["distance (joint std. errors)"]) == {"-3.5"}
    alone = kind.call(settings, {"problems": PROBLEMS, "d": moved[moved["label"] == "mc"]})
    assert set(alone["distance (joint std. errors)"]) == {"-"}


@pytest.mark.parametrize("name", ["sobol", "derivatives", "derivative-curves"])
def test_figures_fit_a_page(name: str) -> None:
    figure = made(figure_kinds(), name, table=("sobol" if name == "sobol" else "derivatives",))
    width, height = figure.get_size_inches()  # type: ignore[attr-defined]
    assert width <= 7.2
    assert height <= 9.0
