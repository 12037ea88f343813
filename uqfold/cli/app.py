"""The commands and their options."""

from __future__ import annotations

import shlex
import sys
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, cast

import typer

import uqfold
from uqfold.cli.interrupts import Interrupts
from uqfold.cli.invocation import Invocation, usage
from uqfold.cli.report import REPORT_HELP, report_command
from uqfold.cli.streams import exit_code_of, flush_streams, open_streams, os_error_text
from uqfold.cli.validate import VALIDATE_HELP, validate_cases
from uqfold.comparison.named_problems import available_problems, named_problem
from uqfold.writing import check_writable

if TYPE_CHECKING:
    from uqfold.evaluation.session import FailedRunPolicy

BATCH_ROWS = 1024
"""Runs in this process between two looks at Ctrl-C; has no influence on any number."""

_WIDEST_CASE = max(map(len, available_problems()))
_CASES = "\n".join(
    f"  {case.name:<{_WIDEST_CASE}}  {case.description}" for case in available_problems().values()
)

_APP_HELP = """How reliable is this system, and which method tells us most cheaply?

\b
Examples:
  uqfold compare folding-wing
  uqfold compare --help
  uqfold validate --quick
  uqfold report uqfold-results/folding-wing
  uqfold methods
"""

_COMPARE_HELP = f"""Compare reliability methods on one case.

Runs every method on the same grid of criteria, prints one table, and writes records (CSV, JSON)
and figures (PNG, SVG).

\b
Cases:
{_CASES}

\b
Examples:
  uqfold compare folding-wing
  uqfold compare series --method ffni-spa --method mc --threshold 2 --threshold 4
  uqfold compare folding-wing --threshold 0.55,0.56 --tau none,0.04 --missions 1,5
  uqfold compare folding-wing --missions 10:0.7 --max-evals 5000 --seed 7 --out results
  uqfold compare folding-wing --method mc --max-evals 8000000 --store wing.db
"""

_METHODS_HELP = """List the methods that can be compared.

The built-in ones, and those that other installed packages add.

\b
Example:
  uqfold methods
"""


app = typer.Typer(
    name="uqfold",
    help=_APP_HELP,
    no_args_is_help=True,
    add_completion=False,
    # plain messages: they stay whole, and can be searched and copied
    rich_markup_mode=None,
    pretty_exceptions_enable=False,
)


def main(arguments: Sequence[str] | None = None) -> None:
    """Run the command line and exit.

    Parameters
    ----------
    arguments
        The words after the program's name; None takes those of this process.
    """
    words = list(sys.argv[1:] if arguments is None else arguments)
    open_streams()
    try:
        try:
            # before anything starts a thread: threads inherit what is said about signals
            with Interrupts() as interrupts:
                app(args=words, prog_name="uqfold", obj=Invocation(words, interrupts))
        finally:
            flush_streams()
    except OSError as error:
        # None: an error of the exit, not of the program
        raise SystemExit(exit_code_of(error)) from None


def _show_version(asked: bool) -> None:
    if asked:
        typer.echo(f"uqfold {uqfold.__version__}")
        raise typer.Exit


@app.callback()
def _common(
    version: Annotated[
        bool,
        typer.Option("--version", callback=_show_version, is_eager=True, help="Show the version."),
    ] = False,
) -> None:
    pass


