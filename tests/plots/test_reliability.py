"""Curves over T: what is drawn are the numbers of the frame, of one problem or of two."""

import math
from typing import Any

import numpy as np
import pandas as pd
import pytest
from matplotlib.collections import LineCollection

import uqfold
from uqfold import plots
from uqfold.plots.wording import value_text

T = np.array([0.5, 0.55, 0.6])
PF = {"one": {"2": 0.5 * 10.0 ** -(40 * (T - 0.5)), "5": 0.9 * 10.0 ** -(40 * (T - 0.5))}}
PF["two"] = {m: pf / 3.0 for m, pf in PF["one"].items()}


def rows(label: str, thresholds: np.ndarray, error: float) -> pd.DataFrame:
    return pd.DataFrame(
        {
            "problem": problem, "label": label, "method": label, "threshold": t, "tau": math.nan,
            "missions": missions, "pf": value, "reliability": 1.0 - value, "std_error": error,
            "ci_low": value - 2 * error, "ci_high": value + 2 * error, "reference_pf": math.nan,
            "reference_std_error": math.nan, "error": math.nan,
        }
        for problem, curves in PF.items()
        for missions, pf in curves.items()
        for t, value in zip(T, pf, strict=True)
        if t in thresholds
    )  # fmt: skip


CURVES, MARKS = rows("ffni-spa", T, math.nan), rows("simulation", T[1:2], 0.001)
PARTS = ("reliability", "pf", "difference")


def draw(*frames: pd.DataFrame, parts: Any = PARTS, **options: Any) -> Any:
    chosen = {"curves": "missions", **options}
    return plots.reliability_panels(pd.concat(frames or (CURVES, MARKS)), parts, **chosen)


def curves(axes: Any) -> list[np.ndarray]:
    return [line.get_ydata() for line in axes.get_lines() if len(line.get_ydata()) == len(T)]


def legend(figure: Any) -> list[str]:
    return [text.get_text() for text in figure.legends[0].get_texts()]


def test_curves_are_those_of_both_problems() -> None:
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


def test_marks_carry_their_intervals_in_the_colour_of_their_problem() -> None:
    figure = draw()
    for axes, half in ((figure.axes[1], 0.002), (figure.axes[2], 2.0 * math.sqrt(2) * 1e-3)):
        bars = [np.ptp(c.get_segments()[0][:, 1]) for c in axes.collections if c.get_segments()]
        assert bars == pytest.approx([2 * half] * len(bars))
        assert len(bars) == (4 if axes is figure.axes[1] else 2)
    marks = [one for one in figure.axes[0].get_lines() if one.get_markerfacecolor() == "white"]
    drawn = [line for line in figure.axes[0].get_lines() if len(line.get_xdata()) == len(T)]
    assert [one.get_color() for one in marks] == [one.get_color() for one in drawn]
    assert len({one.get_color() for one in marks}) == 4


def test_legend_names_problems_curves_marks_and_arrows() -> None:
    texts = ["one", "two", "2 missions", "5 missions", "with its interval"]
    assert legend(draw()) == texts
    assert legend(draw(CURVES, parts=("pf",))) == texts[:4]
    none = MARKS.assign(pf=0.0, ci_low=0.0)
    assert legend(draw(CURVES, none))[-1] == "no failure: upper end"
    assert legend(draw(CURVES, none, parts=("reliability",)))[-1] == "with its interval"


@pytest.mark.parametrize("length", [1, 20, 32])
def test_legend_is_no_wider_than_the_figure(length: int) -> None:
    figure = draw(*(one.replace("one", "n" * length) for one in (CURVES, MARKS)))
    [legend] = figure.legends
    assert legend.get_window_extent().width <= figure.bbox.width
    # the figure grows with the legend, the panels stay as they are
    more = 0.17 * {1: 0, 20: 1, 32: 3}[length]
    assert figure.get_figheight() == pytest.approx(draw().get_figheight() + more)


def test_differences_that_are_given_take_the_place_of_the_curves() -> None:
    """Those with a standard error are marks with two of them, the others a curve."""
    given = pd.DataFrame(
        {"threshold": list(T) * 2, "missions": ["2"] * 3 + ["5"] * 3,
         "difference": np.arange(6.0), "std_error": [0.5] * 3 + [math.nan] * 3}
    )  # fmt: skip
    gap = draw(differences=given).axes[2]
    np.testing.assert_allclose(curves(gap)[-1], [3.0, 4.0, 5.0])
    (bars,) = [one.get_segments() for one in gap.collections]
    np.testing.assert_allclose([bar[:, 1] for bar in bars], [[-1, 1], [0, 2], [1, 3]])


