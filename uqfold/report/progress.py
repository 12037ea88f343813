"""Progress of a comparison: a bar per method, on terminals."""

from __future__ import annotations

import time
from collections.abc import Iterable, Sequence

from rich.console import Console, RenderableType
from rich.progress import (
    BarColumn,
    Progress,
    SpinnerColumn,
    TaskID,
    TextColumn,
    TimeRemainingColumn,
)

from uqfold.evaluation import RunningEstimate

SHOW_AFTER_SECONDS = 2.0
WIDE = 130
"""Terminals from this width on show the running estimate too."""


class ComparisonProgressBar(Progress):
    """Shows which method runs, how far it is, its rate and the time left.

    To be used as a context manager, and to be called as the progress hook of
    `uqfold.comparison.run_comparison`. Draws nothing in the first two seconds of a method.

    Parameters
    ----------
    labels
        The methods, in the order in which they run.
    console
        Where to draw; nothing is drawn unless it is a terminal.
    unit
        What is counted.
    """

    def __init__(self, labels: Sequence[str], console: Console, unit: str = "evaluations") -> None:
        self._labels, self._unit = list(labels), unit
        self._since = time.monotonic()
        self._current: TaskID | None = None
        wide = console.width >= WIDE
        super().__init__(
            SpinnerColumn(),
            TextColumn("{task.description}"),
            BarColumn(bar_width=30 if wide else 10),
            TextColumn("{task.fields[count]}", markup=False),
            TimeRemainingColumn(compact=True),
            *([TextColumn("{task.fields[estimate]}", markup=False)] if wide else []),
            console=console,
            transient=True,
            disable=not console.is_terminal,
        )

    def stop(self) -> None:
        """Stop; rich 13 would end even a bar that was never drawn with an empty line."""
        if not self.disable:
            super().stop()

    def get_renderables(self) -> Iterable[RenderableType]:
        """Return what is drawn: nothing as long as it may be over soon."""
        if time.monotonic() - self._since >= SHOW_AFTER_SECONDS:
            yield from super().get_renderables()

    def watch(self, estimate: RunningEstimate) -> None:
        """Show where the method that runs stands."""
        if self._current is not None:
            interval = f"[{estimate.ci_low:.2g}, {estimate.ci_high:.2g}]"
            self.update(self._current, estimate=f"pf = {estimate.pf:.2g} {interval}")

    def __call__(self, label: str, n_evals: int, expected: int | None) -> None:
        """Take one report of the comparison; zero runs mean that the method starts."""
        if n_evals == 0 or self._current is None:
            if self._current is not None:
                self.remove_task(self._current)
            self._since = time.monotonic()
            number = self._labels.index(label) + 1
            name = f"{number}/{len(self._labels)} {label}"
            self._current = self.add_task(name, total=None, estimate="", count="")
        seconds = time.monotonic() - self._since
        of = "" if expected is None else f" of {expected:,}"
        rate = f", {n_evals / seconds:,.0f}/s" if n_evals and seconds > 0.0 else ""
        count = f"{n_evals:,}{of} {self._unit}{rate}"
        self.update(self._current, completed=n_evals, total=expected, count=count)
