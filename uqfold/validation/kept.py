"""The records kept beside the cases: do they belong to case and code, and what has changed since?

Verdicts are compared, and for every judged finding how much of its margin is left; never bytes.
"""

from __future__ import annotations

import hashlib
import json
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path

from uqfold.validation.case import Case, Tier, find_cases
from uqfold.validation.findings import Finding, number
from uqfold.validation.measurement import claim_verdicts
from uqfold.validation.record import (
    CaseRecord,
    RecordError,
    existing_record,
    read_case_record,
    to_document,
)
from uqfold.validation.runner import changed_since, command

KEPT_TIERS: tuple[Tier, ...] = ("quick", "full")
"""Tiers whose records are kept beside the cases; shorter tiers quote the second."""
MARGIN = 0.5
"""Share of its former margin that a finding may lose before that is said."""


@dataclass(frozen=True)
class Changes:
    """What differs from the kept record of a case; empty where the records tell the same.

    Attributes
    ----------
    verdicts
        Verdicts, of the case, its claims or its findings, that are not the kept ones.
    others
        What has changed otherwise: margins that are half gone, limits, findings that come and go.
    broken
        Why nothing can be said: no measurement, or planted faults that went unnoticed.
    """

    verdicts: tuple[str, ...] = ()
    others: tuple[str, ...] = ()
    broken: tuple[str, ...] = ()

    @property
    def words(self) -> tuple[str, ...]:
        """All of them, what weighs most first."""
        return (
            *(f"broken: {text}" for text in self.broken),
            *(f"changed: {text}" for text in self.verdicts),
            *(f"moved: {text}" for text in self.others),
        )


def kept_record(case: Case, tier: Tier) -> CaseRecord | None:
    """Read the record kept beside a case: of this tier, or else the most thorough one."""
    tiers = (tier,) if tier in KEPT_TIERS else KEPT_TIERS[::-1]
    records = (existing_record(case.kept(one)) for one in tiers)
    return next((record for record in records if record is not None), None)


def kept_records(cases: Path) -> list[CaseRecord]:
    """Read the records kept beside the cases of a folder: of each case the most thorough one."""
    kept = ([case.kept(tier) for tier in KEPT_TIERS[::-1]] for case in find_cases(cases))
    first = (next((path for path in paths if path.is_file()), None) for paths in kept)
    return [read_case_record(path) for path in first if path is not None]


def changes(kept: CaseRecord | None, now: CaseRecord) -> Changes:
    """Compare a record with the kept one of the same case.

    Parameters
    ----------
    kept
        From `kept_record`. Without one, the case is expected to hold; with one of another tier,
        only verdicts of the whole case are compared, and what this tier cannot judge has not
        changed. Otherwise only what was measured for a record counts: a full record that is quoted
        in a shorter tier may have become stale since, which changes no verdict.
    now
        What was measured.
    """
    if now.error:
        return Changes(broken=(f"could not be measured: {now.error}",))
    broken = tuple(
        f"the planted fault {one.fault.name!r} went unnoticed" for one in now.missed_faults
    )
    if kept is None:
        text = "does not hold, and no record of another verdict is kept"
        return Changes((text,) if now.verdict == "does not hold" else (), (), broken)
    if kept.tier != now.tier:
        text = f"the verdict was {kept.verdict!r} ({kept.tier} tier) and is {now.verdict!r}"
        same = now.verdict in (kept.verdict, "cannot be judged")
        return Changes(() if same else (text,), (), broken)
    was, found = _measured_verdicts(kept), _measured_verdicts(now)
    old = {finding.name: finding for finding in kept.findings}
    new = {finding.name: finding for finding in now.findings}
    both = [(old[name], new[name]) for name in old if name in new]
    return Changes(
        (
            *(f"{what} was {was[what]!r} and is {found[what]!r}"
              for what in was if found.get(what, was[what]) != was[what]),
            *(f"{one.name}: was {one.verdict or 'only quoted'!r}: {one.words}; is: {other.words}"
              for one, other in both if one.verdict != other.verdict),
        ),
        (
            *(f"{name}: no longer measured" for name in old if name not in new),
            *(f"{name}: not measured before" for name in new if name not in old),
            *(text for one, other in both
              for text in _moved(one, other, speed=now.case.kind == "benchmark")),
        ),
        broken,
    )  # fmt: skip


def _measured_verdicts(record: CaseRecord) -> dict[str, str]:
    """Return the verdicts of the case and of its claims on what was measured for this record."""
    claims = claim_verdicts(record.measurement.claims, record.findings)
    verdicts: dict[str, str] = {"the verdict": record.measurement.verdict}
    return verdicts | {f"the verdict on {key!r}": verdict for key, verdict in claims.items()}


def _moved(old: Finding, new: Finding, *, speed: bool) -> Iterator[str]:
    """Yield what differs between two findings that give the same verdict."""
    if (old.limit, old.at_least) != (new.limit, new.at_least):
        yield f"{old.name}: the limit has changed; was: {old.words}; is: {new.words}"
    # a limit that was just kept (a loss of exactly zero) has no margin to lose
    if (
        not speed
        and old.verdict == new.verdict == "holds"
        and old.margin
        and new.margin is not None
    ):
        lost = 1.0 - new.margin / old.margin
        if lost > MARGIN:
            share = f"lost {number(100.0 * lost)} % of its margin"
            yield f"{old.name}: {share}; was: {old.words}; is: {new.words}"


def discrepancies(case: Case, tiers: Sequence[Tier] = KEPT_TIERS) -> list[str]:
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
    if record.error:
        yield f"{path.name} holds no measurement: {record.error}"
    for one in record.missed_faults:
        yield f"{path.name}: the planted fault {one.fault.name!r} went unnoticed"


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
