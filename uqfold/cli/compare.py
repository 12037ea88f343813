"""The command ``uqfold compare``: save after every method, show, draw."""

from __future__ import annotations

import contextlib
import os
import shlex
import sys
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Literal

import typer

from uqfold.cli.invocation import Invocation, flag, option, usage
from uqfold.cli.streams import EXIT_FAILED, EXIT_INTERRUPTED, EXIT_USAGE, os_error_text, shown_path
from uqfold.comparison.named_problems import available_problems, named_problem
from uqfold.writing import check_writable

if TYPE_CHECKING:
    import pandas as pd
    from rich.console import Console

    from uqfold.comparison.plan import ComparisonPlan
    from uqfold.problems.base import Problem

BATCH_ROWS = 1024
"""Evaluations in this process between two looks at Ctrl-C; has no influence on any number."""
PIPED_WIDTH = 120
COMPILING = "compiling the model (on first use only, 10 to 20 s) ..."


def problem_lines() -> list[str]:
    """Return name and description of every named problem."""
    problems = available_problems()
    width = max(map(len, problems))
    return [f"{one.name:<{width}}  {one.description}" for one in problems.values()]


_LISTED = "\n".join(f"  {line}" for line in problem_lines())
COMPARE_HELP = f"""Compare reliability methods on one problem.

Runs every method on the same grid of criteria, prints one table, and writes records (CSV, JSON)
and figures (PNG, SVG).

\b
Problems:
{_LISTED}
  FILE.py:FUNCTION             what a function of your own returns

\b
Examples:
  uqfold compare folding-wing
  uqfold compare series --method ffni-spa,mc --threshold 2,4
  uqfold compare folding-wing --threshold 0.55,0.56 --tau none,0.04
  uqfold compare folding-wing --missions 10:0.7 --seed 7 --out results
  uqfold compare folding-wing --method mc --store wing.db
"""

Words = list[str] | None


def compare_methods(
    context: typer.Context,
    problem: Annotated[
        str, typer.Argument(metavar="PROBLEM", help="A name from above, or FILE.py:FUNCTION.")
    ],
    *,
    method: Annotated[
        Words, option("NAME", "Method to run; may be repeated. Default: all.")
    ] = None,
    threshold: Annotated[
        Words, option("T", "Response threshold; may be repeated, or T,T,...")
    ] = None,
    tau: Annotated[
        Words, option("TAU", "Synchronization threshold, or none; may be repeated.")
    ] = None,
    missions: Annotated[
        Words,
        option("M", "Number of missions, or PLANNED:P for a binomial number; may be repeated."),
    ] = None,
    max_evals: Annotated[
        int | None, option("N", "Most evaluations per method. Default: suits the problem.")
    ] = None,
    seed: Annotated[int, option("N", "Seed of every method.")] = 0,
    out: Annotated[
        Path | None,
        option("DIR", "Where to write. Default: uqfold-results/PROBLEM, or FILE-FUNCTION there."),
    ] = None,
    no_figures: Annotated[bool, flag("--no-figures", "Draw no figures.")] = False,
    quiet: Annotated[
        bool, flag("--quiet", "Print nothing but errors; the files are written.")
    ] = False,
    failed_runs: Annotated[
        Literal["bound", "count-as-failure", "raise"], option(None, "What a failed run means.")
    ] = "bound",
    store: Annotated[
        Path | None,
        option("FILE", "Keep evaluations in this file and reuse them; resumes what was killed."),
    ] = None,
    cluster: Annotated[
        str | None, option("ADDRESS", "Run the model on a Dask cluster, as in tcp://...")
    ] = None,
    max_seconds: Annotated[
        float | None, option("S", "Wall-clock limit of each method. Default: none.")
    ] = None,
    progress: Annotated[
        Literal["bar", "json"],
        option(None, "A bar (on terminals only), or lines of JSON on the standard error."),
    ] = "bar",
) -> None:
    """Compare methods on a problem."""
    chosen = usage(named_problem, problem)
    asked = usage(chosen.problem)

    from uqfold.cli.words import chosen_criteria, listed
    from uqfold.comparison.plan import plan_comparison
    from uqfold.evaluation import Dask, Evaluator

    def checked_plan() -> ComparisonPlan:
        return plan_comparison(
            asked,
            None if method is None else listed(method),
            chosen_criteria(asked.default_criteria, threshold, tau, missions),
            max_evals=chosen.max_evals if max_evals is None else max_evals,
            rng=seed,
            evaluator=Evaluator(
                failed_runs=failed_runs,
                batch_rows=BATCH_ROWS if cluster is None else None,
                store=store,
                executor=None if cluster is None else Dask(cluster),
                max_seconds=max_seconds,
            ),
        )

    plan = usage(checked_plan)
    folder = Path("uqfold-results", chosen.name) if out is None else out
    try:
        check_writable(folder)
    except OSError as error:
        raise typer.BadParameter(f"--out {os_error_text(error)}") from error
    code = _compare(
        plan, folder, context.obj, figures=not no_figures, quiet=quiet, lines=progress == "json"
    )
    raise typer.Exit(code)


