"""How many model runs each method spent: the paper's tables of sample sizes.

Simulations that serve as reference have a row too, with the number of runs that they state.
"""

from __future__ import annotations

import re
from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

from uqfold.comparison.studies.keys import TABLE_NAMES, WHERE, Key, Kind
from uqfold.report.studies.selection import joined, selected
from uqfold.report.wording import NO_VALUE

if TYPE_CHECKING:
    import pandas as pd


WITHOUT = "evaluations without synchronization"
WITH = "evaluations with synchronization"


def evaluations_table(
    settings: Mapping[str, Any], tables: Mapping[str, pd.DataFrame]
) -> pd.DataFrame:
    """Give the model runs of every method without and with synchronization.

    Parameters
    ----------
    settings
        Values of the keys of `EVALUATIONS`.
    tables
        Tables of the study.
    """
    import pandas as pd

    frame = selected(joined(tables, settings["table"]), settings["where"])
    frame = frame[frame["pf"].notna()]
    rows = []
    for problem, answers in frame.groupby("problem", sort=False):
        for label, own in answers.groupby("label", sort=False):
            without = own["tau"].isna()
            rows.append(
                {
                    "problem": problem,
                    "method": label,
                    WITHOUT: _range(own.loc[without, "n_evals"]),
                    WITH: _range(own.loc[~without, "n_evals"]),
                }
            )
        runs = _reference_runs(tables["problems"], str(problem))
        compared = answers[answers["reference_pf"].notna()]["tau"].isna()
        if runs is not None:
            rows.append(
                {
                    "problem": problem,
                    "method": "Monte Carlo, the reference",
                    WITHOUT: runs if compared.any() else NO_VALUE,
                    WITH: runs if (~compared).any() else NO_VALUE,
                }
            )
    table = pd.DataFrame(rows)
    if table["problem"].nunique() == 1:
        table = table.drop(columns="problem")
    return table


def _reference_runs(problems: pd.DataFrame, problem: str) -> str | None:
    """Give the number of model runs that a reference by simulation states."""
    row = problems.set_index("problem").loc[problem]
    stated = re.search(r"(\d+) deployments", str(row["reference_how"]))
    if row["reference_kind"] != "simulation" or stated is None:
        return None
    return f"{int(stated[1]):,}"


def _range(counts: pd.Series[int]) -> str:
    if counts.empty:
        return NO_VALUE
    low, high = int(counts.min()), int(counts.max())
    return f"{low:,}" if low == high else f"{low:,} to {high:,}"


EVALUATIONS = Kind(
    "evaluations",
    "Model runs of every method, without and with synchronization.",
    (
        Key("table", TABLE_NAMES, "Runs."),
        Key("where", WHERE, "Rows to count.", {}),
    ),
    evaluations_table,
    needs=("label", "tau", "n_evals", "pf", "reference_pf"),
)
