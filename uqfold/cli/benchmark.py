"""The command ``uqfold benchmark``: answer, keep, go on, and write the league table."""

from __future__ import annotations

import math
import os
import shlex
from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from uqfold.cli.invocation import AsJson, Invocation, Words, flag, option, say_json, usage
from uqfold.cli.streams import EXIT_INTERRUPTED, os_error_text, say, shown_path, stdout_console
from uqfold.comparison.named_problems import available_problems
from uqfold.methods.registry import built_in
from uqfold.writing import check_writable

if TYPE_CHECKING:
    import pandas as pd

BENCHMARK_HELP = """Ask many methods about many problems with known answers, with several seeds.

Prints a league table, and writes it as a page with profiles. Every answer is appended to
rows.jsonl as it ends: the same command goes on after an interruption, and makes again what other
code has made.

\b
Examples:
  uqfold benchmark --workers 2
  uqfold benchmark --method auto,qmc --problem rp22,four-branch --seeds 10
  uqfold benchmark --problem mine.py:problem --max-evals 1e5 --out results
  uqfold benchmark --method auto,mine.py:methods --report league.md
"""

_MAY_GO = (
    "p",
    "bias",
    "covered",
    "clean",
    "rms error",
    "evaluations",
    "no answer",
    "time",
    "right",
)
"""Columns that are left out where there is no room, one after the other."""


def benchmark_methods(
    context: typer.Context,
    *,
    method: Annotated[
        Words,
        typer.Option(
            metavar="NAME",
            help="Method, or FILE.py:FUNCTION for a dict of them; may be repeated. Default: all.",
            autocompletion=built_in,
        ),
    ] = None,
    problem: Annotated[
        Words,
        typer.Option(
            metavar="NAME",
            help="Problem, FILE.toml or FILE.py:FUNCTION; may be repeated. Default: the catalogue.",
            autocompletion=lambda: list(available_problems()),
        ),
    ] = None,
    seeds: Annotated[int, option("N", "How many seeds, counted from zero.")] = 3,
    max_evals: Annotated[float, option("N", "Most evaluations for an answer.")] = 6_000,
    max_seconds: Annotated[
        float | None, option("S", "Wall-clock limit of each answer. Default: none.")
    ] = None,
    workers: Annotated[int, option("N", "Processes that share the work.")] = 1,
    cluster: Annotated[
        str | None, option("ADDRESS", "Share the work on a Dask cluster, as in tcp://...")
    ] = None,
    out: Annotated[Path, option("DIR", "Where to write.")] = Path("uqfold-results/benchmark"),
    report: Annotated[
        Path | None, option("FILE", "The page, .html or .md. Default: report.html in DIR.")
    ] = None,
    quiet: Annotated[
        bool, flag("--quiet", "Print nothing but errors; the files are written.")
    ] = False,
    as_json: AsJson = False,
) -> None:
    """Compare methods on many problems."""
    from rich.console import Console

    from uqfold.cli.words import listed
    from uqfold.comparison.benchmark_rows import ROWS_NAME
    from uqfold.comparison.benchmark_run import benchmark
    from uqfold.comparison.form import encoded
    from uqfold.comparison.league import league_table
    from uqfold.evaluation import Dask
    from uqfold.methods.arguments import checked_budget
    from uqfold.provenance import shown_command
    from uqfold.report.benchmark_page import benchmark_page, league_cells
    from uqfold.report.page.builder import page_path
    from uqfold.report.progress import ComparisonProgressBar
    from uqfold.report.table import joined, text_columns

    invocation: Invocation = context.obj
    page = usage(page_path, "report", report or out / "report.html")
    try:
        check_writable(out)
    except OSError as error:
        raise typer.BadParameter(f"--out {os_error_text(error)}") from error
    command, counted = shown_command(["uqfold", *invocation.words]), [0, 0]
    bar = ComparisonProgressBar(["benchmark"], Console(stderr=True, quiet=quiet), unit="answers")

    def progress(done: int, asked: int) -> None:
        invocation.interrupts.check()
        counted[:] = done, asked
        bar("benchmark", done, asked)

    def answers() -> pd.DataFrame:
        return benchmark(
            None if method is None else listed(method),
            None if problem is None else listed(problem),
            seeds,
            max_evals=checked_budget(max_evals),
            path=out / ROWS_NAME,
            workers=workers if cluster is None else Dask(cluster).client.get_executor(),
            max_seconds=max_seconds,
            progress=progress,
            command=command,
        )

    try:
        with bar:
            frame = usage(answers)
    except KeyboardInterrupt:
        done, asked = counted
        say(f"interrupted: {done} of {asked} answers are kept in {shown_path(out / ROWS_NAME)}; "
            f"to go on: {shlex.join(['uqfold', *invocation.words])}")  # fmt: skip
        raise typer.Exit(EXIT_INTERRUPTED) from None
    console, cells = stdout_console(quiet=quiet or as_json), league_cells(frame)
    if as_json:
        say_json(encoded(league_table(frame).to_dict("records")))
    # a file has room for all
    narrow = console.is_terminal or "COLUMNS" in os.environ
    columns = text_columns(cells, (), console.width if narrow else math.inf, _MAY_GO)
    for line in joined(columns):
        console.print(line, soft_wrap=True)
    if left_out := [name for name in cells.columns if name not in columns]:
        said = f"no room for: {', '.join(left_out)} (on the page they are)"
        console.print(f"\n{said}", highlight=False, markup=False, soft_wrap=True)
    for text in _cut_short(frame):
        console.print(f"\n{text}", highlight=False, markup=False, soft_wrap=True)
    written = usage(benchmark_page(frame, command).write, page)
    names = ", ".join(map(shown_path, [out / ROWS_NAME, *written]))
    console.print(f"\nwritten: {names}", highlight=False, markup=False, soft_wrap=True)


def _cut_short(frame: pd.DataFrame) -> Iterator[str]:
    """Say which answers the limit of time has ended."""
    from uqfold.evaluation.deadline import limit_told

    ended = frame[[limit_told(message) is not None for message in frame["message"]]]
    if len(ended):
        whose = ", ".join(f"{label} {n}" for label, n in ended["label"].value_counts().items())
        yield f"ended by --max-seconds, {len(ended)} of {len(frame)} answers: {whose}"
