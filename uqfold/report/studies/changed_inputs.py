"""What tells the problems of a study apart: inputs whose mean or standard deviation is changed."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

from uqfold.comparison.studies.keys import Kind
from uqfold.report.studies.selection import SelectionError

if TYPE_CHECKING:
    import pandas as pd


def changed_inputs(settings: Mapping[str, Any], tables: Mapping[str, pd.DataFrame]) -> pd.DataFrame:
    """Give every problem's inputs that differ from what most problems have.

    Parameters
    ----------
    settings
        No keys.
    tables
        Tables of the study.

    Raises
    ------
    SelectionError
        If no problem differs.
    """
    import pandas as pd

    frame = tables["inputs"]
    rows = []
    for name, own in frame.groupby("input", sort=False):
        usual = {column: own[column].mode().iloc[0] for column in ("mean", "std")}
        for row in own.to_dict("records"):
            for column, words in (("mean", "mean"), ("std", "standard deviation")):
                if row[column] != usual[column]:
                    rows.append(
                        {
                            "problem": row["problem"],
                            "input": name,
                            "changed": words,
                            "value": f"{row[column]:g} {row['unit']}".strip(),
                            "instead of": f"{usual[column]:g} {row['unit']}".strip(),
                        }
                    )
    if not rows:
        raise SelectionError("all problems have the same inputs")
    order = {problem: i for i, problem in enumerate(frame["problem"].drop_duplicates())}
    rows.sort(key=lambda row: order[row["problem"]])
    return pd.DataFrame(rows)


CHANGED_INPUTS = Kind(
    "changed-inputs",
    "Inputs with another mean or standard deviation than most of the study's problems give them.",
    (),
    changed_inputs,
)
