"""The report on validation cases, as a page; made from records alone, no model is run."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Mapping, Sequence
from typing import Any, get_args

import pandas as pd

import uqfold
from uqfold.plots.wording import seconds_text
from uqfold.report.page.builder import Page
from uqfold.report.page.cells import Tone
from uqfold.report.page.markup import literal
from uqfold.report.validation_case import VERDICT_TONES, case_anchor, case_section
from uqfold.report.verdicts import kept_text, reasons
from uqfold.validation.changes import Changes
from uqfold.validation.check import fingerprint
from uqfold.validation.findings import Verdict
from uqfold.validation.record import CaseRecord

_NAMED = 3
"""Cases that do not hold which a card names; more of them are named below."""


def validation_page(
    records: Sequence[CaseRecord], changes: Mapping[str, Changes] | None = None
) -> Page:
    """Return the report on validation cases.

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
    days = sorted({record.date[:10] for record in records})
    tiers = Counter(record.tier for record in records)
    page = Page(
        "Does uqfold compute what it claims?",
        f"{sum(map(_claims, records))} claims in {len(records)} cases, each with what it is "
        "compared with, a tolerance with its reason, and a verdict. Measured "
        f"{' to '.join(dict.fromkeys((days[0], days[-1])))}, "
        f"{', '.join(f'{count} in the {tier} tier' for tier, count in tiers.items())}; the times "
        f"of the cases add up to {_total_time(records)}.",
        kind="Validation report",
        imprint=f"Made by uqfold {uqfold.__version__} from records alone; no model was run. Digest "
        f"of the records: `{fingerprint(records)}`.",
    )
    _summary(page, records, changes)
    topics: dict[str, list[CaseRecord]] = {}
    for record in records:
        topics.setdefault(record.case.topic, []).append(record)
    page.section("All cases", name="cases")
    page.table(_cases(records), "All cases", tones=VERDICT_TONES)
    page.table(_topics(topics), "Verdicts by topic")
    for topic, own in topics.items():
        page.section(topic[:1].upper() + topic[1:], name=f"topic-{topic}")
        for record in own:
            case_section(page, record)
    _reading(page)
    return page


def fails(record: CaseRecord) -> bool:
    """Whether a case does not hold, was not measured, or missed a planted fault."""
    broken = record.verdict == "does not hold"
    return bool(broken or record.error or record.missed_faults)


def _verdicts(records: Iterable[CaseRecord]) -> Counter[Verdict]:
    """Verdicts of all claims, of which most cases have one."""
    return Counter(
        verdict for record in records for verdict in record.claims.values() or [record.verdict]
    )


def _claims(record: CaseRecord) -> int:
    return len(record.claims) or 1


def _total_time(records: Sequence[CaseRecord]) -> str:
    total = sum(record.seconds for record in records)
    return seconds_text(total) if total < 120.0 else f"{total / 60.0:.0f} minutes"


def _summary(
    page: Page, records: Sequence[CaseRecord], changes: Mapping[str, Changes] | None
) -> None:
    kinds = Counter(record.case.kind for record in records)
    claims = sum(map(_claims, records))
    page.card(
        "What was checked?",
        "1 claim" if claims == 1 else f"{claims} claims",
        f"By kind: {', '.join(f'{count} {kind}' for kind, count in kinds.most_common())}.",
        _faults(records),
    )
    _verdict_card(page, records)
    failing = [record for record in records if fails(record)]
    _failing_card(page, records, failing)
    if changes is not None:
        _kept_card(page, records, changes)
    for record in failing if len(failing) > _NAMED else ():
        page.text(f"- {_linked(record, _shortest(record))}")


def _faults(records: Iterable[CaseRecord]) -> str:
    faults = [one for record in records for one in record.faults]
    planted = [one for one in faults if one.caught is not None]
    if not planted:
        return f"{len(faults)} faults can be planted; none was in this run."
    caught = sum(one.caught is True for one in planted)
    return f"{caught} of {len(planted)} faults planted on purpose were noticed."


def _verdict_card(page: Page, records: Sequence[CaseRecord]) -> None:
    counts = _verdicts(records)
    more = []
    for verdict in ("does not hold", "cannot be judged"):
        number = counts[verdict]
        plural = "do not hold" if verdict == "does not hold" and number > 1 else verdict
        if number:
            more.append(f"**{number} {plural}**.")
    identities = sum(one.identity for record in records for one in record.measurement.claims)
    if identities:
        more.append(f"{identities} of those that hold: an identity, which is no evidence.")
    limits = Counter(one.verdict for record in records for one in record.judged if one.verdict)
    open_ones = limits["cannot be judged"]
    more.append(
        f"{limits['holds']} of {limits.total()} limits are kept"
        + (f"; {open_ones} cannot be judged." if open_ones else ".")
    )
    tone: Tone = "good"
    if counts["does not hold"]:
        tone = "bad"
    elif counts["cannot be judged"]:
        tone = "warn"
    page.card("What holds?", f"{counts['holds']} of {counts.total()} hold", *more, tone=tone)


