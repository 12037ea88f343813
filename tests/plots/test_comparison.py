"""The figure of a comparison, and errors against cost: what is drawn, where, and how it is told."""

import math
from pathlib import Path
from typing import Any

import matplotlib as mpl
import numpy as np
import pandas as pd
import pytest
from matplotlib.axes import Axes
from matplotlib.colors import to_hex, to_rgb
from matplotlib.figure import Figure
from PIL import Image

from tests.comparison.fakes import METHODS, THRESHOLDS, Sampled, Told, toy_problem
from tests.comparison.fakes import toy_frame as frame
from uqfold import plots
from uqfold.methods import available
from uqfold.problems.criterion import criteria

SHORT = criteria(THRESHOLDS)


@pytest.fixture(scope="module")
def whole() -> pd.DataFrame:
    return frame()


@pytest.fixture(scope="module")
def short(whole: pd.DataFrame) -> pd.DataFrame:
    return whole[whole["tau"].isna() & (whole["missions"] == "1")]


def row_of(figure: Any, label: str) -> Axes:
    """The first of the narrow rows of a method."""
    return next(axes for axes in figure.axes if axes.get_ylabel() == label)


def colored(axes: Axes, color: str) -> list[Any]:
    return [line for line in axes.lines if to_hex(line.get_color()).upper() == color]


def drawn(axes: Axes, label: str, labels: list[str]) -> list[tuple[float, float]]:
    """Places of the markers of a method."""
    style = plots.method_styles(labels)[label]
    # caps of error bars are markers, too
    marked = [line for line in colored(axes, style.color) if line.get_marker() == style.marker]
    points = np.array([xy for line in marked for xy in line.get_xydata()])
    return [(float(x), float(y)) for x, y in points if math.isfinite(x + y)]


def test_methods_have_a_look_of_their_own() -> None:
    """Most have a fixed one, others the next free; further ones still look like no other.

    There are more methods than markers that may be filled or hollow, so that some share one.
    """
    styles = list(plots.method_styles([*available(), *"abcdefghijklmnop"]).values())
    assert len(set(styles)) == len(styles)
    assert len({style.color for style in styles[:15]}) == 15
    assert len({style.marker for style in styles[:15]}) >= 12
    # black is the reference
    assert "#000000" not in {style.color for style in styles}


def test_a_method_keeps_its_style_in_other_company() -> None:
    beside = plots.method_styles(["another", "openturns-mc", "mc"])
    assert plots.method_styles(["mc"])["mc"] == beside["mc"]


def test_every_method_has_a_row_with_its_ratios_at_the_true_thresholds(
    whole: pd.DataFrame,
) -> None:
    """The figure moved points sideways, by which thresholds were misread."""
    figure = plots.comparison(whole)
    row = row_of(figure, "biased")
    own = whole[(whole["label"] == "biased") & whole["tau"].isna() & (whole["missions"] == "1")]
    expected = own["pf"] / own["reference_pf"]
    found = drawn(row, "biased", list(METHODS))
    assert [x for x, _ in found] == list(THRESHOLDS)
    np.testing.assert_allclose([y for _, y in found], expected, rtol=1e-12)
    assert row.get_yscale() == "log"


def test_the_curve_is_drawn_once_per_panel_with_the_reference(whole: pd.DataFrame) -> None:
    figure = plots.comparison(whole)
    tops = [axes for axes in figure.axes if axes.get_title(loc="left").endswith(("on", ")"))]
    assert len(tops) == 4
    first = whole[whole["tau"].isna() & (whole["missions"] == "1") & (whole["label"] == "exact")]
    reference = colored(tops[0], "#000000")[0]
    np.testing.assert_allclose(reference.get_ydata(), first["reference_pf"])
    (band,) = tops[0].collections
    edges = band.get_paths()[0].vertices[:, 1]
    assert edges.max() == pytest.approx(1.02 * first["reference_pf"].max(), rel=1e-9)


def test_panels_share_their_axes_and_only_the_last_row_names_the_threshold(
    whole: pd.DataFrame,
) -> None:
    figure = plots.comparison(whole)
    named = [axes for axes in figure.axes if axes.get_xlabel()]
    assert {axes.get_xlabel() for axes in named} == {"threshold T on deflection (mm)"}
    assert len(named) == 4
    assert len({axes.get_xlim() for axes in figure.axes}) == 1


def test_an_interval_becomes_a_bar_of_ratios() -> None:
    own = frame(SHORT, {"mc": Sampled()})
    row = row_of(plots.comparison(own), "mc")
    (bars,) = [one for one in row.collections if "LineCollection" in type(one).__name__]
    ends = np.array([path.vertices[:, 1] for path in bars.get_paths()])
    expected = own[["ci_low", "ci_high"]].to_numpy() / own[["reference_pf"]].to_numpy()
    np.testing.assert_allclose(ends, expected, rtol=1e-9, atol=1e-12)


