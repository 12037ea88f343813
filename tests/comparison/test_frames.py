"""From a frame back to the records, whatever became of the frame on the way."""

import io
import math
import time

import numpy as np
import pandas as pd
import pytest

import uqfold
from tests.comparison.fakes import GRID, METHODS, toy_records
from uqfold.comparison import Records, records_from_frame
from uqfold.comparison.columns import COLUMNS
from uqfold.comparison.csv_cells import csv_text
from uqfold.report.page.html import page_html
from uqfold.report.reports import report_page


@pytest.fixture(scope="module")
def records() -> Records:
    return toy_records()


def written(records: Records) -> list[str]:
    """Rows as text: NaN equals itself there."""
    return [repr([kind(row[name]) for name, kind in COLUMNS.items()]) for row in records.rows]


def test_a_frame_gives_its_records_back(records: Records) -> None:
    again = records_from_frame(records.to_frame())
    assert again.header == records.header
    assert written(again) == written(records)


def test_a_part_of_a_frame_tells_of_that_part(records: Records) -> None:
    frame = records.to_frame()
    part = frame[(frame["threshold"] > 11.5) & (frame["label"] != "biased")]
    again = records_from_frame(part)
    assert [entry.label for entry in again.header.methods] == ["exact", "sampled", "broken"]
    assert {one.threshold for one in again.header.criteria} == {12.0, 13.0}
    assert again.header.seed == records.header.seed
    assert again.header.methods[0].theory == METHODS["exact"].theory
    assert again.complete


def test_a_csv_file_tells_what_its_rows_tell(records: Records) -> None:
    text = records.to_frame().to_csv(index=False)
    again = records_from_frame(pd.read_csv(io.StringIO(text)))
    assert again.header.criteria == GRID
    assert [entry.label for entry in again.header.methods] == list(METHODS)
    assert again.header.versions == {}
    assert [row["message"] for row in again.rows] == [row["message"] for row in records.rows]


def test_rows_of_two_comparisons_keep_no_header_of_one(records: Records) -> None:
    frame = records.to_frame()
    other = frame[frame["label"] == "exact"].assign(label="renamed")
    both = pd.concat([frame, other])
    both.attrs = dict(frame.attrs)
    header = records_from_frame(both).header
    assert header.methods[-1].label == "renamed"
    assert header.command == ""


def test_what_is_no_comparison_is_refused(records: Records) -> None:
    frame = records.to_frame()
    with pytest.raises(ValueError, match="no column 'n_evals'"):
        records_from_frame(frame.drop(columns="n_evals"))
    with pytest.raises(ValueError, match="the frame holds none"):
        records_from_frame(frame.iloc[:0])
    two = pd.concat([frame, frame.assign(problem="other")])
    with pytest.raises(ValueError, match="the frame holds toy, other"):
        records_from_frame(two)


def test_compare_gives_such_a_frame() -> None:
    frame = uqfold.compare(uqfold.problems.series(), "ffni-spa", uqfold.criteria(2.0))
    header = records_from_frame(frame).header
    assert header.methods[0].settings == "FFNISaddlepoint(nodes_shared=3, nodes_individual=5)"
    assert header.date


def test_a_large_frame_is_read_in_seconds() -> None:
    """A frame of 1e5 rows: the work grows as the rows do."""
    frame = toy_records().to_frame()
    seconds = []
    for rows in (500, 5000):
        large = pd.concat([frame.iloc[[0]]] * rows, ignore_index=True)
        large["threshold"] = np.linspace(1.0, 2.0, rows)
        started = time.process_time()
        assert len(records_from_frame(large).header.criteria) == rows
        seconds.append(time.process_time() - started)
    assert seconds[1] < 40.0 * max(seconds[0], 0.02)


@pytest.mark.parametrize("value", [math.inf, -math.inf, 1e308, 5e-324, -1.0])
@pytest.mark.parametrize("name", ["error", "pf", "std_error", "ci_high", "reference_pf"])
def test_a_report_stands_any_number(records: Records, name: str, value: float) -> None:
    """``error = inf`` in a frame."""
    frame = records.to_frame()
    frame[name] = value
    assert "</html>" in page_html(report_page(frame))


@pytest.mark.parametrize(
    ("name", "value", "message"),
    [
        ("missions_planned", math.inf, "planned = inf"),
        ("missions", "some", "missions = 'some'"),
        ("threshold", "high", "the column 'threshold'"),
        ("n_evals", math.inf, "the column 'n_evals'"),
        ("tau", -1.0, "tau"),
    ],
)
def test_a_frame_with_impossible_numbers_is_refused(
    records: Records, name: str, value: object, message: str
) -> None:
    frame = records.to_frame()
    frame["missions_planned"] = math.nan
    frame[name] = [value] * len(frame)
    with pytest.raises(ValueError, match=message):
        records_from_frame(frame)


def test_texts_of_a_csv_file_are_read_as_they_were(records: Records) -> None:
    rows = tuple({**row, "message": "=1+1", "label": "'+a"} for row in records.rows)
    read = pd.read_csv(io.StringIO(csv_text(COLUMNS, rows)))
    assert {(row["message"], row["label"]) for row in records_from_frame(read).rows} == {
        ("=1+1", "'+a")
    }
