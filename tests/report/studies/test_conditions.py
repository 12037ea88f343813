"""The figure kind `conditions`: curves, marks and differences are those of the tables."""

import math
from typing import Any

import numpy as np
import pandas as pd
import pytest

from uqfold.report.studies.conditions import CONDITIONS
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


def draw(**changes: Any) -> Any:
    settings = {
        "table": ("curves", "marks"), "problems": ("one", "two"), "names": ("first", "second"),
        "where": {}, "curves": "missions", "check": "simulation",
        "parts": ("reliability", "pf", "difference"), "smallest_pf": 1e-6,
    }  # fmt: skip
    return CONDITIONS.call({**settings, **changes}, TABLES)


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
