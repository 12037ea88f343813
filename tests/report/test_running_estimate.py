"""The running estimate in the progress bar: on terminals that have room for it."""

import io

import pytest
from rich.console import Console

from uqfold.evaluation import RunningEstimate
from uqfold.report import progress
from uqfold.report.progress import WIDE, ComparisonProgressBar


@pytest.mark.parametrize(("width", "shown"), [(WIDE, True), (WIDE - 1, False), (80, False)])
def test_estimate_is_shown_where_there_is_room(
    width: int, shown: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(progress, "SHOW_AFTER_SECONDS", 0.0)
    file = io.StringIO()
    with ComparisonProgressBar(["mc"], Console(file=file, force_terminal=True, width=width)) as bar:
        bar("mc", 0, None)
        bar.watch(RunningEstimate("T = 4, m = 1", 1.25e-3, 1.1e-3, 1.4e-3))
        bar("mc", 4096, 8192)
    drawn = file.getvalue()
    assert "4,096 of 8,192 evaluations" in drawn
    assert ("pf = 0.0013 [0.0011, 0.0014]" in drawn) == shown