def test_what_cannot_be_drawn_is_refused() -> None:
    one = CURVES[CURVES["problem"] == "one"]
    with pytest.raises(ValueError, match="a difference is that of two problems"):
        draw(one)
    with pytest.raises(ValueError, match="no row to draw"):
        draw(CURVES[:0])
    with pytest.raises(ValueError, match="a difference is that of two problems"):
        draw(CURVES, one.assign(problem="three"))
    with pytest.raises(ValueError, match="frame has no column 'missions'"):
        draw(CURVES.drop(columns="missions"))
    with pytest.raises(ValueError, match="quantities"):
        draw(parts=("pdf",))


@pytest.fixture(scope="module")
def frame() -> pd.DataFrame:
    grid = uqfold.criteria([-2, 0, 2, 4], [None, 16], [1, uqfold.Binomial(10, 0.5)])
    methods = {
        "ffni-pearson": uqfold.methods.FFNIPearson(check=False),
        "ffni-spa": uqfold.methods.FFNISaddlepoint(check=False),
        "mc": uqfold.methods.MonteCarlo(),
    }
    return uqfold.compare(uqfold.problems.series(), methods, grid, max_evals=40_000)


def plain(frame: pd.DataFrame, *labels: str) -> pd.DataFrame:
    return frame[frame["label"].isin(labels) & frame["tau"].isna() & (frame["missions"] == "1")]


def test_curve_and_reference_of_a_comparison(frame: pd.DataFrame) -> None:
    own = plain(frame, "ffni-spa")
    axes = plots.reliability_panels(own, ["pf"]).axes[0]
    drawn = {line.get_linestyle(): line for line in axes.get_lines()}
    assert list(drawn["-"].get_xdata()) == list(own["threshold"])
    np.testing.assert_allclose(drawn["-"].get_ydata(), own["pf"])
    np.testing.assert_allclose(drawn["--"].get_ydata(), own["reference_pf"])
    low, high = axes.get_ylim()
    assert low < own["pf"].min() < own["pf"].max() < high
    assert axes.get_xlabel() == "threshold T on Y"


def test_estimates_that_nobody_calls_a_check_have_their_intervals(frame: pd.DataFrame) -> None:
    own = plain(frame, "mc")
    axes = plots.reliability_panels(own, ["pf"]).axes[0]
    (bars,) = [one for one in axes.collections if isinstance(one, LineCollection)]
    ends = np.array([segment[:, 1] for segment in bars.get_segments()])
    np.testing.assert_allclose(ends, own[["ci_low", "ci_high"]])


def test_one_panel_per_value_and_one_scale(frame: pd.DataFrame) -> None:
    own = frame[frame["label"] == "ffni-pearson"]
    axes = plots.reliability_panels(own, ["pf"], curves="tau", panels="missions").axes
    assert [one.get_title() for one in axes] == ["1 mission", "missions ~ binomial(10, 0.5)"]
    assert len({one.get_ylim() for one in axes}) == 1


def test_errors_that_the_reference_cannot_judge_are_hollow(frame: pd.DataFrame) -> None:
    own = plain(frame, "ffni-spa").copy()
    # a reference with an error of its own, larger than that of two of four estimates
    own["reference_std_error"] = np.where(own["threshold"] < 1.0, own["reference_pf"], 0.0)
    (axes,) = plots.reliability_panels(own, ["error"]).axes
    marked = [one for one in axes.get_lines() if one.get_marker() == "o"]
    sizes = {str(line.get_markerfacecolor()): len(line.get_xdata()) for line in marked}
    assert sizes["white"] == 2
    assert sum(sizes.values()) == 4
    # the smallest tick stands for all that are smaller
    assert [axes.yaxis.get_major_formatter()(one, 0) for one in (1e-4, 0.01)] == ["≤ 0.01 %", "1 %"]
    axes.figure.canvas.draw()


@pytest.mark.parametrize(
    ("column", "value", "text"),
    [
        ("missions", "5", "5 missions"),
        ("missions", "binomial(10, 0.7)", "missions ~ binomial(10, 0.7)"),
        ("tau", 0.04, "tau = 0.04 s"),
        ("tau", None, "no tau"),
        ("units", 4, "4 units"),
        ("label", "mc", "mc"),
    ],
)
def test_values_in_words(column: str, value: object, text: str) -> None:
    assert value_text(column, value, "s") == text
