import math

import numpy as np
import pandas as pd
import pytest

from uqfold.validation import Measurement, Points, Table


def test_table_of_rows() -> None:
    rows = [
        {"set": "a", "time (s)": 1, "ok": True, "share": np.float64(1 / 3)},
        {"set": "b", "time (s)": math.inf, "ok": False, "share": math.nan},
    ]
    table = Table.of("Times", rows)
    assert table.columns == ("set", "time (s)", "ok", "share")
    assert table.rows == (("a", 1.0, "yes", 0.333333333), ("b", "inf", "no", None))


def test_table_of_a_frame() -> None:
    rows = [{"set": "a", "time (s)": 1.5, "ok": True}, {"set": "b", "time (s)": None, "ok": False}]
    assert Table.of("Times", pd.DataFrame(rows)) == Table.of("Times", rows)


@pytest.mark.parametrize(
    ("rows", "message"),
    [
        ([], "the table 'T' has none, give at least one"),
        ([{"a": 1}, {"b": 1}], r"rows\[1\] has the keys \['b'\], not \['a'\]"),
        ([{"a": [1]}], r"rows\[0\]\['a'\] = \[1\]: give a number, a text or None"),
    ],
)
def test_tables_that_do_not_fit(rows: list, message: str) -> None:
    with pytest.raises((ValueError, TypeError), match=message):
        Table.of("T", rows)


def test_ragged_tables_are_refused() -> None:
    with pytest.raises(ValueError, match=r"rows\[0\] has 2 cells for 1 columns of the table 'T'"):
        Table("T", ("a",), ((1.0, 2.0),))
    with pytest.raises(ValueError, match="give at least one name, and none twice"):
        Table("T", ("a", "a"), ())


def test_points_need_their_columns() -> None:
    with pytest.raises(ValueError, match=r"give the columns \['y'\] too"):
        Points("P", "x", "y", Table("P", ("series", "x"), ()))


def test_a_measurement_takes_any_sequences() -> None:
    table = Table("T", ("a",), ())
    assert Measurement([], [table]).tables == (table,)
