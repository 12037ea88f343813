"""The progress bar: late, transient, and on terminals only."""

import io
import time

import pytest
from rich.console import Console

from uqfold.report import progress
from uqfold.report.progress import ComparisonProgressBar


def console(*, terminal: bool) -> tuple[Console, io.StringIO]:
    file = io.StringIO()
    return Console(file=file, force_terminal=terminal, width=100), file


def work(bar: ComparisonProgressBar) -> None:
    bar("first", 0, None)
    bar("first", 500, 2000)
    time.sleep(0.15)
    bar("first", 1000, 2000)
    time.sleep(0.15)
    bar("second", 0, None)


def test_says_method_runs_and_rate(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(progress, "SHOW_AFTER_SECONDS", 0.0)
    terminal, file = console(terminal=True)
    with ComparisonProgressBar(["first", "second"], terminal) as bar:
        work(bar)
    drawn = file.getvalue()
    assert "1/2 first" in drawn
    assert "1,000 of 2,000 evaluations" in drawn
    assert "/s" in drawn
    assert "2/2 second" in drawn


def test_draws_nothing_of_what_is_over_soon() -> None:
    terminal, file = console(terminal=True)
    with ComparisonProgressBar(["first", "second"], terminal) as bar:
        work(bar)
    assert "first" not in file.getvalue()


def test_writes_nothing_into_a_pipe(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(progress, "SHOW_AFTER_SECONDS", 0.0)
    pipe, file = console(terminal=False)
    with ComparisonProgressBar(["first", "second"], pipe) as bar:
        work(bar)
    assert file.getvalue() == ""
