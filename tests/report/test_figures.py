"""Figures: what is drawn, in which style, and where it is written."""

import math
import subprocess
import sys
from dataclasses import replace
from itertools import pairwise
from pathlib import Path

import matplotlib as mpl
import numpy as np
import pytest
from matplotlib.colors import to_hex

from tests.comparison.fakes import GRID, METHODS, THRESHOLDS, Sampled, Told, toy_records
from uqfold.comparison import Records
from uqfold.methods import available
from uqfold.problems.criterion import criteria
from uqfold.report import error_against_evaluations, reliability_curves, write_figures
from uqfold.report.curves import MOST_NESTED
from uqfold.report.style import method_styles

PNG_SIGNATURE = b"\x89PNG\r\n\x1a\n"


@pytest.fixture(scope="module")
def records() -> Records:
    return toy_records()


def colored_lines(axes, color: str):
    return [line for line in axes.lines if to_hex(line.get_color()).upper() == color]


def test_every_built_in_method_has_a_colour_and_a_marker_of_its_own() -> None:
    styles = method_styles([*available(), *"abcdef"]).values()
    assert len({style.color for style in styles}) == len(styles)
    assert len({style.marker for style in styles}) == len(styles)
    # black is the reference
    assert "#000000" not in {style.color for style in styles}


def test_a_method_keeps_its_style_in_other_company() -> None:
    alone, beside = method_styles(["mc"]), method_styles(["another", "openturns-mc", "mc"])
    assert alone["mc"] == beside["mc"]


def test_curves_have_a_row_of_panels_per_tau_and_missions(records: Records) -> None:
    figure = reliability_curves(records)
    assert figure is not None
    assert len(figure.axes) == 2 * 4
    titles = [axes.get_title(loc="left") for axes in figure.axes[::2]]
    assert titles == [
        "1 mission",
        "missions ~ binomial(3, 0.7)",
        "tau = 3 mm, 1 mission",
        "tau = 3 mm, missions ~ binomial(3, 0.7)",
    ]
    assert [axes.get_yscale() for axes in figure.axes] == ["linear", "log"] * 4
    assert figure.axes[-1].get_xlabel() == "threshold T on deflection (mm)"


def test_curves_show_reliability_on_the_left_and_pf_on_the_right(records: Records) -> None:
    figure = reliability_curves(records)
    assert figure is not None
    color = method_styles(records.finished)["biased"].color
    rows = [r for r in records.rows if r["label"] == "biased"][: len(THRESHOLDS)]
    for axes, name in zip(figure.axes[:2], ("reliability", "pf"), strict=True):
        line = colored_lines(axes, color)[0]
        np.testing.assert_allclose(line.get_xdata(), THRESHOLDS)
        np.testing.assert_allclose(line.get_ydata(), [row[name] for row in rows], rtol=1e-12)


def test_the_reference_and_its_band_are_drawn_behind(records: Records) -> None:
    figure = reliability_curves(records)
    assert figure is not None
    axes = figure.axes[1]
    (band,) = axes.collections[:1]
    rows = [r for r in records.rows if r["label"] == "exact"][: len(THRESHOLDS)]
    low, high = band.get_paths()[0].vertices[:, 1].min(), band.get_paths()[0].vertices[:, 1].max()
    pf = [row["reference_pf"] for row in rows]
    assert low == pytest.approx(0.98 * min(pf), rel=1e-9)
    assert high == pytest.approx(1.02 * max(pf), rel=1e-9)
    assert all(band.get_zorder() < line.get_zorder() for line in axes.lines)
    reference = colored_lines(axes, "#000000")[0]
    np.testing.assert_allclose(reference.get_ydata(), pf)


def test_an_interval_becomes_a_bar_and_such_points_are_not_joined() -> None:
    figure = reliability_curves(toy_records(criteria(THRESHOLDS), {"mc": Sampled()}))
    assert figure is not None
    axes = figure.axes[1]
    assert len(axes.containers) == 1
    points = colored_lines(axes, method_styles(["mc"])["mc"].color)[0]
    assert points.get_linestyle() == "None"


