"""The answers of a comparison and the scores of its methods in words, for terminal and page."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, TypeAlias

from uqfold.comparison.columns import ATTRIBUTE
from uqfold.comparison.league import RIGHT_WITHIN
from uqfold.plots.wording import (
    NO_VALUE,
    Row,
    percent,
    probability,
    reference_resolution,
    scientific,
    seconds_text,
)
from uqfold.problems.criterion import threshold_text
from uqfold.report.page.cells import TONES, Cell
from uqfold.report.scores import method_scores

if TYPE_CHECKING:
    import pandas as pd

STATUSES = {
    "failed": "failed",
    "doubtful": "{are} doubtful",
    "budget_exhausted": "{are} out of budget",
    "unsupported": "{are} outside what a method can do",
    "unchecked": "{are} unchecked",
    "converged": "{are} converged",
}
"""Status -> what is said of answers that have it; the worst first."""
WITHIN = f"within {100 * RIGHT_WITHIN:g} %"
UNCHECKED = "nobody estimated the error of the answer"
NOT_JUDGED = "below two standard errors of the reference, which cannot judge it"
ERROR = "|pf - reference| / reference, Eq. (49)"
_NEGLIGIBLE = 1e-6
"""Relative standard error of a reference from which on it is written beside it."""

Remarks: TypeAlias = Mapping[tuple[str, str], int]
"""(label, what the method says) -> number."""


def remark(row: Row) -> str:
    """Return what a method says about a row that did not converge; empty if nothing."""
    if row["status"] == "converged":
        return ""
    if row["pf_low"] < row["pf_high"]:
        bounds = " to ".join(scientific(row[end], 3) for end in ("pf_low", "pf_high"))
        return f"{row['message']}; with the failed runs pf may be {bounds}"
    return str(row["message"])


def remarks(rows: Sequence[Row]) -> Remarks:
    """Number the remarks by label and words; the same words of the same method are one."""
    said = dict.fromkeys((row["label"], remark(row)) for row in rows if remark(row))
    return {key: number for number, key in enumerate(said, start=1)}


def answers_table(frame: pd.DataFrame) -> pd.DataFrame:
    """Return every answer of a comparison as cells; columns that would be empty are left out."""
    import pandas as pd

    rows, unit = frame.to_dict("records"), frame.attrs[ATTRIBUTE]["response_unit"]
    in_unit = f" ({unit})" if unit else ""
    numbers = remarks(rows)
    table = pd.DataFrame(
        {
            "method": row["label"],
            f"T{in_unit}": Cell(
                threshold_text(row["threshold"]).removeprefix("T = "), row["threshold"]
            ),
            f"tau{in_unit}": _cell(row["tau"], f"{row['tau']:g}", "none"),
            "missions": row["missions"],
            "pf": Cell(probability(row["pf"], 4), row["pf"]),
            "interval": _interval(row),
            "beta": _cell(row["beta"], f"{row['beta']:.3f}"),
            "reference": _reference(row),
            "error": _error(row),
            # what a method refuses costs nothing
            "evaluations": Cell(NO_VALUE, math.nan)
            if row["status"] == "unsupported"
            else Cell(f"{row['n_evals_row']:,}", row["n_evals_row"]),
            "status": row["status"].replace("_", " "),
            "remark": f"[{numbers[row['label'], remark(row)]}]" if remark(row) else "",
        }
        for row in rows
    )
    unreferenced = bool(frame["reference_pf"].isna().all())
    unused = {
        f"tau{in_unit}": frame["tau"].isna().all(),
        "missions": frame["missions"].nunique() == 1,
        "reference": unreferenced,
        "error": unreferenced,
        "remark": not numbers,
    }
    return table.drop(columns=[name for name in unused if unused[name]])


def methods_table(frame: pd.DataFrame) -> pd.DataFrame:
    """Return one row of cells per method: how much it answered, how well, and at what cost."""
    import pandas as pd

    scores = method_scores(frame)
    listed = []
    for label, row in zip(scores.index, scores.to_dict("records"), strict=True):
        occurring = [status for status in STATUSES if row[status]]
        said = [f"{row[one]} {one.replace('_', ' ')}" for one in occurring if one != "converged"]
        tone = TONES.get(occurring[0].replace("_", " "), "")
        covers = Cell("none stated", math.nan)
        if row["stated"]:
            covers = Cell(f"{row['cover']} of {row['stated']}", row["cover"] / row["stated"])
        listed.append(
            {
                "method": label,
                "status": Cell(", ".join(said) or "converged", tone=tone),
                "answered": Cell(f"{row['answered']} of {row['asked']}", row["answered"]),
                "median error": Cell(percent(row["median_error"]), row["median_error"]),
                "largest": Cell(percent(row["largest_error"]), row["largest_error"]),
                WITHIN: Cell(f"{row['right']} of {row['referenced']}", row["right"]),
                "interval covers": covers,
                "evaluations": Cell(f"{row['n_evals']:,}", row["n_evals"]),
                "time": Cell(seconds_text(row["seconds"]), row["seconds"]),
            }
        )
    of_references = ["median error", "largest", WITHIN, "interval covers"]
    without = [] if scores["referenced"].any() else of_references
    table = pd.DataFrame(listed).drop(columns=without)
    if len(table) < len(frame):
        return table
    # one criterion: its answers stand in the place of counts
    counts = {"answered", "largest", WITHIN, "interval covers"} & set(table.columns)
    table = table.drop(columns=list(counts)).rename(columns={"median error": "error"})
    answers = answers_table(frame)
    table["status"] = [Cell(one.text.removeprefix("1 "), tone=one.tone) for one in table["status"]]
    table.insert(1, "pf", answers["pf"])
    table.insert(2, "interval", answers["interval"])
    return table


def remarks_table(rows: Sequence[Row]) -> pd.DataFrame:
    """Return what methods say about answers that did not converge, each remark once."""
    import pandas as pd

    said = []
    for (label, words), number in remarks(rows).items():
        own = [row["status"] for row in rows if (row["label"], remark(row)) == (label, words)]
        status = own[0].replace("_", " ")
        said.append((Cell(f"[{number}]", number), label, status, len(own), words))
    heads = ["remark", "method", "status", "criteria", "what the method says"]
    return pd.DataFrame(said, columns=heads)


def _cell(value: float, text: str, missing: str = NO_VALUE) -> Cell:
    return Cell(missing if math.isnan(value) else text, value)


def _interval(row: Row) -> Cell:
    """Return the interval, or else the standard error."""
    low, high = row["ci_low"], row["ci_high"]
    if not math.isnan(row["pf"] + low + high):
        return Cell(f"{probability(low, 3)} .. {probability(high, 3)}", high - low)
    if not math.isnan(row["pf"] + row["std_error"]):
        return Cell(f"± {scientific(row['std_error'], 2)}", row["std_error"])
    return Cell(NO_VALUE if math.isnan(row["pf"]) else "none stated", math.nan)


def _reference(row: Row) -> Cell:
    """Return the reference of a row, with its standard error where that is worth it."""
    pf, error = row["reference_pf"], row["reference_std_error"]
    spread = f" ± {scientific(error, 2)}" if error > _NEGLIGIBLE * pf else ""
    return Cell(probability(pf, 4) + spread, pf)


def _error(row: Row) -> Cell:
    within = "~" if row["error"] <= reference_resolution(row) else ""
    return Cell(f"{within}{percent(row['error'])}", row["error"])