def test_an_answer_of_zero_is_an_arrow_at_the_upper_end_of_its_interval() -> None:
    own = frame(criteria([11.0, 17.0]), {"mc": Sampled(n=100)})
    assert own["pf"].iloc[1] == 0.0
    figure = plots.comparison(own)
    row = row_of(figure, "mc")
    arrows = [line for line in row.lines if line.get_marker() == 7]
    ((x, y),) = [xy for line in arrows for xy in line.get_xydata() if math.isfinite(xy[1])]
    # ci_high is some 1e9 times the reference: the arrow stands at the upper edge
    assert x == 17.0
    assert 1.0 < y <= row.get_ylim()[1]
    assert any("upper end" in text.get_text() for text in figure.legends[0].get_texts())


def test_an_answer_beyond_the_axis_points_outside() -> None:
    own = frame(SHORT, {"far": Told(bias=99.0), "near": Told()})
    row = row_of(plots.comparison(own), "far")
    arrows = [line for line in row.lines if line.get_marker() == 6]
    assert len(arrows) == 1
    assert 9.0 < row.get_ylim()[1] < 20.0


def test_one_criterion_gives_one_line_per_method() -> None:
    (axes,) = plots.comparison(frame(criteria(12.0))).axes
    said = [label.get_text() for label in axes.get_yticklabels()]
    assert [words.split("\n")[0] for words in said] == list(METHODS)
    ((ratio, place),) = drawn(axes, "biased", list(METHODS))
    assert (ratio, place) == (pytest.approx(1.2), 1.0)
    # the first stands on top, and who has no answer says why
    low, high = axes.get_ylim()
    assert low > high
    assert "broken\nfailed" in said


def test_cost_and_error_stand_beside_every_method(whole: pd.DataFrame) -> None:
    said = " ".join(text.get_text() for axes in plots.comparison(whole).axes for text in axes.texts)
    assert "median error 20.0 %\n250 evaluations" in said
    assert "unsupported" in said


def test_without_references_the_median_of_the_methods_is_the_measure() -> None:
    methods = {"low": Told(bias=-0.1), "middle": Told(), "far": Told(bias=1.0)}
    figure = plots.comparison(frame(SHORT, methods, referenced=False))
    assert "against the median of the methods" in figure.get_suptitle()
    assert {y for _, y in drawn(row_of(figure, "middle"), "middle", list(methods))} == {1.0}
    far = [y for _, y in drawn(row_of(figure, "far"), "far", list(methods))]
    np.testing.assert_allclose(far, 2.0)


@pytest.mark.parametrize("grid", [SHORT, criteria(12.0)])
def test_without_references_pf_of_one_method_itself_is_drawn(grid: Any) -> None:
    own = frame(grid, {"a": Told(bias=0.1)}, referenced=False)
    figure = plots.comparison(own)
    assert "failure probability" in figure.get_suptitle()
    side = 0 if len(grid) == 1 else 1
    found = [xy[side] for xy in drawn(figure.axes[0], "a", ["a"])]
    np.testing.assert_allclose(found, own["pf"])


@pytest.mark.parametrize("grid", [criteria([17.0, 18.0]), criteria(17.0)])
def test_answers_that_are_all_zero_are_arrows(grid: Any) -> None:
    """Simulation that saw no failure, without a reference: the upper ends are all there is."""
    figure = plots.comparison(frame(grid, {"mc": Sampled(n=100)}, referenced=False))
    markers = {
        line.get_marker() for line in figure.axes[0].lines if np.isfinite(line.get_xdata()).all()
    }
    assert markers & {4, 7}
    figure.canvas.draw()


def test_results_of_methods_are_drawn_as_a_frame_is() -> None:
    """A plot took frames alone: "no attribute 'columns'" for what a method returns."""
    problem = toy_problem(SHORT)
    results = [Told(bias=bias).estimate(problem, SHORT) for bias in (0.0, 0.5)]
    for given, labels in (
        (results[0], ["told"]),
        (results, ["told", "told 2"]),
        ({"one": results[0], "other": results[1]}, ["one", "other"]),
    ):
        told = plots.values(plots.comparison(given))
        named = {
            name.split(";")[0].removeprefix("method=")
            for name in told
            if name.startswith("method=")
        }
        assert named == set(labels)
        (axes,) = plots.reliability_panels(given, ["pf"]).axes
        assert len([line for line in axes.lines if len(line.get_xdata()) == 3]) == len(labels)
        assert axes.get_xlabel() == "threshold T"
    with pytest.raises(TypeError, match=r"give a DataFrame of uqfold\.compare, or results"):
        plots.comparison([3])  # type: ignore[list-item]


def test_many_methods_and_panels_are_drawn() -> None:
    methods = {f"variant {i}": Told(n=10 * i + 10, bias=0.1 * i) for i in range(12)}
    figure = plots.comparison(frame(criteria([11.0, 12.0], missions=[1, 2]), methods))
    assert len(figure.axes) == 2 * 13
    width, height = figure.get_size_inches()
    assert height < 20.0
    assert width < 9.0


def test_names_of_any_length_and_signs_are_drawn(tmp_path: Path) -> None:
    methods = {"a $name that no figure has room for, and no mathematics": Told(), "b$_": Told()}
    for grid in (SHORT, criteria(12.0)):
        own = frame(grid, methods)
        plots.save(plots.comparison(own), tmp_path / "names", ["svg"])
        plots.save(plots.error_against_evaluations(own), tmp_path / "names", ["svg"])


