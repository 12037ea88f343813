"""The random inputs of the problems, as the paper prints them."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

from uqfold.comparison.studies.keys import TEXT, Key, Kind, list_of

if TYPE_CHECKING:
    import pandas as pd


def inputs_table(settings: Mapping[str, Any], tables: Mapping[str, pd.DataFrame]) -> pd.DataFrame:
    """Give distribution, mean and standard deviation of every input of some problems.

    Parameters
    ----------
    settings
        Values of the keys of `INPUTS`.
    tables
        Tables of the study.
    """
    import pandas as pd

    frame = tables["inputs"]
    names = settings["problems"] or frame["problem"].drop_duplicates().tolist()
    frame = frame[frame["problem"].isin(names)]
    several = {"problem": frame["problem"]} if len(names) > 1 else {}
    return pd.DataFrame(
        {
            **several,
            "input": frame["input"],
            "unit": frame["unit"],
            "drawn": frame["role"].map(
                {"shared": "once per system", "individual": "per unit and mission"}
            ),
            "distribution": frame["distribution"],
            "mean": frame["mean"].map("{:g}".format),
            "standard deviation": frame["std"].map("{:g}".format),
        }
    )


INPUTS = Kind(
    "inputs",
    "Distribution, mean and standard deviation of every input.",
    (Key("problems", list_of(TEXT), "Problems, by name; all without it.", ()),),
    inputs_table,
)