def test_an_estimate_of_zero_shows_its_upper_bound_with_an_arrow() -> None:
    grid = criteria([11.0, 17.0])
    records = toy_records(grid, {"mc": Sampled(n=100)})
    zero = records.rows[1]
    assert zero["pf"] == 0.0
    figure = reliability_curves(records)
    assert figure is not None
    drawn = [
        (x, y)
        for line in figure.axes[1].lines
        if line.get_marker() == "$\\downarrow$"
        for x, y in zip(line.get_xdata(), line.get_ydata(), strict=True)
    ]
    assert drawn == [(17.0, zero["ci_high"])]
    low, high = figure.axes[1].get_ylim()
    assert low < zero["reference_pf"] < zero["ci_high"] < high


def test_one_threshold_puts_the_methods_side_by_side() -> None:
    records = toy_records(criteria(12.0))
    figure = reliability_curves(records)
    assert figure is not None
    for axes in figure.axes:
        assert [label.get_text() for label in axes.get_xticklabels()] == list(METHODS)
        assert axes.get_xlabel() == "T = 12 mm"
    points = colored_lines(figure.axes[1], method_styles(METHODS)["biased"].color)[0]
    assert points.get_xdata().tolist() == [1]
    assert points.get_linestyle() == "None"


def test_an_infinite_threshold_has_no_place_on_the_axis() -> None:
    grid = criteria([11.0, 12.0, math.inf])
    figure = reliability_curves(toy_records(grid, {"exact": Told()}))
    assert figure is not None
    assert all(np.isfinite(line.get_xdata()).all() for line in figure.axes[0].lines)


def test_errors_stand_over_the_evaluations_of_their_criterion(records: Records) -> None:
    figure = error_against_evaluations(records)
    assert figure is not None
    (axes,) = figure.axes
    assert (axes.get_xscale(), axes.get_yscale()) == ("log", "log")
    biased = colored_lines(axes, method_styles(records.finished)["biased"].color)
    small = np.concatenate([line.get_ydata() for line in biased[:2]])
    np.testing.assert_allclose(small, [0.2] * 6, rtol=1e-9)
    assert {float(x) for line in biased for x in line.get_xdata()} == {250.0}
    # the references' two standard errors, 2 %, are the level below which nothing can be judged
    assert max(patch.get_y() + patch.get_height() for patch in axes.patches) == pytest.approx(0.02)


def test_methods_of_equal_cost_stand_side_by_side() -> None:
    methods = {"a": Told(bias=0.1), "b": Told(bias=0.2)}
    figure = error_against_evaluations(toy_records(criteria(12.0), methods))
    assert figure is not None
    styles = method_styles(methods)
    a, b = (
        float(colored_lines(figure.axes[0], styles[label].color)[-1].get_xdata()[0])
        for label in methods
    )
    assert a < 100 < b
    assert b / a < 1.3


def test_an_error_the_reference_cannot_judge_is_hollow() -> None:
    methods = {"a": Told(bias=0.019), "b": Told(n=500, bias=0.021)}
    figure = error_against_evaluations(toy_records(criteria(12.0), methods))
    assert figure is not None
    styles = method_styles(methods)
    faces = {
        label: {
            to_hex(line.get_markerfacecolor()).upper()
            for line in colored_lines(figure.axes[0], styles[label].color)[:2]
            if len(line.get_xdata())
        }
        for label in methods
    }
    assert faces == {"a": {"#FFFFFF"}, "b": {styles["b"].color}}


def test_without_references_there_are_no_errors_to_draw() -> None:
    assert error_against_evaluations(toy_records(referenced=False)) is None


def test_without_answers_there_is_nothing_to_draw(tmp_path: Path) -> None:
    records = toy_records(criteria(12.0), {"broken": METHODS["broken"]})
    assert write_figures(records, tmp_path) == []
    assert list(tmp_path.iterdir()) == []


