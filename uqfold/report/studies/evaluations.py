"""How many model runs each method spent: the paper's tables of sample sizes."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

from uqfold.comparison.studies.keys import TABLE_NAMES, WHERE, Key, Kind
from uqfold.report.studies.selection import joined, selected
from uqfold.report.wording import NO_VALUE

if TYPE_CHECKING:
    import pandas as pd


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
    for (problem, label), own in frame.groupby(["problem", "label"], sort=False):
        without = own["tau"].isna()
        rows.append(
            {
                "problem": problem,
                "method": label,
                "evaluations without synchronization": _range(own.loc[without, "n_evals"]),
                "evaluations with synchronization": _range(own.loc[~without, "n_evals"]),
            }
        )
    table = pd.DataFrame(rows)
    if table["problem"].nunique() == 1:
        table = table.drop(columns="problem")
    return table


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
    needs=("label", "tau", "n_evals", "pf"),
)
