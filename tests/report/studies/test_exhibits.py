"""Figures and tables of studies: what they show, what they leave out, what they refuse."""

import math
from pathlib import Path

import numpy as np
import pandas as pd
import pytest

from uqfold.comparison.studies import StudyRunner, load_study
from uqfold.comparison.studies.results import write_record, write_table
from uqfold.comparison.studies.study import RUN_COLUMNS
from uqfold.report.studies import figure_kinds, table_kinds, write_exhibits, write_page
from uqfold.report.studies.evaluations import EVALUATIONS
from uqfold.report.studies.page import markdown_table
from uqfold.report.studies.selection import SelectionError, selected, value_text
from uqfold.report.wording import NO_VALUE

FILE = """\
schema = "uqfold-study/1"
title = "A study"
question = "How sure are we?"

[problems.series]
case = "series"
store = false

[[run]]
name = "sync"
problem = "series"
methods = ["ffni-pearson", "ffni-spa", "mc"]
thresholds = [-2, 0, 2, 4]
tau = ["none", 16]
missions = [1, { planned = 10, p = 0.5 }]
max_evals = 40000

[[analysis]]
name = "gap"
kind = "independence"
problem = "series"
method = "ffni-spa"
units = [2, 20]
thresholds = [-2, 0, 2]
sampled_draws = 200

[[table]]
name = "sizes"
kind = "evaluations"
table = "sync"

[[table]]
name = "errors"
kind = "errors"
table = "sync"

[[figure]]
name = "all"
kind = "reliability"
table = "sync"
curves = "tau"
panels = "missions"
parts = ["reliability", "pf", "error"]

[[figure]]
name = "one"
kind = "reliability"
table = "sync"
where = { tau = "none", missions = "1", label = "ffni-spa" }

[[figure]]
name = "gap"
kind = "independence"
table = "gap"
"""


@pytest.fixture(scope="module")
def made(tmp_path_factory: pytest.TempPathFactory) -> tuple[Path, dict[str, pd.DataFrame]]:
    folder = tmp_path_factory.mktemp("study")
    (folder / "study.toml").write_text(FILE)
    study = load_study(folder, figure_kinds(), table_kinds())
    done = list(StudyRunner(study).tables())
    record = write_record(folder, study, "uqfold study run", [write_table(folder, t) for t in done])
    tables = {t.name: pd.DataFrame(t.rows, columns=list(t.columns)) for t in done}
    shown, written = write_exhibits(study, tables, folder)
    page = write_page(study, record, tables, shown, folder)
    assert len(written) == 6
    return page, tables


def axes_of(
    name: str, tables: dict[str, pd.DataFrame], settings: dict[str, object]
) -> list[object]:
    return list(figure_kinds()[name].call(settings, tables).axes)


SETTINGS = {
    "table": ("sync",),
    "where": {},
    "curves": None,
    "panels": None,
    "parts": ("reliability", "pf"),
    "reference": True,
    "smallest_pf": None,
    "check": None,
}


def test_curves_show_the_numbers_of_the_table(made: tuple[Path, dict[str, pd.DataFrame]]) -> None:
    _, tables = made
    where = {"tau": "none", "missions": "1", "label": "ffni-spa"}
    rows = selected(tables["sync"], where)
    body, tail = axes_of("reliability", tables, {**SETTINGS, "where": where})
    drawn = {line.get_linestyle(): line for line in body.get_lines()}  # type: ignore[attr-defined]
    assert list(drawn["-"].get_xdata()) == list(rows["threshold"])
    assert list(drawn["-"].get_ydata()) == pytest.approx(list(1.0 - rows["pf"]))
    assert list(drawn["--"].get_ydata()) == pytest.approx(list(1.0 - rows["reference_pf"]))
    assert tail.get_yscale() == "log"  # type: ignore[attr-defined]
    low, high = tail.get_ylim()  # type: ignore[attr-defined]
    assert low < rows["pf"].min() < rows["pf"].max() < high


