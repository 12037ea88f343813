"""One validation case as a section of a page."""

from __future__ import annotations

from collections.abc import Iterable
from typing import TYPE_CHECKING, Any

import pandas as pd

from uqfold.plots import points
from uqfold.plots.wording import seconds_text
from uqfold.report.page.builder import Page
from uqfold.report.page.cells import TONES, typeset
from uqfold.report.page.markup import literal
from uqfold.validation.findings import VERDICT_RULE, Finding
from uqfold.validation.measurement import Points, Table
from uqfold.validation.record import CaseRecord, PlantedFault

if TYPE_CHECKING:
    from uqfold.plots.types import Axes

_UNFOLDED_ROWS = 12
"""Longer tables are folded away."""


def case_anchor(record: CaseRecord) -> str:
    """Return the name of the section in links."""
    return f"case-{record.name.replace('_', '-')}"


def case_section(page: Page, record: CaseRecord) -> None:
    """Add claim, what was measured for it, and verdict of a case, and how it was measured."""
    case, tone, label = record.case, TONES[record.verdict], str(record.verdict)
    if record.claims:
        verdicts = list(record.claims.values())
        label = f"{verdicts.count('holds')} of {len(verdicts)} hold"
    page.section(case.title, level=2, label=label, tone=tone, name=case_anchor(record))
    page.text(f"**{literal(case.claim)}**")
    if record.error:
        page.text(f"**No measurement:** {literal(record.error)}")
    facts = {
        "kind": case.kind,
        "compared with": case.compared_with,
        "its uncertainty": case.uncertainty,
        "its source": case.source,
        "tolerance": case.tolerance,
        "verdict rule": f"{case.verdict_rule} {VERDICT_RULE}",
    }
    page.facts({name: literal(fact) for name, fact in facts.items()})
    _claims(page, record)
    _findings(page, [one for one in record.findings if not one.claim], f"Findings: {case.title}")
    for i, one in enumerate(record.measurement.points, start=1):
        page.figure(points_axes(one), one.title, name=f"{record.name}-{i}")
    for table in record.measurement.tables:
        if len(table.rows) <= _UNFOLDED_ROWS:
            page.table(_frame(table), table.title)
        else:
            with page.details(f"{table.title} ({len(table.rows)} rows)"):
                page.table(_frame(table), table.title)
    if record.faults:
        title = f"Faults planted to see whether it can fail: {case.title}"
        page.table(_without_empty("claims", map(_fault, record.faults)), title)
    with page.details("How it was measured"):
        _made(page, record)


def points_axes(one: Points) -> Axes:
    """Draw the points of a record."""
    return points(_frame(one.table), one.x, one.y, log=one.log, limits=one.limits or {})


def _claims(page: Page, record: CaseRecord) -> None:
    """Add the claims of a case that judges several: a table, then each with its findings."""
    claims = record.measurement.claims
    if not claims:
        return
    said = {one.key: f"{record.claims[one.key]}{' (an identity)' * one.identity}" for one in claims}
    rows = [
        {"claim": one.statement, "where": one.source, "verdict": said[one.key]} for one in claims
    ]
    page.table(pd.DataFrame(rows), f"{record.case.title} one by one")
    for one in claims:
        tone = TONES[record.claims[one.key]]
        page.section(one.key, level=3, label=said[one.key], tone=tone, name=f"claim-{one.key}")
        page.text(literal(f"{one.statement} ({one.source})"))
        page.text(literal(f"Rule: {one.rule}."))
        found = [finding for finding in record.findings if finding.claim == one.key]
        _findings(page, found, f"Findings on the claim {one.key!r}")


def _findings(page: Page, findings: Iterable[Finding], title: str) -> None:
    rows = [
        {
            "finding": one.what,
            "measured": typeset(one.measured) or "not measured",
            "limit": typeset(one.bound) or "quoted only",
            "verdict": one.verdict or "–",
            "remark": one.remark,
        }
        for one in findings
    ]
    if rows:
        page.table(_without_empty("remark", rows), title)


def _fault(one: PlantedFault) -> dict[str, Any]:
    noticed = "not planted in this run"
    if one.verdict is not None:
        noticed = f"{'noticed' if one.caught else 'unnoticed'}: {one.verdict}"
    return {
        "planted fault": one.fault.name,
        "what is made wrong": one.fault.what,
        "claims": ", ".join(one.fault.claims),
        "noticed": noticed,
    }


def _without_empty(column: str, rows: Iterable[dict[str, Any]]) -> pd.DataFrame:
    """Return the rows as a frame, without a column in which nothing stands."""
    frame = pd.DataFrame(list(rows))
    return frame if frame[column].any() else frame.drop(columns=column)


def _frame(table: Table) -> pd.DataFrame:
    return pd.DataFrame(list(table.rows), columns=list(table.columns))


def _made(page: Page, record: CaseRecord) -> None:
    made = record.made
    page.code(made["command"])
    versions = [f"{name} {version}" for name, version in made["versions"].items()]
    digests = [f"{part} {digest[:12]}" for part, digest in made["source"].items()]
    facts = {
        "case": record.name,
        "tier": record.tier,
        "seeds": ", ".join(map(str, record.case.seeds)) or "nothing is random",
        "measured": f"{record.date}, in {seconds_text(record.seconds)}",
        "machine": made["machine"],
        "versions": ", ".join(versions),
        "code, with digests": ", ".join(digests),
    }
    page.facts({name: literal(fact) for name, fact in facts.items() if fact})