def test_figures_are_written_as_png_and_svg(records: Records, tmp_path: Path) -> None:
    written = write_figures(records, tmp_path / "new")
    assert [path.name for path in written] == [
        "reliability-curves.png",
        "reliability-curves.svg",
        "error-against-evaluations.png",
        "error-against-evaluations.svg",
    ]
    assert sorted((tmp_path / "new").iterdir()) == sorted(written)
    for path in written:
        start = path.read_bytes()[:200]
        assert (
            start.startswith(PNG_SIGNATURE)
            if path.suffix == ".png"
            else b"<svg" in start or (b"<?xml" in start)
        )


def test_the_same_records_give_the_same_svg(records: Records, tmp_path: Path) -> None:
    first = write_figures(records, tmp_path / "a")
    again = write_figures(records, tmp_path / "b")
    for one, other in zip(first, again, strict=True):
        if one.suffix == ".svg":
            assert one.read_bytes() == other.read_bytes()


def test_settings_of_the_caller_stay_as_they_were(records: Records, tmp_path: Path) -> None:
    before = dict(mpl.rcParams)
    write_figures(records, tmp_path)
    assert dict(mpl.rcParams) == before


def test_no_window_is_involved(tmp_path: Path) -> None:
    code = (
        "import sys\n"
        "from tests.comparison.fakes import toy_records, Told\n"
        "from uqfold.problems.criterion import criteria\n"
        "from uqfold.report import write_figures\n"
        "records = toy_records(criteria([11.0, 12.0]), {'exact': Told()})\n"
        f"write_figures(records, {str(tmp_path)!r})\n"
        "print('matplotlib.pyplot' in sys.modules)\n"
    )
    done = subprocess.run(
        [sys.executable, "-W", "error", "-c", code],
        capture_output=True,
        text=True,
        check=True,
        cwd=Path(__file__).parents[2],
        timeout=120,
    )
    assert done.stdout.strip() == "False"


def test_labels_of_methods_unknown_to_us_are_drawn_too(tmp_path: Path) -> None:
    methods = {f"variant {i}": Told(n=10 * i + 10, bias=0.1) for i in range(12)}
    records = toy_records(criteria([11.0, 12.0]), methods)
    assert len(write_figures(records, tmp_path)) == 4


def test_rows_without_answer_leave_gaps(records: Records) -> None:
    hole = tuple(
        {**row, "pf": math.nan, "error": math.nan} if row["threshold"] == 12.0 else row
        for row in records.rows
    )
    figure = reliability_curves(replace(records, rows=hole))
    assert figure is not None
    color = method_styles(records.finished)["biased"].color
    assert np.isnan(colored_lines(figure.axes[1], color)[0].get_ydata()[1])
    assert len(GRID) == 12


def test_many_methods_stand_side_by_side_at_each_threshold(records: Records) -> None:
    known = records.header.methods
    copies = [(entry, f"{entry.label}{n or ''}") for n in range(3) for entry in known]
    assert len(known) <= MOST_NESTED < len(copies)
    rows = tuple(
        {**row, "label": label}
        for entry, label in copies
        for row in records.rows
        if row["label"] == entry.label
    )
    methods = tuple(replace(entry, label=label) for entry, label in copies)
    many = replace(records, rows=rows, header=replace(records.header, methods=methods))
    figure = reliability_curves(many)
    assert figure is not None
    (axes, *_) = figure.axes
    drawn = [
        set(np.round(np.asarray(line.get_xdata(), dtype=float), 9))
        for line in axes.lines
        if line.get_markerfacecolor() == "white" and len(line.get_xdata())
    ]
    assert len(drawn) >= len(copies)
    # no two methods share a place, and none is nearer to another threshold than to its own
    thresholds = sorted({row["threshold"] for row in rows if math.isfinite(row["threshold"])})
    gap = min(later - earlier for earlier, later in pairwise(thresholds))
    for index, places in enumerate(drawn):
        assert not any(places & other for other in drawn[:index])
        assert all(min(abs(x - t) for t in thresholds) < 0.5 * gap for x in places)
