"""The program and its commands."""

from __future__ import annotations

import sys
import warnings
from collections.abc import Mapping, Sequence
from typing import Annotated, Any

import typer

import uqfold
from uqfold.cli.benchmark import BENCHMARK_HELP, benchmark_methods
from uqfold.cli.compare import COMPARE_HELP, compare_methods
from uqfold.cli.doctor import DOCTOR_HELP, examine
from uqfold.cli.invocation import AsJson, Interrupts, Invocation, say_json
from uqfold.cli.report import REPORT_HELP, report_command
from uqfold.cli.serve import SERVE_HELP, serve_problem
from uqfold.cli.streams import exit_code_of, flush_streams, open_streams
from uqfold.cli.validate import VALIDATE_HELP, validate_cases
from uqfold.comparison.named_problems import available_problems

_APP_HELP = """How reliable is this system, and which method tells us most cheaply?

\b
Examples:
  uqfold compare folding-wing
  uqfold compare --help
  uqfold benchmark --workers 2
  uqfold validate --quick
  uqfold report uqfold-results/folding-wing
  uqfold methods
  uqfold problems
  uqfold doctor
"""

_METHODS_HELP = """List the methods that can be compared.

The built-in ones, and those that other installed packages add.

\b
Example:
  uqfold methods
"""

_PROBLEMS_HELP = """List the problems that methods can be compared on.

Any other is given as FILE.py:FUNCTION, or stated in FILE.toml.

\b
Example:
  uqfold problems
"""

app = typer.Typer(
    name="uqfold",
    help=_APP_HELP,
    no_args_is_help=True,
    context_settings={"help_option_names": ["-h", "--help"]},
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
    formatted, warnings.formatwarning = warnings.formatwarning, _warning_line
    try:
        try:
            with Interrupts() as interrupts:
                app(args=words, prog_name="uqfold", obj=Invocation(words, interrupts))
        finally:
            flush_streams()
    except OSError as error:
        # None: an error of the exit, not of the program
        raise SystemExit(exit_code_of(error)) from None
    finally:
        warnings.formatwarning = formatted


def _warning_line(message: Warning | str, *_: Any, **__: Any) -> str:
    return f"warning: {message}\n"


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


app.command(name="compare", help=COMPARE_HELP)(compare_methods)
app.command(name="benchmark", help=BENCHMARK_HELP)(benchmark_methods)
app.command(name="report", help=REPORT_HELP)(report_command)
app.command(name="validate", help=VALIDATE_HELP)(validate_cases)
app.command(name="serve", help=SERVE_HELP)(serve_problem)
app.command(name="doctor", help=DOCTOR_HELP)(examine)


@app.command(name="methods", help=_METHODS_HELP)
def list_methods(*, as_json: AsJson = False) -> None:
    """Print name and title of every method."""
    from uqfold.methods import available

    _list({name: method.title for name, method in available().items()}, as_json)


@app.command(name="problems", help=_PROBLEMS_HELP)
def list_problems(*, as_json: AsJson = False) -> None:
    """Print name and description of every named problem."""
    _list({name: one.description for name, one in available_problems().items()}, as_json)


def _list(titles: Mapping[str, str], as_json: bool) -> None:
    if as_json:
        say_json(titles)
        return
    width = max(map(len, titles))
    for name, title in titles.items():
        typer.echo(f"{name:<{width}}  {title}".rstrip())


@app.command(name="study", hidden=True, context_settings={"ignore_unknown_options": True})
def tell_about_studies(words: Annotated[list[str] | None, typer.Argument()] = None) -> None:
    """Say that studies are scripts; until the next release."""
    raise typer.BadParameter("studies are scripts now, run python studies/<name>/study.py --help")
