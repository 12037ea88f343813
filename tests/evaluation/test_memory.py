"""Memory of long runs, with and without a store."""

import subprocess
import sys
from pathlib import Path

import pytest

MOST = 500.0
"""Peak memory allowed (MB)."""
MOST_GROWTH = 10.0
"""Growth allowed from a tenth of the systems (MB)."""


def peak_memory(systems: int, store: str) -> float:
    """Return the peak resident memory (MB) of a Monte Carlo run in a process of its own."""
    program = Path(__file__).with_name("memory_program.py").read_text(encoding="utf-8")
    words = [sys.executable, "-c", program, str(systems), store]
    done = subprocess.run(words, capture_output=True, text=True, check=True)
    return int(done.stdout) / 1e6


@pytest.mark.skipif(sys.platform == "win32", reason="needs getrusage")
@pytest.mark.parametrize(
    ("few", "many", "kept"),
    [
        pytest.param(100_000, 1_000_000, False, marks=pytest.mark.thorough),
        # up to some 500,000 systems the cache of the store still fills
        pytest.param(600_000, 2_000_000, True, marks=pytest.mark.slow),
    ],
)
def test_more_systems_take_no_more_memory(few: int, many: int, kept: bool, tmp_path: Path) -> None:
    stores = [str(tmp_path / f"{systems}.db") if kept else "" for systems in (few, many)]
    least, most = peak_memory(few, stores[0]), peak_memory(many, stores[1])
    assert most - least < MOST_GROWTH
    assert most < MOST
