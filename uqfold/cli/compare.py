"""Running a comparison for the command line: save after every method, show, draw."""

from __future__ import annotations

import contextlib
import os
import sys
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
from rich.console import Console

from uqfold.cli.interrupts import Interrupts
from uqfold.cli.streams import EXIT_USAGE, os_error_text, shown_path
from uqfold.comparison.plan import ComparisonPlan
from uqfold.comparison.records import write_records
from uqfold.comparison.run import run_comparison
from uqfold.evaluation import EngineError, FailedRunError, Store
from uqfold.problems.base import Problem
from uqfold.report.figures import figure_paths, write_figures
from uqfold.report.progress import ComparisonProgressBar, notice_if_slow
from uqfold.report.progress_lines import ProgressLines
from uqfold.report.table import ComparisonTable, noted

if TYPE_CHECKING:
    import pandas as pd

PIPED_WIDTH = 120
COMPILING = "compiling the model (on first use only, 10 to 20 s) ..."

EXIT_FAILED = 1
EXIT_INTERRUPTED = 130


@dataclass
class ComparisonSession:
    """One comparison started from the command line.

    Attributes
    ----------
    plan
        What to run.
    command
        The command as it goes into the records.
    folder
        Where records and figures go.
    interrupts
        Tells whether Ctrl-C was pressed.
    figures
        Whether to draw figures.
    quiet
        Whether to print nothing but errors.
    progress_lines
        Whether to write progress as lines of JSON instead of a bar.
    resume
        The words that start this comparison again, for whoever interrupted it.
    """

    plan: ComparisonPlan
    command: str
    folder: Path
    interrupts: Interrupts
    figures: bool = True
    quiet: bool = False
    progress_lines: bool = False
    resume: str = ""
    frame: pd.DataFrame | None = field(default=None, init=False)
    _written: list[Path] = field(default_factory=list, init=False)

    def run(self) -> int:
        """Run all methods and report; give the exit code of the program.

        Every finished method is saved at once. An interruption ends the run, but the methods that
        finished are kept and shown.
        """
        code = 0
        try:
            self._run_methods()
        except KeyboardInterrupt:
            self._say_interrupted()
            code = EXIT_INTERRUPTED
        except (FailedRunError, EngineError) as error:
            say(f"error: {error}")
            code = EXIT_FAILED
        except OSError as error:
            # the methods that finished are still shown
            say(f"error: {os_error_text(error)}")
            self.figures, code = False, EXIT_USAGE
        if self.frame is not None:
            self._report(self.frame)
        if code == 0 and (self.frame is None or self.frame["pf"].isna().all()):
            say("error: no method has an answer")
            code = EXIT_FAILED
        return code

    def _run_methods(self) -> None:
        """Run the methods one by one, and save each as soon as it has finished."""
        terminal = Console(stderr=True, quiet=self.quiet)
        with notice_if_slow(COMPILING, terminal):
            run_once(self.plan.problem)
        labels = list(self.plan.methods)
        with (
            ProgressLines(sys.stderr)
            if self.progress_lines
            else ComparisonProgressBar(labels, terminal)
        ) as bar:
            plan = replace(self.plan, evaluator=replace(self.plan.evaluator, watch=bar.watch))

            def progress(label: str, n_evals: int, expected: int | None) -> None:
                self.interrupts.check()
                bar(label, n_evals, expected)

            for frame in run_comparison(plan, progress, self.command):
                # what was interrupted may look finished where a library swallowed the interruption
                self.interrupts.check()
                self._save(frame)

    def _save(self, frame: pd.DataFrame) -> None:
        if self.frame is None:
            # figures of an earlier comparison would not belong to these records
            for path in figure_paths(self.folder):
                path.unlink(missing_ok=True)
        self.frame = frame
        self._written = list(write_records(frame, self.folder))

    def _report(self, frame: pd.DataFrame) -> None:
        out = stdout_console(quiet=self.quiet)
        try:
            out.print(ComparisonTable(frame))
        finally:
            # the files are written whether or not anybody can read the table
            if self.figures:
                self._written += write_figures(frame, self.folder)
        names = ", ".join(path.name for path in self._written)
        out.print()
        out.print(noted({f"written to {shown_path(self.folder)}: ": names}))

    def _say_interrupted(self) -> None:
        finished = [] if self.frame is None else list(dict.fromkeys(self.frame["label"]))
        said = "interrupted before any method finished; nothing was written"
        if finished:
            n, kept = len(self.plan.methods), shown_path(self.folder)
            said = f"interrupted: {len(finished)} of {n} methods finished and are kept in {kept}: "
            said += ", ".join(finished)
        say(said)
        store = self.plan.evaluator.store
        if isinstance(store, Store):
            kept = f"{len(store):,} model runs are kept in {shown_path(store.path)}"
            say(f"{kept}; to go on from there: {self.resume}")


def say(text: str) -> None:
    """Say something on the standard error, also when quiet, in one line."""
    Console(stderr=True).print(text, markup=False, highlight=False, soft_wrap=True)


def run_once(problem: Problem) -> None:
    """Run the model once at the median inputs, outside any count, so that it gets compiled.

    Otherwise the first method would be charged with the compilation. What the model has against
    these inputs is for the methods to find out.
    """
    with contextlib.suppress(Exception, SystemExit):
        x = problem.inputs.from_standard_normal(np.zeros((1, problem.inputs.dimension)))
        problem.model(x)


def stdout_console(*, quiet: bool) -> Console:
    """Give the console of the standard output; into a pipe or file the table is set wide."""
    piped = not sys.stdout.isatty() and "COLUMNS" not in os.environ
    return Console(width=PIPED_WIDTH if piped else None, quiet=quiet)
