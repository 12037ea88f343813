"""The command ``uqfold doctor``: what an installation is made of, and what is wrong with it."""

from __future__ import annotations

import os
import tempfile
from pathlib import Path
from typing import Any

import typer

from uqfold.cli.invocation import AsJson, say_json
from uqfold.cli.streams import EXIT_FAILED

DOCTOR_HELP = """Say what this installation is made of, and what is wrong with it.

Versions, threads, the wing's compiled code, and whether a store can be kept in this folder. The
exit code is 1 if something does not work.

\b
Example:
  uqfold doctor
"""
EXTRAS = ("distributed", "xarray", "sphinx", "pytest")
"""Packages that are not needed, and whether they are there."""


def examine(*, as_json: AsJson = False) -> None:
    """Examine the installation."""
    from uqfold.provenance import machine, versions

    found = versions(("pandas", "scikit-learn", "chaospy", *EXTRAS))
    report: dict[str, Any] = {
        "versions": found,
        "machine": machine(),
        "threads": _threads(),
        "compiled": _compiled(),
        "store": _store(),
    }
    report["wrong"] = [
        *(
            f"{name} is not installed: pip install {name}"
            for name, version in found.items()
            if version == "not installed" and name not in EXTRAS
        ),
        *(report[part].pop("wrong") for part in ("compiled", "store") if "wrong" in report[part]),
    ]
    if as_json:
        say_json(report)
    else:
        for part in ("versions", "threads", "compiled", "store"):
            typer.echo(part)
            width = max(map(len, report[part]))
            for name, value in report[part].items():
                typer.echo(f"  {name:<{width}}  {value}")
        typer.echo(f"machine\n  {report['machine']}")
        for one in report["wrong"] or ["nothing is wrong"]:
            typer.echo(one)
    raise typer.Exit(EXIT_FAILED if report["wrong"] else 0)


def _threads() -> dict[str, Any]:
    """Return how many threads there are for whom."""
    import numpy as np
    import threadpoolctl

    np.ones((2, 2)) @ np.ones((2, 2))  # the library is loaded
    pools = {one["internal_api"]: one["num_threads"] for one in threadpoolctl.threadpool_info()}
    # not on every system does a process know on which cores it may run
    allowed = getattr(os, "sched_getaffinity", lambda _: range(os.cpu_count() or 1))(0)
    return {"cores": len(allowed), **pools}


def _compiled() -> dict[str, Any]:
    """Let one wing deploy, and return where its compiled code is kept."""
    from uqfold.mechanism.deployment import deploy_lanes
    from uqfold.problems import folding_wing

    problem = folding_wing()
    time = float(problem.model(problem.inputs.means[None, :])[0])
    cache: Any = getattr(deploy_lanes, "stats", None)
    said = {"cache": cache.cache_path, "deployment of a wing": f"{time:.4f} s"}
    if said["cache"] is None:
        said["wrong"] = (
            "compiled code is not kept: set NUMBA_CACHE_DIR to a folder that is writable"
        )
    return said | {"was kept": "yes" if cache.cache_hits else "no, compiled now"}


def _store() -> dict[str, Any]:
    """Return whether responses can be stored in this folder."""
    import sqlite3

    from uqfold.evaluation import EngineError, Store

    said: dict[str, Any] = {"sqlite": sqlite3.sqlite_version}
    try:
        with tempfile.TemporaryDirectory(dir=".") as folder, Store(Path(folder, "try.db")):
            pass
    except (OSError, EngineError) as error:
        said["wrong"] = f"no store can be kept in this folder: {error}"
    return said | {"here": "no" if "wrong" in said else "works"}
