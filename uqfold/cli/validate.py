"""The command ``uqfold validate``."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

import uqfold
from uqfold.cli.invocation import AsJson, Invocation, flag, option, usage

if TYPE_CHECKING:
    from uqfold.validation.case import Tier

VALIDATE_HELP = """Measure the validation cases, and say what holds.

Each case states one claim, what it is compared with, and a tolerance with its reason.

\b
Exit code:
  0  every verdict is the one of the record kept beside its case,
     "does not hold" included; a case without a record is expected to hold
  1  a verdict has changed
  2  something broke: a case could not be measured, a planted fault went
     unnoticed, or a word of the command is wrong

\b
Tiers:
  --quick     small sizes, under two minutes in all (the default)
  --full      full sizes, an hour or more; goes on where it was interrupted

\b
Examples:
  uqfold validate --quick
  uqfold validate against_other_codes --full --faults
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
    quick: Annotated[bool, flag("--quick", "Small sizes, the default.")] = False,
    full: Annotated[bool, flag("--full", "Full sizes; resumes.")] = False,
    out: Annotated[
        Path | None, option("DIR", "Where to write. Default: uqfold-results/validation-TIER.")
    ] = None,
    faults: Annotated[
        bool | None,
        flag("--faults/--no-faults", "Plant the faults. Default: only with --update."),
    ] = None,
    update: Annotated[
        bool,
        flag("--update", "Replace the kept records: these verdicts become the kept ones."),
    ] = False,
    stale: Annotated[
        bool, flag("--stale", "Only cases whose kept record is missing or of other code.")
    ] = False,
    check: Annotated[
        bool, flag("--check", "Measure nothing: do cases, kept records, code and report agree?")
    ] = False,
    show: Annotated[bool, flag("--list", "Measure nothing: list the cases.")] = False,
    cases: Annotated[
        Path | None, option("DIR", "Folder of the cases. Default: validation.")
    ] = None,
    as_json: AsJson = False,
) -> None:
    """Measure validation cases."""
    from uqfold.cli import validation_session as session
    from uqfold.validation.case import find_cases
    from uqfold.validation.runner import Validation

    if quick and full:
        raise typer.BadParameter("--quick and --full: give one of them")
    found = usage(find_cases, cases or _default_cases(), names or ())
    if show:
        session.print_cases(found, as_json=as_json)
        return
    if check:
        raise typer.Exit(session.check_cases(found, as_json=as_json))
    tier: Tier = "full" if full else "quick"
    if stale:
        found = session.stale_cases(found, tier)
        if not found:
            return
    folder = out or Path("uqfold-results", f"validation-{tier}")
    validation = Validation(tier, folder, update if faults is None else faults)
    invocation: Invocation = context.obj
    raise typer.Exit(
        session.measure_cases(found, validation, invocation, update=update, as_json=as_json)
    )


def _default_cases() -> Path:
    """Return the folder of the cases: here, or beside the installed package (a clone)."""
    here = Path("validation")
    return here if here.is_dir() else Path(uqfold.__file__).resolve().parents[1] / "validation"