def _compare(
    plan: ComparisonPlan,
    folder: Path,
    invocation: Invocation,
    *,
    figures: bool,
    quiet: bool,
    lines: bool,
) -> int:
    """Run all methods and report; return the exit code of the program.

    Every finished method is saved at once. An interruption ends the run, but the methods that
    finished are kept and shown.
    """
    from uqfold.comparison.records import write_records
    from uqfold.evaluation import EngineError, FailedRunError
    from uqfold.report.figures import figure_paths

    frame, code = None, 0
    try:
        for frame in _watched(plan, invocation, quiet=quiet, lines=lines):
            if len(frame.attrs["uqfold-comparison"]["finished"]) == 1:
                # figures of an earlier comparison would not belong to these records
                for path in figure_paths(folder):
                    path.unlink(missing_ok=True)
            write_records(frame, folder)
    except KeyboardInterrupt:
        _say_interrupted(plan, frame, folder, invocation)
        code = EXIT_INTERRUPTED
    except (FailedRunError, EngineError) as error:
        say(f"error: {error}")
        code = EXIT_FAILED
    except OSError as error:
        # the methods that finished are still shown
        say(f"error: {os_error_text(error)}")
        figures, code = False, EXIT_USAGE
    if frame is not None:
        _show(frame, folder, figures=figures, quiet=quiet)
    if code == 0 and (frame is None or frame["pf"].isna().all()):
        say("error: no method has an answer")
        code = EXIT_FAILED
    return code


def _watched(
    plan: ComparisonPlan, invocation: Invocation, *, quiet: bool, lines: bool
) -> Iterator[pd.DataFrame]:
    """Yield the comparison so far after each method, with progress on the standard error."""
    from rich.console import Console

    from uqfold.comparison.run import run_comparison
    from uqfold.provenance import shown_command
    from uqfold.report.progress import ComparisonProgressBar, ProgressLines, notice_if_slow

    terminal = Console(stderr=True, quiet=quiet)
    with notice_if_slow(COMPILING, terminal):
        run_once(plan.problem)
    check = invocation.interrupts.check
    told = ProgressLines(sys.stderr) if lines else None
    with told or ComparisonProgressBar(list(plan.methods), terminal) as bar:

        def progress(label: str, n_evals: int, expected: int | None) -> None:
            check()
            bar(label, n_evals, expected)

        watched = replace(plan, evaluator=replace(plan.evaluator, watch=bar.watch))
        command = shown_command(["uqfold", *invocation.words])
        for frame in run_comparison(watched, progress, command):
            # what was interrupted may look finished where a library swallowed the interruption
            check()
            yield frame


def _show(frame: pd.DataFrame, folder: Path, *, figures: bool, quiet: bool) -> None:
    """Print the table, draw the figures, and say what has been written."""
    from uqfold.comparison.records import CSV_NAME, JSON_NAME
    from uqfold.report.figures import write_figures
    from uqfold.report.table import ComparisonTable

    out = stdout_console(quiet=quiet)
    names = [CSV_NAME, JSON_NAME]
    try:
        out.print(ComparisonTable(frame))
    finally:
        # the files are written whether or not anybody can read the table
        if figures:
            names += [path.name for path in write_figures(frame, folder)]
    written = f"\nwritten to {shown_path(folder)}: {', '.join(names)}"
    out.print(written, highlight=False, markup=False)


def _say_interrupted(
    plan: ComparisonPlan, frame: pd.DataFrame | None, folder: Path, invocation: Invocation
) -> None:
    from uqfold.evaluation import Store

    if frame is None:
        say("interrupted before any method finished; nothing was written")
    else:
        finished = frame["label"].unique()
        kept = f"{len(finished)} of {len(plan.methods)} methods finished and are kept in"
        say(f"interrupted: {kept} {shown_path(folder)}: {', '.join(finished)}")
    store = plan.evaluator.store
    if isinstance(store, Store):
        kept = f"{len(store):,} evaluations are kept in {shown_path(store.path)}"
        say(f"{kept}; to go on from there: {shlex.join(['uqfold', *invocation.words])}")


def say(text: str) -> None:
    """Say something on the standard error, also when quiet, in one line."""
    print(text, file=sys.stderr, flush=True)


def run_once(problem: Problem) -> None:
    """Run the model once at the median inputs, outside any count, so that it gets compiled.

    Otherwise the first method would be charged with the compilation. What the model has against
    these inputs is for the methods to find out.
    """
    import numpy as np

    with contextlib.suppress(Exception, SystemExit):
        x = problem.inputs.from_standard_normal(np.zeros((1, problem.inputs.dimension)))
        problem.model(x)


def stdout_console(*, quiet: bool) -> Console:
    """Return the console of the standard output; into a pipe or file the table is set wide."""
    from rich.console import Console

    piped = not sys.stdout.isatty() and "COLUMNS" not in os.environ
    return Console(width=PIPED_WIDTH if piped else None, quiet=quiet)
