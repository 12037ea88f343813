"""The command ``uqfold serve``: a problem's model over HTTP."""

from __future__ import annotations

from typing import Annotated

import typer

from uqfold.cli.invocation import AsJson, option, say_json, usage
from uqfold.comparison.named_problems import available_problems, named_problem

SERVE_HELP = """Serve a problem's model by the UM-Bridge protocol, until Ctrl-C.

Clients in any language then run it as the model of the problem's name, with one vector of inputs.

\b
Examples:
  uqfold serve folding-wing
  uqfold serve my_model.py:problem --port 4243
"""


def serve_problem(
    problem: Annotated[
        str,
        typer.Argument(
            metavar="PROBLEM",
            help="A named problem, FILE.py:FUNCTION or FILE.toml.",
            autocompletion=lambda: list(available_problems()),
        ),
    ],
    *,
    port: Annotated[int, option("N", "Where to listen.")] = 4242,
    host: Annotated[str, option("ADDRESS", "On which address.")] = "127.0.0.1",
    as_json: AsJson = False,
) -> None:
    """Serve a problem."""
    from uqfold.evaluation import ServedProblem

    asked = usage(usage(named_problem, problem).problem)
    with usage(ServedProblem, asked, port, host) as served:
        if as_json:
            say_json({"model": asked.name, "inputs": asked.inputs.names, "url": served.url})
        else:
            typer.echo(f"{asked.name} ({', '.join(asked.inputs.names)}) at {served.url}")
        served.wait()
