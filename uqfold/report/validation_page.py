"""The report on validation cases, as a page; made from records alone, no model is run."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence

import uqfold
from uqfold.plots.wording import seconds_text
from uqfold.report.page.builder import Page
from uqfold.report.page.cells import Tone, typeset
from uqfold.report.page.markup import literal
from uqfold.report.validation_case import case_anchor, case_section
from uqfold.report.verdicts import cases_table, counted, faults_text, limits_text, reasons
from uqfold.validation.findings import Verdict
from uqfold.validation.kept import fingerprint
from uqfold.validation.record import CaseRecord

_READING = {
    "holds": "at least one limit was judged, and every limit is kept",
    "does not hold": "one limit or more is broken",
    "cannot be judged": "no limit is broken, but one at least cannot be judged (the number "
    "lies closer to it than its own uncertainty, or nobody here can measure it), or there "
    "is none, or the measurement failed",
    "planted fault": "an error made on purpose (a wrong sign, a stale reference); a case "
    "that still holds with it proves nothing",
    "tier": "quick measures with small sizes, full with large ones",
}


def validation_page(records: Sequence[CaseRecord]) -> Page:
    """Return the report on validation cases.

    Parameters
    ----------
    records
        One for each case; nothing that they name is imported or run.

    Raises
    ------
    ValueError
        If there are none.
    """
    if not records:
        raise ValueError("there are no records to report on: run `uqfold validate` first")
    days = sorted({record.date[:10] for record in records})
    tiers = Counter(record.tier for record in records)
    verdicts = [one for record in records for one in record.claims.values() or [record.verdict]]
    page = Page(
        "Does uqfold compute what it claims?",
        f"{counted(len(verdicts), 'claim')} in {counted(len(records), 'case')}, each "
        "with what it is compared with, a tolerance with its reason, and a verdict. Measured "
        f"{' to '.join(dict.fromkeys((days[0], days[-1])))}, "
        f"{', '.join(f'{count} in the {tier} tier' for tier, count in tiers.items())}; the times "
        f"of the cases add up to {seconds_text(sum(record.seconds for record in records))}.",
        kind="Validation report",
        imprint=f"Made by uqfold {uqfold.__version__} from records alone; no model was run. Digest "
        f"of the records: `{fingerprint(records)}`.",
    )
    _holds_card(page, records, verdicts)
    _failing_card(page, records)
    page.section("All cases", name="cases")
    page.table(cases_table(records), "All cases")
    for topic in dict.fromkeys(record.case.topic for record in records):
        page.section(topic[:1].upper() + topic[1:], name=f"topic-{topic}")
        for record in records:
            if record.case.topic == topic:
                case_section(page, record)
    page.section("How to read this", name="reading")
    page.facts(_READING)
    return page


def _holds_card(page: Page, records: Sequence[CaseRecord], verdicts: Sequence[Verdict]) -> None:
    counts = Counter(verdicts)
    broken, unjudged = counts["does not hold"], counts["cannot be judged"]
    more = [f"**{broken} {'does' if broken == 1 else 'do'} not hold**."] if broken else []
    more += [f"**{unjudged} cannot be judged**."] if unjudged else []
    identities = sum(one.identity for record in records for one in record.measurement.claims)
    if identities:
        more.append(f"{identities} of those that hold: an identity, which is no evidence.")
    more.append(f"{limits_text(records)} limits are kept.")
    more.append(f"{faults_text(records)} faults planted on purpose were noticed.")
    tone: Tone = "bad" if broken else "warn" if unjudged else "good"
    page.card("What holds?", f"{counts['holds']} of {counts.total()} hold", *more, tone=tone)


def _failing_card(page: Page, records: Sequence[CaseRecord]) -> None:
    failing = [one for one in records if one.verdict == "does not hold" or one.broken]
    unjudged = [one for one in records if one.verdict == "cannot be judged" and one not in failing]
    tone: Tone = "bad" if failing else "warn" if unjudged else "good"
    answer = counted(len(failing), "case") if failing else "Nothing"
    why = map(_first_reason, failing or unjudged)
    page.card("What does not hold, and why?", answer, *why, tone=tone)


def _first_reason(record: CaseRecord) -> str:
    first, *others = reasons(record) or ["nothing in it has a limit"]
    # the card says already that it does not hold
    text = first.replace(" - does not hold", "") + (f"; and {len(others)} more" if others else "")
    return f"[{literal(record.case.title)}](#{case_anchor(record)}): {literal(typeset(text))}"
