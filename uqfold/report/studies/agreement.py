"""Two ways to the same number, side by side: do they agree?"""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

from uqfold.comparison.studies.keys import COLUMN, TABLE_NAMES, WHERE, Key, Kind
from uqfold.report.studies.selection import distinct, joined, selected
from uqfold.report.wording import NO_VALUE

if TYPE_CHECKING:
    import pandas as pd

_KEYS = ("parameter", "input", "moment", "order", "threshold", "tau", "missions")
"""Columns that tell rows apart, where a table has them."""


def agreement_table(
    settings: Mapping[str, Any], tables: Mapping[str, pd.DataFrame]
) -> pd.DataFrame:
    """Set the answers of two methods beside each other, with their distance in standard errors.

    Settings are the values of the keys of `AGREEMENT`.
    """
    import pandas as pd

    frame = selected(joined(tables, settings["table"]), settings["where"])
    value, error = settings["value"], settings["error"]
    keys = [name for name in _KEYS if name in frame]
    labels = distinct(frame, "label")
    rows = []
    for key, own in frame.groupby(keys, sort=False, dropna=False):
        found = {row["label"]: row for row in own.to_dict("records")}
        line = {name: _cell(one) for name, one in zip(keys, key, strict=True)}
        for label in labels:
            row = found.get(label)
            line[label] = NO_VALUE if row is None else _with_error(row[value], row[error])
        both = [found[label] for label in labels if label in found]
        if len(both) == 2:
            distance = both[0][value] - both[1][value]
            scale = math.hypot(both[0][error], both[1][error])
            line["distance (joint std. errors)"] = (
                f"{distance / scale:+.1f}" if scale > 0 else NO_VALUE
            )
        else:
            line["distance (joint std. errors)"] = NO_VALUE
        rows.append(line)
    return pd.DataFrame(rows)


def _cell(value: Any) -> str:
    if isinstance(value, float):
        return NO_VALUE if math.isnan(value) else f"{value:g}"
    return str(value)


def _with_error(value: float, error: float) -> str:
    """Write a value with its error to the error's second digit."""
    if math.isnan(value):
        return NO_VALUE
    if math.isnan(error) or value == error == 0.0:
        return f"{value + 0.0:.3g}"
    digits = 2 if error <= 0.0 else min(max(1 - math.floor(math.log10(error)), 0), 8)
    return f"{value:.{digits}f} ± {error:.{digits}f}"


AGREEMENT = Kind(
    "agreement",
    "Answers of several methods side by side; of two, the distance in joint standard errors.",
    (
        Key("table", TABLE_NAMES, "Analyses."),
        Key("where", WHERE, "Rows to show.", {}),
        Key("value", COLUMN, "Column of the answer."),
        Key("error", COLUMN, "Column of its standard error."),
    ),
    agreement_table,
    needs=("label",),
)
