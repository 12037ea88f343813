"""Scales and ticks, at the edges of what floats can hold too."""

import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from uqfold.report.page.chart import Scale
from uqfold.report.page.scales import LARGEST, SMALLEST, Line, line_around, tick_texts


@given(st.lists(st.floats(allow_nan=True), max_size=5), st.sampled_from(["linear", "log"]))
def test_every_number_that_can_be_shown_lies_between_the_ends(
    values: list[float], scale: Scale
) -> None:
    line = line_around(values, scale)
    assert line.low < line.high
    for value in values:
        if abs(value) <= LARGEST and (scale == "linear" or value >= SMALLEST):
            assert -1e-6 <= line.place(value) <= 1.0 + 1e-6
    ticks = line.ticks()
    assert len(tick_texts(ticks)) == len(ticks) <= 12
    assert all(-1e-6 <= line.place(tick) <= 1.0 + 1e-6 for tick in ticks)


@pytest.mark.parametrize(
    ("line", "shown"),
    [
        (Line(0.545, 0.57), ["0.545", "0.550", "0.555", "0.560", "0.565", "0.570"]),
        (Line(0.0, 1.0), ["0.0", "0.2", "0.4", "0.6", "0.8", "1.0"]),
        (Line(-3.0, 8.0), ["-2", "0", "2", "4", "6", "8"]),
        (Line(1e-4, 1.0, "log"), ["0.0001", "0.001", "0.01", "0.1", "1"]),
        (Line(1e-6, 1.0, "log"), ["1e-6", "1e-5", "1e-4", "1e-3", "1e-2", "1e-1", "1e0"]),
        (Line(0.02, 0.6, "log"), ["0.02", "0.05", "0.1", "0.2", "0.5"]),
        (Line(50.0, 50_000.0, "log"), ["100", "1,000", "10,000"]),
        (Line(1e-12, 1.0, "log"), ["1e-12", "1e-10", "1e-8", "1e-6", "1e-4", "1e-2", "1e0"]),
    ],
)
def test_ticks_are_round_and_written_alike(line: Line, shown: list[str]) -> None:
    assert tick_texts(line.ticks()) == shown


def test_what_a_logarithm_cannot_take_has_no_place() -> None:
    line = Line(1e-3, 1.0, "log")
    assert math.isnan(line.place(0.0))
    assert math.isnan(line.place(-1.0))
    assert line.place(1e-3) == 0.0
    assert line.place(1.0) == pytest.approx(1.0)
