"""The figure kind `conditions`: curves, marks and differences are those of the tables."""

import math
from typing import Any

import numpy as np
import pandas as pd
import pytest

from uqfold.report.studies.conditions import COLORS, CONDITIONS
from uqfold.report.studies.selection import SelectionError

T = np.array([0.5, 0.55, 0.6])
PF = {"one": {"2": 0.5 * 10.0 ** -(40 * (T - 0.5)), "5": 0.9 * 10.0 ** -(40 * (T - 0.5))}}
PF["two"] = {m: pf / 3.0 for m, pf in PF["one"].items()}


def rows(label: str, thresholds: np.ndarray, error: float) -> pd.DataFrame:
    table = []
    for problem, curves in PF.items():
        for missions, pf in curves.items():
            for t, value in zip(T, pf, strict=True):
                if t in thresholds:
                    table.append(
                        {
                            "problem": problem, "label": label, "threshold": t, "tau": math.nan,
                            "missions": missions, "pf": value, "reliability": 1.0 - value,
                            "std_error": error, "ci_low": value - 2 * error,
                            "ci_high": value + 2 * error,
                        }
                    )  # fmt: skip
    return pd.DataFrame(table)


TABLES = {
    "curves": rows("ffni-spa", T, math.nan),
    "marks": rows("simulation", T[1:2], 0.001),
    "problems": pd.DataFrame(
        {"problem": ["one", "two"], "response": "deployment time", "response_unit": "s"}
    ),
}


def draw(tables: dict[str, pd.DataFrame] | None = None, **changes: Any) -> Any:
    settings = {
        "table": ("curves", "marks"), "problems": ("one", "two"), "names": ("first", "second"),
        "where": {}, "curves": "missions", "check": "simulation",
        "parts": ("reliability", "pf", "difference"), "smallest_pf": 1e-6,
        "paired": None,
    }  # fmt: skip
    return CONDITIONS.call({**settings, **changes}, {**TABLES, **(tables or {})})


def curves(axes: Any) -> list[np.ndarray]:
    return [line.get_ydata() for line in axes.get_lines() if len(line.get_ydata()) == len(T)]


def test_curves_are_those_of_both_conditions() -> None:
    body, tail, _ = draw().axes
    expected = [PF[problem][m] for problem in ("one", "two") for m in ("2", "5")]
    np.testing.assert_allclose(curves(tail), expected)
    np.testing.assert_allclose(curves(body), 1.0 - np.array(expected))
    assert tail.get_yscale() == "log"


def test_difference_is_first_less_second_reliability() -> None:
    gap = draw().axes[2]
    expected = [PF["two"][m] - PF["one"][m] for m in ("2", "5")]
    np.testing.assert_allclose(curves(gap), expected)
    assert max(np.concatenate(expected)) < 0.0
    assert "first less second" in gap.get_ylabel()


def test_marks_carry_their_intervals() -> None:
    figure = draw()
    for axes, half in ((figure.axes[1], 0.002), (figure.axes[2], 1.959964 * math.sqrt(2) * 1e-3)):
        bars = [np.ptp(c.get_segments()[0][:, 1]) for c in axes.collections if c.get_segments()]
        assert bars == pytest.approx([2 * half] * len(bars))
        assert len(bars) == (4 if axes is figure.axes[1] else 2)


def test_legend_names_conditions_curves_and_marks() -> None:
    texts = [text.get_text() for text in draw().legends[0].get_texts()]
    assert texts == ["first", "second", "$m$ = 2", "$m$ = 5", "simulation, 95 %"]
    alone = draw(table=("curves",), parts=("pf",)).legends[0].get_texts()
    assert [text.get_text() for text in alone] == texts[:-1]


def test_anything_but_two_conditions_is_refused() -> None:
    with pytest.raises(SelectionError, match="give two of each"):
        draw(problems=("one",))
    with pytest.raises(SelectionError, match="no row has"):
        draw(problems=("one", "three"))


@pytest.mark.parametrize("length", [1, 20, 32])
def test_legend_is_no_wider_than_the_figure(length: int) -> None:
    figure = draw(names=("n" * length, "second"))
    [legend] = figure.legends
    assert legend.get_window_extent().width <= figure.bbox.width
    rows = 5 if length == 32 else 3
    # the figure grows with the legend, the panels stay as they are
    assert figure.get_figheight() == pytest.approx(1.9 + 1.9 + 1.6 + 0.45 + 0.17 * rows + 0.1)


def test_marks_have_the_colour_of_their_condition() -> None:
    body = draw().axes[0]
    marks = [line for line in body.get_lines() if line.get_markerfacecolor() == "white"]
    edges = [line.get_markeredgecolor() for line in marks]
    assert edges == [COLORS[0]] * 2 + [COLORS[1]] * 2


def test_legend_explains_arrows_where_they_are_drawn() -> None:
    none = TABLES["marks"].assign(pf=0.0, ci_low=0.0)
    texts = [text.get_text() for text in draw({"marks": none}).legends[0].get_texts()]
    assert texts[-1] == "no failure: upper end"
    body = draw({"marks": none}, parts=("reliability",)).legends[0].get_texts()
    assert [text.get_text() for text in body] == texts[:-1]


def test_axis_of_T_leaves_out_where_nothing_happens() -> None:
    """Curves that rise from 0.58 to 0.6 do not share their panel with half a range of zeros."""
    T = np.round(np.arange(0.5, 0.7, 0.005), 4)
    parts = []
    for problem, shift in (("one", 0.0), ("two", 0.005)):
        pf = 1.0 / (1.0 + np.exp((T - 0.59 - shift) / 0.001))
        parts.append(
            TABLES["curves"]
            .iloc[[0] * T.size]
            .assign(problem=problem, threshold=T, pf=pf, reliability=1.0 - pf)
        )
    figure = draw({"curves": pd.concat(parts)}, table=("curves",))
    low, high = figure.axes[0].get_xlim()
    assert (low, high) == pytest.approx((0.58, 0.61), abs=0.0051)


def test_paired_runs_take_the_place_of_the_curves_difference() -> None:
    paired = pd.DataFrame(
        {"problem": "one", "other": "two", "threshold": list(T) * 2,
         "missions": ["2"] * 3 + ["5"] * 3, "difference": np.arange(6.0), "std_error": 0.5}
    )  # fmt: skip
    gap = draw({"pairs": paired}, paired="pairs").axes[2]
    np.testing.assert_allclose(curves(gap), [[0.0, 1.0, 2.0], [3.0, 4.0, 5.0]])
    band = gap.collections[0].get_paths()[0].vertices[:, 1]
    assert (band.min(), band.max()) == (-1.0, 3.0)
    assert not [line for line in gap.get_lines() if len(line.get_xdata()) == 1]
    with pytest.raises(SelectionError, match="paired = 'other'"):
        draw(paired="other")
