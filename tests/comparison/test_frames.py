"""Frames of a comparison, whatever became of them on the way."""

import io
import math
import time

import numpy as np
import pandas as pd
import pytest

import uqfold
from tests.comparison.fakes import GRID, METHODS, toy_frame
from uqfold.comparison import checked_frame, comparison_header, criteria_of
from uqfold.report.reports import report_page


@pytest.fixture(scope="module")
def frame() -> pd.DataFrame:
    return toy_frame()


def labels(frame: pd.DataFrame) -> list[str]:
    return [one["label"] for one in comparison_header(frame)["methods"]]


def test_a_frame_of_compare_is_returned_as_it_is(frame: pd.DataFrame) -> None:
    again = checked_frame(frame)
    pd.testing.assert_frame_equal(again, frame, check_exact=True)
    assert again.attrs == frame.attrs


def test_a_part_of_a_frame_tells_of_that_part(frame: pd.DataFrame) -> None:
    part = frame[(frame["threshold"] > 11.5) & (frame["label"] != "biased")]
    header = comparison_header(part)
    assert labels(part) == header["finished"] == ["exact", "sampled", "broken"]
    assert {one.threshold for one in criteria_of(header)} == {12.0, 13.0}
    assert header["seed"] == frame.attrs["uqfold-comparison"]["seed"]
    assert header["methods"][0]["theory"]["summary"] == METHODS["exact"].theory.summary
    # nobody says of it that it was interrupted
    assert labels(frame[frame["label"] == "exact"]) == ["exact"]


def test_a_csv_file_tells_what_its_rows_tell(frame: pd.DataFrame) -> None:
    read = checked_frame(pd.read_csv(io.StringIO(frame.to_csv(index=False))))
    header = comparison_header(read)
    assert criteria_of(header) == GRID
    assert labels(read) == list(METHODS)
    assert header["versions"] == {}
    assert list(read["message"]) == list(frame["message"])


def test_rows_of_two_comparisons_keep_no_header_of_one(frame: pd.DataFrame) -> None:
    other = frame[frame["label"] == "exact"].assign(label="renamed")
    both = pd.concat([frame, other])
    both.attrs = dict(frame.attrs)
    assert labels(both)[-1] == "renamed"
    assert comparison_header(both)["command"] == ""


def test_what_is_no_comparison_is_refused(frame: pd.DataFrame) -> None:
    with pytest.raises(ValueError, match="no column 'n_evals'"):
        checked_frame(frame.drop(columns="n_evals"))
    with pytest.raises(ValueError, match="the frame holds none"):
        checked_frame(frame.iloc[:0])
    two = pd.concat([frame, frame.assign(problem="other")])
    with pytest.raises(ValueError, match="the frame holds toy, other"):
        checked_frame(two)


def test_compare_gives_such_a_frame() -> None:
    frame = uqfold.compare(uqfold.problems.series(), "ffni-spa", uqfold.criteria(2.0))
    header = comparison_header(frame)
    (method,) = header["methods"]
    assert method["settings"] == repr(uqfold.methods.FFNISaddlepoint())
    assert header["date"]


def test_a_large_frame_is_read_in_seconds() -> None:
    """A frame of 1e5 rows: the work grows as the rows do."""
    frame = toy_frame()
    seconds = []
    for rows in (500, 5000):
        large = frame.iloc[[0] * rows].reset_index(drop=True)
        large["threshold"] = np.linspace(1.0, 2.0, rows)
        started = time.process_time()
        assert len(comparison_header(large)["criteria"]) == rows
        seconds.append(time.process_time() - started)
    assert seconds[1] < 40.0 * max(seconds[0], 0.02)


NUMBERS = ["pf", "std_error", "ci_high", "reference_pf"]


@pytest.mark.parametrize(
    "name", ["error", *(pytest.param(one, marks=pytest.mark.thorough) for one in NUMBERS)]
)
def test_a_report_stands_any_number(frame: pd.DataFrame, name: str) -> None:
    """``error = inf`` in a frame; in all its rows, or one of many in one frame."""
    numbers = [math.inf, -math.inf, 1e308, 5e-324, -1.0]
    one = frame[(frame["label"] == "sampled") & frame["tau"].isna() & (frame["missions"] == "1")]
    for values in (numbers, [math.inf]) if name == "error" else (numbers,):
        spoiled = one.copy()
        spoiled[name] = np.resize(values, len(spoiled))
        assert "</html>" in report_page(spoiled).html()


@pytest.mark.parametrize(
    ("name", "value", "message"),
    [
        ("missions_planned", math.inf, "planned = inf"),
        ("missions", "some", "missions = 'some'"),
        ("threshold", "high", r"\[0\].threshold: Input should be a valid number"),
        ("n_evals", math.inf, r"\[0\].n_evals: Input should be a finite number"),
        ("tau", -1.0, "tau"),
    ],
)
def test_a_frame_with_impossible_numbers_is_refused(
    frame: pd.DataFrame, name: str, value: object, message: str
) -> None:
    frame = frame.copy()
    frame["missions_planned"] = math.nan
    frame[name] = [value] * len(frame)
    with pytest.raises(ValueError, match=message):
        checked_frame(frame)


def test_a_comparison_prints_the_columns_that_people_read(frame: pd.DataFrame) -> None:
    """It printed 6 of 29 columns, of which pf was none."""
    head, first, *_ = repr(frame).splitlines()
    assert head.split() == [
        "label", "threshold", "tau", "missions", "pf", "ci_low", "ci_high", "reference_pf", "error",
        "n_evals_row", "status",
    ]  # fmt: skip
    assert f"{frame['pf'].iloc[0]:.4g}" in first.split()
    assert "<th>pf</th>" in (frame._repr_html_() or "")
    assert len(frame.columns) == 29
    # what says nothing is left out, and parts that are no comparison print as frames do
    plain = frame[frame["tau"].isna() & (frame["missions"] == "1")].assign(error=math.nan)
    assert not {"tau", "missions", "error"} & set(repr(plain).split())
    part = frame[["label", "pf"]]
    assert repr(part) == repr(pd.DataFrame(part))
