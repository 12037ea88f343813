"""What methods say about their answers."""

from __future__ import annotations

from collections.abc import Iterable

from uqfold.plots.wording import Row, scientific

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
