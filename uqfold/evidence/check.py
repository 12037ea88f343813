"""Do the kept records, the cases, the code and the report belong together?"""

from __future__ import annotations

import hashlib
import json
from collections.abc import Iterable, Iterator, Sequence
from pathlib import Path

from uqfold.evidence.case import Case
from uqfold.evidence.code_digest import changed_parts, code_digests
from uqfold.evidence.record import CaseRecord
from uqfold.evidence.record_file import RecordError, read_case_record, to_document
from uqfold.evidence.runner import command, declared

KEPT_TIERS = "quick", "full"
"""Tiers whose records are kept beside the cases; shorter tiers quote the second."""


def discrepancies(case: Case, tiers: Sequence[str] = KEPT_TIERS) -> list[str]:
    """Say where the records that lie beside a case do not belong to it or to the code."""
    code = code_digests(case.folder, case.data)
    return [line for tier in tiers for line in _record_discrepancies(case, tier, code)]


def fingerprint(records: Iterable[CaseRecord]) -> str:
    """Give a digest of what some records say, for a report to carry.

    It does not depend on the order of the records, or on how their files are laid out.
    """
    documents = sorted(json.dumps(to_document(one), sort_keys=True) for one in records)
    return hashlib.sha256("\n".join(documents).encode()).hexdigest()[:16]


def report_discrepancies(report: Path, records: Sequence[CaseRecord]) -> list[str]:
    """Say whether a report carries the fingerprint of these records."""
    if not report.is_file():
        return ["there is no report"]
    if fingerprint(records) not in report.read_text(encoding="utf-8"):
        return ["the report was made from other records"]
    return []


def _record_discrepancies(case: Case, tier: str, code: dict[str, str]) -> Iterator[str]:
    path = case.folder / f"{tier}.json"
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
    other = [name for name, value in declared(case).items() if getattr(record, name) != value]
    if other:
        yield f"{path.name}: the case has changed since: {', '.join(other)}"
    if [one.name for one in record.faults] != [one.name for one in case.faults]:
        yield f"{path.name}: other faults are declared now"
    changed = changed_parts(record.code, code)
    if changed:
        yield (
            f"{path.name} of {record.date[:10]} was measured with other code ({', '.join(changed)})"
            f": {command(case, record.tier)} --update"
        )
    if record.error:
        yield f"{path.name} holds no measurement: {record.error}"
    for fault in record.missed_faults:
        yield f"{path.name}: the planted fault {fault.name!r} went unnoticed"
