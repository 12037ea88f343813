"""How reports write numbers and criteria."""

import math

import pytest

from tests.comparison.fakes import toy_frame
from uqfold.comparison.columns import ATTRIBUTE
from uqfold.plots.wording import (
    answers_of,
    criterion_text,
    percent,
    reference_resolution,
    scientific,
    seconds_text,
)


@pytest.mark.parametrize(
    ("value", "shown"),
    [
        (0.53211, "5.32e-1"),
        (1.0, "1.00e0"),
        (9.9999e-5, "1.00e-4"),
        (3.2e-12, "3.20e-12"),
        (0.0, "0"),
        (math.nan, "-"),
        (math.inf, "inf"),
    ],
)
def test_scientific(value: float, shown: str) -> None:
    assert scientific(value, 3) == shown


@pytest.mark.parametrize(
    ("value", "shown"),
    [
        (math.nan, "-"),
        (0.0, "0.0 %"),
        (9.9e-5, "<0.01 %"),
        (1e-4, "0.01 %"),
        (0.00994, "0.99 %"),
        (0.00996, "1.0 %"),
        (0.0234, "2.3 %"),
        (0.9994, "99.9 %"),
        (0.9996, "100 %"),
        (2.56, "256 %"),
        (99.99, "9999 %"),
        (4321.0, "4.3e5 %"),
        (1e12, "1.0e14 %"),
    ],
)
def test_percent(value: float, shown: str) -> None:
    assert percent(value) == shown


@pytest.mark.parametrize(
    ("value", "shown"),
    [
        (0.0004, "0.4 ms"),
        (0.00949, "9.5 ms"),
        (0.358, "358 ms"),
        (0.9994, "999 ms"),
        (0.9996, "1.0 s"),
        (21.74, "21.7 s"),
        (99.96, "100 s"),
        (1234.5, "1234 s"),
    ],
)
def test_seconds(value: float, shown: str) -> None:
    assert seconds_text(value) == shown


@pytest.mark.parametrize(
    ("key", "unit", "shown"),
    [
        ((0.55, None, "1"), "s", "T = 0.55 s, 1 mission"),
        ((0.55, 0.04, "5"), "s", "T = 0.55 s, tau = 0.04 s, 5 missions"),
        ((-3.0, None, "binomial(10, 0.7)"), "", "T = -3, missions ~ binomial(10, 0.7)"),
        ((math.inf, None, "1"), "s", "T = inf s, 1 mission"),
    ],
)
def test_criteria(key: tuple[float, float | None, str], unit: str, shown: str) -> None:
    threshold, tau, missions = key
    row = {"threshold": threshold, "tau": math.nan if tau is None else tau, "missions": missions}
    assert criterion_text(row, unit) == shown


def test_a_reference_judges_down_to_two_of_its_standard_errors() -> None:
    row = {"reference_pf": 0.02, "reference_std_error": 0.001}
    assert reference_resolution(row) == pytest.approx(0.1)
    assert math.isnan(reference_resolution({**row, "reference_pf": math.nan}))
    assert math.isnan(reference_resolution({**row, "reference_pf": 0.0}))


def test_what_is_drawn_carries_no_header_that_each_selection_would_copy() -> None:
    """Pandas copies ``attrs`` in depth into every column: a third of the time of a report."""
    frame = toy_frame()
    header = frame.attrs[ATTRIBUTE]
    assert answers_of(frame).attrs == {}
    assert frame.attrs[ATTRIBUTE] == header