def test_a_check_is_drawn_as_marks_with_its_intervals(
    made: tuple[Path, dict[str, pd.DataFrame]],
) -> None:
    _, tables = made
    where = {"tau": "none", "missions": "1", "label": ["ffni-spa", "mc"]}
    rows = selected(tables["sync"], {**where, "label": "mc"})
    settings = {**SETTINGS, "where": where, "check": "mc", "reference": False}
    figure = figure_kinds()["reliability"].call(settings, tables)
    tail = figure.axes[1]
    joined = [line for line in tail.get_lines() if line.get_linestyle() == "-"]
    assert len(joined) == 1
    (bars,) = [c for c in tail.collections if len(c.get_segments()) == len(rows)]
    ends = np.array([segment[:, 1] for segment in bars.get_segments()])
    np.testing.assert_allclose(ends, rows[["ci_low", "ci_high"]])
    texts = [text.get_text() for text in figure.legends[0].get_texts()]
    assert texts == ["ffni-spa", "simulation, 95 %"]


def test_a_label_of_its_own_keeps_the_colour_of_its_method(
    made: tuple[Path, dict[str, pd.DataFrame]],
) -> None:
    _, tables = made
    frame = tables["sync"]
    colours = {}
    for label in ("ffni-pearson", "fine"):
        renamed = frame.assign(label=frame["label"].replace("ffni-pearson", label))
        where = {"tau": 16, "missions": "1", "label": [label, "mc"]}
        body, _ = axes_of("reliability", {**tables, "sync": renamed}, {**SETTINGS, "where": where})
        colours[label] = [line.get_color() for line in body.get_lines()]  # type: ignore[attr-defined]
    assert colours["fine"] == colours["ffni-pearson"]


def test_one_panel_per_value_and_one_scale(made: tuple[Path, dict[str, pd.DataFrame]]) -> None:
    _, tables = made
    axes = axes_of(
        "reliability", tables, {**SETTINGS, "curves": "tau", "panels": "missions", "parts": ("pf",)}
    )
    assert [one.get_title() for one in axes] == [  # type: ignore[attr-defined]
        "$m$ = 1",
        "$N_t$ = 10, $p_m$ = 0.5",
    ]
    assert len({one.get_ylim() for one in axes}) == 1  # type: ignore[attr-defined]


def test_errors_that_the_reference_cannot_judge_are_hollow(
    made: tuple[Path, dict[str, pd.DataFrame]],
) -> None:
    _, tables = made
    frame = tables["sync"].copy()
    # a reference with an error of its own, larger than that of two of four estimates
    frame["reference_std_error"] = np.where(frame["threshold"] < 1.0, frame["reference_pf"], 0.0)
    where = {"tau": "none", "missions": "1", "label": "ffni-spa"}
    [axes] = axes_of(
        "reliability", {**tables, "sync": frame}, {**SETTINGS, "where": where, "parts": ("error",)}
    )
    sizes = {
        str(line.get_markerfacecolor()): len(line.get_xdata())
        for line in axes.get_lines()  # type: ignore[attr-defined]
        if line.get_marker() != "None"
    }
    assert sizes["white"] == 2
    assert sum(sizes.values()) == 4


def test_difference_of_dependence(made: tuple[Path, dict[str, pd.DataFrame]]) -> None:
    _, tables = made
    gap = tables["gap"]
    # sixteen responses per draw cannot judge twenty units
    assert gap.loc[gap["units"] == 20, "sampled_difference"].isna().all()
    two = gap[gap["units"] == 2]
    z = (two["sampled_difference"] - two["difference"]) / two["sampled_std_error"]
    assert z.abs().max() < 4.0
    axes = axes_of("independence", tables, {"table": "gap", "where": {}, "smallest_pf": None})
    assert len(axes) == 3


