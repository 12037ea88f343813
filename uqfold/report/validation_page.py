"""The report on validation cases, as a page."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator, Mapping, Sequence

import uqfold
from uqfold.evidence.changes import Changes
from uqfold.evidence.check import fingerprint
from uqfold.evidence.record import CaseRecord, PlantedFault
from uqfold.report.evidence_blocks import (
    VERDICT_TONES,
)
from uqfold.report.page.blocks import (
    Block,
    Card,
    Cards,
    Cell,
    Code,
    Column,
    Facts,
    Link,
    Page,
    Paragraph,
    Part,
    Row,
    Section,
    Strong,
    Table,
    Tone,
    Words,
)
from uqfold.report.validation_case import case_anchor, case_section
from uqfold.report.verdicts import kept_text, reasons
from uqfold.report.wording import seconds_text

_NAMED = 3
"""Claims that do not hold which the first screen names in a card; more of them get a table."""
_LISTED = 6
"""Rows of that table."""


def validation_page(
    records: Sequence[CaseRecord], changes: Mapping[str, Changes] | None = None
) -> Page:
    """Make the report on validation cases.

    Parameters
    ----------
    records
        One for each case; nothing that they name is imported or run.
    changes
        Name of a case -> what differs from its kept record; None: that was not looked at.

    Raises
    ------
    ValueError
        If there are none.
    """
    if not records:
        raise ValueError("there are no records to report on: run `uqfold validate` first")
    topics: dict[str, list[CaseRecord]] = {}
    for record in records:
        topics.setdefault(record.topic, []).append(record)
    days = sorted({record.date[:10] for record in records})
    when = days[0] if len(days) == 1 else f"{days[0]} to {days[-1]}"
    tiers = Counter(record.tier for record in records)
    how = ", ".join(f"{count} in the {tier} tier" for tier, count in tiers.items())
    return Page(
        title="Does uqfold compute what it claims?",
        kicker="Validation report",
        lead=f"{len(records)} claims, each with what it is compared with, a tolerance with its "
        f"reason, and a verdict. Measured {when}, {how}, in {_total_time(records)}.",
        summary=tuple(_summary(records, topics, changes)),
        sections=(
            Section("cases", "All cases", (_topics_table(topics), _cases_table(records)))
            if sum(map(fails, records)) > _NAMED
            else Section("cases", "All cases", (_cases_table(records),)),
            *(_topic(topic, own, i) for i, (topic, own) in enumerate(topics.items())),
            _reading(),
        ),
        imprint=[
            f"Made by uqfold {uqfold.__version__} from records alone; no model was run. Digest of "
            "the records: ",
            Code(fingerprint(records)),
            ".",
        ],
    )


def _total_time(records: Sequence[CaseRecord]) -> str:
    total = sum(record.seconds for record in records)
    return seconds_text(total) if total < 120.0 else f"{total / 60.0:.0f} minutes"


def _summary(
    records: Sequence[CaseRecord],
    topics: dict[str, list[CaseRecord]],
    changes: Mapping[str, Changes] | None,
) -> Iterator[Block]:
    kept = () if changes is None else (_kept_card(records, changes),)
    yield Cards((_checked_card(records), _verdict_card(records), _failing_card(records), *kept))
    failing = [record for record in records if fails(record)]
    if len(failing) > _NAMED:
        yield _failing_table(failing[:_LISTED])
        if len(failing) > _LISTED:
            yield Paragraph(f"and {len(failing) - _LISTED} more, in the table of all cases.")
    else:
        yield _topics_table(topics)


def _checked_card(records: Sequence[CaseRecord]) -> Card:
    kinds = Counter(record.kind for record in records)
    said = ", ".join(f"{count} {kind}" for kind, count in kinds.most_common())
    planted = [fault for record in records for fault in record.faults if fault.caught is not None]
    more = [f"By kind: {said}."]
    if planted:
        caught = sum(fault.caught is True for fault in planted)
        more.append(f"{caught} of {len(planted)} faults planted on purpose were noticed.")
    else:
        declared = sum(len(record.faults) for record in records)
        more.append(f"{declared} faults can be planted; none was in this run.")
    noun = "claim" if len(records) == 1 else "claims"
    return Card("What was checked?", f"{len(records)} {noun}", tuple(more))


def _verdict_card(records: Sequence[CaseRecord]) -> Card:
    counts = Counter(record.verdict for record in records)
    answer = f"{counts['holds']} of {len(records)} hold"
    more: list[Words] = [
        [Strong(f"{counts[verdict]} {_plural(verdict, counts[verdict])}", tone), "."]
        for verdict, tone in VERDICT_TONES.items()
        if verdict != "holds" and counts[verdict]
    ]
    limits = Counter(one.verdict for record in records for one in record.judged if one.verdict)
    said = f"{limits['holds']} of {limits.total()} limits are kept"
    open_ones = limits["cannot be judged"]
    more.append(f"{said}; {open_ones} cannot be judged." if open_ones else f"{said}.")
    tone: Tone = "good"
    if counts["does not hold"]:
        tone = "bad"
    elif counts["cannot be judged"]:
        tone = "warn"
    return Card("What holds?", answer, tuple(more), tone)


def _kept_card(records: Sequence[CaseRecord], changes: Mapping[str, Changes]) -> Card:
    compared = [(one, changes[one.name]) for one in records if one.name in changes]
    more = tuple(_linked(record, text) for record, found in compared for text in found.words)
    tone: Tone = "good"
    if any(found.broken or found.verdicts for _, found in compared):
        tone = "bad"
    answer = kept_text([found for _, found in compared])
    return Card("Is that what was found before?", answer[0].upper() + answer[1:], more, tone)


def _plural(verdict: str, count: int) -> str:
    return "do not hold" if verdict == "does not hold" and count > 1 else verdict


def _failing_card(records: Sequence[CaseRecord]) -> Card:
    title = "What does not hold, and why?"
    failing = [record for record in records if fails(record)]
    if not failing:
        unjudged = [record for record in records if record.verdict == "cannot be judged"]
        open_ones = tuple(_linked(one, _first_reason(one)) for one in unjudged[:_NAMED])
        return Card(title, "Nothing", open_ones, "warn" if unjudged else "good")
    named = failing[: _NAMED if len(failing) <= _NAMED else 1]
    more: tuple[Words, ...] = tuple(_linked(one, _first_reason(one)) for one in named)
    if len(failing) > len(named):
        more = (*more, f"and {len(failing) - len(named)} more, in the table below.")
    noun = "case" if len(failing) == 1 else "cases"
    return Card(title, f"{len(failing)} {noun}", more, "bad")


def _linked(record: CaseRecord, why: str) -> list[Part]:
    return [Link(record.title, case_anchor(record)), f": {why}"]


def _first_reason(record: CaseRecord) -> str:
    found = reasons(record)
    # the card says already that it does not hold
    return found[0].replace(" - does not hold", "") if found else "nothing in it has a limit"


def _shortest(record: CaseRecord) -> str:
    others = len(reasons(record)) - 1
    return _first_reason(record) + (f"; and {others} more" if others > 0 else "")


def fails(record: CaseRecord) -> bool:
    """Whether a case does not hold, was not measured, or missed a planted fault."""
    broken = record.verdict == "does not hold"
    return bool(broken or record.error or record.missed_faults)


def _failing_table(failing: Sequence[CaseRecord]) -> Table:
    rows = [
        Row(
            (
                Cell([Link(record.title, case_anchor(record))]),
                Cell(record.verdict, tone=VERDICT_TONES[record.verdict]),
                Cell(_shortest(record)),
            )
        )
        for record in failing
    ]
    columns = (Column("case"), Column("verdict"), Column("why"))
    return Table("What does not hold, and why", columns, tuple(rows), tools=False)


def _topics_table(topics: dict[str, list[CaseRecord]]) -> Table:
    rows = []
    for i, (topic, records) in enumerate(topics.items()):
        counts = Counter(record.verdict for record in records)
        faults = [fault for record in records for fault in record.faults]
        cells = [Cell([Link(topic, _topic_anchor(i))]), _count_cell(len(records), "")]
        cells += [_count_cell(counts[verdict], tone) for verdict, tone in VERDICT_TONES.items()]
        cells.append(_faults_cell(faults))
        seconds = sum(record.seconds for record in records)
        cells.append(Cell(seconds_text(seconds), seconds))
        rows.append(Row(tuple(cells)))
    heads = ["topic", "claims", *VERDICT_TONES, "faults noticed", "time"]
    columns = tuple(Column(head, numeric=i > 0) for i, head in enumerate(heads))
    return Table("Verdicts by topic", columns, tuple(rows), show_caption=False)


def _count_cell(count: int, tone: Tone) -> Cell:
    return Cell(str(count) if count else "–", float(count), tone if count else "quiet")


def _faults_cell(faults: Sequence[PlantedFault]) -> Cell:
    planted = [fault for fault in faults if fault.caught is not None]
    if not planted:
        return Cell("not planted" if faults else "–", -1.0, "quiet")
    caught = sum(fault.caught is True for fault in planted)
    tone: Tone = "good" if caught == len(planted) else "bad"
    return Cell(f"{caught} of {len(planted)}", caught / len(planted), tone)


def _cases_table(records: Sequence[CaseRecord]) -> Table:
    columns = (
        Column("case"),
        Column("topic", choices=True),
        Column("kind", choices=True),
        Column("verdict", choices=True),
        Column("limits kept", numeric=True),
        Column("faults noticed", numeric=True),
        Column("tier", choices=True),
        Column("time", numeric=True),
        Column("date"),
    )
    rows = []
    for record in records:
        judged = [one for one in record.judged if one.verdict is not None]
        kept = sum(one.verdict == "holds" for one in judged)
        rows.append(
            Row(
                (
                    Cell([Link(record.title, case_anchor(record))]),
                    Cell(record.topic),
                    Cell(record.kind),
                    Cell(record.verdict, tone=VERDICT_TONES[record.verdict]),
                    Cell(f"{kept} of {len(judged)}", float(kept)),
                    _faults_cell(record.faults),
                    Cell(record.tier),
                    Cell(seconds_text(record.seconds), record.seconds),
                    Cell(record.date[:10]),
                )
            )
        )
    return Table("All cases", columns, tuple(rows), show_caption=False)


def _topic(topic: str, records: Sequence[CaseRecord], index: int) -> Section:
    title = topic[:1].upper() + topic[1:]
    return Section(_topic_anchor(index), title, tuple(case_section(record) for record in records))


def _topic_anchor(index: int) -> str:
    return f"topic-{index + 1}"


def _reading() -> Section:
    """Explain the words of the report."""
    return Section(
        "reading",
        "How to read this",
        (
            Facts(
                (
                    ("holds", "at least one limit was judged, and every limit is kept"),
                    ("does not hold", "one limit or more is broken"),
                    (
                        "cannot be judged",
                        "no limit is broken, but one at least cannot be judged (the number lies "
                        "closer to it than its own uncertainty, or nobody here can measure it), or "
                        "there is none, or the measurement failed",
                    ),
                    (
                        "planted fault",
                        "an error made on purpose (a wrong sign, a stale reference); a case that "
                        "still holds with it proves nothing",
                    ),
                    (
                        "tier",
                        "quick and default measure with small sizes, full with large ones; what "
                        "full found earlier is quoted with its date",
                    ),
                )
            ),
        ),
    )
