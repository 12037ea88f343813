"""The command ``uqfold compare``: save after every method, show, draw."""

from __future__ import annotations

import contextlib
import shlex
import textwrap
from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Literal

import typer

from uqfold.cli.invocation import AsJson, Invocation, Words, flag, option, usage
from uqfold.cli.streams import (
    EXIT_FAILED,
    EXIT_INTERRUPTED,
    EXIT_USAGE,
    os_error_text,
    say,
    shown_path,
    stdout_console,
)
from uqfold.comparison.named_problems import available_problems, named_problem
from uqfold.methods.registry import built_in
from uqfold.problems.catalogue.folder import titles
from uqfold.writing import check_writable

if TYPE_CHECKING:
    import pandas as pd

    from uqfold.evaluation import Evaluator
    from uqfold.problems.base import Problem

BATCH_ROWS = 1024
"""Evaluations in this process between two looks at Ctrl-C; has no influence on any number."""
COMPILING = "preparing the model (compiled on first use, 10 to 20 s) ..."


_NAMED = {name: one.description for name, one in available_problems().items()}
_LISTED = "\n".join(f"  {name:<27}  {_NAMED[name]}" for name in _NAMED if name not in titles())
_METHODS = textwrap.fill(", ".join(built_in()), 76, initial_indent="  ", subsequent_indent="  ",
                         break_on_hyphens=False)  # fmt: skip
COMPARE_HELP = f"""Compare reliability methods on one problem.

Runs every method on the same grid of criteria, prints one table, and writes records (CSV, JSON)
and figures (PNG, SVG).

\b
Problems:
{_LISTED}
  FILE.py:FUNCTION             what a function of your own returns
  FILE.toml                    model, inputs and criteria in a file
  and {len(titles())} limit states of the literature, which "uqfold problems" lists

\b
Methods, which "uqfold methods" describes:
{_METHODS}

\b
Examples:
  uqfold compare folding-wing
  uqfold compare my_model.py:problem --reference 1.2e-3
  uqfold compare series --method ffni-spa,mc --threshold 2,4
  uqfold compare folding-wing --threshold 0.55,0.56 --tau none,0.04
  uqfold compare folding-wing --missions 10:0.7 --seed 7 --out results
  uqfold compare folding-wing --method mc --store wing.db
"""