def test_page(made: tuple[Path, dict[str, pd.DataFrame]]) -> None:
    page, tables = made
    text = page.read_text()
    for words in (
        "# A study",
        "How sure are we?",
        "![all](figures/all.png)",
        "| ffni-spa | 75 | - |",
    ):
        assert words in text
    # what a method says of rows without an answer, and how often
    refused = tables["sync"]["status"] == "unsupported"
    assert f"use ffni-pearson ({int(refused.sum())} rows)" in text


def test_error_table_by_hand() -> None:
    frame = pd.DataFrame([dict.fromkeys(RUN_COLUMNS, math.nan)] * 3)
    frame = frame.assign(
        problem="p",
        label="m",
        reference_pf=[0.05, 0.02, 0.002],
        reference_std_error=[0.0, 0.01, 0.0],
    )
    frame["pf"] = frame["reference_pf"] * [1.2, 0.9, 2.0]
    frame["error"] = [0.2, 0.1, 1.0]
    table = table_kinds()["errors"].call({"table": ("t",), "where": {}}, {"t": frame})
    assert table.to_dict("records") == [
        {
            "method": "m",
            "tau": "no",
            "reference pf": "1e-2 to 1e-1",
            "criteria": "2",
            "median error": "+5.0 %",
            "from": "-10.0 %",
            "to": "+20.0 %",
            "below the reference's own error": "1",
        },
        {
            "method": "m",
            "tau": "no",
            "reference pf": "1e-3 to 1e-2",
            "criteria": "1",
            "median error": "+100 %",
            "from": "+100 %",
            "to": "+100 %",
            "below the reference's own error": "0",
        },
    ]


def test_selection() -> None:
    frame = pd.DataFrame({"tau": [math.nan, 1.0, 2.0], "m": ["1", "2", "2"]})
    assert list(selected(frame, {"tau": ["none", 2]}).index) == [0, 2]
    assert list(selected(frame, {"m": "2", "tau": 1.0}).index) == [1]
    with pytest.raises(SelectionError, match="no row has"):
        selected(frame, {"tau": 3})


@pytest.mark.parametrize(
    ("column", "value", "text"),
    [
        ("missions", "5", "$m$ = 5"),
        ("missions", "binomial(10, 0.7)", "$N_t$ = 10, $p_m$ = 0.7"),
        ("tau", 0.04, "$\\tau$ = 0.04 s"),
        ("tau", None, "no $\\tau$"),
        ("units", 4, "$n$ = 4"),
        ("max_evals", 20000.0, "20,000 evaluations"),
        ("label", "mc", "mc"),
    ],
)
def test_values_in_words(column: str, value: object, text: str) -> None:
    assert value_text(column, value, "s") == text


def test_markdown_escapes_what_would_end_a_cell() -> None:
    assert markdown_table(pd.DataFrame({"a": ["x|y\nz"]})).endswith("| x\\|y z |")


def test_evaluations_have_a_row_of_the_simulated_reference() -> None:
    """The paper's table of sample sizes sets its Monte Carlo beside its methods."""
    row = {"problem": "wing", "tau": math.nan, "pf": 0.1, "reference_pf": 0.1}
    synchronized = {**row, "tau": 0.04, "label": "pearson", "n_evals": 9}
    tables = {
        "runs": pd.DataFrame([{**row, "label": "spa", "n_evals": 7}, synchronized]),
        "problems": pd.DataFrame(
            [{"problem": "wing", "reference_kind": "simulation",
              "reference_how": "Simulation of the mechanism, 7987200 deployments: 104 blocks"}]
        ),
    }  # fmt: skip
    settings = {"table": ("runs",), "where": {}}
    found = EVALUATIONS.call(settings, tables).to_numpy().tolist()
    assert found == [
        ["spa", "7", NO_VALUE],
        ["pearson", NO_VALUE, "9"],
        ["Monte Carlo, the reference", "7,987,200", "7,987,200"],
    ]
    exact = tables["problems"].assign(reference_kind="integration")
    assert len(EVALUATIONS.call(settings, {**tables, "problems": exact})) == 2
