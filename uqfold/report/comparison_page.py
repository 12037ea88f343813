"""The report on a comparison, as a page."""

from __future__ import annotations

import uqfold
from uqfold.comparison.records import Records
from uqfold.report.answers_table import REMARKS_ANCHOR, answers_table, remarks_table
from uqfold.report.chart_data import cost_figure, curves_figure, method_keys, panel_keys
from uqfold.report.methods_section import methods_section, reproduction_section
from uqfold.report.page.blocks import Block, Controls, Page, Paragraph, Section
from uqfold.report.summary import summary_blocks
from uqfold.report.wording import reference_resolution, remarks

TABLE_ANCHOR = "all-answers"
_NOT_JUDGED = (
    "~: the error is below two standard errors of the reference, which cannot judge it. Standard "
    "errors of references below a millionth of pf are left out."
)


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
    answers: list[Block] = [*first, answers_table(records, numbers)]
    if any(row["error"] <= reference_resolution(row) for row in records.rows):
        answers.append(Paragraph(_NOT_JUDGED, small=True))
    sections.append(Section(TABLE_ANCHOR, "All answers", tuple(answers)))
    if numbers:
        sections.append(Section(REMARKS_ANCHOR, "Remarks", (remarks_table(records, numbers),)))
    return sections


def _controls(records: Records) -> Controls:
    groups = [("Methods", tuple(method_keys(records).values()))]
    panels = panel_keys(records)
    if len(panels) > 1:
        groups.append(("Criteria", tuple(panels.values())))
    return Controls(tuple(groups))
