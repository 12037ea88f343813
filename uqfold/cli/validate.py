"""The command ``uqfold validate``."""

from __future__ import annotations

import shlex
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from uqfold.cli.invocation import Invocation, usage

if TYPE_CHECKING:
    from uqfold.validation.case import Tier

VALIDATE_HELP = """Measure the validation cases, and say what holds.

Each case states one claim, what it is compared with, and a tolerance with its reason.

\b
Exit code:
  0  every verdict is the one of the record kept beside its case, "does not hold"
     included; a case without such a record is expected to hold
  1  a verdict has changed
  2  something broke: a case could not be measured, a planted fault went unnoticed,
     or a word of the command is wrong

\b
Tiers:
  --quick     small sizes, under two minutes in all
  (default)   under ten minutes; also plants every case's faults
  --full      full sizes, an hour or more; goes on where it was interrupted

\b
Examples:
  uqfold validate --quick
  uqfold validate against_scipy mechanism_limits
  uqfold validate --list
  uqfold validate --check
"""


def validate_cases(
    context: typer.Context,
    names: Annotated[
        list[str] | None,
        typer.Argument(metavar="CASE", help="Cases to measure. Default: all."),
    ] = None,
    *,
    quick: Annotated[bool, typer.Option("--quick", help="Small sizes.")] = False,
    full: Annotated[bool, typer.Option("--full", help="Full sizes; resumes.")] = False,
    out: Annotated[
        Path | None,
        typer.Option(
            metavar="DIR", help="Where to write. Default: uqfold-results/validation[-TIER]."
        ),
    ] = None,
    faults: Annotated[
        bool | None,
        typer.Option(
            "--faults/--no-faults",
            help="Plant the cases' faults, each of which has to be noticed. Default: yes, except "
            "with --quick without --update.",
        ),
    ] = None,
    update: Annotated[
        bool,
        typer.Option(
            "--update",
            help="Replace the records kept beside the cases, whose verdicts become the kept ones.",
        ),
    ] = False,
    stale: Annotated[
        bool,
        typer.Option(
            "--stale",
            help="Only cases whose kept record is missing, or was measured with other code.",
        ),
    ] = False,
    check: Annotated[
        bool,
        typer.Option(
            "--check", help="Measure nothing: do cases, kept records, code and report agree?"
        ),
    ] = False,
    show: Annotated[bool, typer.Option("--list", help="Measure nothing: list the cases.")] = False,
    cases: Annotated[
        Path | None,
        typer.Option(metavar="DIR", help="Folder of the cases. Default: validation."),
    ] = None,
) -> None:
    """Measure validation cases."""
    from uqfold.cli import validation_session as session
    from uqfold.validation.case import find_cases

    if quick and full:
        raise typer.BadParameter("--quick and --full: give one of them")
    if (update or stale) and not (quick or full):
        raise typer.BadParameter(
            "--update and --stale are for the tiers whose records are kept: add --quick or --full"
        )
    found = usage(find_cases, cases or session.default_cases(), names or ())
    if show:
        session.print_cases(found)
        return
    if check:
        raise typer.Exit(session.check_cases(found))
    tier: Tier = "quick" if quick else "full" if full else "default"
    if stale:
        found = session.stale_cases(found, tier)
        if not found:
            return
    name = "validation" if tier == "default" else f"validation-{tier}"
    invocation: Invocation = context.obj
    measuring = session.ValidationSession(
        found,
        tier,
        Path("uqfold-results", name) if out is None else out,
        invocation.interrupts,
        faults=update or not quick if faults is None else faults,
        update=update,
        resume=shlex.join(["uqfold", *invocation.words]),
    )
    raise typer.Exit(measuring.run())
