"""The table on terminals of any width, and in files."""

import io
import math
import re
from dataclasses import asdict

import pandas as pd
import pytest
from rich.console import Console

import uqfold
from tests.comparison.fakes import GRID, METHODS, Told, toy_frame
from uqfold.plots.wording import criterion_text, probability
from uqfold.problems.criterion import criteria
from uqfold.report import ComparisonTable

ANSI = re.compile(r"\x1b\[")


def printed(frame: pd.DataFrame, width: int, *, terminal: bool = False) -> str:
    console = Console(file=io.StringIO(), width=width, force_terminal=terminal, no_color=False)
    console.print(ComparisonTable(frame))
    assert isinstance(console.file, io.StringIO)
    return console.file.getvalue()


@pytest.fixture(scope="module")
def frame() -> pd.DataFrame:
    return toy_frame()


@pytest.mark.parametrize("width", [80, 100, 120, 200])
def test_fits_the_width_with_one_line_per_row(frame: pd.DataFrame, width: int) -> None:
    lines = printed(frame, width).splitlines()
    assert max(map(len, lines)) <= width
    for label in METHODS:
        rows = [line for line in lines if line.startswith(f"  {label} ")]
        # one per criterion, and one in the summary
        assert len(rows) == len(GRID) + 1


def test_lines_end_where_their_text_does(frame: pd.DataFrame) -> None:
    assert not [line for line in printed(frame, 120).splitlines() if line != line.rstrip()]


def test_no_colour_and_no_boxes_unless_on_a_terminal(frame: pd.DataFrame) -> None:
    plain = printed(frame, 100)
    assert not ANSI.search(plain)
    assert not re.search("[─-╿]", plain)
    assert ANSI.search(printed(frame, 100, terminal=True))


def test_groups_are_headed_by_criterion_and_reference(frame: pd.DataFrame) -> None:
    text = printed(frame, 120)
    for one in GRID:
        key = (one.threshold, one.tau, str(one.missions))
        asked = {**asdict(one), "tau": one.tau or math.nan, "missions": key[2]}
        (head,) = [
            line
            for line in text.splitlines()
            if line.startswith(f"{criterion_text(asked, 'mm')}  ")
        ]
        same = (frame["threshold"] == key[0]) & (frame["missions"] == key[2])
        row = frame[same].iloc[0]
        assert "reference pf" in head
        if one.tau is None:
            assert f"reference pf {probability(row['reference_pf'], 4)} ± " in head


def test_a_criterion_without_a_reference_says_so() -> None:
    text = printed(toy_frame(referenced=False), 120)
    assert text.count("no reference") == len(GRID)
    assert "Eq. (49)" not in text


def test_every_cell_is_right() -> None:
    methods = {
        "biased": Told(n=250, bias=0.2),
        "exact": Told(n=150_000),
        "broken": METHODS["broken"],
    }
    frame = toy_frame(criteria(12.0), methods).assign(seconds=0.5)
    lines = [line.split() for line in printed(frame, 120).splitlines()]
    pf = probability(1.2 * frame["reference_pf"][0], 4)
    assert ["biased", pf, "none", "stated", "20.0", "%", "250", "unchecked"] in lines
    assert ["broken", "-", "-", "-", "0", "failed", "[2]"] in lines
    # 150,000 runs are beyond the budget of 5,000
    assert ["exact", "-", "-", "-", "0", "failed", "[1]"] in lines


def test_what_a_method_refuses_costs_nothing(frame: pd.DataFrame) -> None:
    rows = [line.split() for line in printed(frame, 120).splitlines() if "unsupported" in line]
    assert len(rows) == len(GRID) / 2
    assert {tuple(row[:5]) for row in rows} == {("biased", "-", "-", "-", "-")}


def test_an_error_that_the_reference_cannot_judge_is_marked() -> None:
    # the references of the fakes have a standard error of 1 %
    methods = {"within": Told(bias=0.0199), "beyond": Told(bias=0.0201)}
    text = printed(toy_frame(criteria(12.0), methods), 120)
    assert "~2.0 %" in next(line for line in text.splitlines() if "within" in line)
    assert "~" not in next(line for line in text.splitlines() if "beyond" in line)
    assert "~          below two standard errors of the reference" in text


def test_messages_stand_below_once_each_and_converged_rows_have_none(frame: pd.DataFrame) -> None:
    text = printed(frame, 120)
    body, _, notes = text.partition("\n  interval ")
    assert "ArithmeticError" not in body
    # brackets in a message are text, not markup
    assert notes.count("[3] broken: ArithmeticError: a pole [at zero]") == 1
    assert notes.count("[1] biased: told not to answer tau") == 1
    assert body.count("unsupported [1]") == len(GRID) / 2
    assert body.count("failed [3]") == len(GRID)
    assert not re.search(r"converged \[", body)


def test_bounds_from_failed_runs_are_told() -> None:
    frame = toy_frame(criteria(12.0), {"exact": Told()})
    frame = frame.assign(status="doubtful", pf_low=0.01, message="1 run failed")
    text = printed(frame, 120)
    assert "1 run failed; with the failed runs pf may be 1.00e-2 to " in text


def test_a_narrow_terminal_loses_nothing(frame: pd.DataFrame) -> None:
    narrow = "".join(printed(frame, 50).split())
    for label in frame["label"]:
        assert label in narrow
    assert "unsupported[1]" in narrow
    assert "ArithmeticError:apole[atzero]" in narrow


def test_at_60_columns_every_row_is_one_line(frame: pd.DataFrame) -> None:
    """Lines were folded in the middle of a number: what has no room is left out, and said."""
    lines = printed(frame, 60).splitlines()
    for label in METHODS:
        assert sum(line.startswith(f"  {label} ") for line in lines) == len(GRID) + 1
    assert max(map(len, lines)) <= 60
    assert "  left out   evaluations and interval, which a wider" in lines
    assert "left out" not in printed(frame, 80)
    # what a method's whole run cost is always told
    (head,) = [line.split() for line in lines if "whole run" in line]
    assert "evaluations" in head


def test_the_summary_counts_answers_and_errors(frame: pd.DataFrame) -> None:
    lines = [line.split() for line in printed(frame, 120).splitlines()]
    start = lines.index(
        ["whole", "run", "answered", "median", "error", "largest", "evaluations", "time"]
    )
    biased = next(line for line in lines[start:] if line[:1] == ["biased"])
    assert biased[1:9] == ["6", "of", "12", "20.0", "%", "20.0", "%", "250"]
    broken = next(line for line in lines[start:] if line[:1] == ["broken"])
    assert broken[1:7] == ["0", "of", "12", "-", "-", "0"]


def test_where_stated_errors_come_from_is_one_line() -> None:
    """It stood in the details of a result alone, and in the message of a doubted row."""
    method = uqfold.methods.PolynomialChaos(runs=15, max_degree=2)
    frame = uqfold.compare(
        uqfold.testing.LinearNormalSystem().problem(), method, uqfold.criteria(12.0)
    )
    parts = frame.attrs["uqfold-comparison"]["error_parts"]["pce"]
    assert list(parts) == ["training", "integration", "sampling"]
    joint = math.hypot(*parts.values())
    assert joint == pytest.approx(float(frame["std_error"].iloc[0] / frame["pf"].iloc[0]), rel=1e-6)
    said = next(line for line in printed(frame, 200).splitlines() if "errors  " in line)
    assert "pce training" in said
    assert "integration" in said
