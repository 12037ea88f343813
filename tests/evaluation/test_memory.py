"""Memory of long runs; the case `bounded_memory` measures it in full size."""

import sys

import pytest

from validation.bounded_memory.measure import MOST, MOST_GROWTH, peak_memory


@pytest.mark.skipif(sys.platform == "win32", reason="needs getrusage")
def test_ten_times_the_systems_take_no_more_memory() -> None:
    few, many = (peak_memory(systems, seed=1) for systems in (100_000, 1_000_000))
    assert many - few < MOST_GROWTH
    assert many < MOST
