import math

import pytest

from uqfold.evidence import Axis, Column, Figure, Measurement, Series, Table


def test_table_of_rows() -> None:
    rows = [
        {"set": "a", "time (s)": 1, "ok": True},
        {"set": "b", "time (s)": math.inf, "ok": False},
    ]
    table = Table.of("times", "Times", rows)
    assert table.columns == (Column("set"), Column("time", "s"), Column("ok"))
    assert table.rows == (("a", 1.0, "yes"), ("b", math.inf, "no"))


@pytest.mark.parametrize(
    ("rows", "message"),
    [
        ([], "table 't' has none, give at least one"),
        ([{"a": 1}, {"b": 1}], r"row 1 has the keys \['b'\], not \['a'\]"),
    ],
)
def test_tables_that_do_not_fit(rows: list, message: str) -> None:
    with pytest.raises(ValueError, match=message):
        Table.of("t", "T", rows)


def test_ragged_tables_are_refused() -> None:
    with pytest.raises(ValueError, match="row 0 has 2 cells for 1 columns"):
        Table("t", "T", (Column("a"),), ((1.0, 2.0),))
    with pytest.raises(ValueError, match="names a column twice"):
        Table("t", "T", (Column("a"), Column("a")), ())


def test_ragged_series_are_refused() -> None:
    with pytest.raises(ValueError, match="2 x for 1 y"):
        Series("s", (1.0, 2.0), (1.0,))
    with pytest.raises(ValueError, match="1 low for 2 x"):
        Series("s", (1.0, 2.0), (1.0, 2.0), (0.5,), (1.5, 2.5))
    with pytest.raises(ValueError, match="only one of low and high"):
        Series("s", (1.0,), (1.0,), low=(0.5,))


def test_names_within_a_case_differ() -> None:
    figure = Figure("f", "F", Axis("x"), Axis("y"), ())
    with pytest.raises(ValueError, match="two figures have the same name"):
        Measurement.of([], figures=[figure, figure])
