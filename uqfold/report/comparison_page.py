"""The report on a comparison, as a page."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any

import uqfold
from uqfold.plots.comparison_figure import comparison
from uqfold.plots.error_figure import error_against_evaluations
from uqfold.plots.style import HEADER
from uqfold.plots.telling import gid
from uqfold.plots.wording import (
    NO_VALUE,
    Row,
    comparison_rows,
    count_text,
    drawable,
    panel_key,
    panel_text,
    percent,
    probability,
    quantity,
    reference_resolution,
    scientific,
)
from uqfold.report.methods_section import add_methods, add_reproduction
from uqfold.report.page.builder import Page
from uqfold.report.page.cells import Cell, Tone, typeset
from uqfold.report.page.markup import literal
from uqfold.report.summary import add_summary
from uqfold.report.wording import remark, remarks

if TYPE_CHECKING:
    import pandas as pd

TABLE_NAME = "all-answers"
STATUS_TONES: dict[str, Tone] = {
    "converged": "good",
    "budget exhausted": "warn",
    "doubtful": "warn",
    "unsupported": "quiet",
    "failed": "bad",
}
NEGLIGIBLE = 1e-6
"""Relative standard error of a reference from which on it is written beside it."""
_NOT_JUDGED = (
    "~: the error is below two standard errors of the reference, which cannot judge it. Standard "
    "errors of references below a millionth of pf are left out."
)
_RATIOS = (
    "On top pf over the threshold; below it every method's pf over that of the reference, under "
    "the threshold that it belongs to. Bars are the intervals that a method states itself."
)
_COST = (
    "Error of Eq. (49), |pf - reference| / reference, against the evaluations of the model. "
    "Methods of equal cost stand side by side."
)


def comparison_page(frame: pd.DataFrame) -> Page:
    """Make the report on a comparison; nothing that it names is imported or run.

    Parameters
    ----------
    frame
        The comparison, with its header in ``attrs``.
    """
    header, rows = frame.attrs[HEADER], comparison_rows(frame)
    finished = list(dict.fromkeys(row["label"] for row in rows))
    n = len(finished)
    page = Page(
        f"{header['problem']}: " + (f"{n} methods compared" if n > 1 else "one method"),
        _lead(header, rows, finished),
        kind="Comparison of reliability methods",
        imprint=f"Made by uqfold {uqfold.__version__} from records of "
        f"{header['date'] or 'unknown date'}. Numbers are the recorded ones; no model was run.",
    )
    add_summary(page, frame)
    _add_results(page, frame, rows)
    add_methods(page, header, rows)
    add_reproduction(page, header)
    return page


def _lead(header: Mapping[str, Any], rows: Sequence[Row], finished: Sequence[str]) -> str:
    unit = f" ({header['response_unit']})" if header["response_unit"] else ""
    n = len(header["criteria"])
    said = f"Every method was asked for the failure probability under the same {n} criteria"
    said = said if n > 1 else "Every method was asked for one failure probability"
    said += f"; response: {literal(header['response'] + unit)}"
    if header["max_evals"] is not None:
        said += f"; at most {header['max_evals']:,} evaluations each"
    said += f"; seed {header['seed']}."
    missing = [one["label"] for one in header["methods"] if one["label"] not in finished]
    if missing:
        said += f" Interrupted: no rows of {literal(', '.join(missing))}."
    return said


def _add_results(page: Page, frame: pd.DataFrame, rows: Sequence[Row]) -> None:
    unit = frame.attrs[HEADER]["response_unit"]
    if drawable(rows, "pf"):
        page.section("Answers", name="curves")
        page.figure(
            comparison(frame),
            "Failure probability, and every method against it",
            _RATIOS,
            name="comparison",
        )
    if drawable(rows, "error"):
        page.section("Error against cost", name="cost")
        page.figure(
            error_against_evaluations(frame),
            "Errors of all answers",
            _COST,
            name="error-against-evaluations",
        )
    numbers = remarks(rows)
    page.section("All answers", name=TABLE_NAME)
    in_unit = f" ({unit})" if unit else ""
    page.table(
        _answers(rows, in_unit, numbers),
        "Every answer, with the interval that the method states",
        formats={
            f"T{in_unit}": _quantity,
            f"tau{in_unit}": _quantity,
            "pf": lambda pf: typeset(probability(pf, 4)),
            "beta": lambda beta: NO_VALUE if math.isnan(beta) else f"{beta:.3f}",
        },
        belongs=[
            gid(method=row["label"], criterion=panel_text(panel_key(row), unit)) for row in rows
        ],
        tones=STATUS_TONES,
    )
    if any(row["error"] <= reference_resolution(row) for row in rows):
        page.text(literal(_NOT_JUDGED), small=True)
    if numbers:
        page.section("Remarks", name="remarks")
        page.table(
            _remarks(rows, numbers),
            "What methods say about answers that did not converge",
            belongs=[gid(method=label) for label, _ in numbers],
            tones=STATUS_TONES,
        )


def _answers(
    rows: Sequence[Row], in_unit: str, numbers: Mapping[tuple[str, str], int]
) -> pd.DataFrame:
    """Return every row of a comparison; columns that would be empty are left out."""
    import pandas as pd

    columns: dict[str, list[Any]] = {
        "method": [row["label"] for row in rows],
        f"T{in_unit}": [row["threshold"] for row in rows],
    }
    if any(not math.isnan(row["tau"]) for row in rows):
        columns[f"tau{in_unit}"] = [row["tau"] for row in rows]
    if len({row["missions"] for row in rows}) > 1:
        columns["missions"] = [row["missions"] for row in rows]
    columns["pf"] = [row["pf"] for row in rows]
    columns["interval"] = [_interval(row) for row in rows]
    columns["beta"] = [row["beta"] for row in rows]
    if any(not math.isnan(row["reference_pf"]) for row in rows):
        columns["reference"] = [_reference(row) for row in rows]
        columns["error"] = [_error(row) for row in rows]
    columns["evaluations"] = [_evaluations(row) for row in rows]
    columns["status"] = [row["status"].replace("_", " ") for row in rows]
    if numbers:
        found = (numbers.get((row["label"], remark(row))) for row in rows)
        columns["remark"] = ["" if number is None else f"[{number}]" for number in found]
    return pd.DataFrame(columns)


def _quantity(value: float) -> str:
    return "none" if math.isnan(value) else quantity(value, "")


def _interval(row: Row) -> Cell:
    low, high = row["ci_low"], row["ci_high"]
    if not math.isnan(row["pf"] + low + high):
        return Cell(typeset(f"{probability(low, 3)} .. {probability(high, 3)}"), high - low)
    if not math.isnan(row["pf"] + row["std_error"]):
        return Cell(typeset(f"± {scientific(row['std_error'], 2)}"), row["std_error"])
    return Cell(NO_VALUE if math.isnan(row["pf"]) else "none stated", math.nan)


def _reference(row: Row) -> Cell:
    pf, error = row["reference_pf"], row["reference_std_error"]
    spread = f" ± {scientific(error, 2)}" if error > NEGLIGIBLE * pf else ""
    return Cell(typeset(probability(pf, 4) + spread), pf)


def _error(row: Row) -> Cell:
    within = "~" if row["error"] <= reference_resolution(row) else ""
    return Cell(f"{within}{percent(row['error'])}", row["error"])


def _evaluations(row: Row) -> Cell:
    # what a method refuses costs nothing
    if row["status"] == "unsupported":
        return Cell(NO_VALUE, math.nan)
    return Cell(count_text(row["n_evals_row"]), float(row["n_evals_row"]))


def _remarks(rows: Sequence[Row], numbers: Mapping[tuple[str, str], int]) -> pd.DataFrame:
    """Return what methods say about answers that did not converge, each remark once."""
    import pandas as pd

    said = []
    for (label, words), number in numbers.items():
        own = [row for row in rows if (row["label"], remark(row)) == (label, words)]
        statuses = dict.fromkeys(row["status"].replace("_", " ") for row in own)
        said.append((Cell(f"[{number}]", number), label, ", ".join(statuses), len(own), words))
    heads = ["remark", "method", "status", "criteria", "what the method says"]
    return pd.DataFrame(said, columns=heads)
