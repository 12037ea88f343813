"""The commands on studies."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

if TYPE_CHECKING:
    from uqfold.cli.invocation import Invocation

QUICK_FOLDER = Path("uqfold-results", "studies-quick")
DEFAULT_ROOT = Path("studies")

_HELP = """Run declarative studies: a folder with a study.toml, and what it leads to.

\b
Examples:
  uqfold study list
  uqfold study run studies/example-1
  uqfold study check
"""

_RUN_HELP = """Run studies: write their tables (CSV), figures (PNG, SVG) and report.md.

Model runs and finished jobs are kept, so that a second run redraws in seconds and one that was
interrupted goes on where it stopped.

\b
Examples:
  uqfold study run studies/example-1
  uqfold study run studies/example-1 --redraw
  uqfold study run studies/example-1 --quick --out try
  uqfold study run my-study --store my-runs
"""

_LIST_HELP = """List the studies in a folder, what they ask, and the state of their results.

\b
Examples:
  uqfold study list
  uqfold study list my-studies
"""

_CHECK_HELP = """Check studies: their files, and whether their results are what a fresh run gives.

The file is read and checked; the committed tables must be those of the record, made from this very
file; and a fresh reduced run must give the same numbers, within the tolerances that the study
states under [check].

\b
Examples:
  uqfold study check
  uqfold study check studies/example-1 --no-run
"""

_KEYS_HELP = """Print the reference of all keys of a study file, in Markdown.

\b
Example:
  uqfold study keys
"""

study_app = typer.Typer(
    name="study", help=_HELP, no_args_is_help=True, rich_markup_mode=None, add_completion=False
)

_Folders = Annotated[
    list[Path] | None,
    typer.Argument(
        metavar="[FOLDER]...", help="Folders with a study.toml. Default: all in studies."
    ),
]
_Store = Annotated[
    Path | None,
    typer.Option(metavar="DIR", help="Where runs and jobs are kept. Default: .cache beside it."),
]


@study_app.command(name="run", help=_RUN_HELP)
def run_studies(
    context: typer.Context,
    folders: Annotated[
        list[Path], typer.Argument(metavar="FOLDER...", help="Folders with a study.toml.")
    ],
    *,
    quick: Annotated[
        bool, typer.Option("--quick", help="Reduced form, into uqfold-results/studies-quick.")
    ] = False,
    out: Annotated[
        Path | None,
        typer.Option(metavar="DIR", help="Where to write. Default: the study's own folder."),
    ] = None,
    store: _Store = None,
    no_store: Annotated[bool, typer.Option("--no-store", help="Keep and reuse nothing.")] = False,
    redraw: Annotated[
        bool, typer.Option("--redraw", help="Run nothing; draw anew from the results.")
    ] = False,
    quiet: Annotated[bool, typer.Option("--quiet", help="Print nothing but errors.")] = False,
) -> None:
    """Run studies."""
    from uqfold.cli.study_session import Options, run_all

    if out is not None and len(folders) > 1:
        raise typer.BadParameter("--out takes the results of one study: give one folder")
    if redraw and quick:
        raise typer.BadParameter("--redraw draws existing results: leave --quick out")
    options = Options(
        quick=quick, out=out, store=store, keep=not no_store, redraw=redraw, quiet=quiet
    )
    raise typer.Exit(run_all(folders, options, context.obj))


@study_app.command(name="list", help=_LIST_HELP)
def list_studies(
    root: Annotated[
        Path, typer.Argument(metavar="[ROOT]", help="Folder of studies.")
    ] = DEFAULT_ROOT,
) -> None:
    """List studies."""
    from uqfold.cli.study_session import show_list

    raise typer.Exit(show_list(root))


@study_app.command(name="check", help=_CHECK_HELP)
def check_studies(
    context: typer.Context,
    folders: _Folders = None,
    *,
    no_run: Annotated[
        bool, typer.Option("--no-run", help="Check the files only; run nothing.")
    ] = False,
    store: _Store = None,
) -> None:
    """Check studies."""
    from uqfold.cli.study_session import check_all

    invocation: Invocation = context.obj
    raise typer.Exit(check_all(folders or None, store, invocation, run=not no_run))


@study_app.command(name="keys", help=_KEYS_HELP)
def show_keys() -> None:
    """Print the reference of all keys."""
    from uqfold.report.studies.key_reference import key_reference

    typer.echo(key_reference(), nl=False)
