"""All answers of a comparison, and what methods say about them, as tables of a page."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from typing import TypeAlias

from uqfold.comparison.columns import Row as Record
from uqfold.comparison.records import Records
from uqfold.report.chart_data import method_keys, panel_keys
from uqfold.report.page.blocks import Cell, Column, Link, Number, Row, Table, Tone
from uqfold.report.wording import (
    NO_VALUE,
    count_text,
    panel_key,
    percent,
    probability,
    quantity,
    reference_resolution,
    remark,
    scientific,
)

REMARKS_ANCHOR = "remarks"
NEGLIGIBLE = 1e-6
"""Relative standard error of a reference from which on it is written beside it."""
STATUS_TONES: dict[str, Tone] = {
    "converged": "good",
    "unchecked": "",
    "budget_exhausted": "warn",
    "doubtful": "warn",
    "unsupported": "quiet",
    "failed": "bad",
}

_Maker: TypeAlias = Callable[[Record], Cell]


def answers_table(records: Records, numbers: Mapping[tuple[str, str], int]) -> Table:
    """Give every row of a comparison; columns that would be empty are left out.

    Parameters
    ----------
    records
        The comparison.
    numbers
        Numbers of the remarks, by label and words.
    """
    rows, unit = records.rows, records.header.response_unit
    keys, panels = method_keys(records), panel_keys(records)
    in_unit = f" ({unit})" if unit else ""
    referenced = any(not math.isnan(row["reference_pf"]) for row in rows)
    offered: list[tuple[Column, _Maker, bool]] = [
        (
            Column("method", choices=True),
            lambda row: Cell(row["label"], key=keys[row["label"]]),
            True,
        ),
        (
            Column(f"T{in_unit}", numeric=True, choices=True),
            lambda row: Cell(quantity(row["threshold"], ""), row["threshold"]),
            True,
        ),
        (
            Column(f"tau{in_unit}", numeric=True, choices=True),
            _tau_cell,
            any(not math.isnan(row["tau"]) for row in rows),
        ),
        (
            Column("missions", choices=True),
            lambda row: Cell(row["missions"]),
            len({row["missions"] for row in rows}) > 1,
        ),
        (
            Column("pf", numeric=True),
            lambda row: Cell([Number(probability(row["pf"], 4))], row["pf"]),
            True,
        ),
        (Column("interval", numeric=True), _interval_cell, True),
        (Column("beta", numeric=True), _beta_cell, True),
        (Column("reference", numeric=True), _reference_cell, referenced),
        (Column("error", numeric=True), _error_cell, referenced),
        (Column("evaluations", numeric=True), _evaluations_cell, True),
        (Column("status", choices=True), _status_cell, True),
        (Column("remark"), lambda row: _remark_cell(row, numbers), bool(numbers)),
    ]
    shown = [(column, make) for column, make, needed in offered if needed]
    return Table(
        "Every answer, with the interval that the method states",
        tuple(column for column, _ in shown),
        tuple(
            Row(
                tuple(make(row) for _, make in shown),
                keys=(keys[row["label"]].name, panels[panel_key(row)].name),
            )
            for row in rows
        ),
        show_caption=False,
    )


def remarks_table(records: Records, numbers: Mapping[tuple[str, str], int]) -> Table:
    """Give what methods say about answers that did not converge, each remark once."""
    keys = method_keys(records)
    by_remark: dict[tuple[str, str], list[Record]] = {}
    for row in records.rows:
        by_remark.setdefault((row["label"], remark(row)), []).append(row)
    rows = []
    for (label, said), number in numbers.items():
        concerned = by_remark[label, said]
        statuses = dict.fromkeys(row["status"].replace("_", " ") for row in concerned)
        cells = (
            Cell(f"[{number}]", float(number)),
            Cell(label, key=keys[label]),
            Cell(", ".join(statuses), tone=STATUS_TONES.get(concerned[0]["status"], "")),
            Cell(str(len(concerned)), float(len(concerned))),
            Cell(said),
        )
        rows.append(Row(cells, keys=(keys[label].name,)))
    columns = (
        Column("remark", numeric=True),
        Column("method", choices=True),
        Column("status", choices=True),
        Column("criteria", numeric=True),
        Column("what the method says"),
    )
    return Table(
        "What methods say about answers that did not converge",
        columns,
        tuple(rows),
        show_caption=False,
    )


def _tau_cell(row: Record) -> Cell:
    none = math.isnan(row["tau"])
    return Cell("none" if none else quantity(row["tau"], ""), row["tau"])


def _interval_cell(row: Record) -> Cell:
    if math.isnan(row["pf"]):
        return Cell(NO_VALUE, math.nan)
    low, high = row["ci_low"], row["ci_high"]
    if not math.isnan(low + high):
        ends = f"{probability(low, 3)} .. {probability(high, 3)}"
        return Cell([Number(ends)], high - low)
    if not math.isnan(row["std_error"]):
        return Cell([Number(f"± {scientific(row['std_error'], 2)}")], row["std_error"])
    return Cell("none stated", math.nan)


def _beta_cell(row: Record) -> Cell:
    shown = NO_VALUE if math.isnan(row["beta"]) else f"{row['beta']:.3f}"
    return Cell([Number(shown)], row["beta"])


def _reference_cell(row: Record) -> Cell:
    pf, error = row["reference_pf"], row["reference_std_error"]
    if math.isnan(pf):
        return Cell(NO_VALUE, math.nan)
    shown = probability(pf, 4)
    if error > NEGLIGIBLE * pf:
        shown += f" ± {scientific(error, 2)}"
    return Cell([Number(shown)], pf)


def _error_cell(row: Record) -> Cell:
    within = row["error"] <= reference_resolution(row)
    return Cell([Number(f"{'~' if within else ''}{percent(row['error'])}")], row["error"])


def _evaluations_cell(row: Record) -> Cell:
    # what a method refuses costs nothing
    if row["status"] == "unsupported":
        return Cell(NO_VALUE, math.nan)
    return Cell(count_text(row["n_evals_row"]), float(row["n_evals_row"]))


def _status_cell(row: Record) -> Cell:
    status = str(row["status"])
    return Cell(status.replace("_", " "), tone=STATUS_TONES.get(status, ""))


def _remark_cell(row: Record, numbers: Mapping[tuple[str, str], int]) -> Cell:
    number = numbers.get((row["label"], remark(row)))
    return Cell("" if number is None else [Link(f"[{number}]", REMARKS_ANCHOR)])
