"""The records kept beside the cases: do they belong to case and code, which verdicts have changed?

Verdicts are compared, never numbers or bytes.
"""

from __future__ import annotations

import hashlib
import json
from collections.abc import Iterable, Iterator, Sequence
from pathlib import Path

from uqfold.validation.case import TIERS, Case, Tier, find_cases
from uqfold.validation.record import CaseRecord, RecordError, read_case_record, to_document
from uqfold.validation.runner import changed_since, command


def kept_records(cases: Path) -> list[CaseRecord]:
    """Read the records kept beside the cases of a folder: of each case the most thorough one."""
    kept = ([case.kept(tier) for tier in reversed(TIERS)] for case in find_cases(cases))
    first = (next((path for path in paths if path.is_file()), None) for paths in kept)
    return [read_case_record(path) for path in first if path is not None]


def changes(kept: CaseRecord | None, now: CaseRecord) -> tuple[str, ...]:
    """Return the verdicts, of a case, its claims or its findings, that are not the kept ones.

    Without a kept record a case is expected to hold; one that could not be measured has none.
    """
    if now.error:
        return ()
    if kept is None:
        text = "does not hold, and no record of another verdict is kept"
        return (text,) if now.verdict == "does not hold" else ()
    was, found = _verdicts(kept), _verdicts(now)
    turned = [what for what in was if what in found and was[what] != found[what]]
    return tuple(f"{what} was {was[what]!r} and is {found[what]!r}" for what in turned)


def _verdicts(record: CaseRecord) -> dict[str, str]:
    """Return the verdicts of a case, of its claims and of its findings, by what they are on."""
    claims = {f"the verdict on {key!r}": verdict for key, verdict in record.claims.items()}
    findings = {one.name: one.verdict or "quoted only" for one in record.findings}
    return {"the verdict": record.verdict, **claims, **findings}


def discrepancies(case: Case, tiers: Sequence[Tier] = TIERS) -> list[str]:
    """Return where the records that lie beside a case do not belong to it or to the code."""
    return [line for tier in tiers for line in _record_discrepancies(case, tier)]


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
    for text in record.broken:
        yield f"{path.name}: {text}"


def fingerprint(records: Iterable[CaseRecord]) -> str:
    """Return a digest of what some records say, for a report to carry.

    It does not depend on the order of the records, or on how their files are laid out.
    """
    documents = sorted(json.dumps(to_document(one), sort_keys=True) for one in records)
    return hashlib.sha256("\n".join(documents).encode()).hexdigest()[:16]