@app.command(name="compare", help=_COMPARE_HELP)
def compare_methods(
    context: typer.Context,
    case: Annotated[str, typer.Argument(metavar="CASE", help="One of the cases above.")],
    *,
    method: Annotated[
        list[str] | None,
        typer.Option(metavar="NAME", help="Method to run; may be repeated. Default: all."),
    ] = None,
    threshold: Annotated[
        list[str] | None,
        typer.Option(metavar="T", help="Response threshold; may be repeated, or T,T,..."),
    ] = None,
    tau: Annotated[
        list[str] | None,
        typer.Option(metavar="TAU", help="Synchronization threshold, or none; may be repeated."),
    ] = None,
    missions: Annotated[
        list[str] | None,
        typer.Option(
            metavar="M",
            help="Number of missions, or PLANNED:P for a binomial number; may be repeated.",
        ),
    ] = None,
    max_evals: Annotated[
        int | None,
        typer.Option(metavar="N", help="Most model runs per method. Default: suits the case."),
    ] = None,
    seed: Annotated[int, typer.Option(metavar="N", help="Seed of every method.")] = 0,
    out: Annotated[
        Path | None,
        typer.Option(metavar="DIR", help="Where to write. Default: uqfold-results/CASE."),
    ] = None,
    no_figures: Annotated[bool, typer.Option("--no-figures", help="Draw no figures.")] = False,
    quiet: Annotated[
        bool, typer.Option("--quiet", help="Print nothing but errors; the files are written.")
    ] = False,
    failed_runs: Annotated[
        str,
        typer.Option(
            metavar="POLICY",
            help="What a failed model run means: bound, count-as-failure or raise.",
        ),
    ] = "bound",
    store: Annotated[
        Path | None,
        typer.Option(
            metavar="FILE",
            help="Keep model runs in this file and reuse those in it; resumes what was killed.",
        ),
    ] = None,
    cluster: Annotated[
        str | None,
        typer.Option(metavar="ADDRESS", help="Run the model on a Dask cluster, as in tcp://..."),
    ] = None,
    max_seconds: Annotated[
        float | None,
        typer.Option(metavar="S", help="Wall-clock limit of each method. Default: none."),
    ] = None,
    progress: Annotated[
        str,
        typer.Option(
            metavar="KIND", help="bar (on terminals only), or json: lines on the standard error."
        ),
    ] = "bar",
) -> None:
    """Compare methods on a case."""
    chosen = usage(named_problem, case)
    problem = chosen.problem()

    from uqfold.cli.compare import ComparisonSession
    from uqfold.cli.words import chosen_criteria, chosen_word, listed
    from uqfold.comparison.plan import ComparisonPlan, plan_comparison
    from uqfold.evaluation import Dask, Evaluator
    from uqfold.problems.criterion import Criteria
    from uqfold.provenance import shown_command

    def plan() -> ComparisonPlan:
        return plan_comparison(
            problem,
            None if method is None else listed(method),
            chosen_criteria(Criteria(problem.default_criteria or ()), threshold, tau, missions),
            max_evals=chosen.max_evals if max_evals is None else max_evals,
            rng=seed,
            evaluator=Evaluator(
                # the evaluator itself refuses other policies
                failed_runs=cast("FailedRunPolicy", failed_runs),
                batch_rows=BATCH_ROWS if cluster is None else None,
                store=store,
                executor=None if cluster is None else Dask(cluster),
                max_seconds=max_seconds,
            ),
        )

    kind = usage(chosen_word, progress, "progress", ("bar", "json"))
    planned = usage(plan)
    folder = Path("uqfold-results", chosen.name) if out is None else out
    try:
        check_writable(folder)
    except OSError as error:
        raise typer.BadParameter(f"--out {os_error_text(error)}") from error
    invocation: Invocation = context.obj
    session = ComparisonSession(
        planned,
        shown_command(["uqfold", *invocation.words]),
        folder,
        invocation.interrupts,
        figures=not no_figures,
        quiet=quiet,
        progress_lines=kind == "json",
        resume=shlex.join(["uqfold", *invocation.words]),
    )
    raise typer.Exit(session.run())


@app.command(name="methods", help=_METHODS_HELP)
def list_methods() -> None:
    """Print name and title of every method."""
    from uqfold.methods import available

    methods = available()
    width = max(map(len, methods))
    for name, method in methods.items():
        typer.echo(f"{name:<{width}}  {method.title}".rstrip())


app.command(name="report", help=REPORT_HELP)(report_command)


@app.command(name="study", hidden=True, context_settings={"ignore_unknown_options": True})
def tell_about_studies(words: Annotated[list[str] | None, typer.Argument()] = None) -> None:
    """Say that studies are scripts; until the next release."""
    raise typer.BadParameter("studies are scripts now, run python studies/<name>/study.py --help")


app.command(name="validate", help=VALIDATE_HELP)(validate_cases)
