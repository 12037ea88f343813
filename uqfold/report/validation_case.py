"""One validation case as a section of a page."""

from __future__ import annotations

from collections.abc import Iterable
from typing import TYPE_CHECKING

import pandas as pd

from uqfold.plots import points
from uqfold.plots.wording import seconds_text
from uqfold.report.page.builder import Page
from uqfold.report.page.cells import Tone
from uqfold.report.page.markup import literal
from uqfold.validation.findings import VERDICT_RULE, Finding, number
from uqfold.validation.measurement import Points, Table
from uqfold.validation.record import CaseRecord

if TYPE_CHECKING:
    from matplotlib.axes import Axes

VERDICT_TONES: dict[str, Tone] = {
    "holds": "good",
    "does not hold": "bad",
    "cannot be judged": "warn",
}
_UNFOLDED_ROWS = 12
"""Longer tables are folded away."""


def case_anchor(record: CaseRecord) -> str:
    """Return the name of the section in links."""
    return f"case-{record.name.replace('_', '-')}"


def case_section(page: Page, record: CaseRecord) -> None:
    """Add claim, what was measured for it, and verdict of a case, and how it was measured."""
    case, tone, label = record.case, VERDICT_TONES[record.verdict], str(record.verdict)
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
    own = [one for one in record.findings if not one.claim]
    if own:
        _findings(page, own, f"Findings: {case.title}")
    _stored(page, record)
    for i, one in enumerate(record.measurement.points, start=1):
        page.figure(points_axes(one), one.title, name=f"{record.name}-{i}")
    for table in record.measurement.tables:
        _table(page, table)
    if record.faults:
        page.table(_faults(record), f"Faults planted to see whether it can fail: {case.title}")
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
    verdicts = record.claims
    said = {one.key: f"{verdicts[one.key]}{' (an identity)' * one.identity}" for one in claims}
    rows = [
        {"claim": one.statement, "where": one.source, "verdict": said[one.key]} for one in claims
    ]
    page.table(pd.DataFrame(rows), f"{record.case.title} one by one", tones=VERDICT_TONES)
    for one in claims:
        tone = VERDICT_TONES[verdicts[one.key]]
        page.section(one.key, level=3, label=said[one.key], tone=tone, name=f"claim-{one.key}")
        page.text(literal(f"{one.statement} ({one.source})"))
        page.text(literal(f"Rule: {one.rule}."))
        found = [finding for finding in record.judged if finding.claim == one.key]
        _findings(page, found, f"Findings on the claim {one.key!r}")


def _findings(page: Page, findings: Iterable[Finding], title: str) -> None:
    rows = []
    for one in findings:
        unit = f" {one.unit}" if one.unit else ""
        spread = "" if one.uncertainty is None else f" ± {number(one.uncertainty)}"
        value = "not measured" if one.value is None else f"{number(one.value)}{spread}{unit}"
        bound = "at least" if one.at_least else "at most"
        limit = "quoted only" if one.limit is None else f"{bound} {number(one.limit)}{unit}"
        rows.append(
            {
                "finding": one.what,
                "measured": value,
                "limit": limit,
                "verdict": one.verdict or "–",
                "remark": one.remark,
            }
        )
    frame = pd.DataFrame(rows)
    shown = frame if frame["remark"].any() else frame.drop(columns="remark")
    page.table(shown, title, tones=VERDICT_TONES)


def _stored(page: Page, record: CaseRecord) -> None:
    stored = record.stored
    if stored is None:
        return
    state = (
        "with the same code, so they count too"
        if stored.current
        else f"with other code ({', '.join(stored.changed)}), so they are only quoted"
    )
    said = f"The full tier, measured {stored.date[:10]} in {seconds_text(stored.seconds)} {state}:"
    page.text(literal(said))
    _findings(page, stored.findings, f"Findings of the full tier: {record.case.title}")


def _table(page: Page, table: Table) -> None:
    if len(table.rows) <= _UNFOLDED_ROWS:
        page.table(_frame(table), table.title)
        return
    with page.details(f"{table.title} ({len(table.rows)} rows)"):
        page.table(_frame(table), table.title)


def _frame(table: Table) -> pd.DataFrame:
    return pd.DataFrame(list(table.rows), columns=list(table.columns))


def _faults(record: CaseRecord) -> pd.DataFrame:
    rows = []
    for one in record.faults:
        noticed = "not planted in this run"
        if one.verdict is not None:
            noticed = f"{'noticed' if one.caught else 'unnoticed'}: {one.verdict}"
        rows.append(
            {
                "planted fault": one.fault.name,
                "what is made wrong": one.fault.what,
                "claims": ", ".join(one.fault.claims),
                "noticed": noticed,
            }
        )
    frame = pd.DataFrame(rows)
    return frame if frame["claims"].any() else frame.drop(columns="claims")


def _made(page: Page, record: CaseRecord) -> None:
    made = record.made
    page.code(made["command"])
    facts = {
        "case": record.name,
        "tier": record.tier,
        "seeds": ", ".join(map(str, record.case.seeds)) or "nothing is random",
        "measured": f"{record.date}, in {seconds_text(record.seconds)}",
        "machine": made["machine"],
        "versions": ", ".join(f"{name} {version}" for name, version in made["versions"].items()),
        "code, with digests": ", ".join(
            f"{part} {digest[:12]}" for part, digest in made["source"].items()
        ),
    }
    page.facts({name: literal(fact) for name, fact in facts.items() if fact})