def test_rows_without_answer_leave_gaps(whole: pd.DataFrame) -> None:
    hole = whole.copy()
    hole.loc[hole["threshold"] == 12.0, ["pf", "error"]] = math.nan
    row = row_of(plots.comparison(hole), "biased")
    assert [x for x, _ in drawn(row, "biased", list(METHODS))] == [11.0, 13.0]


def test_an_infinite_threshold_has_no_place_on_the_axis() -> None:
    own = frame(criteria([11.0, 12.0, math.inf]), {"exact": Told()}, referenced=False)
    figure = plots.comparison(own)
    assert all(np.isfinite(line.get_xdata()).all() for axes in figure.axes for line in axes.lines)


@pytest.mark.parametrize("name", ["comparison", "error_against_evaluations"])
def test_what_cannot_be_drawn_is_refused(name: str) -> None:
    nothing = frame(criteria(12.0), {"broken": METHODS["broken"]})
    with pytest.raises(ValueError, match="frame has no answer"):
        getattr(plots, name)(nothing)
    with pytest.raises(ValueError, match="frame has no column 'label'"):
        getattr(plots, name)(nothing.drop(columns="label"))


def test_every_answer_is_told(whole: pd.DataFrame) -> None:
    told = plots.values(plots.comparison(whole))
    answered = whole[whole["pf"].notna()]
    by_method = dict.fromkeys(METHODS, 0)
    for name, texts in told.items():
        if name.startswith("method="):
            by_method[name.split(";")[0].removeprefix("method=")] += len(texts)
    assert {label: n for label, n in by_method.items() if n} == dict(
        answered["label"].value_counts()
    )
    (first, *_) = told["method=biased;criterion=1 mission"]
    assert first.startswith("T = 11 mm, 1 mission\npf = ")
    assert "error 20.0 %\n250 evaluations\nunchecked" in first


def test_errors_stand_over_the_evaluations_of_their_criterion(whole: pd.DataFrame) -> None:
    axes = plots.error_against_evaluations(whole)
    assert (axes.get_xscale(), axes.get_yscale()) == ("log", "log")
    found = drawn(axes, "biased", list(METHODS))
    # six criteria and their median
    np.testing.assert_allclose(found, [[250.0, 0.2]] * 7, rtol=1e-9)
    # the references' two standard errors, 2 %, are the level below which nothing can be judged
    assert max(patch.get_y() + patch.get_height() for patch in axes.patches) == pytest.approx(0.02)


def test_errors_are_drawn_into_axes_of_the_callers(whole: pd.DataFrame) -> None:
    left, right = Figure().subplots(1, 2)
    assert plots.error_against_evaluations(whole, right) is right
    assert not left.lines


def test_the_same_frame_gives_the_same_files(short: pd.DataFrame, tmp_path: Path) -> None:
    before = dict(mpl.rcParams)
    first, again = (
        plots.save(plots.comparison(short), tmp_path / name / "pf-0.5", ["png", "svg"])
        for name in "ab"
    )
    assert [path.name for path in first] == ["pf-0.5.png", "pf-0.5.svg"]
    assert [path.read_bytes() for path in first] == [path.read_bytes() for path in again]
    assert first[0].read_bytes().startswith(b"\x89PNG\r\n\x1a\n")
    assert b"deflection" in first[1].read_bytes()
    # settings of the caller stay
    assert dict(mpl.rcParams) == before


def test_a_small_mark_has_the_colour_of_its_method_in_a_png_too(tmp_path: Path) -> None:
    """The palette of a picture turned the colours of a few small marks into others."""
    styles = plots.method_styles([*available(), "another"])
    with plots.figure_settings():
        axes = Figure(figsize=(8.0, 5.0)).subplots()
        for k, style in enumerate(styles.values()):
            axes.plot([k], [0.5], style.marker, color=style.color)
        axes.plot(np.linspace(0.0, 10.0, 60), np.cos(np.arange(60)), "o-", color="#009E73")
    (path,) = plots.save(axes, tmp_path / "marks")
    with Image.open(path) as picture:
        pixels = np.unique(np.asarray(picture.convert("RGB")).reshape(-1, 3), axis=0).astype(int)
    for label, style in styles.items():
        color = np.rint(255.0 * np.array(to_rgb(style.color)))
        assert np.abs(pixels - color).max(axis=1).min() <= 8, label


def test_the_figures_of_a_comparison_are_written(short: pd.DataFrame, tmp_path: Path) -> None:
    from uqfold.report import write_figures

    written = write_figures(short, tmp_path / "new")
    assert [path.name for path in written] == [
        "comparison.png", "comparison.svg",
        "error-against-evaluations.png", "error-against-evaluations.svg",
    ]  # fmt: skip
    assert sorted((tmp_path / "new").iterdir()) == sorted(written)
    nothing = frame(criteria(12.0), {"broken": METHODS["broken"]})
    assert write_figures(nothing, tmp_path / "none") == []
