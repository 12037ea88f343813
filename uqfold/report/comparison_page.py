"""The report on a comparison, as a page."""

from __future__ import annotations

import math
from collections.abc import Mapping

import uqfold
from uqfold.comparison.columns import Row as Record
from uqfold.comparison.records import Records
from uqfold.report.chart_data import cost_figure, curves_figure, method_keys, panel_keys
from uqfold.report.methods_section import methods_section, reproduction_section
from uqfold.report.page.blocks import (
    Block,
    Cell,
    Column,
    Controls,
    Link,
    Number,
    Page,
    Paragraph,
    Part,
    Row,
    Section,
    Table,
    Tone,
)
from uqfold.report.summary import summary_blocks
from uqfold.report.wording import (
    NO_VALUE,
    count_text,
    panel_key,
    percent,
    probability,
    quantity,
    reference_resolution,
    remark,
    remarks,
    scientific,
)

TABLE_ANCHOR, NOTES_ANCHOR = "all-answers", "remarks"
NEGLIGIBLE = 1e-6
"""Relative standard error of a reference from which on it is written beside it."""
STATUS_TONES: dict[str, Tone] = {
    "converged": "good",
    "budget_exhausted": "warn",
    "doubtful": "warn",
    "unsupported": "quiet",
    "failed": "bad",
}


def comparison_page(records: Records) -> Page:
    """Make the report on a comparison.

    Parameters
    ----------
    records
        The comparison; nothing that it names is imported or run.
    """
    header = records.header
    return Page(
        title=f"{header.problem}: {len(records.finished)} methods compared"
        if len(records.finished) > 1
        else f"{header.problem}: one method",
        kicker="Comparison of reliability methods",
        lead=_lead(records),
        summary=summary_blocks(records) if records.rows else (_nothing(),),
        sections=(*_result_sections(records), methods_section(records),
                  reproduction_section(header)),
        imprint=f"Made by uqfold {uqfold.__version__} from records of "
        f"{header.date or 'unknown date'}. Numbers are the recorded ones; no model was run.",
    )  # fmt: skip


def _nothing() -> Paragraph:
    return Paragraph("No method has finished: there is nothing to report.")


def _lead(records: Records) -> str:
    header = records.header
    unit = f" ({header.response_unit})" if header.response_unit else ""
    n = len(header.criteria)
    said = f"Every method was asked for the failure probability under the same {n} criteria"
    said = said if n > 1 else "Every method was asked for one failure probability"
    said += f"; response: {header.response}{unit}"
    if header.max_evals is not None:
        said += f"; at most {header.max_evals:,} evaluations each"
    said += f"; seed {header.seed}."
    missing = [one.label for one in header.methods if one.label not in records.finished]
    if missing:
        said += f" Interrupted: no rows of {', '.join(missing)}."
    return said


def _result_sections(records: Records) -> list[Section]:
    if not records.rows:
        return []
    sections = []
    curves = curves_figure(records, TABLE_ANCHOR)
    first: list[Block] = [_controls(records)]
    if curves is not None:
        sections.append(Section("curves", "Answers", (*first, curves)))
        first = []
    cost = cost_figure(records, TABLE_ANCHOR)
    if cost is not None:
        sections.append(Section("cost", "Error against cost", (cost,)))
    numbers = remarks(records.rows)
    sections.append(
        Section(TABLE_ANCHOR, "All answers", (*first, _answers_table(records, numbers)))
    )
    if numbers:
        sections.append(Section(NOTES_ANCHOR, "Remarks", (_remarks_table(records, numbers),)))
    return sections


def _controls(records: Records) -> Controls:
    groups = [("Methods", tuple(method_keys(records).values()))]
    panels = panel_keys(records)
    if len(panels) > 1:
        groups.append(("Criteria", tuple(panels.values())))
    return Controls(tuple(groups))


def _answers_table(records: Records, numbers: Mapping[tuple[str, str], int]) -> Table:
    keys, panels = method_keys(records), panel_keys(records)
    unit = records.header.response_unit
    several_missions = len({row["missions"] for row in records.rows}) > 1
    with_tau = any(not math.isnan(row["tau"]) for row in records.rows)
    in_unit = f" ({unit})" if unit else ""
    columns = [Column("method", choices=True), Column(f"T{in_unit}", numeric=True, choices=True)]
    if with_tau:
        columns.append(Column(f"tau{in_unit}", numeric=True, choices=True))
    if several_missions:
        columns.append(Column("missions", choices=True))
    columns += [
        Column("pf", numeric=True),
        Column("interval", numeric=True),
        Column("beta", numeric=True),
        Column("reference", numeric=True),
        Column("error", numeric=True),
        Column("evaluations", numeric=True),
        Column("status", choices=True),
        Column("remark"),
    ]
    rows = []
    for row in records.rows:
        cells = [
            Cell(row["label"], key=keys[row["label"]]),
            Cell(quantity(row["threshold"], ""), row["threshold"]),
        ]
        if with_tau:
            none = math.isnan(row["tau"])
            cells.append(Cell("none" if none else quantity(row["tau"], ""), row["tau"]))
        if several_missions:
            cells.append(Cell(row["missions"]))
        cells += _answer_cells(row, numbers)
        shown_with = (keys[row["label"]].name, panels[panel_key(row)].name)
        rows.append(Row(tuple(cells), keys=shown_with))
    return Table(
        "Every answer, with the interval that the method states",
        tuple(columns),
        tuple(rows),
        show_caption=False,
    )


def _answer_cells(row: Record, numbers: Mapping[tuple[str, str], int]) -> list[Cell]:
    status = str(row["status"])
    number = numbers.get((row["label"], remark(row)))
    within = row["error"] <= reference_resolution(row)
    remarked: Part = "" if number is None else Link(f"[{number}]", NOTES_ANCHOR)
    return [
        _probability(row["pf"], 4),
        _interval_cell(row),
        Cell(NO_VALUE if math.isnan(row["beta"]) else f"{row['beta']:.3f}", row["beta"]),
        _reference_cell(row),
        Cell([Number(f"{'~' if within else ''}{percent(row['error'])}")], row["error"]),
        # what a method refuses costs nothing
        Cell(NO_VALUE, math.nan)
        if status == "unsupported"
        else Cell(count_text(row["n_evals_row"]), float(row["n_evals_row"])),
        Cell(status.replace("_", " "), tone=STATUS_TONES.get(status, "")),
        Cell([remarked]),
    ]


def _probability(value: float, digits: int) -> Cell:
    return Cell([Number(probability(value, digits))], value)


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


def _reference_cell(row: Record) -> Cell:
    pf, error = row["reference_pf"], row["reference_std_error"]
    if math.isnan(pf):
        return Cell(NO_VALUE, math.nan)
    shown = probability(pf, 4)
    if error > NEGLIGIBLE * pf:
        shown += f" ± {scientific(error, 2)}"
    return Cell([Number(shown)], pf)


def _remarks_table(records: Records, numbers: Mapping[tuple[str, str], int]) -> Table:
    keys = method_keys(records)
    rows = []
    for (label, said), number in numbers.items():
        concerned = [r for r in records.rows if (r["label"], remark(r)) == (label, said)]
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
