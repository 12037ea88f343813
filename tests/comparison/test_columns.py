"""The columns of a comparison, and the error of Eq. (49)."""

import math

import pytest

from uqfold.comparison.columns import COLUMNS, relative_error, rows_to_frame


@pytest.mark.parametrize(("pf", "reference"), [(0.2, 0.25), (0.3, 0.25), (1e-3, 1.1e-3)])
def test_error_is_that_of_equation_49(pf: float, reference: float) -> None:
    reliability, known = 1.0 - pf, 1.0 - reference
    printed = abs(reliability - known) / (1.0 - known)
    assert relative_error(pf, reference) == pytest.approx(printed, rel=1e-12)


def test_error_survives_where_one_minus_pf_is_one() -> None:
    assert relative_error(3e-20, 2e-20) == pytest.approx(0.5, rel=1e-15)


@pytest.mark.parametrize(
    ("pf", "reference"), [(math.nan, 0.1), (0.1, math.nan), (0.1, 0.0), (0.0, 0.0)]
)
def test_error_is_nan_without_something_to_compare(pf: float, reference: float) -> None:
    assert math.isnan(relative_error(pf, reference))


def test_frame_without_rows_has_the_columns_and_types() -> None:
    frame = rows_to_frame([])
    assert list(frame) == list(COLUMNS)
    assert frame["pf"].dtype == "float64"
    assert frame["n_evals"].dtype == "int64"
