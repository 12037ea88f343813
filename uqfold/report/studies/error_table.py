"""Errors by decade of pf: where a method holds, and where it does not."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

from uqfold.comparison.studies.keys import TABLE_NAMES, WHERE, Key, Kind
from uqfold.report.studies.selection import joined, selected
from uqfold.report.wording import percent, reference_resolution

if TYPE_CHECKING:
    import pandas as pd


def error_table(settings: Mapping[str, Any], tables: Mapping[str, pd.DataFrame]) -> pd.DataFrame:
    """Give the signed relative errors of pf, by method and decade of the reference.

    Parameters
    ----------
    settings
        Values of the keys of `ERRORS`.
    tables
        Tables of the study.

    Returns
    -------
    pandas.DataFrame
        One row per problem, method, with or without tau, and decade: number of criteria, median
        and extreme errors, and how many of them the reference is too uncertain to judge.
    """
    import pandas as pd

    frame = selected(joined(tables, settings["table"]), settings["where"])
    frame = frame[frame["error"].notna()].copy()
    frame["signed"] = (frame["pf"] - frame["reference_pf"]) / frame["reference_pf"]
    frame["decade"] = frame["reference_pf"].map(_decade)
    frame["tau"] = frame["tau"].map(lambda tau: "no" if math.isnan(tau) else "yes")
    rows = []
    groups = frame.groupby(["problem", "label", "tau", "decade"], sort=False)
    for (problem, label, tau, decade), own in groups:
        unjudged = sum(row["error"] <= reference_resolution(row) for row in own.to_dict("records"))
        rows.append(
            {
                "problem": problem,
                "method": label,
                "tau": tau,
                "decade": decade,
                "reference pf": f"1e{decade} to 1e{decade + 1}",
                "criteria": str(len(own)),
                "median error": _signed(own["signed"].median()),
                "from": _signed(own["signed"].min()),
                "to": _signed(own["signed"].max()),
                "below the reference's own error": str(unjudged),
            }
        )
    table = pd.DataFrame(rows).sort_values(
        ["problem", "method", "tau", "decade"], ascending=[True, True, True, False], kind="stable"
    )
    dropped = ["decade"] + (["problem"] if table["problem"].nunique() == 1 else [])
    return table.drop(columns=dropped)


def _decade(pf: float) -> int:
    """Give the exponent below pf: -2 for 0.01 < pf <= 0.1."""
    return math.ceil(math.log10(pf)) - 1


def _signed(error: float) -> str:
    return f"{'-' if error < 0.0 else '+'}{percent(abs(error))}"


ERRORS = Kind(
    "errors",
    "Errors of pf by method and decade of the reference.",
    (
        Key("table", TABLE_NAMES, "Runs."),
        Key("where", WHERE, "Rows to judge.", {}),
    ),
    error_table,
    needs=("label", "tau", "pf", "reference_pf", "reference_std_error", "error"),
)
