"""What methods say about their answers; numbers are written by `uqfold.plots.wording`."""

from __future__ import annotations

from collections.abc import Iterable

from uqfold.comparison.columns import Row
from uqfold.plots.wording import (
    NO_VALUE,
    REFERENCE_STANDARD_ERRORS,
    CriterionKey,
    count_text,
    criterion_key,
    criterion_text,
    finite,
    panel_key,
    panel_text,
    percent,
    probability,
    quantity,
    reference_resolution,
    scientific,
    seconds_text,
)

__all__ = [
    "NO_VALUE",
    "REFERENCE_STANDARD_ERRORS",
    "UNCHECKED",
    "CriterionKey",
    "count_text",
    "criterion_key",
    "criterion_text",
    "finite",
    "panel_key",
    "panel_text",
    "percent",
    "probability",
    "quantity",
    "reference_resolution",
    "remark",
    "remarks",
    "scientific",
    "seconds_text",
]

UNCHECKED = "nobody estimated the error of the answer"
"""What the status ``unchecked`` means."""


def remark(row: Row) -> str:
    """Return what a method says about a row that did not converge; empty if nothing."""
    if row["status"] == "converged":
        return ""
    if row["pf_low"] < row["pf_high"]:
        bounds = " to ".join(scientific(row[end], 3) for end in ("pf_low", "pf_high"))
        return f"{row['message']}; with the failed runs pf may be {bounds}"
    return str(row["message"])


def remarks(rows: Iterable[Row]) -> dict[tuple[str, str], int]:
    """Number the remarks by label and words; the same words of the same method are one."""
    said = dict.fromkeys((row["label"], remark(row)) for row in rows if remark(row))
    return {key: number for number, key in enumerate(said, start=1)}