def compare_methods(
    context: typer.Context,
    problem: Annotated[
        str,
        typer.Argument(
            metavar="PROBLEM",
            help="A name from above, FILE.py:FUNCTION or FILE.toml.",
            autocompletion=lambda: list(_NAMED),
        ),
    ],
    *,
    method: Annotated[
        Words,
        typer.Option(
            metavar="NAME",
            help="Method to run; may be repeated. Default: all.",
            autocompletion=built_in,
        ),
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
        float | None, option("N", "Most evaluations per method. Default: suits the problem.")
    ] = None,
    reference: Annotated[
        str | None,
        option("PF", "Known pf, or PF,PF,... by criterion; or a folder of records of one method."),
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
    as_json: AsJson = False,
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
) -> None:
    """Compare methods on a problem."""
    chosen = usage(named_problem, problem)
    asked = usage(chosen.problem)

    from rich.console import Console

    from uqfold.cli.words import chosen_criteria, known_reference, listed
    from uqfold.comparison.run import labelled_methods, run_comparison
    from uqfold.evaluation import Dask, Evaluator
    from uqfold.methods.arguments import checked_budget
    from uqfold.provenance import shown_command
    from uqfold.report.progress import ComparisonProgressBar

    invocation: Invocation = context.obj
    methods = usage(labelled_methods, None if method is None else listed(method))
    terminal = Console(stderr=True, quiet=quiet)
    bar = ComparisonProgressBar(list(methods), terminal)

    def progress(label: str, n_evals: int, expected: int | None) -> None:
        invocation.interrupts.check()
        bar(label, n_evals, expected)

    def checked() -> tuple[Evaluator, Iterator[pd.DataFrame]]:
        evaluator = Evaluator(
            failed_runs=failed_runs,
            batch_rows=BATCH_ROWS if cluster is None else None,
            store=store,
            executor=None if cluster is None else Dask(cluster),
            max_seconds=max_seconds,
            watch=bar.watch,
        )
        return evaluator, run_comparison(
            asked,
            methods,
            chosen_criteria(asked.default_criteria, threshold, tau, missions),
            max_evals=chosen.max_evals if max_evals is None else checked_budget(max_evals),
            rng=seed,
            reference=None if reference is None else known_reference(reference),
            evaluator=evaluator,
            progress=progress,
            command=shown_command(["uqfold", *invocation.words]),
        )

    evaluator, comparisons = usage(checked)
    folder = Path("uqfold-results", chosen.name) if out is None else out
    try:
        check_writable(folder)
        _check_same_problem(folder, asked.name)
    except OSError as error:
        raise typer.BadParameter(f"--out {os_error_text(error)}") from error

    def watched() -> Iterator[pd.DataFrame]:
        with terminal.status(COMPILING):
            run_once(asked)
        with bar:
            for frame in comparisons:
                # what was interrupted may look finished where a library swallowed the interruption
                invocation.interrupts.check()
                yield frame

    frame, code = _saved(watched(), folder, invocation, evaluator)
    if frame is not None:
        if as_json:
            typer.echo((folder / "comparison.json").read_text(encoding="utf-8"), nl=False)
        _show(
            frame,
            folder,
            figures=not no_figures and code != EXIT_USAGE,
            quiet=quiet or as_json,
        )
    if code == 0 and (frame is None or frame["pf"].isna().all()):
        say("error: no method has an answer")
        code = EXIT_FAILED
    raise typer.Exit(code)


def _check_same_problem(folder: Path, name: str) -> None:
    """Refuse a folder that holds the records of another problem."""
    from uqfold.comparison.columns import ATTRIBUTE
    from uqfold.comparison.records import RecordsError, read_records

    with contextlib.suppress(RecordsError, OSError):
        held = read_records(folder).attrs[ATTRIBUTE]["problem"]
        if held != name:
            where = shown_path(folder)
            raise typer.BadParameter(f"--out {where} holds records of {held!r}: give another")


def _saved(
    comparisons: Iterator[pd.DataFrame],
    folder: Path,
    invocation: Invocation,
    evaluator: Evaluator,
) -> tuple[pd.DataFrame | None, int]:
    """Save every finished method at once; return all that finished, and the exit code.

    An interruption ends the run, but the methods that finished are kept.
    """
    from uqfold.comparison.records import write_records
    from uqfold.evaluation import EngineError, FailedRunError
    from uqfold.report.comparison_page import figure_paths

    frame = None
    try:
        for frame in comparisons:
            if frame["label"].nunique() == 1:
                # figures of an earlier comparison would not belong to these records
                for path in figure_paths(folder):
                    path.unlink(missing_ok=True)
            write_records(frame, folder)
    except KeyboardInterrupt:
        _say_interrupted(frame, folder, invocation, evaluator)
        return frame, EXIT_INTERRUPTED
    except (FailedRunError, EngineError) as error:
        say(f"error: {error}")
        return frame, EXIT_FAILED
    except OSError as error:
        # the methods that finished are still shown
        say(f"error: {os_error_text(error)}")
        return frame, EXIT_USAGE
    return frame, 0


def _show(frame: pd.DataFrame, folder: Path, *, figures: bool, quiet: bool) -> None:
    """Print the table, draw the figures, and say what has been written."""
    from uqfold.comparison.records import CSV_NAME, JSON_NAME
    from uqfold.report.comparison_page import write_figures
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
    frame: pd.DataFrame | None, folder: Path, invocation: Invocation, evaluator: Evaluator
) -> None:
    from uqfold.comparison.columns import ATTRIBUTE
    from uqfold.evaluation import Store

    if frame is None:
        say("interrupted before any method finished; nothing was written")
    else:
        header = frame.attrs[ATTRIBUTE]
        finished, asked = header["finished"], header["methods"]
        kept = f"{len(finished)} of {len(asked)} methods finished and are kept in"
        say(f"interrupted: {kept} {shown_path(folder)}: {', '.join(finished)}")
    if isinstance(evaluator.store, Store):
        kept = (
            f"{len(evaluator.store):,} evaluations are kept in {shown_path(evaluator.store.path)}"
        )
        say(f"{kept}; to go on from there: {shlex.join(['uqfold', *invocation.words])}")


def run_once(problem: Problem) -> None:
    """Run the model once at the median inputs, outside any count, so that it gets compiled.

    Otherwise the first method would be charged with the compilation. What the model has against
    these inputs is for the methods to find out.
    """
    import numpy as np

    with contextlib.suppress(Exception, SystemExit):
        x = problem.inputs.from_standard_normal(np.zeros((1, problem.inputs.dimension)))
        problem.model(x)
