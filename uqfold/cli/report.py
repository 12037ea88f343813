"""The command that turns records into a report."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from uqfold.cli.invocation import AsJson, option, say_json, usage
from uqfold.cli.streams import shown_path

REPORT_HELP = """Write the report on records: one HTML file that needs nothing else, or Markdown.

RUN_DIR is a folder that `uqfold compare`, `benchmark` or `validate` has written. No model is run.
The HTML file can be sent, printed, and read without a network; Markdown has its charts beside it.

\b
Examples:
  uqfold report uqfold-results/folding-wing
  uqfold report uqfold-results/folding-wing --out docs/wing.md
"""


def report_command(
    run_dir: Annotated[
        Path, typer.Argument(metavar="RUN_DIR", help="Folder, or file, with records.")
    ],
    *,
    out: Annotated[
        Path | None, option("FILE", "An .html or .md file. Default: report.html in RUN_DIR.")
    ] = None,
    as_json: AsJson = False,
) -> None:
    """Write a report."""
    from uqfold.report.reports import write_report

    if out is None:
        out = (run_dir if run_dir.is_dir() else run_dir.parent) / "report.html"
    report, *pictures = usage(write_report, run_dir, out)
    if as_json:
        say_json({"report": shown_path(report), "pictures": list(map(shown_path, pictures))})
        return
    beside = f", {len(pictures)} pictures in {pictures[0].parent.name}" if pictures else ""
    typer.echo(f"written: {shown_path(report)}{beside}")