def _failing_card(page: Page, records: Sequence[CaseRecord], failing: Sequence[CaseRecord]) -> None:
    title = "What does not hold, and why?"
    if not failing:
        unjudged = [one for one in records if one.verdict == "cannot be judged"]
        said = [_linked(one, _first_reason(one)) for one in unjudged[:_NAMED]]
        page.card(title, "Nothing", *said, tone="warn" if unjudged else "good")
        return
    named = failing[: _NAMED if len(failing) <= _NAMED else 1]
    said = [_linked(one, _first_reason(one)) for one in named]
    if len(failing) > len(named):
        said.append(f"and {len(failing) - len(named)} more, below.")
    answer = "1 case" if len(failing) == 1 else f"{len(failing)} cases"
    page.card(title, answer, *said, tone="bad")


def _kept_card(page: Page, records: Sequence[CaseRecord], changes: Mapping[str, Changes]) -> None:
    compared = [(one, changes[one.name]) for one in records if one.name in changes]
    said = [_linked(record, text) for record, found in compared for text in found.words]
    stale = [one for one in records if one.stored is not None and not one.stored.current]
    if stale:
        said.append(
            f"{len(stale)} cases quote a full record that was measured with other code: "
            f"{', '.join(f'`{one.name}`' for one in stale)}."
        )
    bad = any(found.broken or found.verdicts for _, found in compared)
    answer = kept_text([found for _, found in compared])
    page.card(
        "Is that what was found before?",
        answer[0].upper() + answer[1:],
        *said,
        tone="bad" if bad else "good",
    )


def _linked(record: CaseRecord, why: str) -> str:
    return f"[{literal(record.case.title)}](#{case_anchor(record)}): {literal(why)}"


def _first_reason(record: CaseRecord) -> str:
    found = reasons(record)
    # the card says already that it does not hold
    return found[0].replace(" - does not hold", "") if found else "nothing in it has a limit"


def _shortest(record: CaseRecord) -> str:
    others = len(reasons(record)) - 1
    return _first_reason(record) + (f"; and {others} more" if others > 0 else "")


def _topics(topics: Mapping[str, Sequence[CaseRecord]]) -> pd.DataFrame:
    rows = []
    for topic, records in topics.items():
        counts = _verdicts(records)
        rows.append(
            {"topic": topic, "claims": counts.total()}
            | {verdict: counts[verdict] for verdict in get_args(Verdict)}
            | {"faults noticed": _noticed(records)}
        )
    return pd.DataFrame(rows)


def _cases(records: Sequence[CaseRecord]) -> pd.DataFrame:
    return pd.DataFrame(map(_case_row, records))


def _case_row(record: CaseRecord) -> dict[str, Any]:
    judged = [one for one in record.judged if one.verdict is not None]
    kept = sum(one.verdict == "holds" for one in judged)
    return {
        "case": record.name,
        "title": record.case.title,
        "topic": record.case.topic,
        "kind": record.case.kind,
        "verdict": record.verdict,
        "limits kept": f"{kept} of {len(judged)}",
        "faults noticed": _noticed([record]),
        "tier": record.tier,
        "time (s)": record.seconds,
        "date": record.date[:10],
    }


def _noticed(records: Iterable[CaseRecord]) -> str:
    planted = [one.caught for record in records for one in record.faults if one.caught is not None]
    return f"{sum(planted)} of {len(planted)}" if planted else "not planted"


def _reading(page: Page) -> None:
    """Explain the words of the report."""
    page.section("How to read this", name="reading")
    page.facts(
        {
            "holds": "at least one limit was judged, and every limit is kept",
            "does not hold": "one limit or more is broken",
            "cannot be judged": "no limit is broken, but one at least cannot be judged (the number "
            "lies closer to it than its own uncertainty, or nobody here can measure it), or there "
            "is none, or the measurement failed",
            "planted fault": "an error made on purpose (a wrong sign, a stale reference); a case "
            "that still holds with it proves nothing",
            "tier": "quick and default measure with small sizes, full with large ones; what full "
            "found earlier is quoted with its date",
        }
    )
