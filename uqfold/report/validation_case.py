"""One validation case as a section of a page."""

from __future__ import annotations

from collections.abc import Iterator

from uqfold.comparison.findings import VERDICT_RULE
from uqfold.evidence.record import CaseRecord
from uqfold.report.evidence_blocks import (
    VERDICT_TONES,
    evidence_figure,
    evidence_table,
    findings_table,
)
from uqfold.report.page.blocks import (
    Block,
    Cell,
    Code,
    Column,
    Details,
    Facts,
    Listing,
    Paragraph,
    Row,
    Section,
    Strong,
    Table,
    Words,
)
from uqfold.report.wording import seconds_text

_UNFOLDED_ROWS = 12
"""Longer tables are folded away."""


def case_anchor(record: CaseRecord) -> str:
    """Give the name of the section in links."""
    return f"case-{record.name}"


def case_section(record: CaseRecord) -> Section:
    """Give claim, evidence and verdict of a case, and how it was measured."""
    return Section(
        case_anchor(record),
        record.title,
        tuple(_case_blocks(record)),
        record.verdict,
        VERDICT_TONES[record.verdict],
    )


def _case_blocks(record: CaseRecord) -> Iterator[Block]:
    yield Paragraph([Strong(record.claim)])
    if record.error:
        yield Paragraph([Strong("No measurement: ", "bad"), record.error])
    yield Facts(
        (
            ("kind", record.kind),
            ("compared with", record.compared_with),
            ("its uncertainty", record.uncertainty),
            ("its source", record.source),
            ("tolerance", record.tolerance),
            ("verdict rule", f"{record.verdict_rule} {VERDICT_RULE}"),
        )
    )
    if record.findings:
        yield findings_table(record.findings, f"Findings: {record.title}")
    stored = record.stored
    if stored is not None:
        yield from _stored(record)
    for figure in record.measurement.figures:
        yield evidence_figure(figure, record.name)
    for table in record.measurement.tables:
        shown = evidence_table(table)
        if len(table.rows) > _UNFOLDED_ROWS:
            yield Details(f"{table.title} ({len(table.rows)} rows)", (shown,))
        else:
            yield shown
    if record.faults:
        yield _faults_table(record)
    yield Details("How it was measured", tuple(_provenance(record)))


def _stored(record: CaseRecord) -> Iterator[Block]:
    stored = record.stored
    assert stored is not None
    state = (
        "with the same code, so they count too"
        if stored.current
        else f"with other code ({', '.join(stored.changed)}), so they are only quoted"
    )
    said = f"The full tier, measured {stored.date[:10]} in {seconds_text(stored.seconds)} {state}:"
    yield Paragraph(said)
    yield findings_table(stored.findings, f"Findings of the full tier: {record.title}")


def _faults_table(record: CaseRecord) -> Table:
    rows = []
    for fault in record.faults:
        noticed = Cell("not planted in this run", tone="quiet")
        if fault.verdict is not None:
            caught = bool(fault.caught)
            noticed = Cell(f"{'noticed' if caught else 'unnoticed'}: {fault.verdict}",
                           tone="good" if caught else "bad")  # fmt: skip
        rows.append(Row((Cell(fault.name), Cell(fault.what), noticed)))
    columns = (Column("planted fault"), Column("what is made wrong"), Column("noticed"))
    return Table("Faults planted to see whether the case can fail", columns, tuple(rows),
                 tools=False)  # fmt: skip


def _provenance(record: CaseRecord) -> Iterator[Block]:
    yield Listing(record.command)
    versions = ", ".join(f"{name} {version}" for name, version in record.versions.items())
    seeds = ", ".join(map(str, record.seeds))
    facts: list[tuple[str, Words]] = [
        ("case", [Code(record.name)]),
        ("tier", record.tier),
        ("seeds", seeds or "nothing is random"),
        ("measured", f"{record.date}, in {seconds_text(record.seconds)}"),
        ("machine", record.machine),
        ("versions", versions),
    ]
    if record.code:
        code = ", ".join(f"{part} {digest[:12]}" for part, digest in record.code.items())
        facts.append(("code, with digests", code))
    yield Facts(tuple(facts))
