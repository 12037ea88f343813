"""Do the kept records, the cases, the code and the report belong together?"""

from __future__ import annotations

import hashlib
import json
from collections.abc import Iterable, Iterator, Sequence
from pathlib import Path

from uqfold.validation.case import Case, Tier
from uqfold.validation.record import CaseRecord, RecordError, read_case_record, to_document
from uqfold.validation.runner import changed_since, command, existing_record

KEPT_TIERS: tuple[Tier, ...] = ("quick", "full")
"""Tiers whose records are kept beside the cases; shorter tiers quote the second."""


def kept_record(case: Case, tier: Tier) -> CaseRecord | None:
    """Read the record kept beside a case: of this tier, or else the most thorough one."""
    tiers = (tier,) if tier in KEPT_TIERS else KEPT_TIERS[::-1]
    records = (existing_record(case.kept(one)) for one in tiers)
    return next((record for record in records if record is not None), None)


def discrepancies(case: Case, tiers: Sequence[Tier] = KEPT_TIERS) -> list[str]:
    """Return where the records that lie beside a case do not belong to it or to the code."""
    return [line for tier in tiers for line in _record_discrepancies(case, tier)]


def fingerprint(records: Iterable[CaseRecord]) -> str:
    """Return a digest of what some records say, for a report to carry.

    It does not depend on the order of the records, or on how their files are laid out.
    """
    documents = sorted(json.dumps(to_document(one), sort_keys=True) for one in records)
    return hashlib.sha256("\n".join(documents).encode()).hexdigest()[:16]


def report_discrepancies(report: Path, records: Sequence[CaseRecord]) -> list[str]:
    """Return what is wrong with a report that should carry the fingerprint of these records."""
    if not report.is_file():
        return ["there is no report"]
    if fingerprint(records) not in report.read_text(encoding="utf-8"):
        return ["the report was made from other records"]
    return []


def _record_discrepancies(case: Case, tier: Tier) -> Iterator[str]:
    path = case.kept(tier)
    if not path.exists():
        yield f"no record of the {tier} tier is kept"
        return
    try:
        record = read_case_record(path)
    except RecordError as error:
        yield str(error)
        return
    if record.tier != tier:
        yield f"{path.name} holds a record of the {record.tier} tier"
    fields = type(case.declared).__dataclass_fields__
    other = [one for one in fields if getattr(record.case, one) != getattr(case.declared, one)]
    if other:
        yield f"{path.name}: the case has changed since: {', '.join(other)}"
    if tuple(one.fault for one in record.faults) != case.faults:
        yield f"{path.name}: other faults are declared now"
    changed = changed_since(record, case)
    if changed:
        yield (
            f"{path.name} of {record.date[:10]} was measured with other code ({', '.join(changed)})"
            f": {command(case, record.tier)} --update"
        )
    if record.error:
        yield f"{path.name} holds no measurement: {record.error}"
    for one in record.missed_faults:
        yield f"{path.name}: the planted fault {one.fault.name!r} went unnoticed"
